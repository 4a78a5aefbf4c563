#include "tracking/polhemus_reports.h"

#include "base/clock.h"
#include "tracking/device_clock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ABSENT_FRAMES 3 /* a frame that was damaged on its way is not a sensor that was pulled */
#define JUMP_FRAMES 240 /* beyond what the time explains: the device counts anew */
#define COUNT_NS GR_NS_PER_S /* over which frames are counted */
#define COUNT_FRAMES 20
#define AFTER_STEP_NS (2 * TRACK_CLOCK_STEP_NS)

void track_polhemus_to_base(const float device[3], float base[3])
{
	const float x = device[0], y = device[1], z = device[2];

	base[0] = y;
	base[1] = -z;
	base[2] = -x;
}

void track_polhemus_from_base(const float base[3], float device[3])
{
	const float x = base[0], y = base[1], z = base[2];

	device[0] = -z;
	device[1] = x;
	device[2] = -y;
}

void track_polhemus_begin(struct track_polhemus_state *s, double rate_hz)
{
	const int64_t next_ns = s->started ? s->device_ns + AFTER_STEP_NS : 0;

	memset(s, 0, sizeof *s);
	s->device_ns = next_ns;
	s->period_ns = (int64_t)(1e9 / rate_hz + 0.5);
}

/* The period of a rate that such a device has, nearest to what was counted. */
static int64_t nearest_period(double period_ns)
{
	/* VIPER; LIBERTY and PATRIOT are among them; 94 and 188 are LATUS'. */
	static const double rates_hz[] = { 30, 60, 94, 120, 188, 240, 480, 960 };
	double best = INFINITY;
	int64_t nearest = 0;

	for (size_t i = 0; i < sizeof rates_hz / sizeof *rates_hz; i++) {
		const double off = fabs(log(period_ns * 1e-9 * rates_hz[i]));

		if (off >= best)
			continue;
		best = off;
		nearest = (int64_t)(1e9 / rates_hz[i] + 0.5);
	}
	return nearest;
}

static void start_at(struct track_polhemus_state *s, uint64_t frame, int64_t arrived_ns,
		     int64_t device_ns)
{
	s->started = true;
	s->frame = s->first = s->counted = frame;
	s->arrived_ns = s->counted_ns = arrived_ns;
	s->device_ns = s->first_ns = device_ns;
	s->counted_period_ns = s->period_ns;
}

/* Frames that come at another rate than they should, twice in a row: so be it. */
static void count(struct track_polhemus_state *s, int64_t arrived_ns)
{
	const int64_t took_ns = arrived_ns - s->counted_ns;
	const uint64_t frames = s->frame - s->counted;
	int64_t period_ns;

	if (took_ns < COUNT_NS || frames < COUNT_FRAMES)
		return;
	period_ns = nearest_period((double)took_ns / (double)frames);
	/* A rate of its own, that is in no list, is left alone. */
	if (llabs(period_ns - s->period_ns) > s->period_ns / 16 &&
	    period_ns == s->counted_period_ns) {
		s->period_ns = period_ns;
		start_at(s, s->frame, arrived_ns, s->device_ns + AFTER_STEP_NS);
		return;
	}
	s->counted_period_ns = period_ns;
	s->counted = s->frame;
	s->counted_ns = arrived_ns;
}

static uint32_t next_set(struct track_polhemus_state *s, bool whole)
{
	uint32_t lost = 0;

	for (unsigned i = 0; i < TRACK_POLHEMUS_SENSORS; i++) {
		const uint32_t bit = UINT32_C(1) << i;

		if (s->present & bit)
			s->absent[i] = 0;
		else if (whole && (s->known & bit) && ++s->absent[i] == ABSENT_FRAMES)
			lost |= bit;
	}
	s->known = (s->known | s->present) & ~lost;
	s->present = 0;
	return lost;
}

uint32_t track_polhemus_frame(struct track_polhemus_state *s, uint32_t number, int64_t arrived_ns,
			      uint64_t *missed)
{
	const int64_t since_ns = arrived_ns - s->arrived_ns;
	const uint64_t elapsed = since_ns > 0 ? (uint64_t)(since_ns / s->period_ns) : 0;
	uint64_t frame;
	bool jumped;

	*missed = 0;
	if (!s->started) {
		start_at(s, number, arrived_ns, s->device_ns);
		return 0;
	}
	frame = track_unwrap(number, 32, s->frame + elapsed);
	if (frame == s->frame)
		return 0;
	jumped = frame > s->frame ? frame - s->frame > 2 * elapsed + JUMP_FRAMES
				  : s->frame - frame > JUMP_FRAMES;
	if (jumped) {
		start_at(s, number, arrived_ns, s->device_ns + AFTER_STEP_NS);
		return next_set(s, false);
	}
	if (frame > s->frame)
		*missed = frame - s->frame - 1;
	s->device_ns = s->first_ns + ((int64_t)frame - (int64_t)s->first) * s->period_ns;
	s->frame = frame;
	s->arrived_ns = arrived_ns;
	count(s, arrived_ns);
	return next_set(s, *missed == 0);
}

void track_polhemus_report(struct track_polhemus_state *s,
			   const struct track_polhemus_sensor *sensor, struct track_report *out)
{
	*out = (struct track_report){
		.device_ns = s->device_ns,
		.has = TRACK_POSITION | TRACK_ORIENTATION | TRACK_DEVICE_TIME |
		       (sensor->has & (TRACK_BUTTONS | TRACK_QUALITY)),
		.sensor = sensor->sensor,
		.buttons = sensor->buttons,
		.quality = sensor->quality,
	};
	track_polhemus_to_base(sensor->place_m, out->T_base_sensor.p);
	track_polhemus_to_base(&sensor->turn[1], out->T_base_sensor.q);
	out->T_base_sensor.q[3] = sensor->turn[0];
	if (sensor->sensor < TRACK_POLHEMUS_SENSORS)
		s->present |= UINT32_C(1) << sensor->sensor;
}

void track_polhemus_lost(const struct track_polhemus_state *s, unsigned sensor,
			 struct track_report *out)
{
	*out = (struct track_report){
		.device_ns = s->device_ns,
		.has = TRACK_LOST | TRACK_DEVICE_TIME,
		.sensor = sensor,
	};
}
