/*
 * A made-up light that the nodes of a simulated cluster share out: what their
 * renderers would hold of it, and that each holds what was made.
 */
#ifndef GROTTO_TESTS_SHARE_ROOM_H
#define GROTTO_TESTS_SHARE_ROOM_H

#include "cluster_sim.h"

/* What a node's renderer holds: which frame's slice of each rank. */
struct share_light {
	unsigned index, count;
	uint64_t now[FDP_MAX_NODES];  /* used in the frame that is being drawn */
	uint64_t next[FDP_MAX_NODES]; /* put, or made; used from the next frame on */
	bool fresh;                   /* nobody has ours */
	uint64_t due, on_time, restarts;
};

struct share_room {
	struct sim sim;
	struct share_light lights[FDP_MAX_NODES];
	size_t bytes;          /* of all slices */
	uint64_t still_after;  /* the light moves up to this frame */
	uint64_t made[FDP_MAX_NODES]; /* by rank, the newest of the present division */
};

/* Nodes that have not started, with that many bytes of a light that moves without end. */
void share_room_init(struct share_room *room, size_t nodes, size_t bytes, uint64_t seed);
/* All nodes' renderers hold the same, and the newest of all. */
void share_room_assert_same(struct share_room *room);

#endif
