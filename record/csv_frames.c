#include "record/csv_private.h"

#include "base/result.h"

#include <inttypes.h>
#include <string.h>

#define BIT(node) (UINT64_C(1) << (node))

void csv_frames_head(FILE *file)
{
	fputs("frame,begun_s,applied_s,ready_s,swap_sent_s,swap_at_s,nodes,nodes_ready,nodes_swapped,"
	      "skew_us,skew_raw_us,hash,whole,scene_s,tracked,head_x_m,head_y_m,head_z_m,head_qx,head_qy,head_qz,"
	      "head_qw,wand_x_m,wand_y_m,wand_z_m,wand_qx,wand_qy,wand_qz,wand_qw,wand_buttons,"
	      "room_x_m,room_y_m,room_z_m,room_qx,room_qy,room_qz,room_qw,hand_layout\n", file);
}

static void write_time(const struct csv_frames *c, int64_t ns)
{
	fputc(',', c->file);
	if (ns > 0)
		csv_seconds(c->file, ns - c->start_ns);
}

static void write_pose(FILE *file, const struct csv_pose *pose)
{
	csv_floats(file, pose->p, 3);
	csv_floats(file, pose->q, 4);
}

static void write_spread(FILE *file, const struct csv_spread *s)
{
	if (s->nodes & (s->nodes - 1)) /* two or more */
		fprintf(file, "%.3f", ((double)s->last_ns - (double)s->first_ns) * 1e-3);
}

static void write_row(const struct csv_frames *c, const struct csv_frame *f)
{
	FILE *file = c->file;

	fprintf(file, "%" PRIu64, f->frame);
	write_time(c, f->begun_ns);
	write_time(c, f->acked_ns);
	write_time(c, f->ready_ns);
	write_time(c, f->sent_ns);
	write_time(c, f->at_ns);
	fprintf(file, ",%d,%d,%d,", __builtin_popcountll(f->live), __builtin_popcountll(f->ready),
		__builtin_popcountll(f->raw.nodes));
	write_spread(file, &f->by_master);
	fputc(',', file);
	write_spread(file, &f->raw);
	fprintf(file, ",%016" PRIx64 ",%d,", f->hash, f->whole);
	if (!f->held) {
		fputs(",,,,,,,,,,,,,,,,,,,,,,,,\n", file);
		return;
	}
	csv_seconds(file, (int64_t)f->scene_ns);
	fprintf(file, ",%" PRIu32, f->flags);
	write_pose(file, &f->head);
	write_pose(file, &f->wand);
	fprintf(file, ",%" PRIu32, f->buttons);
	write_pose(file, &f->room);
	fprintf(file, ",%" PRIu32 "\n", f->hand_layout);
}

/* Writes the open frames up to `last`, in their order. */
static void write_up_to(struct csv_frames *c, uint64_t last)
{
	for (;;) {
		struct csv_frame *oldest = NULL;

		for (int i = 0; i < CSV_OPEN; i++)
			if (c->open[i].frame && c->open[i].frame <= last &&
			    (!oldest || c->open[i].frame < oldest->frame))
				oldest = &c->open[i];
		if (!oldest)
			return;
		write_row(c, oldest);
		oldest->frame = 0;
	}
}

void csv_frames_end(struct csv_frames *c)
{
	if (c->file)
		write_up_to(c, UINT64_MAX);
}

static struct csv_frame *find(struct csv_frames *c, uint64_t frame)
{
	struct csv_frame *f = &c->open[frame % CSV_OPEN];

	return frame && f->frame == frame ? f : NULL;
}

static void copy_pose(const struct param_state *state, enum param_id position,
		      enum param_id rotation, struct csv_pose *out)
{
	memcpy(out->p, param_f32(state, position), sizeof out->p);
	memcpy(out->q, param_f32(state, rotation), sizeof out->q);
}

static void begin(struct csv_frames *c, const struct record_entry *entry)
{
	const struct record_frame *from = &entry->frame;
	struct csv_frame *f = &c->open[from->frame % CSV_OPEN];
	const struct param_state *state = c->states.state;

	if (f->frame)
		write_up_to(c, f->frame);
	*f = (struct csv_frame){
		.frame = from->frame, .hash = from->hash, .live = from->live,
		.begun_ns = entry->time_ns, .whole = entry->kind == RECORD_STATE,
	};
	if (!c->states_known || record_states_take(&c->states, entry) != GR_OK)
		return;
	f->held = true;
	memcpy(&f->scene_ns, param_get(state, PARAM_FRAME_TIME), sizeof f->scene_ns);
	copy_pose(state, PARAM_HEAD_POSITION, PARAM_HEAD_ROTATION, &f->head);
	copy_pose(state, PARAM_WAND_POSITION, PARAM_WAND_ROTATION, &f->wand);
	copy_pose(state, PARAM_ROOM_POSITION, PARAM_ROOM_ROTATION, &f->room);
	f->buttons = *param_u32(state, PARAM_WAND_BUTTONS);
	f->flags = *param_u32(state, PARAM_TRACK_FLAGS);
	f->hand_layout = *param_u32(state, PARAM_HAND_MODE);
}

static void widen(struct csv_spread *s, unsigned node, int64_t ns)
{
	if (s->nodes & BIT(node))
		return;
	if (!s->nodes || ns < s->first_ns)
		s->first_ns = ns;
	if (!s->nodes || ns > s->last_ns)
		s->last_ns = ns;
	s->nodes |= BIT(node);
}

static void note_shown(struct csv_frames *c, const struct record_shown *s)
{
	struct csv_frame *f = find(c, s->frame);

	if (!f)
		return;
	widen(&f->raw, s->node, s->node_ns);
	if (s->master_ns != 0)
		widen(&f->by_master, s->node, s->master_ns);
}

/* The first word of each node counts; the last node's is the frame's. */
static void note_word(uint64_t *nodes, int64_t *last_ns, unsigned node, int64_t time_ns)
{
	if (*nodes & BIT(node))
		return;
	*nodes |= BIT(node);
	*last_ns = time_ns;
}

static void note_report(struct csv_frames *c, const struct record_report *p, int64_t time_ns)
{
	const bool swapped = record_report_name(p->kind)[0] == 's';
	const bool ready = record_report_name(p->kind)[0] == 'r';
	struct csv_frame *f = swapped ? NULL : find(c, p->frame);

	if (!f || p->hash != f->hash)
		return;
	note_word(&f->acked, &f->acked_ns, p->node, time_ns); /* who is ready holds it, too */
	if (ready)
		note_word(&f->ready, &f->ready_ns, p->node, time_ns);
}

void csv_frames_note(struct csv_frames *c, const struct record_entry *entry)
{
	struct csv_frame *f;

	switch (entry->kind) {
	case RECORD_STATE:
	case RECORD_DELTA: begin(c, entry); break;
	case RECORD_SHOWN: note_shown(c, &entry->shown); break;
	case RECORD_REPORT: note_report(c, &entry->report, entry->time_ns); break;
	case RECORD_SWAP:
		f = find(c, entry->swap.frame);
		if (f && !f->sent_ns) {
			f->sent_ns = entry->time_ns;
			f->at_ns = entry->swap.at_ns;
		}
		break;
	default: break;
	}
}
