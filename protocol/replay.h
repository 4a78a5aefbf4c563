/*
 * The sequence numbers seen from one sender: each is taken once, none from
 * before the window (RFC 4303, section 3.4.3, in 64 bits).
 */
#ifndef GROTTO_PROTOCOL_REPLAY_H
#define GROTTO_PROTOCOL_REPLAY_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define FDP_REPLAY_WINDOW 1024 /* sequence numbers; a multiple of 64 */

struct fdp_replay {
	uint64_t top;   /* highest taken */
	uint64_t floor; /* nothing at or below it is taken */
	uint64_t seen[FDP_REPLAY_WINDOW / 64]; /* bit of sequence s: s mod window */
};

/* Takes sequences above `floor` only. */
static inline void fdp_replay_start(struct fdp_replay *r, uint64_t floor)
{
	memset(r, 0, sizeof *r);
	r->top = r->floor = floor;
}

/* True once for each sequence. Call it only with what is authentic. */
static inline bool fdp_replay_take(struct fdp_replay *r, uint64_t sequence)
{
	const uint64_t slot = sequence % FDP_REPLAY_WINDOW;
	const uint64_t bit = UINT64_C(1) << slot % 64;

	if (sequence <= r->floor ||
	    (sequence <= r->top && r->top - sequence >= FDP_REPLAY_WINDOW))
		return false;
	if (sequence > r->top) {
		if (sequence - r->top >= FDP_REPLAY_WINDOW)
			memset(r->seen, 0, sizeof r->seen);
		else
			for (uint64_t s = r->top + 1; s < sequence; s++)
				r->seen[s % FDP_REPLAY_WINDOW / 64] &= ~(UINT64_C(1) << s % 64);
		r->top = sequence;
	} else if (r->seen[slot / 64] & bit) {
		return false;
	}
	r->seen[slot / 64] |= bit;
	return true;
}

#endif
