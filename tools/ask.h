/*
 * Asks a running master over its control socket (docs/control.md): one line
 * out, one line with a JSON document back.
 */
#ifndef GROTTO_TOOLS_ASK_H
#define GROTTO_TOOLS_ASK_H

#include <stddef.h>
#include <stdint.h>

#define ASK_ANSWER_MAX 65538 /* with newline and NUL */

/*
 * `answer` gets the line without its newline, NUL-terminated. Waits no longer
 * than patience_ns for all of it. GR_OK; GR_ERR_IO (errno: nobody listens,
 * not allowed), GR_ERR_TIMEOUT, GR_ERR_FORMAT for an answer without an end or
 * longer than size, GR_ERR_RANGE for a path that no socket can have.
 */
int ask_master(const char *path, const char *request, int64_t patience_ns, char *answer,
	       size_t size);

#endif
