/*
 * The control socket: a Unix stream socket on which a client sends one
 * request a line and gets one JSON document a line. docs/control.md gives the
 * requests. What arrives is hostile until it is checked: a line is at most
 * CONTROL_LINE_MAX bytes of printable ASCII; clients that do not take their
 * answer, or send a line without an end, are dropped.
 *
 * Fixed number of clients with fixed buffers; nothing is allocated after
 * control_create. Thread: the loop's.
 */
#ifndef GROTTO_DAEMON_CONTROL_H
#define GROTTO_DAEMON_CONTROL_H

#include "base/clock.h"
#include "daemon/loop.h"

#include <stddef.h>

#define CONTROL_CLIENTS 8
#define CONTROL_LINE_MAX 1024
#define CONTROL_ANSWER_MAX 65536
#define CONTROL_WORDS 64
#define CONTROL_SLOW_NS (2 * GR_NS_PER_S)  /* an answer not taken, a line not ended */
#define CONTROL_IDLE_NS (60 * GR_NS_PER_S) /* a client that asks nothing */

/*
 * Splits a line into words in place, at blanks. Returns how many (0 for an
 * empty line), or GR_ERR_FORMAT for a byte that is not printable ASCII or too
 * many words. line[len] is overwritten with NUL.
 */
int control_split(char *line, size_t len, char *words[CONTROL_WORDS]);

/*
 * Answers a request: writes a NUL-terminated JSON document without newline
 * into answer. words[0..count-1], count >= 1.
 */
typedef void (*control_answer_fn)(void *ctx, char *const *words, int count, char *answer,
				  size_t size);

struct control;
/*
 * Listens at `path` with mode 0660. A socket file that nobody listens at is
 * replaced; a living one, or a file of another kind, is refused. The log
 * says why. The loop must outlive the control.
 */
int control_create(struct control **out, struct loop *loop, const char *path,
		   control_answer_fn answer, void *ctx);
/* Closes all clients and removes the socket file. */
void control_destroy(struct control **control);
int control_clients(const struct control *control);

/* {"ok":false,"error":"..."} */
void control_refuse(char *answer, size_t size, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

#endif
