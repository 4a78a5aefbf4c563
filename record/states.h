/*
 * From the recorded frames to the state in each: whole states and deltas put
 * on one another, with every hash computed again.
 */
#ifndef GROTTO_RECORD_STATES_H
#define GROTTO_RECORD_STATES_H

#include "protocol/params.h"
#include "record/format.h"

struct record_states {
	struct param_state *state; /* of `frame`, when held */
	uint64_t frame, hash;      /* the last that was right; 0: none */
	bool held;   /* false: a whole state is waited for */
	bool jumped; /* the last frame did not follow on the one before it here */
};

int record_states_init(struct record_states *states);
void record_states_finish(struct record_states *states);
/*
 * The entry's frame is put on what is held. GR_OK; GR_NOTHING: it needs one
 * that is not there; GR_ERR_FORMAT: it is not what its hash says, or not a
 * state, or of no later frame. Whatever is not GR_OK waits for a whole state.
 */
int record_states_take(struct record_states *states, const struct record_entry *entry);
/* Something is missing before the next frame. */
void record_states_gap(struct record_states *states);

#endif
