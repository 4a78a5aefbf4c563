/*
 * Work on data from outside in a process of its own: libraries that read many
 * formats crash on some files, and this process must not. The child is a fork,
 * so that it needs no program of its own; it has limits on memory, CPU time and
 * what it writes, and hands back one block of bytes in memory.
 *
 * It shields from crashes, loops and runaway memory. It is no sandbox: the child
 * may open what its parent may open.
 *
 * Call it before there are threads, GL contexts or clients: the daemons and the
 * command import before they create a target. A child of a process with threads
 * works where libc's malloc survives a fork (glibc's does); other libraries'
 * locks may be held for ever in the child, which then ends by its time limit.
 */
#ifndef GROTTO_RENDERER_SCENE_ISOLATE_H
#define GROTTO_RENDERER_SCENE_ISOLATE_H

#include <stddef.h>
#include <stdint.h>

struct isolate_limits {
	size_t memory;    /* bytes of address space beyond the parent's; not under sanitizers */
	size_t block;     /* bytes of the block */
	unsigned cpu_s;   /* of processor time */
	unsigned wall_ms; /* of time at all */
};

enum isolate_how {
	ISOLATE_DONE,   /* left with status 0: the block is whole */
	ISOLATE_STATUS, /* left with another status, in number */
	ISOLATE_SIGNAL, /* died of the signal in number, also at the CPU limit (SIGXCPU) */
	ISOLATE_LATE,   /* did not end within wall_ms and was killed */
};

struct isolate_end {
	enum isolate_how how;
	int number;
	const uint8_t *block; /* read only and sealed: nobody can change it any more */
	size_t len;
};

/*
 * Runs in the child. Writes the block to fd; 0 when that went well. What it
 * changes in memory is lost.
 */
typedef int (*isolate_work)(void *context, int fd);

/* Blocks until the child has ended. GR_OK with *out filled, or GR_ERR_IO (no child, errno). */
int isolate_run(const struct isolate_limits *limits, isolate_work work, void *context,
		struct isolate_end *out);
void isolate_finish(struct isolate_end *end);
/* All of the bytes to fd, however often it takes; GR_ERR_IO. */
int isolate_write(int fd, const void *bytes, size_t len);

#endif
