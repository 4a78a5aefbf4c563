/*
 * What the master measures of each frame: from its begin to SWAP on the wire
 * and to the last node's report that it swapped, and how far apart the nodes
 * swapped. Pure, fixed size.
 *
 * Skew is the spread of the times at which the nodes swapped, by the master's
 * clock: as good as the estimates of the nodes' clocks (protocol/clock_offset.h).
 * A frame of which one node's time is not known has none. It is counted apart
 * for frames that were shown when told and for those shown at a set time.
 */
#ifndef GROTTO_DAEMON_FRAME_STATS_H
#define GROTTO_DAEMON_FRAME_STATS_H

#include "daemon/histogram.h"

#include <stdbool.h>
#include <stdint.h>

#define FRAME_STATS_OPEN 8 /* frames whose reports may be under way at once */
#define FRAME_STATS_NODES 64

struct frame_open {
	uint64_t frame; /* 0: unused */
	int64_t begin_ns;
	int64_t swap_sent_ns; /* 0: not yet */
	uint64_t expected, applied, arrived; /* bit per node */
	int64_t first_swap_ns, last_swap_ns; /* the master's clock */
	bool unknown;   /* a node's time is not known */
	bool scheduled; /* shown at a time that was set */
};

struct frame_stats {
	uint64_t begun, complete, incomplete; /* frames; all reports came, or not all */
	/*
	 * us. From begin: the last node has applied the state (what the thesis
	 * calls synchronisation, seed 004 section 4.2), SWAP is sent, the last
	 * node's report of the swap is here. From SWAP: the same report. Skew.
	 */
	struct histogram applied, swap_sent, last_swapped, swap_to_last, skew;
	struct histogram skew_told, skew_scheduled; /* of these */
	int64_t smoothed_swap_ns; /* begin to SWAP, running mean over about 8 frames; 0 before the first */
	struct frame_open open[FRAME_STATS_OPEN];
};

void frame_stats_begin(struct frame_stats *stats, uint64_t frame, uint64_t expected,
		       int64_t now_ns);
/* Node said that it holds the state of `frame`. */
void frame_stats_applied(struct frame_stats *stats, unsigned node, uint64_t frame, int64_t now_ns);
void frame_stats_swap_sent(struct frame_stats *stats, uint64_t frame, bool scheduled, int64_t now_ns);
/* Node swapped `frame` at swap_ns of the master's clock, 0: not known; now_ns is the report's arrival. */
void frame_stats_swapped(struct frame_stats *stats, unsigned node, uint64_t frame, int64_t swap_ns,
			 int64_t now_ns);
/* A node that will not report any more. */
void frame_stats_gone(struct frame_stats *stats, unsigned node);
/* All reports of `frame` are in (or it was never begun). */
bool frame_stats_settled(const struct frame_stats *stats, uint64_t frame);

#endif
