/*
 * Child processes under watch: started by fork and exec with their output in
 * a log file each, waited for through pidfds (no polling), ended by their own
 * pid and never otherwise, with bounded waits.
 *
 * A child is asked to end (SIGTERM) by the kernel should this process die.
 * One thread; the caller blocks SIGINT and SIGTERM while children run, which
 * children_start does.
 */
#ifndef GROTTO_TOOLS_CHILDREN_H
#define GROTTO_TOOLS_CHILDREN_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

struct child {
	char *name; /* for messages, owned */
	char *log;  /* path of its output, owned */
	pid_t pid;
	int pidfd;  /* -1 once it has ended */
	int status; /* as waitpid gives it, once it has ended */
	bool told;  /* it did not end by itself: children_end told it to */
};

struct children {
	struct child *items;
	size_t count, running;
	sigset_t old_signals;
	int signal_fd; /* SIGINT, SIGTERM, SIGHUP */
	int timer_fd;  /* ticks */
	int input_fd;  /* see children_input; -1: none */
};

/* Blocks the ending signals. GR_OK or GR_ERR_IO (errno). */
int children_start(struct children *children);
/* Kills and reaps what still runs (children_end), gives the signals back. */
void children_finish(struct children *children);

/*
 * argv[0] is the path to run; argv ends with NULL. Both outputs go to `log`,
 * which is made anew. GR_OK, GR_ERR_IO (errno: also that of a failed exec),
 * GR_ERR_NOMEM.
 */
int children_spawn(struct children *children, const char *name, char *const argv[],
		   const char *log);

enum children_event {
	CHILDREN_ENDED,  /* *out_child has ended */
	CHILDREN_TICK,   /* the tick set by children_tick */
	CHILDREN_INPUT,  /* there is something to read, or the end of it */
	CHILDREN_SIGNAL, /* a person asked to end */
	CHILDREN_TIMEOUT,
	CHILDREN_FAILED, /* poll failed (errno) */
};

/* Tick every interval_ns; 0 stops it. */
int children_tick(struct children *children, int64_t interval_ns);
/* Also waits for this descriptor to become readable; -1: for none. Borrowed. */
void children_input(struct children *children, int fd);
/* Blocks for at most timeout_ns (negative: for ever). */
enum children_event children_wait(struct children *children, int64_t timeout_ns,
				  size_t *out_child);

/* SIGTERM to what runs, up to patience_ns for it to end, then SIGKILL. */
void children_end(struct children *children, int64_t patience_ns);

bool child_ended_well(const struct child *child);
/* "ended with status 1", "was killed by signal 11 (Segmentation fault)", "runs". */
void child_describe(const struct child *child, char *text, size_t size);

#endif
