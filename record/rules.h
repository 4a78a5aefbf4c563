/*
 * Did a recorded session keep the protocol's rules? From the entries alone:
 * every node held the frame's state, no SWAP went out before all that counted
 * were ready or late, and frames were swapped in their order. Pure.
 */
#ifndef GROTTO_RECORD_RULES_H
#define GROTTO_RECORD_RULES_H

#include "record/format.h"

#define RECORD_RULES_OPEN 64 /* frames whose answers may still come */

struct record_rules {
	uint64_t equal;     /* answers with the frame's hash, one of each node and frame */
	uint64_t different; /* with another one */
	uint64_t early;     /* SWAPs before all that counted were ready, late, or gone */
	uint64_t back;      /* SWAPs of a frame that is not above the last */
	uint64_t last_swap;
	struct {
		uint64_t frame; /* 0: unused */
		uint64_t hash;
		uint64_t live, answered, ready, excused; /* bit per node */
	} open[RECORD_RULES_OPEN];
};

void record_rules_note(struct record_rules *rules, const struct record_entry *entry);
/* Entries are missing here: frames under way are not judged. */
void record_rules_gap(struct record_rules *rules);

#endif
