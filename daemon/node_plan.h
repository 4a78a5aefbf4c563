/*
 * Which plan of the light a node goes by (renderer/gi/plan.h): its own, until
 * the master refuses it for another that the room has. Bounded, so that a room
 * which never settles is not followed for ever: after NODE_PLAN_TRIES in
 * NODE_PLAN_AGAIN_NS without a swap, and for a plan that cannot be had here, the
 * refusal stands until that time is over.
 *
 * Pure: no I/O, time is handed in.
 */
#ifndef GROTTO_DAEMON_NODE_PLAN_H
#define GROTTO_DAEMON_NODE_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#define NODE_PLAN_TRIES 3
#define NODE_PLAN_AGAIN_NS INT64_C(600000000000)

struct node_plan {
	uint64_t present;    /* what the node computes; 0: the scene file says it */
	uint64_t wanted;     /* to be taken now; 0: none */
	uint64_t impossible; /* the last one that could not be had; 0: none */
	unsigned tries;      /* since the last swap */
	int64_t since_ns;    /* of the first of them */
};

/* The room's plan, from outside; 0: none was said. Whether it is `wanted` now. */
bool node_plan_offered(struct node_plan *plan, uint64_t offered, int64_t now_ns);
/* `wanted` has been tried: the node computes `present` now, which is it or the one before. */
void node_plan_tried(struct node_plan *plan, uint64_t present);
/* The node is in step with the room. */
void node_plan_settled(struct node_plan *plan);

#endif
