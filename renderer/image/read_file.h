/* A whole file into memory, for decoders that take bytes. */
#ifndef GROTTO_RENDERER_IMAGE_READ_FILE_H
#define GROTTO_RENDERER_IMAGE_READ_FILE_H

#include "base/diag.h"

#include <stddef.h>
#include <stdint.h>

/*
 * 1 to `most` bytes of a plain file; the caller frees *out. GR_ERR_CONFIG with
 * a line in diag that begins with `what` ("texture"), or GR_ERR_NOMEM.
 */
int read_file(const char *path, size_t most, uint8_t **out, size_t *out_len, struct gr_diag *diag,
	      const char *what);

#endif
