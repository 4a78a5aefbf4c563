#include "record/survey.h"

#include "base/result.h"
#include "record/states.h"

#include <stdlib.h>

struct surveyor {
	struct record_survey survey;
	struct record_states states;
	bool begun;
};

static void note_frame(struct surveyor *v, const struct record_entry *entry)
{
	struct record_survey *s = &v->survey;
	const uint64_t frame = entry->frame.frame;

	if (s->frames == 0)
		s->first_frame = frame;
	else if (frame > s->last_frame)
		s->frames_missing += frame - s->last_frame - 1;
	if (frame > s->last_frame)
		s->last_frame = frame;
	s->frames++;
	s->wholes += entry->kind == RECORD_STATE;
	if (!s->states_known)
		return;
	switch (record_states_take(&v->states, entry)) {
	case GR_NOTHING: s->frames_unusable++; break;
	case GR_ERR_FORMAT: s->frames_wrong++; break;
	default: break;
	}
}

static void note(struct surveyor *v, const struct record_entry *entry)
{
	struct record_survey *s = &v->survey;

	if (s->first_ns == 0 || entry->time_ns < s->first_ns)
		s->first_ns = entry->time_ns;
	if (entry->time_ns > s->last_ns)
		s->last_ns = entry->time_ns;
	record_rules_note(&s->rules, entry);
	switch (entry->kind) {
	case RECORD_SAMPLE:
		s->samples[entry->sample.tracker]++;
		s->samples_invalid += !(entry->sample.flags & RECORD_VALID);
		s->samples_refused += !(entry->sample.flags & RECORD_TAKEN);
		break;
	case RECORD_STATE:
	case RECORD_DELTA: note_frame(v, entry); break;
	case RECORD_REPORT: s->reports[entry->report.node]++; break;
	case RECORD_SWAP: s->swaps++; break;
	case RECORD_SHOWN: s->shown[entry->shown.node]++; break;
	case RECORD_EVENT: s->events[entry->event.kind]++; break;
	case RECORD_LOST:
		s->lost += entry->lost.entries;
		s->lost_frames += entry->lost.frames;
		break;
	}
}

static int begin(struct surveyor *v, const struct record_reader *reader,
		 const struct record_block *block)
{
	v->survey = (struct record_survey){
		.session = *record_reader_session(reader),
		.recording = block->head.recording,
	};
	v->survey.states_known = v->survey.session.table_hash == param_table_hash();
	v->begun = true;
	record_states_finish(&v->states);
	return record_states_init(&v->states);
}

static void note_block(struct surveyor *v, struct record_reader *reader,
		       const struct record_block *block)
{
	struct record_cursor cursor = record_block_entries(reader, block);
	struct record_entry entry;

	v->survey.blocks++;
	v->survey.bytes += RECORD_HEAD_BYTES + block->head.len;
	if (block->gap) {
		v->survey.gaps++;
		record_states_gap(&v->states);
		record_rules_gap(&v->survey.rules);
	}
	if (block->head.kind == RECORD_END) {
		v->survey.ended = true;
		v->survey.end = block->end;
	}
	while (record_cursor_next(&cursor, &entry))
		note(v, &entry);
}

int record_survey(struct record_reader *reader, record_survey_fn fn, void *ctx)
{
	struct surveyor *v = calloc(1, sizeof *v);
	struct record_block block;
	int r = GR_OK;

	if (!v)
		return GR_ERR_NOMEM;
	while (r == GR_OK && (r = record_reader_next(reader, &block)) == GR_OK) {
		if (block.first) {
			if (v->begun)
				fn(ctx, &v->survey);
			r = begin(v, reader, &block);
		}
		if (r == GR_OK)
			note_block(v, reader, &block);
	}
	if (r == GR_NOTHING && v->begun) {
		fn(ctx, &v->survey);
		r = GR_OK;
	}
	record_states_finish(&v->states);
	free(v);
	return r;
}
