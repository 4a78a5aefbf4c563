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

/* The device's counters go on; how many reports are missing, and the time since the last one. */
static uint64_t count_on(enum track_sony_model model, struct track_sony_state *s,
			 const struct track_sony_report *raw, int64_t arrived_ns, double *dt_s)
{
	const struct track_sony_bits bits = track_sony_bits(model);
	const int64_t since_ns = arrived_ns - s->arrived_ns;
	const uint64_t last = s->time, sequence = s->sequence;
	uint64_t missed = 0;

	*dt_s = 0;
	if (!s->started) {
		s->time = raw->time;
		s->sequence = raw->sequence;
	} else {
		s->time = track_unwrap(raw->time, bits.time,
				       last + (uint64_t)(since_ns > 0 ? 3 * since_ns / bits.step_3ns
								      : 0));
		/* After a long silence nobody knows how often the sequence went round. */
		s->sequence = track_unwrap(raw->sequence, bits.sequence, sequence + 1);
		*dt_s = ((double)s->time - (double)last) * (double)bits.step_3ns / 3e9;
		if (since_ns < GR_NS_PER_S && s->sequence > sequence)
			missed = s->sequence - sequence - 1;
	}
	s->started = true;
	s->arrived_ns = arrived_ns;
	return missed;
}

uint64_t track_sony_take(enum track_sony_model model, struct track_sony_state *s,
			 const struct track_sony_report *raw, int64_t arrived_ns,
			 struct track_report *out)
{
	double gyro[3], accel[3], dt_s;
	uint64_t missed;

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
	missed = count_on(model, s, raw, arrived_ns, &dt_s);
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
	out->has |= TRACK_ORIENTATION | TRACK_DEVICE_TIME;
	out->device_ns = (int64_t)(s->time * (uint64_t)track_sony_bits(model).step_3ns / 3);
	return missed;
}
