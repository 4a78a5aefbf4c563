/* The filters: how well they foresee, how calm they are, and what they make of bad samples. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "tools/bench/predict.h"
#include "tools/bench/stats.h"
#include "tracking/filter.h"

#include <float.h>

#define MS GR_NS_PER_MS
#define S GR_NS_PER_S
#define DEG (180 / M_PI)
#define NOISE_M 0.3e-3
#define NOISE_RAD (0.1 / DEG)

static const double rates_hz[] = { 60, 100, 240, 1000 };
#define RATES (sizeof rates_hz / sizeof rates_hz[0])

static struct track_filter_params open_gate(enum track_filter_kind kind)
{
	struct track_filter_params p = track_filter_defaults(kind);

	p.position.gate = p.orientation.gate = 0;
	return p;
}

static struct gr_pose pose_of(double x, double turn)
{
	struct gr_pose pose;

	gr_pose_heading((vec3){ (float)x, 1, 0 }, (float)turn, &pose);
	return pose;
}

static double turn_of(const struct gr_pose *pose)
{
	return 2 * atan2((double)pose->q[1], (double)pose->q[3]);
}

static struct hand_pose hand(const void *ctx, double t)
{
	return hand_at(ctx, t);
}

/* The default filter, on a hand that works: the goals, at every rate. */
static void foresees_a_hand(void **state)
{
	const double horizons_s[] = { 0, 0.01, 0.02, 0.033, 0.05 };
	struct unit_random random = unit_random_start("foresees_a_hand");
	struct hand *made = hand_create(30, unit_random_u32(&random));
	const struct predict_motion motion = { hand, made, 30 };
	const struct track_filter_params params = track_filter_defaults(TRACK_FILTER_KALMAN);

	(void)state;
	assert_non_null(made);
	for (size_t r = 0; r < RATES; r++) {
		const struct predict_samples samples = { rates_hz[r], NOISE_M, NOISE_RAD, unit_random_u32(&random) };

		printf("# %4.0f Hz, error over that of the last sample:", rates_hz[r]);
		for (size_t h = 0; h < sizeof horizons_s / sizeof horizons_s[0]; h++) {
			struct predict_error none, e;
			double m, rad;

			assert_true(predict_measure(&motion, &samples, NULL, horizons_s[h], &none));
			assert_true(predict_measure(&motion, &samples, &params, horizons_s[h], &e));
			m = e.rms_m / none.rms_m;
			rad = e.rms_rad / none.rms_rad;
			printf(" %.0f ms %.2f %.2f", horizons_s[h] * 1e3, m, rad);
			assert_true(m < 1 && rad < 1); /* never worse than none */
			if (horizons_s[h] == 0.033)
				assert_true(m < 1 / 2.5 && rad < 1 / 2.5);
			if (h == 0)
				assert_true(fabs(e.lag_s) < 1e-3); /* goal 5 ms */
		}
		printf("\n");
	}
	hand_destroy(made);
}

static void rests(void **state)
{
	struct unit_random random = unit_random_start("rests");
	const struct track_filter_params params = track_filter_defaults(TRACK_FILTER_KALMAN);

	(void)state;
	for (size_t r = 0; r < RATES; r++) {
		double m[9], rad[9];

		for (int i = 0; i < 9; i++) {
			const struct predict_samples samples = { rates_hz[r], NOISE_M, NOISE_RAD,
								 unit_random_u32(&random) };
			const struct predict_rest rest = predict_rest(&samples, &params);

			m[i] = rest.m;
			rad[i] = rest.rad;
		}
		stats_sort(m, 9);
		stats_sort(rad, 9);
		printf("# %4.0f Hz, at rest %.3f mm and %.4f degrees an axis\n", rates_hz[r], m[4] * 1e3, rad[4] * DEG);
		assert_true(m[4] <= 0.1e-3 && rad[4] * DEG <= 0.03);
	}
}

/* A ramp without noise is followed alike at any rate: constants are in seconds. */
static void rates_are_alike(void **state)
{
	(void)state;
	for (int kind = 0; kind < TRACK_FILTER_KINDS; kind++) {
		double end[2][2];

		for (int fast = 0; fast < 2; fast++) {
			const int64_t step = fast ? S / 240 : S / 60;
			struct track_filter_params params = open_gate((enum track_filter_kind)kind);
			struct track_filter f;
			struct gr_pose out;

			track_filter_init(&f, &params);
			for (int64_t t = 0; t <= S; t += step) {
				const double s = (double)t * 1e-9;
				const struct gr_pose in = pose_of(0.8 * s, 0.9 * s);

				assert_int_equal(track_filter_add(&f, t, &in), GR_OK);
			}
			assert_true(track_filter_at(&f, f.time_ns + 30 * MS, &out));
			end[fast][0] = (double)out.p[0] - 0.8 * ((double)f.time_ns * 1e-9 + 0.03);
			end[fast][1] = turn_of(&out) - 0.9 * ((double)f.time_ns * 1e-9 + 0.03);
		}
		printf("# %-11s 30 ms ahead on a ramp: %.2f and %.2f mm at 60 and 240 Hz\n",
		       track_filter_name((enum track_filter_kind)kind), end[0][0] * 1e3, end[1][0] * 1e3);
		/* one-euro lags by design: 0.8 m/s over its cut-off */
		assert_true(fabs(end[0][0] - end[1][0]) < 1.5e-3);
		assert_true(fabs(end[0][1] - end[1][1]) < 1e-2);
		if (kind != TRACK_FILTER_ONE_EURO)
			assert_true(fabs(end[0][0]) < 1e-4 && fabs(end[0][1]) < 1e-4);
	}
}

/* q and -q are one turn; through half a turn and on, more than once. */
static void signs_and_wraps(void **state)
{
	(void)state;
	for (int kind = 0; kind < TRACK_FILTER_KINDS; kind++) {
		struct track_filter_params params = track_filter_defaults((enum track_filter_kind)kind);
		struct track_filter f;
		struct gr_pose out;
		double miss;

		track_filter_init(&f, &params);
		for (int i = 0; i < 600; i++) {
			struct gr_pose in = pose_of(0, 0.05 * i);

			for (int k = 0; i % 3 == 0 && k < 4; k++)
				in.q[k] = -in.q[k];
			assert_int_equal(track_filter_add(&f, i * 5 * MS, &in), GR_OK);
		}
		assert_true(track_filter_at(&f, 599 * 5 * MS + 20 * MS, &out));
		miss = remainder(turn_of(&out) - 0.05 * (599 + 4), 2 * M_PI);
		assert_true(fabs(miss) < (kind == TRACK_FILTER_ONE_EURO ? 0.1 : 2e-3));
		assert_int_equal(f.gated + f.restarts, 0);
	}
}

/* A hemisphere flip for some samples never moves the body; one that stays is believed, softly. */
static void a_jump_is_refused_and_then_believed(void **state)
{
	(void)state;
	for (int kind = 0; kind < TRACK_FILTER_KINDS; kind++) {
		struct track_filter_params params = track_filter_defaults((enum track_filter_kind)kind);
		struct track_filter f;
		struct gr_pose in = pose_of(0.5, 0.2), flipped = pose_of(-0.5, 0.2), out;
		double before = 0.5;
		int64_t t = 0;

		track_filter_init(&f, &params);
		for (; t < S; t += 4 * MS)
			assert_int_equal(track_filter_add(&f, t, &in), GR_OK);
		for (int i = 0; i < 8; i++, t += 4 * MS) {
			assert_int_equal(track_filter_add(&f, t, &flipped), GR_NOTHING);
			assert_true(track_filter_at(&f, t, &out));
			assert_true(fabs((double)out.p[0] - 0.5) < 1e-6);
		}
		for (int i = 0; i < 50; i++, t += 4 * MS)
			assert_int_equal(track_filter_add(&f, t, &in), GR_OK);
		assert_int_equal(f.gated, 8);
		assert_int_equal(f.restarts, 0);

		/* It stays: 50 ms later the body goes there, without a jump of what is shown. */
		for (int64_t from = t; t < from + 500 * MS; t += 4 * MS) {
			const int r = track_filter_add(&f, t, &flipped);

			assert_int_equal(r, t - from < 50 * MS ? GR_NOTHING : GR_OK);
			assert_true(track_filter_at(&f, t, &out));
			assert_true(fabs((double)out.p[0] - before) < 0.035); /* 1 m in 0.2 s, at 4 ms */
			before = (double)out.p[0];
		}
		assert_true(fabs(before + 0.5) < 1e-5);
		assert_int_equal(f.restarts, 1);
	}
}

/* Lost: on along the velocity for a while, then back to the last good pose; seen again elsewhere. */
static void lost_and_seen_again(void **state)
{
	(void)state;
	for (int kind = 0; kind < TRACK_FILTER_KINDS; kind++) {
		struct track_filter_params params = open_gate((enum track_filter_kind)kind);
		struct track_filter f;
		struct gr_pose in, out;
		double last, most = 0, before;
		int64_t t = 0;

		track_filter_init(&f, &params);
		for (; t <= S; t += 10 * MS) {
			in = pose_of((double)t * 1e-9, 0);
			assert_int_equal(track_filter_add(&f, t, &in), GR_OK);
		}
		assert_true(track_filter_at(&f, S, &out));
		last = before = (double)out.p[0];
		for (t = S; t < 4 * S; t += MS) {
			assert_true(track_filter_at(&f, t, &out));
			assert_true(fabs((double)out.p[0] - before) < 1.1e-3); /* no faster than it was, 1 m/s */
			before = (double)out.p[0];
			most = fmax(most, before - last);
		}
		assert_true(most > 0.05 && most < 0.08);
		assert_true(fabs(before - last) < 1e-5);
		/* Two metres away. */
		in = pose_of(3, 1);
		for (int i = 0; i < 60; i++, t += 10 * MS) {
			assert_int_equal(track_filter_add(&f, t, &in), GR_OK);
			assert_true(track_filter_at(&f, t, &out));
			assert_true(fabs((double)out.p[0] - before) < 0.16); /* 2 m in 0.2 s, at 10 ms */
			before = (double)out.p[0];
		}
		assert_true(fabs(before - 3) < 1e-4 && fabs(turn_of(&out) - 1) < 1e-4);
		assert_int_equal(f.restarts, 1);
	}
}

static void bad_samples_change_nothing(void **state)
{
	(void)state;
	for (int kind = 0; kind < TRACK_FILTER_KINDS; kind++) {
		struct track_filter_params params = track_filter_defaults((enum track_filter_kind)kind);
		struct track_filter f, before;
		struct gr_pose in = pose_of(0, 0), out;

		track_filter_init(&f, &params);
		assert_false(track_filter_at(&f, 0, &out));
		for (int i = 0; i < 20; i++)
			assert_int_equal(track_filter_add(&f, i * MS, &in), GR_OK);
		memcpy(&before, &f, sizeof f);
		assert_int_equal(track_filter_add(&f, 19 * MS, &in), GR_ERR_RANGE);
		assert_int_equal(track_filter_add(&f, INT64_MIN, &in), GR_ERR_RANGE);
		memset(in.q, 0, sizeof in.q);
		assert_int_equal(track_filter_add(&f, S, &in), GR_ERR_FORMAT);
		in = pose_of(0, 0);
		in.p[1] = NAN;
		assert_int_equal(track_filter_add(&f, S, &in), GR_ERR_FORMAT);
		in.p[1] = INFINITY;
		assert_int_equal(track_filter_add(&f, S, &in), GR_ERR_FORMAT);
		assert_memory_equal(&before, &f, sizeof f);
	}
}

static bool finite_pose(const struct gr_pose *pose)
{
	return gr_pose_valid(pose);
}

/* Whatever sound poses and times come, in any order of size: what comes out is a pose. */
static void always_a_pose(void **state)
{
	struct unit_random random = unit_random_start("always_a_pose");

	(void)state;
	for (int run = 0; run < 400; run++) {
		struct track_filter_params params = track_filter_defaults((enum track_filter_kind)(run % TRACK_FILTER_KINDS));
		const double scale = pow(10, unit_random_range(&random, -44, 12));
		struct track_filter f;
		struct gr_pose in, out;
		int64_t t = run & 1 ? 0 : INT64_C(4000000000000000000);

		if (run % 8 < 4)
			params.position.gate = params.orientation.gate = 0;
		track_filter_init(&f, &params);
		for (int i = 0; i < 200; i++) {
			in = pose_of(unit_random_range(&random, -scale, scale), unit_random_range(&random, -4, 4));
			/* from a nanosecond to some seconds apart */
			t += 1 + (int64_t)pow(10, unit_random_range(&random, 0, 9.5));
			assert_true(track_filter_add(&f, t, &in) >= 0);
			assert_true(track_filter_at(&f, t + (int64_t)unit_random_range(&random, -1e9, 1e12), &out));
			if (!finite_pose(&out))
				fail_msg("%s: not finite, scale %g, sample %d",
					 track_filter_name(params.kind), scale, i);
		}
	}
}

/* Any time constant that a layout may have, also far below the time between two samples. */
static void any_time_constant(void **state)
{
	struct track_filter_params params = open_gate(TRACK_FILTER_EXPONENTIAL);

	(void)state;
	params.gap_s = 5;
	for (double tau_s = 1e-4; tau_s < 1; tau_s *= 1.5) {
		struct track_filter f;
		struct gr_pose out;

		params.position.tau_s = params.orientation.tau_s = tau_s;
		track_filter_init(&f, &params);
		for (int i = 0; i < 300; i++) {
			const double s = 0.01 * i + (i > 100 ? 3 : 0);
			const struct gr_pose in = pose_of(0.7 * s, 0.3 * s);

			assert_int_equal(track_filter_add(&f, (int64_t)(s * 1e9) + 1, &in), GR_OK);
			assert_true(track_filter_at(&f, f.time_ns + 30 * MS, &out));
			assert_true(finite_pose(&out));
		}
		if (tau_s < 0.01) /* it has settled on the ramp */
			assert_true(fabs((double)out.p[0] - 0.7 * ((double)f.time_ns * 1e-9 + 0.03)) < 1e-4);
	}
}

/* An hour at 1000 Hz of one who does not move: nothing drifts, and no covariance wears out. */
static void an_hour_at_rest(void **state)
{
	const struct track_filter_params params = track_filter_defaults(TRACK_FILTER_KALMAN);
	const int samples = getenv("GROTTO_LONG") ? 3600000 : 300000;
	const struct gr_pose in = pose_of(1.25, 0.5);
	struct track_filter f;
	struct gr_pose out;

	(void)state;
	track_filter_init(&f, &params);
	for (int i = 0; i < samples; i++)
		assert_int_equal(track_filter_add(&f, i * MS, &in), GR_OK);
	assert_true(track_filter_at(&f, f.time_ns + 50 * MS, &out));
	assert_true(fabs((double)out.p[0] - 1.25) < 1e-7 && fabs(turn_of(&out) - 0.5) < 1e-6);
	for (int m = 0; m < TRACK_MODELS; m++) {
		const struct track_model *k = &f.of.kalman.position[m];

		assert_true(k->xx > 0 && k->vv > 0 && k->xx * k->vv >= k->xv * k->xv);
		assert_true(k->weight > 0 && k->weight <= 1);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(foresees_a_hand),
		cmocka_unit_test(rests),
		cmocka_unit_test(rates_are_alike),
		cmocka_unit_test(signs_and_wraps),
		cmocka_unit_test(a_jump_is_refused_and_then_believed),
		cmocka_unit_test(lost_and_seen_again),
		cmocka_unit_test(bad_samples_change_nothing),
		cmocka_unit_test(always_a_pose),
		cmocka_unit_test(any_time_constant),
		cmocka_unit_test(an_hour_at_rest),
	};
	return cmocka_run_group_tests_name("filter", tests, NULL, NULL);
}
