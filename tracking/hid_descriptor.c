/* Items of a report descriptor. What their fields are is in hid_fields.c. */
#include "tracking/hid_fields.h"

#include "base/cursor.h"
#include "base/result.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define STACK 64
#define NEST 64

enum type { MAIN, GLOBAL, LOCAL, RESERVED };
enum main_tag { INPUT = 8, OUTPUT = 9, COLLECTION = 10, FEATURE = 11, END_COLLECTION = 12 };
enum global_tag {
	PAGE,
	MIN,
	MAX,
	PHYSICAL_MIN,
	PHYSICAL_MAX,
	EXPONENT,
	UNIT,
	SIZE,
	ID,
	COUNT,
	PUSH,
	POP
};
enum local_tag { USAGE, USAGE_MIN, USAGE_MAX, DELIMITER = 10 };
#define APPLICATION 1 /* collection */
#define LONG_ITEM 0xfe

struct parser {
	struct track_hid_pads *out;
	bool all;
	struct hid_globals now, stack[STACK];
	unsigned pushed;
	struct hid_locals locals;
	unsigned depth;	    /* of collections */
	int pad;	    /* whose collection this is in, or -1 */
	bool unnumbered;    /* an input came before any report number */
	uint32_t bits[256]; /* of each input report */
	size_t at;	    /* of the item */
	char *why;
	size_t size;
};

static __attribute__((format(printf, 2, 3))) int refuse(struct parser *p, const char *format, ...)
{
	va_list args;
	int n = snprintf(p->why, p->size, "report descriptor, byte %zu: ", p->at);

	va_start(args, format);
	if (n >= 0 && (size_t)n < p->size)
		vsnprintf(p->why + n, p->size - (size_t)n, format, args);
	va_end(args);
	return GR_ERR_FORMAT;
}

/* Of n bytes, little endian. */
static int32_t as_signed(uint32_t value, unsigned n)
{
	return n == 1 ? (int8_t)value : n == 2 ? (int16_t)value : (int32_t)value;
}

static int take_global(struct parser *p, unsigned tag, uint32_t value, unsigned n)
{
	switch (tag) {
	case PAGE: p->now.page = value; break;
	case MIN: p->now.min = as_signed(value, n); break;
	case MAX:
		p->now.max = as_signed(value, n);
		p->now.max_unsigned = value;
		break;
	case SIZE: p->now.size = value; break;
	case COUNT: p->now.count = value; break;
	case ID:
		if (value == 0 || value > 255)
			return refuse(p, "a report has number %u; 1 to 255 can be", value);
		if (p->unnumbered)
			return refuse(p, "a report gets number %u after inputs without one", value);
		p->now.report = (uint8_t)value;
		p->out->numbered = true;
		break;
	case PUSH:
		if (p->pushed == STACK)
			return refuse(p, "more than %d states are pushed", STACK);
		p->stack[p->pushed++] = p->now;
		break;
	case POP:
		if (!p->pushed)
			return refuse(p, "pops a state that nothing pushed");
		p->now = p->stack[--p->pushed];
		break;
	default: break; /* physical range and units: nothing is measured in them here */
	}
	return GR_OK;
}

static int take_local(struct parser *p, unsigned tag, uint32_t value, unsigned n)
{
	struct hid_locals *l = &p->locals;

	if (tag == DELIMITER) {
		l->alternatives = value == 1 ? 1 : 0;
		return GR_OK;
	}
	if (tag > USAGE_MAX || (l->alternatives && l->alternatives++ > 1))
		return GR_OK; /* strings and designators; all but the first of several names */
	if (tag == USAGE_MIN) {
		l->min = (struct hid_usage){ value, n == 4 };
		l->has_min = true;
		return GR_OK;
	}
	if (l->count == HID_RANGES)
		return refuse(p, "one item has more than %d usages", HID_RANGES);
	if (tag == USAGE) {
		l->ranges[l->count++] = (struct hid_range){ { value, n == 4 }, value };
		return GR_OK;
	}
	if (!l->has_min)
		return refuse(p, "a usage maximum without its minimum");
	if (value < l->min.value)
		return refuse(p, "usage maximum %u is below the minimum %u", value, l->min.value);
	l->ranges[l->count++] = (struct hid_range){ l->min, value };
	l->has_min = false;
	return GR_OK;
}

static int begin_collection(struct parser *p, uint32_t kind)
{
	const uint32_t usage = hid_usage_at(&p->locals, p->now.page, 0);

	if (p->depth == NEST)
		return refuse(p, "collections are nested more than %d deep", NEST);
	p->depth++;
	if (p->depth > 1 || kind != APPLICATION || !(p->all || hid_is_pad(usage)))
		return GR_OK;
	if (p->out->pad_count == TRACK_HID_PADS)
		return refuse(p, "more than %d gamepads in one device", TRACK_HID_PADS);
	p->pad = (int)p->out->pad_count++;
	p->out->usages[p->pad] = usage;
	return GR_OK;
}

static int end_collection(struct parser *p)
{
	if (!p->depth)
		return refuse(p, "ends a collection that nothing began");
	if (--p->depth > 0 || p->pad < 0)
		return GR_OK;
	/* A collection without anything of a gamepad's is none. */
	if (!p->out->has_buttons[p->pad] && !p->out->has_axes[p->pad])
		p->out->pad_count--;
	p->pad = -1;
	return GR_OK;
}

static int take_input(struct parser *p, uint32_t flags)
{
	const struct hid_globals *g = &p->now;
	const uint64_t bits = (uint64_t)g->size * g->count;
	uint32_t *at = &p->bits[g->report];
	const char *wrong = NULL;

	if (!p->out->numbered)
		p->unnumbered = true;
	else if (!g->report)
		return refuse(p, "an input without a report number where others have one");
	if (bits > 8 * TRACK_HID_REPORT_MOST || *at + bits > 8 * (TRACK_HID_REPORT_MOST - 1))
		return refuse(p, "report %u is longer than %d bytes", g->report,
			      TRACK_HID_REPORT_MOST);
	if (p->pad >= 0)
		wrong = hid_add_fields(p->out, g, &p->locals, (unsigned)p->pad, flags, *at);
	if (wrong)
		return refuse(p, "%s", wrong);
	*at += (uint32_t)bits;
	return GR_OK;
}

static int take_main(struct parser *p, unsigned tag, uint32_t value)
{
	int r = GR_OK;

	if (p->locals.has_min)
		return refuse(p, "a usage minimum without its maximum");
	switch (tag) {
	case INPUT: r = take_input(p, value); break;
	case COLLECTION: r = begin_collection(p, value); break;
	case END_COLLECTION: r = end_collection(p); break;
	default: break; /* outputs and features are counted apart */
	}
	p->locals = (struct hid_locals){ 0 };
	return r;
}

static int take_item(struct parser *p, struct gr_reader *r)
{
	static const unsigned sizes[] = { 0, 1, 2, 4 };
	const uint8_t head = gr_read_u8(r);
	const unsigned n = sizes[head & 3], tag = head >> 4;
	uint32_t value = 0;

	if (head == LONG_ITEM) {
		const uint8_t len = gr_read_u8(r);

		(void)gr_read_u8(r); /* its tag: none was ever given out */
		(void)gr_read_bytes(r, len);
		return r->ok ? GR_OK : refuse(p, "the descriptor ends within a long item");
	}
	for (unsigned i = 0; i < n; i++)
		value |= (uint32_t)gr_read_u8(r) << 8 * i;
	if (!r->ok)
		return refuse(p, "the descriptor ends within an item");
	switch ((enum type)(head >> 2 & 3)) {
	case MAIN: return take_main(p, tag, value);
	case GLOBAL: return take_global(p, tag, value, n);
	case LOCAL: return take_local(p, tag, value, n);
	default: return GR_OK; /* reserved: passed over, as its size is known */
	}
}

static int take_all(struct parser *p, const uint8_t *bytes, size_t len)
{
	struct gr_reader r = gr_reader(bytes, len);
	int result = GR_OK;

	while (result == GR_OK && gr_reader_left(&r)) {
		p->at = r.at;
		result = take_item(p, &r);
	}
	if (result < 0)
		return result;
	p->at = len;
	if (p->depth)
		return refuse(p, "%u collections do not end", p->depth);
	if (!p->out->field_count)
		return refuse(p, "no gamepad or joystick with buttons or axes in it");
	return GR_OK;
}

int track_hid_parse(const uint8_t *bytes, size_t len, bool all, struct track_hid_pads *out,
		    char *why, size_t size)
{
	struct parser p = { .out = out, .all = all, .pad = -1, .why = why, .size = size };
	int r;

	memset(out, 0, sizeof *out);
	if (len > TRACK_HID_DESCRIPTOR_MOST)
		return refuse(&p, "%zu bytes long; at most %d can be", len,
			      TRACK_HID_DESCRIPTOR_MOST);
	r = take_all(&p, bytes, len);
	for (unsigned i = 0; r == GR_OK && i < 256; i++)
		if (p.bits[i])
			out->bytes[i] = (uint16_t)((p.bits[i] + 7) / 8 + out->numbered);
	return r;
}
