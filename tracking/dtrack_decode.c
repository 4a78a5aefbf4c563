/* A datagram of DTrack. Pure. */
#include "tracking/dtrack.h"

#include "base/result.h"
#include "tracking/text.h"

#include <math.h>
#include <string.h>

#define ITEMS_MOST 4096	  /* of one line; there are fewer in a datagram */
#define BUTTONS_MOST 1024 /* of one Flystick; so many words are passed by */
#define VALUES_MOST 64
#define AMOUNT_MOST 1e9 /* of anything without a range of its own */
#define DAY_S 86401	/* with a leap second */
#define EPOCH_MOST UINT32_MAX

/* What the block before the position holds, and the blocks after the matrix. */
enum form {
	FORM_BODY,	   /* [id qu] */
	FORM_INERTIAL,	   /* [id st er] */
	FORM_OLD_FLYSTICK, /* [id qu bt], eight buttons */
	FORM_FLYSTICK,	   /* [id qu nbt nct] ... [bt.. ct..] */
	FORM_OLD_TOOL,	   /* [id qu bt], four buttons */
	FORM_TOOL,	   /* [id qu nbt rd] ... [bt..][covariance] */
};

static const struct line {
	const char *word;
	enum form form;
	bool calibrated; /* the number of calibrated ones stands before the number of those here */
	bool newer;	 /* goes before the other line of the same sensors */
	unsigned first, count;
} lines[] = {
	{ "6d", FORM_BODY, false, false, TRACK_DTRACK_BODY, TRACK_DTRACK_BODIES },
	{ "6di", FORM_INERTIAL, false, true, TRACK_DTRACK_BODY, TRACK_DTRACK_BODIES },
	{ "6df", FORM_OLD_FLYSTICK, false, false, TRACK_DTRACK_FLYSTICK, TRACK_DTRACK_FLYSTICKS },
	{ "6df2", FORM_FLYSTICK, true, true, TRACK_DTRACK_FLYSTICK, TRACK_DTRACK_FLYSTICKS },
	{ "6dmt", FORM_OLD_TOOL, false, false, TRACK_DTRACK_TOOL, TRACK_DTRACK_TOOLS },
	{ "6dmt2", FORM_TOOL, true, true, TRACK_DTRACK_TOOL, TRACK_DTRACK_TOOLS },
};
#define LINES (sizeof lines / sizeof lines[0])
static const struct line joint_line = { "6dj", FORM_BODY, true, false, TRACK_DTRACK_JOINT,
					TRACK_DTRACK_JOINTS };
/* Of other humans than the first: no sensor has their numbers. */
static const struct line other_joint_line = { "6dj", FORM_BODY, true, false, TRACK_DTRACK_JOINT,
					      0 };

struct parser {
	struct track_dtrack_frame *frame;
	uint32_t newer; /* sensors that a newer line gave */
	unsigned lines; /* bit i: lines[i] was there; then 6dj */
};

/* -1..1, negative: not tracked. */
static void read_quality(struct track_text *t, struct track_dtrack_item *out)
{
	const double quality = track_text_number(t, 1);

	out->lost = quality < 0;
	out->quality = (float)quality;
}

/* The block before the position. Returns the item's number. */
static uint32_t read_head(struct track_text *t, enum form form, struct track_dtrack_item *out,
			  uint32_t *button_count)
{
	uint32_t id;

	*button_count = 0;
	track_text_expect(t, '[');
	id = track_text_u32(t, UINT32_MAX);
	if (form == FORM_INERTIAL) {
		out->lost = track_text_u32(t, 3) == 0;
		out->quality = -1;
		(void)track_text_number(t, AMOUNT_MOST);
	} else {
		read_quality(t, out);
	}
	out->has_input = form != FORM_BODY && form != FORM_INERTIAL;
	if (form == FORM_OLD_FLYSTICK || form == FORM_OLD_TOOL)
		out->buttons = track_text_u32(t, UINT32_MAX);
	if (form == FORM_FLYSTICK || form == FORM_TOOL)
		*button_count = track_text_u32(t, BUTTONS_MOST);
	if (form == FORM_FLYSTICK)
		out->axis_count = track_text_u32(t, VALUES_MOST);
	if (form == FORM_TOOL)
		(void)track_text_number(t, AMOUNT_MOST);
	track_text_expect(t, ']');
	return id;
}

static void read_pose(struct track_text *t, struct track_dtrack_item *out)
{
	bool zero = true;

	track_text_expect(t, '[');
	for (int i = 0; i < 3; i++)
		out->place_mm[i] = track_text_number(t, AMOUNT_MOST);
	track_text_close(t); /* some write three angles there, too */
	track_text_expect(t, '[');
	for (int i = 0; i < 9; i++) {
		out->turn[i] = track_text_number(t, AMOUNT_MOST);
		zero = zero && out->turn[i] == 0;
	}
	track_text_expect(t, ']');
	if (zero)
		out->lost = true;
}

static void read_buttons(struct track_text *t, uint32_t count, struct track_dtrack_item *out)
{
	for (uint32_t i = 0; t->ok && i < count; i += 32) {
		const uint32_t word = track_text_u32(t, UINT32_MAX);

		if (i == 0)
			out->buttons = count < 32 ? word & ((UINT32_C(1) << count) - 1) : word;
	}
}

static void read_values(struct track_text *t, struct track_dtrack_item *out)
{
	const unsigned count = out->axis_count;

	for (unsigned i = 0; t->ok && i < count; i++) {
		const double value = track_text_number(t, 1);

		if (i < TRACK_AXES)
			out->axes[i] = (float)value;
	}
	if (count > TRACK_AXES)
		out->axis_count = TRACK_AXES;
}

/* The blocks after the matrix. */
static void read_tail(struct track_text *t, enum form form, uint32_t button_count,
		      struct track_dtrack_item *out)
{
	if (form != FORM_FLYSTICK && form != FORM_TOOL)
		return;
	track_text_expect(t, '[');
	read_buttons(t, button_count, out);
	if (form == FORM_FLYSTICK)
		read_values(t, out);
	track_text_expect(t, ']');
	if (form == FORM_TOOL) {
		track_text_expect(t, '[');
		track_text_close(t);
	}
}

/* An old Flystick says where its stick is by four of its eight buttons. */
static void read_hat(struct track_dtrack_item *item)
{
	const uint32_t b = item->buttons;

	item->hat = true;
	item->axis_count = 2;
	item->axes[0] = (float)((b & 0x80) != 0) - (float)((b & 0x20) != 0);
	item->axes[1] = (float)((b & 0x40) != 0) - (float)((b & 0x10) != 0);
	item->buttons = b & 0x0f;
}

static void read_item(struct parser *p, struct track_text *t, const struct line *line,
		      uint32_t *here)
{
	struct track_dtrack_item item = { 0 };
	uint32_t button_count, bit, id = read_head(t, line->form, &item, &button_count);

	read_pose(t, &item);
	read_tail(t, line->form, button_count, &item);
	if (line->form == FORM_OLD_FLYSTICK)
		read_hat(&item);
	if (line->form == FORM_OLD_TOOL)
		item.buttons &= 0x0f;
	if (!t->ok)
		return;
	if (id >= line->count) {
		p->frame->beyond++;
		return;
	}
	bit = UINT32_C(1) << (line->first + id);
	if (*here & bit) {
		t->ok = false;
		return;
	}
	*here |= bit;
	if (!(p->newer & bit))
		p->frame->items[line->first + id] = item;
	if (line->newer)
		p->newer |= bit;
}

static uint32_t mask(unsigned first, unsigned count)
{
	return ((UINT32_C(1) << count) - 1) << first;
}

static bool read_items(struct parser *p, struct track_text *t, const struct line *line)
{
	uint32_t here = 0, count;

	if (line->calibrated)
		(void)track_text_u32(t, ITEMS_MOST);
	count = track_text_u32(t, ITEMS_MOST);
	for (uint32_t i = 0; t->ok && i < count; i++)
		read_item(p, t, line, &here);
	p->frame->listed |= mask(line->first, line->count);
	p->frame->present |= here;
	return track_text_done(t);
}

/* Human models, each [id joints] and its joints; those of the first one are sensors. */
static bool read_humans(struct parser *p, struct track_text *t)
{
	uint32_t here = 0, humans;

	(void)track_text_u32(t, ITEMS_MOST);
	humans = track_text_u32(t, ITEMS_MOST);
	for (uint32_t i = 0; t->ok && i < humans; i++) {
		uint32_t id, joints;

		track_text_expect(t, '[');
		id = track_text_u32(t, UINT32_MAX);
		joints = track_text_u32(t, ITEMS_MOST);
		track_text_expect(t, ']');
		for (uint32_t k = 0; t->ok && k < joints; k++)
			read_item(p, t, id == 0 ? &joint_line : &other_joint_line, &here);
	}
	p->frame->listed |= mask(joint_line.first, joint_line.count);
	p->frame->present |= here;
	return track_text_done(t);
}

static bool read_ts(struct track_dtrack_frame *frame, struct track_text *t)
{
	const double seconds = track_text_number(t, DAY_S);

	/* A negative one is "not available", in A.R.T.'s parser. */
	frame->has_ts = seconds >= 0;
	frame->ts_ns = llrint(seconds * 1e6) * GR_NS_PER_US;
	return track_text_done(t);
}

static bool read_ts2(struct track_dtrack_frame *frame, struct track_text *t)
{
	frame->ts2_ns = (int64_t)track_text_u32(t, EPOCH_MOST) * GR_NS_PER_S;
	frame->ts2_ns += (int64_t)track_text_u32(t, 999999) * GR_NS_PER_US;
	frame->latency_ns = (int64_t)track_text_u32(t, UINT32_MAX) * GR_NS_PER_US;
	frame->has_ts2 = true;
	return track_text_done(t);
}

/* False when a line that has been there already comes again. */
static bool first_of(struct parser *p, unsigned bit)
{
	const bool first = !(p->lines >> bit & 1);

	p->lines |= 1u << bit;
	return first;
}

static bool read_line(struct parser *p, struct track_text *t)
{
	for (unsigned i = 0; i < LINES; i++)
		if (track_text_word(t, lines[i].word))
			return first_of(p, i) && read_items(p, t, &lines[i]);
	if (track_text_word(t, joint_line.word))
		return first_of(p, LINES) && read_humans(p, t);
	if (track_text_word(t, "ts"))
		return first_of(p, LINES + 1) && read_ts(p->frame, t);
	if (track_text_word(t, "ts2"))
		return first_of(p, LINES + 2) && read_ts2(p->frame, t);
	/* 6dcal says no more than 6d; markers, hands, covariances, and what will be thought of. */
	return !track_text_word(t, "fr");
}

int track_dtrack_decode(const uint8_t *bytes, size_t len, struct track_dtrack_frame *out)
{
	struct track_dtrack_frame frame = { 0 };
	struct parser p = { .frame = &frame };
	struct track_text text, line;

	while (len > 0 && len <= TRACK_DTRACK_BYTES && bytes[len - 1] == 0)
		len--;
	if (len == 0 || len > TRACK_DTRACK_BYTES)
		return -TRACK_FAULT_LENGTH;
	text = track_text(bytes, len);
	if (!track_text_line(&text, &line) || !track_text_word(&line, "fr"))
		return -TRACK_FAULT_FORMAT;
	frame.number = track_text_u32(&line, UINT32_MAX);
	if (!track_text_done(&line))
		return -TRACK_FAULT_FORMAT;
	while (track_text_line(&text, &line))
		if (!read_line(&p, &line))
			return -TRACK_FAULT_FORMAT;
	*out = frame;
	return GR_OK;
}
