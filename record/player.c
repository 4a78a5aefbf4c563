#include "record/player.h"

#include "base/result.h"

#include <inttypes.h>
#include <stdlib.h>

struct record_player {
	struct record_player_params params;
	struct record_reader *reader;
	struct record_block block;
	struct record_cursor cursor;
	struct record_session session; /* the reader goes on to the next recording's at the end */
	struct record_states states;
	struct record_player_counts counts;
	bool begun, over;
};

const struct record_session *record_player_session(const struct record_player *p)
{
	return &p->session;
}

/* To the SESSION block with which the wanted recording begins. */
static int find_recording(struct record_player *p, const char *path, struct gr_diag *diag)
{
	int found = 0, r;

	while ((r = record_reader_next(p->reader, &p->block)) == GR_OK)
		if (p->block.first && ++found == p->params.recording) {
			p->session = *record_reader_session(p->reader);
			return GR_OK;
		}
	if (r < 0)
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "cannot be read to its end");
	else if (found == 0)
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
			    "holds no recording, or none whose start is sound");
	else
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "recording %d: it holds %d",
			    p->params.recording, found);
	return r < 0 ? r : GR_ERR_FORMAT;
}

static int check_table(const struct record_player *p, const char *path, struct gr_diag *diag)
{
	if (p->session.table_hash == param_table_hash())
		return GR_OK;
	gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
		    "was recorded by grotto %s with the parameters %016" PRIx64
		    ", this one has %016" PRIx64 ": its states mean nothing here; use that version",
		    p->session.grotto, p->session.table_hash, param_table_hash());
	return GR_ERR_VERSION;
}

int record_player_open(struct record_player **out, const char *path,
		       const struct record_player_params *params, struct gr_diag *diag)
{
	struct record_player *p = calloc(1, sizeof *p);
	int r;

	*out = NULL;
	if (!p)
		return GR_ERR_NOMEM;
	p->params = *params;
	r = record_states_init(&p->states);
	if (r == GR_OK)
		r = record_reader_open(&p->reader, path, diag);
	if (r == GR_OK)
		r = find_recording(p, path, diag);
	if (r == GR_OK)
		r = check_table(p, path, diag);
	if (r != GR_OK) {
		record_player_destroy(&p);
		return r;
	}
	*out = p;
	return GR_OK;
}

void record_player_destroy(struct record_player **player)
{
	struct record_player *p = *player;

	*player = NULL;
	if (!p)
		return;
	record_reader_destroy(&p->reader);
	record_states_finish(&p->states);
	free(p);
}

void record_player_counts(const struct record_player *p, struct record_player_counts *out)
{
	*out = p->counts;
}

void record_player_damage(const struct record_player *p, struct record_damage *out)
{
	record_reader_damage(p->reader, out);
}

/* The next entry that begins a frame. */
static int next_frame_entry(struct record_player *p, struct record_entry *entry)
{
	for (;;) {
		int r;

		while (record_cursor_next(&p->cursor, entry))
			if (entry->kind == RECORD_STATE || entry->kind == RECORD_DELTA)
				return GR_OK;
		if (p->over)
			return GR_NOTHING;
		r = record_reader_next(p->reader, &p->block);
		if (r != GR_OK)
			return r;
		if (p->block.first) {
			p->over = true;
			return GR_NOTHING;
		}
		if (p->block.gap)
			record_states_gap(&p->states);
		p->cursor = record_block_entries(p->reader, &p->block);
	}
}

int record_player_next(struct record_player *p, struct param_state *state, struct record_play *out)
{
	struct record_entry entry;
	int r;

	while ((r = next_frame_entry(p, &entry)) == GR_OK) {
		const struct record_frame *f = &entry.frame;
		const uint64_t last = p->states.frame;

		if (!p->begun && (entry.kind != RECORD_STATE ||
				  entry.time_ns - p->session.start_ns < p->params.from_ns))
			continue;
		r = record_states_take(&p->states, &entry);
		p->counts.wrong += r == GR_ERR_FORMAT;
		if (r != GR_OK)
			continue;
		if (p->begun)
			p->counts.missing += f->frame - last - 1;
		*out = (struct record_play){
			.frame = f->frame, .previous_frame = f->previous_frame,
			.hash = f->hash, .previous_hash = f->previous_hash,
			.live = f->live, .time_ns = entry.time_ns,
			.jumps = !p->begun || p->states.jumped,
		};
		p->begun = true;
		p->counts.frames++;
		param_state_copy(state, p->states.state);
		return GR_OK;
	}
	return r;
}
