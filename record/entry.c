/* Entries: the small things that happened, one after the other in a block. */
#include "record/format.h"

#define REPORT_ACK 6
#define REPORT_READY 9
#define REPORT_SWAPPED 11
#define BODIES 2 /* head, wand */

#include <string.h>

const char *record_event_name(uint8_t kind)
{
	static const char *const names[] = { "joined", "left", "refused", "late", "evicted",
					     "mismatch", "setting" };

	return kind >= RECORD_JOINED && kind <= RECORD_SETTING ? names[kind - RECORD_JOINED] : "unknown";
}

const char *record_report_name(uint8_t kind)
{
	switch (kind) {
	case REPORT_ACK: return "ack";
	case REPORT_READY: return "ready";
	case REPORT_SWAPPED: return "swapped";
	default: return "unknown";
	}
}

static void write_sample(struct gr_writer *w, const struct record_sample *s)
{
	const struct gr_pose *pose = &s->T_room_body;

	if (s->axis_count > RECORD_AXES) {
		w->ok = false;
		return;
	}
	gr_write_u8(w, s->tracker);
	gr_write_u8(w, s->body);
	gr_write_u8(w, s->flags);
	gr_write_u8(w, s->axis_count);
	gr_write_u64(w, (uint64_t)s->time_ns);
	for (int i = 0; i < 3; i++)
		gr_write_f32(w, pose->p[i]);
	for (int i = 0; i < 4; i++)
		gr_write_f32(w, pose->q[i]);
	gr_write_u32(w, s->buttons);
	for (int i = 0; i < s->axis_count; i++)
		gr_write_f32(w, s->axes[i]);
	if (s->flags & RECORD_TIMED)
		gr_write_u64(w, (uint64_t)s->device_ns);
}

static bool read_sample(struct gr_reader *r, const struct record_session *session,
			struct record_sample *s)
{
	const unsigned both = RECORD_VALID | RECORD_TAKEN;

	memset(s, 0, sizeof *s);
	s->tracker = gr_read_u8(r);
	s->body = gr_read_u8(r);
	s->flags = gr_read_u8(r);
	s->axis_count = gr_read_u8(r);
	s->time_ns = (int64_t)gr_read_u64(r);
	for (int i = 0; i < 3; i++)
		s->T_room_body.p[i] = gr_read_f32(r);
	for (int i = 0; i < 4; i++)
		s->T_room_body.q[i] = gr_read_f32(r);
	s->buttons = gr_read_u32(r);
	if (s->axis_count > RECORD_AXES)
		return false;
	for (int i = 0; i < s->axis_count; i++)
		s->axes[i] = gr_read_f32(r);
	if (s->flags & RECORD_TIMED)
		s->device_ns = (int64_t)gr_read_u64(r);
	return gr_reader_done(r) && s->tracker < session->tracker_count && s->body < BODIES &&
	       !(s->flags & ~(both | RECORD_TIMED)) &&
	       ((s->flags & both) != both || gr_pose_valid(&s->T_room_body));
}

static void write_frame(struct gr_writer *w, const struct record_frame *f)
{
	gr_write_u64(w, f->frame);
	gr_write_u64(w, f->previous_frame);
	gr_write_u64(w, f->hash);
	gr_write_u64(w, f->previous_hash);
	gr_write_u64(w, f->live);
	gr_write_bytes(w, f->delta, f->delta_len);
}

static bool read_frame(struct gr_reader *r, const struct record_session *session, bool whole,
		       struct record_frame *f)
{
	const uint64_t nodes = session->node_count == 64 ? UINT64_MAX
							 : (UINT64_C(1) << session->node_count) - 1;
	struct gr_reader delta;
	uint64_t base;

	f->frame = gr_read_u64(r);
	f->previous_frame = gr_read_u64(r);
	f->hash = gr_read_u64(r);
	f->previous_hash = gr_read_u64(r);
	f->live = gr_read_u64(r);
	f->delta_len = gr_reader_left(r);
	f->delta = gr_read_bytes(r, f->delta_len);
	if (!r->ok || f->frame <= f->previous_frame || f->live & ~nodes)
		return false;
	delta = gr_reader(f->delta, f->delta_len);
	base = gr_read_varint(&delta);
	return delta.ok && base == (whole ? 0 : f->previous_frame) &&
	       (whole || f->previous_frame > 0);
}

static void write_report(struct gr_writer *w, const struct record_report *p)
{
	gr_write_u8(w, p->node);
	gr_write_u8(w, p->kind);
	gr_write_u16(w, 0);
	gr_write_u64(w, p->frame);
	gr_write_u64(w, p->hash);
	gr_write_u64(w, p->swapped_frame);
	gr_write_u64(w, p->swapped_count);
	gr_write_u64(w, (uint64_t)p->swap_ns);
	gr_write_u32(w, p->render_us);
	gr_write_u64(w, p->slice);
}

static bool read_report(struct gr_reader *r, const struct record_session *session,
			struct record_report *p)
{
	unsigned reserved;

	p->node = gr_read_u8(r);
	p->kind = gr_read_u8(r);
	reserved = gr_read_u16(r);
	p->frame = gr_read_u64(r);
	p->hash = gr_read_u64(r);
	p->swapped_frame = gr_read_u64(r);
	p->swapped_count = gr_read_u64(r);
	p->swap_ns = (int64_t)gr_read_u64(r);
	p->render_us = gr_read_u32(r);
	p->slice = gr_read_u64(r);
	return gr_reader_done(r) && !reserved && p->node < session->node_count &&
	       (p->kind == REPORT_ACK || p->kind == REPORT_READY || p->kind == REPORT_SWAPPED);
}

static void write_event(struct gr_writer *w, const struct record_event *e)
{
	const size_t len = strnlen(e->text, sizeof e->text);

	gr_write_u8(w, e->kind);
	gr_write_u8(w, e->node);
	gr_write_u16(w, (uint16_t)len);
	gr_write_u64(w, e->frame);
	gr_write_u64(w, e->ours);
	gr_write_u64(w, e->theirs);
	gr_write_bytes(w, e->text, len);
	w->ok = w->ok && len < sizeof e->text;
}

static bool read_event(struct gr_reader *r, const struct record_session *session,
		       struct record_event *e)
{
	const uint8_t *text;
	size_t len;

	e->kind = gr_read_u8(r);
	e->node = gr_read_u8(r);
	len = gr_read_u16(r);
	e->frame = gr_read_u64(r);
	e->ours = gr_read_u64(r);
	e->theirs = gr_read_u64(r);
	text = len < sizeof e->text ? gr_read_bytes(r, len) : NULL;
	if (!text || !gr_reader_done(r))
		return false;
	for (size_t i = 0; i < len; i++)
		if (text[i] < 0x20 || text[i] == 0x7f)
			return false;
	memcpy(e->text, text, len);
	e->text[len] = '\0';
	return e->kind >= RECORD_JOINED && e->kind <= RECORD_SETTING &&
	       (e->node < session->node_count || e->node == RECORD_ALL_NODES);
}

static void write_shown(struct gr_writer *w, const struct record_shown *s)
{
	gr_write_u8(w, s->node);
	gr_write_u8(w, 0);
	gr_write_u64(w, s->frame);
	gr_write_u64(w, (uint64_t)s->node_ns);
	gr_write_u64(w, (uint64_t)s->master_ns);
}

static void write_body(struct gr_writer *w, const struct record_entry *e)
{
	switch (e->kind) {
	case RECORD_SAMPLE: write_sample(w, &e->sample); return;
	case RECORD_STATE:
	case RECORD_DELTA: write_frame(w, &e->frame); return;
	case RECORD_REPORT: write_report(w, &e->report); return;
	case RECORD_SWAP:
		gr_write_u64(w, e->swap.frame);
		gr_write_u64(w, (uint64_t)e->swap.at_ns);
		return;
	case RECORD_EVENT: write_event(w, &e->event); return;
	case RECORD_LOST:
		gr_write_u64(w, e->lost.entries);
		gr_write_u64(w, e->lost.frames);
		gr_write_u64(w, (uint64_t)e->lost.since_ns);
		return;
	case RECORD_SHOWN: write_shown(w, &e->shown); return;
	}
	w->ok = false;
}

size_t record_entry_encode(const struct record_entry *entry, uint8_t *bytes, size_t size)
{
	struct gr_writer head = gr_writer(bytes, size), w;

	if (size < RECORD_ENTRY_HEAD)
		return 0;
	w = gr_writer(bytes + RECORD_ENTRY_HEAD,
		      size < RECORD_ENTRY_MAX ? size - RECORD_ENTRY_HEAD : RECORD_BODY_MAX);
	write_body(&w, entry);
	gr_write_u8(&head, (uint8_t)entry->kind);
	gr_write_u8(&head, 0);
	gr_write_u16(&head, (uint16_t)w.len);
	gr_write_u64(&head, (uint64_t)entry->time_ns);
	return w.ok ? RECORD_ENTRY_HEAD + w.len : 0;
}

static bool read_swap(struct gr_reader *r, struct record_swap *s)
{
	s->frame = gr_read_u64(r);
	s->at_ns = (int64_t)gr_read_u64(r);
	return gr_reader_done(r) && s->frame > 0 && s->at_ns >= 0;
}

static bool read_lost(struct gr_reader *r, struct record_lost *l)
{
	l->entries = gr_read_u64(r);
	l->frames = gr_read_u64(r);
	l->since_ns = (int64_t)gr_read_u64(r);
	return gr_reader_done(r) && l->entries > 0 && l->frames <= l->entries && l->since_ns >= 0;
}

static bool read_shown(struct gr_reader *r, const struct record_session *session,
		       struct record_shown *s)
{
	unsigned reserved;

	s->node = gr_read_u8(r);
	reserved = gr_read_u8(r);
	s->frame = gr_read_u64(r);
	s->node_ns = (int64_t)gr_read_u64(r);
	s->master_ns = (int64_t)gr_read_u64(r);
	return gr_reader_done(r) && !reserved && s->node < session->node_count && s->frame > 0;
}

static bool read_body(struct gr_reader *body, const struct record_session *session,
		      struct record_entry *out)
{
	switch (out->kind) {
	case RECORD_SAMPLE: return read_sample(body, session, &out->sample);
	case RECORD_STATE: return read_frame(body, session, true, &out->frame);
	case RECORD_DELTA: return read_frame(body, session, false, &out->frame);
	case RECORD_REPORT: return read_report(body, session, &out->report);
	case RECORD_SWAP: return read_swap(body, &out->swap);
	case RECORD_EVENT: return read_event(body, session, &out->event);
	case RECORD_LOST: return read_lost(body, &out->lost);
	case RECORD_SHOWN: return read_shown(body, session, &out->shown);
	}
	return false;
}

bool record_entry_decode(struct gr_reader *r, const struct record_session *session,
			 struct record_entry *out)
{
	const unsigned kind = gr_read_u8(r), reserved = gr_read_u8(r);
	const size_t len = gr_read_u16(r);
	struct gr_reader body;
	const uint8_t *bytes;

	out->time_ns = (int64_t)gr_read_u64(r);
	bytes = gr_read_bytes(r, len);
	if (!bytes || kind < RECORD_SAMPLE || kind > RECORD_SHOWN || reserved || out->time_ns < 0 ||
	    len > RECORD_BODY_MAX) {
		r->ok = false;
		return false;
	}
	out->kind = (enum record_entry_kind)kind;
	body = gr_reader(bytes, len);
	if (!read_body(&body, session, out))
		r->ok = false;
	return r->ok;
}
