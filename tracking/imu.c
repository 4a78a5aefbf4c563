#include "tracking/imu.h"

#include <math.h>
#include <string.h>

#define GAP_S 0.1
#define SETTLE_S                                                                                   \
	1.0 /* in which the tilt follows gravity faster: the first look is one noisy sample */
#define SETTLE_GAIN 5.0
#define LONG_REST 10 /* windows in a row */
#define SMOOTH 4     /* windows, whose mean the bias is */

static double length(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

/* The base's +Y in the body's axes. */
static void up_of(const struct rotation *r, double out[3])
{
	const double *q = r->q;

	out[0] = 2 * (q[0] * q[1] + q[2] * q[3]);
	out[1] = 1 - 2 * (q[0] * q[0] + q[2] * q[2]);
	out[2] = 2 * (q[1] * q[2] - q[0] * q[3]);
}

/* The shortest turn that brings the body's own `up` to the base's +Y. */
static struct rotation upright(const double up[3])
{
	static const double y[3] = { 0, 1, 0 };
	double axis[3], sine;

	cross(up, y, axis);
	sine = length(axis);
	if (sine < 1e-9) /* as it is, or upside down, about whatever axis */
		return up[1] > 0 ? ROTATION_NONE : (struct rotation){ { 0, 0, 1, 0 } };
	for (int i = 0; i < 3; i++)
		axis[i] *= atan2(sine, up[1]) / sine;
	return rotation_exp(axis);
}

/* ---- rest ---- */

static void begin_window(struct track_imu *imu)
{
	imu->window_s = 0;
	imu->count = 0;
	memset(imu->sum, 0, sizeof imu->sum);
}

/* True: the values still stay within what rest is. */
static bool watch(struct track_imu *imu, const double values[6])
{
	bool rests = true;

	for (int i = 0; i < 6; i++) {
		const double most = i < 3 ? imu->params.rest_rad_s : imu->params.rest_g;

		imu->low[i] = imu->count ? fmin(imu->low[i], values[i]) : values[i];
		imu->high[i] = imu->count ? fmax(imu->high[i], values[i]) : values[i];
		rests = rests && imu->high[i] - imu->low[i] <= most;
	}
	for (int i = 0; i < 3; i++)
		imu->sum[i] += values[i];
	imu->count++;
	return rests;
}

static void look_for_rest(struct track_imu *imu, const double gyro[3], const double accel[3],
			  double dt_s)
{
	const double values[6] = { gyro[0], gyro[1], gyro[2], accel[0], accel[1], accel[2] };
	double mean[3], change[3];
	bool far;

	if (!watch(imu, values)) {
		imu->far = 0;
		begin_window(imu);
		return;
	}
	imu->window_s += dt_s;
	if (imu->window_s < imu->params.rest_s)
		return;
	for (int i = 0; i < 3; i++) {
		mean[i] = imu->sum[i] / imu->count;
		change[i] = mean[i] - imu->bias_rad_s[i];
	}
	begin_window(imu);
	if (length(mean) > imu->params.bias_most_rad_s)
		return;
	far = imu->learnt && length(change) > imu->params.step_rad_s;
	imu->far = far ? imu->far + 1 : 0;
	if (far && imu->far < LONG_REST)
		return;
	if (far)
		imu->learnt = imu->far = 0;
	/* The mean of the first windows, then slower: a bias drifts over minutes. */
	for (int i = 0; i < 3; i++)
		imu->bias_rad_s[i] += change[i] / (imu->learnt + 1);
	imu->learnt += imu->learnt + 1 < SMOOTH;
}

/* ---- orientation ---- */

void track_imu_add(struct track_imu *imu, const double gyro[3], const double accel[3], double dt_s)
{
	const double g = length(accel);
	double rate[3], up[3], measured[3], error[3];
	double gain = imu->params.gain_s;

	if (dt_s > GAP_S) /* where it has been meanwhile nobody knows */
		imu->age_s = 0;
	if (!(dt_s > 0 && dt_s <= GAP_S))
		dt_s = 0;
	if (!imu->started && g > 0.5) {
		for (int i = 0; i < 3; i++)
			measured[i] = accel[i] / g;
		imu->T_base_body = upright(measured);
		imu->started = true;
		begin_window(imu);
	}
	if (!imu->started)
		imu->T_base_body = ROTATION_NONE;
	look_for_rest(imu, gyro, accel, dt_s);
	imu->age_s += dt_s;
	if (imu->age_s < SETTLE_S)
		gain *= SETTLE_GAIN;
	for (int i = 0; i < 3; i++)
		rate[i] = gyro[i] - imu->bias_rad_s[i];
	if (fabs(g - 1) <= imu->params.free_g) {
		for (int i = 0; i < 3; i++)
			measured[i] = accel[i] / g;
		up_of(&imu->T_base_body, up);
		cross(measured, up, error);
		for (int i = 0; i < 3; i++)
			rate[i] += gain * error[i];
	}
	for (int i = 0; i < 3; i++)
		rate[i] *= dt_s;
	imu->T_base_body = rotation_by(&imu->T_base_body, rate);
}

void track_imu_recentre(struct track_imu *imu)
{
	const double *q = imu->T_base_body.q;
	/* Where the body's -Z points, seen from above; its +Y where that is straight up or down. */
	double x = -2 * (q[0] * q[2] + q[1] * q[3]);
	double z = -(1 - 2 * (q[0] * q[0] + q[1] * q[1]));
	const double y = -2 * (q[1] * q[2] - q[0] * q[3]);
	double turn[3] = { 0 };
	struct rotation back;

	if (hypot(x, z) < 0.02) {
		const double sign = y > 0 ? -1 : 1; /* nose up: its top points backwards */

		x = sign * 2 * (q[0] * q[1] - q[2] * q[3]);
		z = sign * 2 * (q[1] * q[2] + q[0] * q[3]);
	}
	turn[1] = -atan2(-x, -z);
	back = rotation_exp(turn);
	imu->T_base_body = rotation_mul(&back, &imu->T_base_body);
}
