/*
 * A surfel set as a file. Little endian:
 *
 *   "GRSURFEL", u32 form, u32 baker, key, u64 length of the whole file,
 *   counts and lengths (surfel_file.c), the arrays of surfel_set_parts one after
 *   the other, and BLAKE2b-256 of all that stands before it.
 *
 * The key says what the set was made from: a file of another key is stale.
 * Nothing of a file is used before its checksum, every size, every index and
 * every number have been looked at; what is wrong is said in diag.
 *
 * Thread safety: none needed; no state.
 */
#ifndef GROTTO_RENDERER_GI_SURFEL_FILE_H
#define GROTTO_RENDERER_GI_SURFEL_FILE_H

#include "base/diag.h"
#include "renderer/gi/surfel_bake.h"
#include "renderer/gi/surfel_set.h"

#include <stdint.h>

#define SURFEL_FILE_FORM 2
#define SURFEL_KEY_BYTES 32
/* Longest file that is read. */
#define SURFEL_FILE_MOST ((uint64_t)6 << 30)

/* Of all that the set depends on: the scene's content, the settings, the baker. */
void surfel_file_key(const struct scene *scene, const struct surfel_bake_params *params,
		     uint8_t key[SURFEL_KEY_BYTES]);

/* Whole or not at all: beside `path` first, then renamed. GR_OK, GR_ERR_IO (errno says why). */
int surfel_file_write(const struct surfel_set *set, const uint8_t key[SURFEL_KEY_BYTES],
		      const char *path);
/*
 * GR_NOTHING: there is no file. GR_ERR_VERSION: of another grotto;
 * GR_ERR_MISMATCH: of another scene or other settings; GR_ERR_FORMAT: cut short,
 * damaged, or no such file at all; GR_ERR_IO, GR_ERR_NOMEM. A warning in diag
 * says which and why; *out is NULL then.
 */
int surfel_file_read(struct surfel_set **out, const uint8_t key[SURFEL_KEY_BYTES],
		     const char *path, struct gr_diag *diag);
/* The same from bytes; name stands in messages. */
int surfel_file_decode(struct surfel_set **out, const uint8_t key[SURFEL_KEY_BYTES],
		       const uint8_t *bytes, size_t len, const char *name, struct gr_diag *diag);

#endif
