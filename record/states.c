#include "record/states.h"

#include "base/result.h"

int record_states_init(struct record_states *s)
{
	*s = (struct record_states){ 0 };
	return param_state_create(&s->state);
}

void record_states_finish(struct record_states *s)
{
	param_state_destroy(&s->state);
}

void record_states_gap(struct record_states *s)
{
	s->held = false;
}

static bool versions_right(const struct param_state *state, uint64_t frame)
{
	for (int i = 0; i < PARAM_COUNT; i++)
		if (param_version(state, (enum param_id)i) > frame)
			return false;
	return true;
}

int record_states_take(struct record_states *s, const struct record_entry *entry)
{
	const struct record_frame *f = &entry->frame;
	const bool follows = s->frame && f->previous_frame == s->frame && f->previous_hash == s->hash;
	const uint64_t last = s->frame;

	if (entry->kind == RECORD_DELTA && !(s->held && follows)) {
		s->held = false;
		return GR_NOTHING;
	}
	s->held = false;
	if (f->frame <= last || param_delta_apply(s->state, f->delta, f->delta_len) != GR_OK ||
	    !versions_right(s->state, f->frame) ||
	    param_state_hash(s->state, f->previous_hash) != f->hash)
		return GR_ERR_FORMAT;
	s->jumped = !follows;
	s->frame = f->frame;
	s->hash = f->hash;
	s->held = true;
	return GR_OK;
}
