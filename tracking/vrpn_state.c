/* VRPN's messages, by the names that this connection has given their numbers. Pure. */
#include "tracking/vrpn.h"

#include "base/cursor.h"
#include "base/result.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define BUTTONS_MOST 256			/* of VRPN; ours are the first 32 */
#define CHANNELS_MOST 128			/* likewise, the first TRACK_AXES */
#define AWAY_NS (INT64_C(400) * 86400 * GR_NS_PER_S) /* from the clock's zero, far from overflow */

/* What a type is to us. */
enum type { TYPE_OTHER, TYPE_POSE, TYPE_BUTTON, TYPE_BUTTONS, TYPE_CHANNELS, TYPES };

static const char *const type_names[TYPES] = {
	[TYPE_POSE] = "vrpn_Tracker Pos_Quat",
	[TYPE_BUTTON] = "vrpn_Button Change",
	[TYPE_BUTTONS] = "vrpn_Button States",
	[TYPE_CHANNELS] = "vrpn_Analog Channel",
};

static int32_t read_s32(struct gr_reader *r)
{
	return (int32_t)__builtin_bswap32(gr_read_u32(r));
}

static double read_f64(struct gr_reader *r)
{
	const uint64_t bits = __builtin_bswap64(gr_read_u64(r));
	double value;

	memcpy(&value, &bits, sizeof value);
	return value;
}

/* ---- names ---- */

/* A name with its length in front and a NUL behind; NULL: it is none. */
static const char *read_name(const struct track_vrpn_message *m)
{
	struct gr_reader r = gr_reader(m->body, m->len);
	const int32_t size = read_s32(&r);
	const char *name;

	if (!r.ok || size < 1 || size > TRACK_VRPN_NAME)
		return NULL;
	name = (const char *)gr_read_bytes(&r, (size_t)size);
	if (!name || !gr_reader_done(&r) || strnlen(name, (size_t)size) != (size_t)size - 1)
		return NULL;
	return name;
}

static void note_other(struct track_vrpn_state *s, const char *name)
{
	size_t len = strlen(s->others);

	/* The server's own, of no use to a person. */
	if (!strcmp(name, "VRPN Control"))
		return;
	snprintf(s->others + len, sizeof s->others - len, "%s%s", len ? ", " : "", name);
	for (; s->others[len]; len++)
		if (!isprint((unsigned char)s->others[len]))
			s->others[len] = '?';
}

static int describe(struct track_vrpn_state *s, const struct track_vrpn_message *m)
{
	const char *name = read_name(m);

	if (!name || m->sender < 0 || m->sender >= TRACK_VRPN_IDS)
		return -TRACK_FAULT_FORMAT;
	if (m->type == TRACK_VRPN_SENDER) {
		if (!strcmp(name, s->device)) {
			s->there = true;
			s->sender = m->sender;
		} else {
			/* A number that is another's now is not the device's any more. */
			if (s->there && s->sender == m->sender)
				s->there = false;
			note_other(s, name);
		}
		return GR_OK;
	}
	s->types[m->sender] = TYPE_OTHER;
	for (int i = TYPE_OTHER + 1; i < TYPES; i++)
		if (!strcmp(name, type_names[i]))
			s->types[m->sender] = (uint8_t)i;
	return GR_OK;
}

/* ---- reports ---- */

static void add_input(const struct track_vrpn_state *s, struct track_report *r)
{
	r->has |= (s->has_buttons ? (unsigned)TRACK_BUTTONS : 0) |
		  (s->has_axes ? (unsigned)TRACK_AXIS_VALUES : 0);
	r->buttons = s->buttons;
	r->axis_count = s->axis_count;
	memcpy(r->axes, s->axes, sizeof r->axes);
}

/* Buttons and channels, for whichever sensors they may be bound beside. */
static void input_reports(const struct track_vrpn_state *s, struct track_vrpn_reports *out)
{
	const uint32_t sensors = s->seen ? s->seen : 1;

	for (uint32_t i = 0; i < TRACK_VRPN_SENSORS; i++) {
		if (!(sensors >> i & 1))
			continue;
		out->reports[out->count] = (struct track_report){ .sensor = i };
		add_input(s, &out->reports[out->count++]);
	}
}

/*
 * The server's time from a zero of ours. False: the same as the sensor's last,
 * and no duplicate, for nothing is sent twice by TCP: the server's clock is
 * coarse.
 */
static bool take_time(struct track_vrpn_state *s, const struct track_vrpn_message *m, int32_t sensor,
		      bool datagram, int64_t *out)
{
	const bool again = (s->seen >> sensor & 1) && s->last_ns[sensor] == m->time_ns;

	if (!s->has_zero || llabs(m->time_ns - s->zero_ns) > AWAY_NS)
		s->zero_ns = m->time_ns;
	s->has_zero = true;
	s->last_ns[sensor] = m->time_ns;
	*out = m->time_ns - s->zero_ns;
	return datagram || !again;
}

static int take_pose(struct track_vrpn_state *s, const struct track_vrpn_message *m, bool datagram,
		     struct track_vrpn_reports *out)
{
	struct gr_reader r = gr_reader(m->body, m->len);
	struct track_report *report = &out->reports[0];
	const int32_t sensor = read_s32(&r);
	double v[7];

	(void)read_s32(&r);
	for (int i = 0; i < 7; i++)
		v[i] = read_f64(&r);
	if (!gr_reader_done(&r))
		return -TRACK_FAULT_LENGTH;
	if (sensor < 0)
		return -TRACK_FAULT_FORMAT;
	if (sensor >= TRACK_VRPN_SENSORS)
		return -TRACK_FAULT_SENSOR;
	for (int i = 0; i < 7; i++)
		if (!(fabs(v[i]) <= (double)TRACK_PLACE_MAX_M))
			return -TRACK_FAULT_POSE;
	*report = (struct track_report){ .has = TRACK_POSITION | TRACK_ORIENTATION,
					 .sensor = (uint32_t)sensor };
	for (int i = 0; i < 3; i++)
		report->T_base_sensor.p[i] = (float)v[i];
	for (int i = 0; i < 4; i++)
		report->T_base_sensor.q[i] = (float)v[3 + i];
	if (take_time(s, m, sensor, datagram, &report->device_ns))
		report->has |= TRACK_DEVICE_TIME;
	s->seen |= UINT32_C(1) << sensor;
	add_input(s, report);
	out->count = 1;
	return GR_OK;
}

static void set_button(struct track_vrpn_state *s, int32_t button, bool pressed)
{
	const uint32_t bit = button < 32 ? UINT32_C(1) << button : 0;

	s->has_buttons = true;
	s->buttons = pressed ? s->buttons | bit : s->buttons & ~bit;
}

static int take_button(struct track_vrpn_state *s, const struct track_vrpn_message *m)
{
	struct gr_reader r = gr_reader(m->body, m->len);
	const int32_t button = read_s32(&r), pressed = read_s32(&r);

	if (!gr_reader_done(&r))
		return -TRACK_FAULT_LENGTH;
	if (button < 0 || button >= BUTTONS_MOST)
		return -TRACK_FAULT_FORMAT;
	set_button(s, button, pressed != 0);
	return GR_OK;
}

static int take_buttons(struct track_vrpn_state *s, const struct track_vrpn_message *m)
{
	struct gr_reader r = gr_reader(m->body, m->len);
	const int32_t count = read_s32(&r);

	if (!r.ok)
		return -TRACK_FAULT_LENGTH;
	if (count < 0 || count > BUTTONS_MOST)
		return -TRACK_FAULT_FORMAT;
	if (gr_reader_left(&r) != (size_t)count * 4)
		return -TRACK_FAULT_LENGTH;
	s->has_buttons = true;
	s->buttons = 0;
	for (int32_t i = 0; i < count; i++)
		set_button(s, i, read_s32(&r) != 0);
	return GR_OK;
}

static int take_channels(struct track_vrpn_state *s, const struct track_vrpn_message *m)
{
	struct gr_reader r = gr_reader(m->body, m->len);
	const double count = read_f64(&r);
	float axes[TRACK_AXES] = { 0 };
	uint32_t kept = 0;

	if (!r.ok)
		return -TRACK_FAULT_LENGTH;
	if (!(count >= 0 && count <= CHANNELS_MOST) || count != floor(count))
		return -TRACK_FAULT_FORMAT;
	if (gr_reader_left(&r) != (size_t)count * 8)
		return -TRACK_FAULT_LENGTH;
	for (size_t i = 0; i < (size_t)count; i++) {
		const double value = read_f64(&r);

		if (!isfinite(value))
			return -TRACK_FAULT_FORMAT;
		/* Channels have no range that the protocol knows; beyond 1 is the end of the way. */
		if (i < TRACK_AXES)
			axes[kept++] = (float)fmax(-1, fmin(1, value));
	}
	memcpy(s->axes, axes, sizeof s->axes);
	s->axis_count = kept;
	s->has_axes = true;
	return GR_OK;
}

int track_vrpn_take(struct track_vrpn_state *s, const struct track_vrpn_message *m, bool datagram,
		    struct track_vrpn_reports *out)
{
	int r = GR_NOTHING;

	out->ended = false;
	out->count = 0;
	if (m->type < 0) {
		if (datagram) /* names come by the connection alone */
			return -TRACK_FAULT_FORMAT;
		out->ended = m->type == TRACK_VRPN_DISCONNECT;
		if (m->type == TRACK_VRPN_SENDER || m->type == TRACK_VRPN_TYPE)
			r = describe(s, m);
		return r;
	}
	if (m->type >= TRACK_VRPN_IDS || !s->there || m->sender != s->sender)
		return GR_NOTHING;
	switch (s->types[m->type]) {
	case TYPE_POSE: return take_pose(s, m, datagram, out);
	case TYPE_BUTTON: r = take_button(s, m); break;
	case TYPE_BUTTONS: r = take_buttons(s, m); break;
	case TYPE_CHANNELS: r = take_channels(s, m); break;
	default: return GR_NOTHING;
	}
	if (r == GR_OK)
		input_reports(s, out);
	return r;
}

void track_vrpn_rest(const struct track_vrpn_state *s, struct track_vrpn_reports *out)
{
	out->ended = false;
	out->count = 0;
	if (!s->seen && (s->has_buttons || s->has_axes))
		input_reports(s, out);
}
