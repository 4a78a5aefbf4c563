/*
 * The barrier by itself: ends that draw nothing. Private to bench-barrier.
 */
#ifndef GROTTO_TOOLS_BENCH_BARRIER_H
#define GROTTO_TOOLS_BENCH_BARRIER_H

#include "protocol/master.h"
#include "tools/bench/cluster.h"

#define BARRIER_FRAMES_MOST 100000

/* Shared by all processes of a bench. */
struct barrier_room {
	struct bench_cluster cluster;
	unsigned frames, warm; /* warm: begun before those that count */
	enum fdp_swap swap;    /* of this run */
	/* Of node n in frame f: [n * frames + f], the one CLOCK_MONOTONIC of this machine. */
	int64_t *swap_ns, *ready_ns;
	/* By the master's estimates: from the first swap to the last, us. */
	double seen_p50_us, seen_p99_us;
	uint64_t scheduled, late;
	double clock_off_us[CLUSTER_NODES_MOST]; /* the master's estimate less the truth, 0 */
};

/* One run, in the process of that end. */
void barrier_master(struct barrier_room *room);
void barrier_node(struct barrier_room *room, unsigned node);

#endif
