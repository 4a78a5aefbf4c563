/*
 * How a node keeps pace, and what becomes of one that does not: a pure state
 * machine, fed once for each frame that the node should have drawn.
 *
 * A frame is slow when the node was ready later than `limit_ns` after it began. Each
 * slow one counts up, each other one down, to nothing: a node that is slow in more
 * than half of its frames gets to `frames`, and is slow; one that hiccups does not.
 *
 *   in step ──slow──► slow, half rate or evicted, as the policy says
 *   slow, half rate ──as many in time──► in step
 *
 * Who falls back soon after has to keep pace for twice as long the next time (up to
 * 16 times), and stays out for twice as long, so that nothing flaps. "Soon": before
 * eight times as many frames as were asked of it.
 *
 * Dead nodes are not its business: see params.evict_frames of the master.
 */
#ifndef GROTTO_PROTOCOL_PACE_H
#define GROTTO_PROTOCOL_PACE_H

#include <stdbool.h>
#include <stdint.h>

enum fdp_slow {
	FDP_SLOW_EVICT, /* it is left out, and may not come back at once */
	FDP_SLOW_WAIT,  /* all wait for it, past the deadline, while it gives signs of life */
	FDP_SLOW_HALF,  /* it draws every second frame, and the others do not wait for it in those */
};

struct fdp_pace_params {
	enum fdp_slow policy;
	int64_t limit_ns;    /* 0: the barrier's deadline */
	unsigned frames;     /* 0: FDP_PACE_FRAMES */
	int64_t wait_most_ns;   /* FDP_SLOW_WAIT: so long after a frame began at most; 0: FDP_PACE_WAIT_NS */
	int64_t rejoin_most_ns; /* FDP_SLOW_EVICT: out for so long at most; 0: FDP_PACE_REJOIN_NS */
};
#define FDP_PACE_FRAMES 120
#define FDP_PACE_WAIT_NS INT64_C(1000000000)
#define FDP_PACE_REJOIN_NS INT64_C(30000000000)
#define FDP_PACE_OUT_NS INT64_C(1000000000) /* the second time; the first time it may come back at once */
#define FDP_PACE_RELAPSES 4 /* from there on nothing gets longer but the time out */

enum fdp_pace_state { FDP_PACE_IN_STEP, FDP_PACE_SLOW, FDP_PACE_HALF, FDP_PACE_EVICTED };
const char *fdp_pace_state_name(enum fdp_pace_state state);

struct fdp_pace {
	enum fdp_pace_state state;
	unsigned score;      /* slow frames more than others; once it is slow, frames to be in time */
	unsigned relapses;   /* times that it fell back soon */
	uint64_t steady;     /* frames in step since it last was not */
	int64_t since_ns;    /* of the state; 0: never another */
	int64_t out_until_ns; /* evicted: may not come back before */
};

/* Zero for 0 and what is missing put in; deadline_ns is the barrier's. */
struct fdp_pace_params fdp_pace_complete(const struct fdp_pace_params *params, int64_t deadline_ns);
/*
 * A frame that it should have drawn is over; it was slow in it, or not. True when the
 * state is another one now.
 */
bool fdp_pace_frame(struct fdp_pace *pace, const struct fdp_pace_params *params, bool slow,
		    int64_t now_ns);
/*
 * It lives, and missed as many barriers in a row as a node may: the policy takes effect
 * at once. True when that leaves it in the room, at half the rate; else it is to be evicted.
 */
bool fdp_pace_too_late(struct fdp_pace *pace, const struct fdp_pace_params *params, int64_t now_ns);
/* Whether it may come back. */
static inline bool fdp_pace_may_join(const struct fdp_pace *pace, int64_t now_ns)
{
	return pace->state != FDP_PACE_EVICTED || now_ns >= pace->out_until_ns;
}
/* It comes (back): in step, what it did before not forgotten. */
void fdp_pace_join(struct fdp_pace *pace, int64_t now_ns);

#endif
