/*
 * What the room shows next, and when: trackers and settings (live_source.h),
 * or a recording (replay_source.h). The master's frame loop knows only this.
 *
 * Thread: the loop's. No allocation and no waiting in `next`.
 */
#ifndef GROTTO_DAEMON_FRAME_SOURCE_H
#define GROTTO_DAEMON_FRAME_SOURCE_H

#include "protocol/params.h"

#include <stdbool.h>
#include <stdint.h>

/* Of `due`: on the master's own grid of frame times. */
#define FRAME_SOURCE_GRID (-1)

struct frame_moment {
	int64_t now_ns;
	int64_t to_swap_ns; /* from now until the frame will have been swapped, guessed */
	uint64_t last;      /* number of the frame before; 0: this is the first */
	bool restart_light; /* of all nodes: one has joined or caught up */
};

struct frame_next {
	uint64_t frame;       /* its number, above the last */
	bool restarts_light;  /* costs many frames' work */
	bool jumps;           /* its hash is chained to this, not to the frame before: */
	uint64_t previous_frame, previous_hash;
	const char *refused;  /* a parameter whose value was outside its range and that keeps the old one, or NULL */
};

struct frame_source;
struct frame_source_ops {
	/* Puts the next frame into `state`. GR_OK, GR_NOTHING (there is none), or an error. */
	int (*next)(struct frame_source *source, const struct frame_moment *moment,
		    struct param_state *state, struct frame_next *out);
	/* When it is due: CLOCK_MONOTONIC, LOOP_NEVER, or FRAME_SOURCE_GRID. NULL: the grid. */
	int64_t (*due)(const struct frame_source *source);
	/* The frame is on its way to the nodes in `live`; hash is the master's. May be NULL. */
	void (*begun)(struct frame_source *source, uint64_t live, uint64_t hash, int64_t now_ns);
	/* There are no more frames. May be NULL: there always are. */
	bool (*over)(const struct frame_source *source);
	/* A node says which hash it holds for a frame. May be NULL. */
	void (*held)(struct frame_source *source, unsigned node, uint64_t frame, uint64_t hash);
};

/* First member of each source's own struct. */
struct frame_source {
	const struct frame_source_ops *ops;
};

#endif
