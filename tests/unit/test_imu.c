/*
 * Orientation from gyroscope and accelerometer, on made motion whose truth is
 * known: tilt, heading, what rest teaches, what a hand may do meanwhile.
 */
#include "tests/unit/unit.h"

#include "tracking/imu.h"

#define PI 3.14159265358979
#define DEG (PI / 180)
#define RATE_HZ 250
#define DT_S (1.0 / RATE_HZ)
#define WAVES 3

/* A hand: each axis a sum of waves, of turning (rad/s, body's axes) and of pushing (g, base's). */
struct hand {
	double turn[3][WAVES], push[3][WAVES], hz[6][WAVES], phase[6][WAVES];
};

/* The sensors: white noise, a bias that wanders, scales that are off, steps of a DualShock 4's
 * size. */
struct sensors {
	double bias[3], scale[3];
	double wander; /* rad/s per square root of a second */
	struct unit_random *random;
};

struct world {
	struct rotation truth;
	struct sensors sensors;
	struct track_imu imu;
	double time_s;
	double tilt_max, tilt_sum2;
	unsigned count;
};

static double normal(struct unit_random *r)
{
	const double u = unit_random_range(r, 1e-12, 1), v = unit_random_range(r, 0, 2 * PI);

	return sqrt(-2 * log(u)) * cos(v);
}

static struct hand hand_of(struct unit_random *r)
{
	struct hand h;

	for (int i = 0; i < 6; i++)
		for (int k = 0; k < WAVES; k++) {
			h.hz[i][k] = unit_random_range(r, 0.2, 2);
			h.phase[i][k] = unit_random_range(r, 0, 2 * PI);
			/* pushes of some 10 cm: faster is harder */
			*(i < 3 ? &h.turn[i][k] : &h.push[i - 3][k]) =
				i < 3 ? unit_random_range(r, 0, 1.2)
				      : unit_random_range(r, 0, 0.06) * h.hz[i][k] * h.hz[i][k] / 2;
		}
	return h;
}

static void begin(struct world *w, struct unit_random *r, double bias)
{
	*w = (struct world){ .truth = ROTATION_NONE,
			     .sensors = { .wander = 0.003 * DEG, .random = r },
			     .imu.params = TRACK_IMU_STANDARD };
	for (int i = 0; i < 3; i++) {
		w->sensors.bias[i] = bias * unit_random_range(r, -1, 1);
		w->sensors.scale[i] = unit_random_range(r, 0.997, 1.003);
	}
}

static void up_in(const struct rotation *r, double out[3])
{
	const double *q = r->q;

	out[0] = 2 * (q[0] * q[1] + q[2] * q[3]);
	out[1] = 1 - 2 * (q[0] * q[0] + q[2] * q[2]);
	out[2] = 2 * (q[1] * q[2] - q[0] * q[3]);
}

/* v, of the base's axes, in the body's. */
static void to_body(const struct rotation *r, const double v[3], double out[3])
{
	const struct rotation back = { { -r->q[0], -r->q[1], -r->q[2], r->q[3] } };
	const double *q = back.q;
	double t[3];

	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, k = (i + 2) % 3;

		t[i] = 2 * (q[j] * v[k] - q[k] * v[j]);
	}
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, k = (i + 2) % 3;

		out[i] = v[i] + q[3] * t[i] + q[j] * t[k] - q[k] * t[j];
	}
}

static double steps_of(double value, double step)
{
	return round(value / step) * step;
}

/* One measurement after the body turned at that rate for DT_S, pushed as said. */
static void step(struct world *w, const double rate[3], const double push_g[3])
{
	struct sensors *s = &w->sensors;
	const double held[3] = { push_g[0], push_g[1] + 1, push_g[2] };
	double turn[3], gyro[3], accel[3], up[3], is[3], tilt, cosine;

	for (int i = 0; i < 3; i++)
		turn[i] = rate[i] * DT_S;
	w->truth = rotation_by(&w->truth, turn);
	to_body(&w->truth, held, accel);
	for (int i = 0; i < 3; i++) {
		s->bias[i] += s->wander * sqrt(DT_S) * normal(s->random);
		gyro[i] =
			steps_of(rate[i] * s->scale[i] + s->bias[i] + 0.2 * DEG * normal(s->random),
				 DEG / 16);
		accel[i] = steps_of(accel[i] + 0.002 * normal(s->random), 1.0 / 8192);
	}
	track_imu_add(&w->imu, gyro, accel, DT_S);
	w->time_s += DT_S;
	up_in(&w->truth, up);
	up_in(&w->imu.T_base_body, is);
	cosine = up[0] * is[0] + up[1] * is[1] + up[2] * is[2];
	tilt = acos(cosine > 1 ? 1 : cosine) / DEG;
	w->tilt_max = tilt > w->tilt_max ? tilt : w->tilt_max;
	w->tilt_sum2 += tilt * tilt;
	w->count++;
}

static void rest(struct world *w, double seconds)
{
	const double none[3] = { 0 };

	for (int i = 0; i < seconds * RATE_HZ; i++)
		step(w, none, none);
}

static void move(struct world *w, const struct hand *h, double seconds)
{
	for (int i = 0; i < seconds * RATE_HZ; i++) {
		double both[6] = { 0 };

		for (int a = 0; a < 6; a++)
			for (int k = 0; k < WAVES; k++)
				both[a] += (a < 3 ? h->turn[a][k] : h->push[a - 3][k]) *
					   sin(2 * PI * h->hz[a][k] * w->time_s + h->phase[a][k]);
		step(w, both, both + 3);
	}
}

/* By how much the heading is off, degrees: the part about +Y of the turn from truth to estimate. */
static double heading_off(const struct world *w)
{
	const struct rotation back = { { -w->truth.q[0], -w->truth.q[1], -w->truth.q[2],
					 w->truth.q[3] } };
	const struct rotation d = rotation_mul(&w->imu.T_base_body, &back);

	return 2 * atan2(d.q[1] * (d.q[3] < 0 ? -1 : 1), fabs(d.q[3])) / DEG;
}

static void measure(double rest_s, double bias, unsigned visits, double *drift_median,
		    double *drift_most, double *tilt_rms, double *tilt_most, struct unit_random *r)
{
	double drift[64];

	*tilt_rms = *tilt_most = 0;
	for (unsigned i = 0; i < visits; i++) {
		struct world w;
		struct hand h = hand_of(r);
		double before;

		begin(&w, r, bias);
		rest(&w, rest_s);
		before = heading_off(&w);
		move(&w, &h, 60);
		drift[i] = fabs(heading_off(&w) - before);
		*tilt_rms += w.tilt_sum2 / w.count;
		*tilt_most = w.tilt_max > *tilt_most ? w.tilt_max : *tilt_most;
		for (unsigned k = i; k > 0 && drift[k] < drift[k - 1]; k--) {
			const double t = drift[k];

			drift[k] = drift[k - 1];
			drift[k - 1] = t;
		}
	}
	*drift_median = drift[visits / 2];
	*drift_most = drift[visits - 1];
	*tilt_rms = sqrt(*tilt_rms / visits);
}

static void a_minute_in_the_hand(void **state)
{
	struct unit_random r = unit_random_start("hand");
	double median, most, rms, tilt;

	(void)state;
	measure(2, 1 * DEG, 12, &median, &most, &rms, &tilt, &r);
	printf("# put down first: heading %.2f degrees a minute (median of 12 hands), at most "
	       "%.2f; tilt "
	       "%.2f rms, %.2f at most\n",
	       median, most, rms, tilt);
	assert_true(median < 2);
	assert_true(most < 6);
	assert_true(rms < 0.5);
	assert_true(tilt < 3);
	measure(DT_S, 1 * DEG, 12, &median, &most, &rms, &tilt, &r);
	printf("# never put down: heading %.1f degrees a minute, at most %.1f; tilt %.2f rms, %.2f "
	       "at most\n",
	       median, most, rms, tilt);
	assert_true(most < 75); /* the bias' 60, as nothing tells it */
	assert_true(rms < 3);
}

static void at_rest_it_stays(void **state)
{
	struct unit_random r = unit_random_start("rest");
	struct world w;

	(void)state;
	begin(&w, &r, 1 * DEG);
	rest(&w, 3);
	assert_true(w.imu.learnt);
	for (int i = 0; i < 3; i++)
		assert_true(fabs(w.imu.bias_rad_s[i] - w.sensors.bias[i]) < 0.1 * DEG);
	const double before = heading_off(&w);
	rest(&w, 120);
	printf("# two minutes at rest: heading went %.3f degrees\n", heading_off(&w) - before);
	assert_true(fabs(heading_off(&w) - before) < 1);
	assert_true(w.tilt_max < 0.5);
}

/* A slow, steady turn is no bias; what lasts longer than any hand holds is. */
static void a_slow_turn_is_no_bias(void **state)
{
	struct unit_random r = unit_random_start("slow");
	const double none[3] = { 0 }, slow[3] = { 0, 2 * DEG, 0 };
	struct world w;

	(void)state;
	begin(&w, &r, 1 * DEG);
	rest(&w, 3);
	const double before = heading_off(&w);
	for (int i = 0; i < 8 * RATE_HZ; i++)
		step(&w, slow, none);
	assert_true(fabs(heading_off(&w) - before) < 1); /* of 16 degrees */
	/* Its bias went off by more than a step while nobody laid it down. */
	for (int i = 0; i < 3; i++)
		w.sensors.bias[i] += 1.2 * DEG;
	rest(&w, 40);
	for (int i = 0; i < 3; i++)
		assert_true(fabs(w.imu.bias_rad_s[i] - w.sensors.bias[i]) < 0.1 * DEG);
}

static void turns_are_right_handed(void **state)
{
	const double up[3] = { 0, 1, 0 };

	(void)state;
	for (int axis = 0; axis < 3; axis++) {
		struct track_imu imu = { .params = TRACK_IMU_STANDARD };
		double rate[3] = { 0 }, accel[3];

		imu.params.gain_s = 0;
		rate[axis] = PI / 2;
		track_imu_add(&imu, (const double[3]){ 0 }, up, DT_S);
		for (int i = 0; i < RATE_HZ; i++) {
			to_body(&imu.T_base_body, up, accel);
			track_imu_add(&imu, rate, accel, DT_S);
		}
		for (int i = 0; i < 3; i++)
			assert_true(fabs(imu.T_base_body.q[i] - (i == axis ? sqrt(0.5) : 0)) <
				    1e-6);
	}
}

/* However it is held when the first sample comes, up is up; a fall begins nothing. */
static void it_begins_as_it_is_held(void **state)
{
	struct unit_random r = unit_random_start("begin");
	const double none[3] = { 0 };

	(void)state;
	for (int i = 0; i < 1000; i++) {
		struct track_imu imu = { .params = TRACK_IMU_STANDARD };
		double up[3], is[3], norm = 0;

		for (int k = 0; k < 3; k++) {
			up[k] = i >= 2	 ? normal(&r)
				: k == 1 ? 1 - 2 * i
					 : 0; /* first upright, and upside down */
			norm += up[k] * up[k];
		}
		for (int k = 0; k < 3; k++)
			up[k] /= sqrt(norm);
		track_imu_add(&imu, none, none, DT_S);
		assert_false(imu.started);
		assert_true(imu.T_base_body.q[3] == 1);
		track_imu_add(&imu, none, up, DT_S);
		assert_true(imu.started);
		up_in(&imu.T_base_body, is);
		for (int k = 0; k < 3; k++)
			assert_true(fabs(is[k] - up[k]) < 1e-6);
	}
}

static void recentred_it_points_ahead_and_leans_as_before(void **state)
{
	struct unit_random r = unit_random_start("recentre");

	(void)state;
	for (int i = 0; i < 1000; i++) {
		const double v[3] = { normal(&r), normal(&r), normal(&r) };
		struct track_imu imu = { .T_base_body = rotation_exp(v), .started = true };
		double before[3], after[3];
		const double *q = imu.T_base_body.q;
		const double ahead =
			hypot(2 * (q[0] * q[2] + q[1] * q[3]), 1 - 2 * (q[0] * q[0] + q[1] * q[1]));

		up_in(&imu.T_base_body, before);
		track_imu_recentre(&imu);
		up_in(&imu.T_base_body, after);
		for (int k = 0; k < 3; k++)
			assert_true(fabs(before[k] - after[k]) < 1e-9);
		/* The body's -Z is over the base's -Z, unless it is all but upright. */
		if (ahead < 0.03)
			continue;
		assert_true(fabs(2 * (q[0] * q[2] + q[1] * q[3])) < 1e-9);
		assert_true(1 - 2 * (q[0] * q[0] + q[1] * q[1]) > 0);
	}
	/* Held straight up, and straight down: its top says where it is turned to. */
	for (int i = 0; i < 2; i++) {
		const double turn[3] = { 0, 1, 0 }, tip[3] = { i ? -PI / 2 : PI / 2, 0, 0 };
		struct track_imu imu = { .T_base_body = rotation_exp(turn) };

		imu.T_base_body = rotation_by(&imu.T_base_body, tip);
		track_imu_recentre(&imu);
		const struct rotation wanted = rotation_exp(tip);
		double off[3];

		rotation_between(&wanted, &imu.T_base_body, off);
		for (int k = 0; k < 3; k++)
			assert_true(fabs(off[k]) < 1e-6);
	}
}

/* It was away and is held otherwise now: its tilt is right within a second. */
static void a_gap_is_found_out(void **state)
{
	const double none[3] = { 0 }, up[3] = { 0, 1, 0 }, aside[3] = { 0.8, 0.6, 0 };
	struct track_imu imu = { .params = TRACK_IMU_STANDARD };
	double is[3];

	(void)state;
	for (int i = 0; i < 3 * RATE_HZ; i++)
		track_imu_add(&imu, none, up, DT_S);
	track_imu_add(&imu, none, aside, 2);
	for (int i = 0; i < RATE_HZ; i++)
		track_imu_add(&imu, none, aside, DT_S);
	up_in(&imu.T_base_body, is);
	assert_true(acos(is[0] * 0.8 + is[1] * 0.6) < 6 * DEG); /* of 53 */
}

/* Whatever the sensors say, it is a turn; times that cannot be are none. */
static void nothing_breaks_it(void **state)
{
	struct unit_random r = unit_random_start("hostile");
	struct track_imu imu = { .params = TRACK_IMU_STANDARD };

	(void)state;
	for (int i = 0; i < 200000; i++) {
		static const double dt[] = { DT_S, 0, -1, 0.1, 0.2, 1e9, NAN };
		double gyro[3], accel[3], norm = 0;

		for (int k = 0; k < 3; k++) {
			gyro[k] = unit_random_range(&r, -60, 60);
			accel[k] = unit_random_u32(&r) % 3 ? unit_random_range(&r, -6, 6) : 0;
		}
		track_imu_add(&imu, gyro, accel, dt[unit_random_u32(&r) % 7]);
		if (i % 100 == 0)
			track_imu_recentre(&imu);
		for (int k = 0; k < 4; k++)
			norm += imu.T_base_body.q[k] * imu.T_base_body.q[k];
		assert_true(fabs(norm - 1) < 1e-9);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_minute_in_the_hand),
		cmocka_unit_test(at_rest_it_stays),
		cmocka_unit_test(a_slow_turn_is_no_bias),
		cmocka_unit_test(turns_are_right_handed),
		cmocka_unit_test(it_begins_as_it_is_held),
		cmocka_unit_test(recentred_it_points_ahead_and_leans_as_before),
		cmocka_unit_test(a_gap_is_found_out),
		cmocka_unit_test(nothing_breaks_it),
	};

	return cmocka_run_group_tests_name("imu", tests, NULL, NULL);
}
