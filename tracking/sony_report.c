/* What Sony's pads say, in the common form: counters that go on, orientation. Pure. */
#include "tracking/sony.h"

struct track_sony_bits track_sony_bits(enum track_sony_model model)
{
	/* 16/3 us in 16 bits wrap after 0.35 s; 1/3 us in 32 bits after 24 minutes. */
	return model == TRACK_SONY_DUALSHOCK4 ? (struct track_sony_bits){ 6, 16, 16000 }
					      : (struct track_sony_bits){ 8, 32, 1000 };
}

static float stick(uint8_t raw)
{
	return raw < 128 ? (float)(raw - 128) / 128.0f : (float)(raw - 128) / 127.0f;
}

/* The time since the last report, seconds, by the pad's clock where that goes. */
static double pass_time(enum track_sony_model model, struct track_sony_state *s, uint32_t raw,
			int64_t since_ns)
{
	const struct track_sony_bits bits = track_sony_bits(model);
	const uint64_t last = s->time;
	const int64_t steps = since_ns > 0 ? 3 * since_ns / bits.step_3ns : 0;

	s->time = track_unwrap(raw, bits.time, last + (uint64_t)steps);
	s->stood = raw == s->raw_time ? s->stood + 1 : 0;
	s->raw_time = raw;
	if (s->stood >= TRACK_SONY_STOOD)
		return (double)since_ns / 1e9;
	return ((double)s->time - (double)last) * (double)bits.step_3ns / 3e9;
}

/* Reports that are missing before this one. */
static uint64_t count_on(enum track_sony_model model, struct track_sony_state *s, uint8_t raw,
			 int64_t since_ns)
{
	const uint64_t last = s->sequence;

	s->sequence = track_unwrap(raw, track_sony_bits(model).sequence, last + 1);
	/* After a long silence nobody knows how often it went round. */
	return since_ns < GR_NS_PER_S && s->sequence > last ? s->sequence - last - 1 : 0;
}

uint64_t track_sony_take(enum track_sony_model model, struct track_sony_state *s,
			 const struct track_sony_report *raw, int64_t arrived_ns,
			 struct track_report *out)
{
	double gyro[3], accel[3], dt_s = 0;
	uint64_t missed = 0;

	*out = (struct track_report){
		.has = TRACK_BUTTONS | TRACK_AXIS_VALUES,
		.buttons = raw->buttons,
		.axis_count = 6,
		.axes = { stick(raw->sticks[0]), 0 - stick(raw->sticks[1]), stick(raw->sticks[2]),
			  0 - stick(raw->sticks[3]), (float)raw->triggers[0] / 255.0f,
			  (float)raw->triggers[1] / 255.0f },
		.battery = raw->battery,
	};
	if (!raw->motion)
		return 0;
	if (raw->battery >= 0)
		out->has |= TRACK_BATTERY;
	if (s->started) {
		dt_s = pass_time(model, s, raw->time, arrived_ns - s->arrived_ns);
		missed = count_on(model, s, raw->sequence, arrived_ns - s->arrived_ns);
	} else {
		s->time = s->raw_time = raw->time;
		s->sequence = raw->sequence;
	}
	s->started = true;
	s->arrived_ns = arrived_ns;
	for (int i = 0; i < 3; i++) {
		const struct track_sony_calibration *c = &s->calibration;

		gyro[i] = (raw->gyro[i] - c->bias[i]) * c->scale[i];
		accel[i] = (raw->accel[i] - c->bias[3 + i]) * c->scale[3 + i];
	}
	track_imu_add(&s->imu, gyro, accel, dt_s);
	if (raw->buttons & ~s->held & s->recentre)
		track_imu_recentre(&s->imu);
	s->held = raw->buttons;
	rotation_to(&s->imu.T_base_body, out->T_base_sensor.q);
	out->has |= TRACK_ORIENTATION;
	if (s->stood >= TRACK_SONY_STOOD)
		return missed;
	out->has |= TRACK_DEVICE_TIME;
	out->device_ns = (int64_t)(s->time * (uint64_t)track_sony_bits(model).step_3ns / 3);
	return missed;
}
