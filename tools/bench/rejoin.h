/*
 * A node that comes back to a room whose light is shared out: when it shows and when it
 * has all of the light, and what that does to the others' frames. Private to bench-rejoin.
 */
#ifndef GROTTO_TOOLS_BENCH_REJOIN_H
#define GROTTO_TOOLS_BENCH_REJOIN_H

#include "tools/bench/cluster.h"

#define REJOIN_FRAMES_MOST 100000
#define REJOIN_VICTIM 0u
#define REJOIN_WARM 120
#define REJOIN_AWAY 60 /* frames that the node stays away */

/* Shared by all processes of a bench. */
struct rejoin_room {
	struct bench_cluster cluster;
	unsigned quiet; /* frames after the first REJOIN_WARM, before the node dies */
	unsigned most;	/* frames of a run */
	/* Of frame f, by the one CLOCK_MONOTONIC of this machine; 0: not. */
	int64_t *begun_ns, *applied_ns;	   /* applied by node n: [n * most + f] */
	uint8_t *late;			   /* by others than the victim */
	_Atomic uint64_t dies_after, last; /* frames */
	_Atomic int64_t back_ns, shows_ns; /* the victim begins anew; shows its first picture */
	_Atomic int64_t
		whole_ns[CLUSTER_NODES_MOST]; /* a node has all slices of all nodes; 0: not */
	uint64_t bulk_bytes;		      /* that the master sent from the return to the end */
};

/* One run, in the process of that end. */
void rejoin_master(struct rejoin_room *room);
void rejoin_node(struct rejoin_room *room, unsigned node);

#endif
