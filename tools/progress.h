/*
 * How far a long computation is, for people: one line that moves on a terminal,
 * else a plain line now and then. On stderr, so that results stay apart.
 *
 * Not thread safe.
 */
#ifndef GROTTO_TOOLS_PROGRESS_H
#define GROTTO_TOOLS_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct progress {
	const char *what;
	bool terminal;
	bool shown;      /* a line stands on the terminal */
	int64_t next_ns; /* of the next plain line */
};

/* Holds signals as below; what is kept, not copied. */
void progress_start(struct progress *progress, const char *what);
/* done 0..1; seconds_left negative: not known; note: further words, or NULL. */
void progress_show(struct progress *progress, double done, double seconds_left, const char *note);
/* Takes the line away, and signals end the program again. */
void progress_end(struct progress *progress);

/* "40 s", "3 min 20 s", "2 h 5 min"; returns text. */
char *progress_time(double seconds, char *text, size_t size);

/*
 * From here on Ctrl-C and a request to end wait until progress_asked_to_end
 * looks; call before threads are started. A second Ctrl-C is as ever.
 */
void progress_hold_signals(void);
bool progress_asked_to_end(void);

#endif
