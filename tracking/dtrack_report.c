/* A frame of DTrack as reports of the common form. Pure. */
#include "tracking/dtrack.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STALE_MOST 8		       /* frames of a lower number in a row: the counter began anew */
#define GAP_MOST (1 << 20)	       /* more than so many frames are not missing: likewise */
#define REST_NS GR_NS_PER_S	       /* after which any number goes */
#define DAY_NS (86400 * GR_NS_PER_S)
#define AWAY_NS (400 * DAY_NS) /* from the clock's zero; differences stay far from overflow */
#define TURN_SLACK 0.01	       /* of the matrix times its transpose: three decimals and some */

/* ---- which frame it is ---- */

static int check_number(struct track_dtrack_state *state, uint32_t number, int64_t arrived_ns,
			uint64_t *missed)
{
	const int32_t ahead = (int32_t)(number - state->number);
	const bool rested = arrived_ns - state->arrived_ns > REST_NS;

	*missed = 0;
	if (state->started && !rested && ahead <= 0) {
		/* A duplicate says nothing of a counter that began anew. */
		if (ahead == 0 || ++state->stale < STALE_MOST)
			return -TRACK_FAULT_ORDER;
	} else if (state->started && !rested && ahead < GAP_MOST) {
		*missed = (uint64_t)ahead - 1;
	}
	state->started = true;
	state->stale = 0;
	state->number = number;
	return GR_OK;
}

/* Time of day as one that does not wrap: the day that is nearest to what must have passed. */
static int64_t unwrap_day(const struct track_dtrack_state *state, int64_t ts_ns, int64_t arrived_ns)
{
	const int64_t expected = state->raw_ns + (arrived_ns - state->arrived_ns);
	const double days = (double)(expected - ts_ns) / (double)DAY_NS;

	return ts_ns + llrint(days) * DAY_NS;
}

/* The frame's time from a zero of our own; false when it has none. */
static bool take_time(struct track_dtrack_state *state, const struct track_dtrack_frame *frame,
		      int64_t arrived_ns, int64_t *out)
{
	int64_t raw_ns = frame->has_ts2 ? frame->ts2_ns : frame->ts_ns;

	if (!frame->has_ts && !frame->has_ts2) {
		state->has_time = false;
		return false;
	}
	if (state->has_time && state->by_ts2 != frame->has_ts2)
		state->has_time = false;
	if (state->has_time && !frame->has_ts2)
		raw_ns = unwrap_day(state, raw_ns, arrived_ns);
	if (!state->has_time || llabs(raw_ns - state->zero_ns) > AWAY_NS)
		state->zero_ns = raw_ns;
	state->has_time = true;
	state->by_ts2 = frame->has_ts2;
	state->raw_ns = raw_ns;
	*out = raw_ns - state->zero_ns;
	return true;
}

/* ---- poses ---- */

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A turn and nothing else: columns of length 1 at right angles, right handed. */
static bool is_turn(const double m[9])
{
	const double *x = m, *y = m + 3, *z = m + 6;
	const double cross[3] = { x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2],
				  x[0] * y[1] - x[1] * y[0] };

	for (int i = 0; i < 3; i++)
		if (!(fabs(dot(m + 3L * i, m + 3L * i) - 1) <= TURN_SLACK))
			return false;
	return fabs(dot(x, y)) <= TURN_SLACK && fabs(dot(y, z)) <= TURN_SLACK &&
	       fabs(dot(z, x)) <= TURN_SLACK && dot(cross, z) > 0;
}

/* X right, Y away, Z up to X right, Y up, Z near; the same for a quaternion's vector part. */
static void from_z_up(float v[3])
{
	const float y = v[1];

	v[1] = v[2];
	v[2] = -y;
}

static bool pose(const struct track_dtrack_item *item, bool z_up, struct gr_pose *out)
{
	mat3 columns;

	if (!is_turn(item->turn))
		return false;
	for (int i = 0; i < 9; i++)
		columns[i / 3][i % 3] = (float)item->turn[i];
	glm_mat3_quat(columns, out->q);
	glm_quat_normalize(out->q);
	for (int i = 0; i < 3; i++)
		out->p[i] = (float)(item->place_mm[i] * 0.001);
	if (z_up) {
		from_z_up(out->p);
		from_z_up(out->q);
	}
	return true;
}

static void input(const struct track_dtrack_item *item, const struct track_dtrack_setup *setup,
		  struct track_report *out)
{
	out->has |= TRACK_BUTTONS | TRACK_AXIS_VALUES;
	out->buttons = item->buttons;
	out->axis_count = item->axis_count;
	memcpy(out->axes, item->axes, sizeof out->axes);
	if (item->hat)
		return;
	if (setup->stick_x_left)
		out->axes[0] = -out->axes[0];
	if (setup->stick_y_down)
		out->axes[1] = -out->axes[1];
}

/* False: nothing to say. */
static bool one_report(const struct track_dtrack_item *item, const struct track_dtrack_setup *setup,
		       struct track_dtrack_reports *counts, struct track_report *out)
{
	if (item->lost) {
		out->has |= TRACK_LOST;
	} else if (pose(item, setup->z_up, &out->T_base_sensor)) {
		out->has |= TRACK_POSITION | TRACK_ORIENTATION;
		if (item->quality >= 0)
			out->has |= TRACK_QUALITY;
		out->quality = item->quality;
	} else {
		counts->bad_poses++;
	}
	if (item->has_input)
		input(item, setup, out);
	return out->has != 0;
}

int track_dtrack_take(struct track_dtrack_state *state, const struct track_dtrack_setup *setup,
		      const struct track_dtrack_frame *frame, int64_t arrived_ns,
		      struct track_dtrack_reports *out)
{
	const struct track_dtrack_item gone = { .lost = true };
	int64_t device_ns = 0;
	bool timed;

	out->count = out->bad_poses = 0;
	if (check_number(state, frame->number, arrived_ns, &out->missed) < 0)
		return -TRACK_FAULT_ORDER;
	timed = take_time(state, frame, arrived_ns, &device_ns);
	state->arrived_ns = arrived_ns;
	state->known |= frame->present;
	for (uint32_t i = 0; i < TRACK_DTRACK_SENSORS; i++) {
		struct track_report *report = &out->reports[out->count];

		if (!(state->known & frame->listed & UINT32_C(1) << i))
			continue;
		*report = (struct track_report){ .sensor = i, .device_ns = device_ns };
		if (!one_report(frame->present >> i & 1 ? &frame->items[i] : &gone, setup, out,
				report))
			continue;
		if (timed)
			report->has |= TRACK_DEVICE_TIME;
		out->count++;
	}
	return GR_OK;
}
