/*
 * From bytes to libconfig's tree, with the bounds that a file from outside
 * needs: at most CONFIG_TEXT_MAX bytes and CONFIG_TEXT_KEYS settings, no NUL,
 * no @include (a layout must be one file so that its hash and its line
 * numbers mean something).
 *
 * Private to config/.
 */
#ifndef GROTTO_CONFIG_CONFIG_TEXT_H
#define GROTTO_CONFIG_CONFIG_TEXT_H

#include "base/diag.h"

#include <libconfig.h>
#include <stddef.h>

#define CONFIG_TEXT_MAX (1024u * 1024u)
/*
 * libconfig compares each new key with all others of its group: 120,000 keys,
 * which 1 MiB can hold, take minutes. Counted as '=' and ':', so a few in
 * comments and IPv6 addresses count too.
 */
#define CONFIG_TEXT_KEYS 8192

/*
 * The whole file as a string, caller frees. GR_OK, GR_ERR_IO (named in diag),
 * GR_ERR_CONFIG (too long, or not a regular file), GR_ERR_NOMEM.
 */
int config_text_load(const char *path, char **out_text, size_t *out_len, struct gr_diag *diag);

/*
 * Parses len bytes; name stands in the messages. On GR_OK the caller ends
 * with config_destroy; otherwise (GR_ERR_CONFIG, GR_ERR_NOMEM) there is
 * nothing to destroy.
 */
int config_text_parse(const char *text, size_t len, const char *name, config_t *out,
		      struct gr_diag *diag);

/* `file` beside the file `beside`, unless it is absolute. Caller frees; NULL when out of memory. */
char *config_text_beside(const char *beside, const char *file);

#endif
