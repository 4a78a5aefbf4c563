/*
 * The swap barrier of one frame, as sets of nodes (bit i is node i). Pure:
 * who is waited for, who is late, and when the wait is over.
 */
#ifndef GROTTO_PROTOCOL_BARRIER_H
#define GROTTO_PROTOCOL_BARRIER_H

#include <stdbool.h>
#include <stdint.h>

struct fdp_barrier {
	uint64_t frame;
	uint64_t live;  /* waited for: they count since the frame began */
	uint64_t draws; /* begin to draw it, and are asked until they acknowledge */
	uint64_t acked; /* hold the frame's state */
	uint64_t ready;
	int64_t begun_ns, deadline_ns; /* absolute */
};

static inline void fdp_barrier_start(struct fdp_barrier *b, uint64_t frame, uint64_t live,
				     int64_t now_ns, int64_t wait_ns)
{
	*b = (struct fdp_barrier){ frame, live, live, 0, 0, now_ns, now_ns + wait_ns };
}

/* A node that left, or joined anew, is waited for no more. */
static inline void fdp_barrier_drop(struct fdp_barrier *b, unsigned node)
{
	b->live &= ~(UINT64_C(1) << node);
	b->draws &= ~(UINT64_C(1) << node);
}

static inline uint64_t fdp_barrier_unready(const struct fdp_barrier *b)
{
	return b->live & ~b->ready;
}

static inline uint64_t fdp_barrier_unacked(const struct fdp_barrier *b)
{
	return b->draws & ~b->acked & ~b->ready;
}

static inline bool fdp_barrier_complete(const struct fdp_barrier *b)
{
	return !fdp_barrier_unready(b);
}

static inline bool fdp_barrier_over(const struct fdp_barrier *b, int64_t now_ns)
{
	return fdp_barrier_complete(b) || now_ns >= b->deadline_ns;
}

#endif
