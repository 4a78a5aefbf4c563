/* The arm from a sensor to wand's tip or eyes, the file that measurements are kept in, the matrices behind. */
#include "tests/unit/align_room.h"
#include "tests/unit/unit_config.h"

#include "base/result.h"
#include "tracking/lever.h"
#include "tracking/still.h"
#include "tracking/survey.h"

#include <unistd.h>

#define SAMPLES 1000

static const double arm[3] = { 0.02, -0.05, -0.21 };
static const double tip[3] = { 0.6, -0.4, 1.1 };

/* A tip that stays, a wand that is turned by up to `by` about each axis; noise of the sensor's place. */
static void pivot_samples(struct unit_random *r, const double by[3], double noise_m, struct lever_sample *out)
{
	const struct rotation start = align_turn(r);

	for (int k = 0; k < SAMPLES; k++) {
		double turn[3], to[3];
		struct dmat3 R;

		for (int i = 0; i < 3; i++)
			turn[i] = unit_random_range(r, -by[i] - 1e-15, by[i] + 1e-15);
		out[k].q = rotation_by(&start, turn);
		R = dmat3_from_rotation(&out[k].q);
		dmat3_apply(&R, arm, to);
		for (int i = 0; i < 3; i++)
			out[k].p[i] = tip[i] - to[i] + noise_m * align_normal(r);
	}
}

static double distance(const double a[3], const double b[3])
{
	return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static void a_pivot_gives_the_arm(void **state)
{
	struct unit_random r = unit_random_start("pivot");
	static struct lever_sample samples[SAMPLES];
	double squares = 0, worst = 0;
	const int rounds = 200;

	(void)state;
	for (int round = 0; round < rounds; round++) {
		const double by[3] = { unit_random_range(&r, 0.4, 1), unit_random_range(&r, 0, 1),
				       unit_random_range(&r, 0.4, 1) };
		struct lever_fit f;
		char why[ALIGN_WHY];

		pivot_samples(&r, by, 0, samples);
		assert_int_equal(lever_pivot(samples, SAMPLES, &f, why, sizeof why), GR_OK);
		assert_true(distance(f.arm, arm) < 1e-9 && distance(f.tip, tip) < 1e-9);
		pivot_samples(&r, by, 0.001, samples);
		assert_int_equal(lever_pivot(samples, SAMPLES, &f, why, sizeof why), GR_OK);
		assert_true(f.used >= SAMPLES - 5); /* chance goes beyond 5 mm, seldom */
		worst = fmax(worst, distance(f.arm, arm));
		/* Along the direction that is known least, in units of what is said to be its error. */
		squares += pow(((f.arm[0] - arm[0]) * f.least_turned[0] + (f.arm[1] - arm[1]) * f.least_turned[1] +
				(f.arm[2] - arm[2]) * f.least_turned[2]) / f.error_m, 2) / rounds;
	}
	printf("# pivot, %d samples with 1 mm of noise a coordinate: arm off by %.2f mm at most; error squared over "
	       "the one said: %.2f\n",
	       SAMPLES, worst * 1e3, squares);
	assert_true(worst < 0.002);
	assert_true(squares > 0.4 && squares < 1.7);
}

static void turned_about_one_axis_it_is_refused(void **state)
{
	struct unit_random r = unit_random_start("one axis");
	static struct lever_sample samples[SAMPLES];

	(void)state;
	for (int axis = 0; axis < 4; axis++) {
		const double by[3] = { axis == 0, axis == 1, axis == 2 };
		struct lever_fit f;
		char why[ALIGN_WHY];

		pivot_samples(&r, by, 0.001, samples);
		assert_int_equal(lever_pivot(samples, SAMPLES, &f, why, sizeof why), GR_ERR_RANGE);
		assert_int_equal(f.fault, LEVER_NOT_TURNED);
		assert_non_null(strstr(why, "turned too little"));
		if (axis < 3)
			assert_true(fabs(fabs(f.least_turned[axis]) - 1) < 1e-6);
	}
}

static void a_tip_that_slips(void **state)
{
	struct unit_random r = unit_random_start("slip");
	static struct lever_sample samples[SAMPLES];
	const double by[3] = { 0.7, 0.7, 0.7 };
	struct lever_fit f;
	char why[ALIGN_WHY];

	(void)state;
	/* For a tenth of the time: left out. */
	pivot_samples(&r, by, 0.001, samples);
	for (int k = 900; k < SAMPLES; k++)
		samples[k].p[0] += 0.2;
	assert_int_equal(lever_pivot(samples, SAMPLES, &f, why, sizeof why), GR_OK);
	assert_true(f.used >= 895 && f.used <= 900); /* chance goes beyond 5 mm, seldom */
	assert_true(distance(f.arm, arm) < 0.001);
	/* For good, half-way: refused. */
	for (int k = 500; k < 900; k++)
		samples[k].p[0] += 0.2;
	assert_int_equal(lever_pivot(samples, SAMPLES, &f, why, sizeof why), GR_ERR_MISMATCH);
	assert_int_equal(f.fault, LEVER_SLIPPED);
	assert_non_null(strstr(why, "did not stay where it was"));
	for (int bad = 0; bad < 7; bad++) {
		pivot_samples(&r, by, 0.001, samples);
		*(bad < 3 ? &samples[7].p[bad] : &samples[7].q.q[bad - 3]) = bad % 2 ? NAN : INFINITY;
		assert_int_equal(lever_pivot(samples, SAMPLES, &f, why, sizeof why), GR_ERR_RANGE);
		assert_int_equal(f.fault, LEVER_NOT_FINITE);
	}
	assert_int_equal(lever_pivot(samples, 9, &f, why, sizeof why), GR_ERR_RANGE);
	assert_int_equal(f.fault, LEVER_COUNT);
	/* Lengths in millimetres. */
	pivot_samples(&r, by, 0, samples);
	for (int k = 0; k < SAMPLES; k++)
		for (int i = 0; i < 3; i++)
			samples[k].p[i] *= 1000;
	assert_int_equal(lever_pivot(samples, SAMPLES, &f, why, sizeof why), GR_ERR_MISMATCH);
	assert_int_equal(f.fault, LEVER_TOO_LONG);
}

static void eyes_at_known_points(void **state)
{
	struct unit_random r = unit_random_start("eyes");

	(void)state;
	for (size_t count = 1; count <= 9; count++) {
		struct lever_sample samples[9];
		double body[9][3];
		const size_t off = unit_random_u32(&r) % count;
		struct lever_fit f;
		char why[ALIGN_WHY];

		for (size_t k = 0; k < count; k++) {
			struct dmat3 R;
			double to[3];

			samples[k].q = align_turn(&r);
			R = dmat3_from_rotation(&samples[k].q);
			dmat3_apply(&R, arm, to);
			for (int i = 0; i < 3; i++) {
				body[k][i] = unit_random_range(&r, -2, 2);
				samples[k].p[i] = body[k][i] - to[i] + 0.001 * align_normal(&r);
			}
		}
		assert_int_equal(lever_points(samples, (const double(*)[3])body, count, 0.03, &f, why, sizeof why),
				 GR_OK);
		assert_int_equal(f.used, count);
		assert_true(distance(f.arm, arm) < 0.01);
		body[off][1] += 0.2;
		if (count < 2)
			continue;
		if (count == 2) {
			assert_int_equal(lever_points(samples, (const double(*)[3])body, count, 0.03, &f, why,
						      sizeof why),
					 GR_ERR_MISMATCH);
			assert_non_null(strstr(why, "do not agree on one arm"));
			continue;
		}
		assert_int_equal(lever_points(samples, (const double(*)[3])body, count, 0.03, &f, why, sizeof why),
				 GR_OK);
		assert_true(f.wrong[off] && f.used == count - 1);
		assert_true(distance(f.arm, arm) < 0.01);
	}
}

/* ---- held still ---- */

static void means_at_rest(void **state)
{
	struct unit_random r = unit_random_start("still");
	const struct rotation q = align_turn(&r);
	struct still s = { 0 };
	struct rotation mean;
	double off_rad[3];

	(void)state;
	assert_true(still_spread_m(&s) == 0);
	for (int i = 0; i < 1000; i++) {
		double p[3], turn[3];
		struct rotation noisy;

		for (int k = 0; k < 3; k++) {
			p[k] = 100 * k + 0.001 * align_normal(&r);
			turn[k] = 0.002 * align_normal(&r);
		}
		noisy = rotation_by(&q, turn);
		for (int k = 0; k < 4 && i % 2; k++)
			noisy.q[k] = -noisy.q[k];
		still_add(&s, p, &noisy, p);
	}
	mean = still_turn(&s);
	rotation_between(&q, &mean, off_rad);
	for (int k = 0; k < 3; k++) {
		assert_true(fabs(s.p[k] - 100 * k) < 6 * 0.001 / sqrt(1000));
		assert_true(fabs(off_rad[k]) < 6 * 0.002 / sqrt(1000));
	}
	/* sqrt(3) mm, to its own error */
	assert_true(fabs(still_spread_m(&s) - 0.001 * sqrt(3)) < 0.0002);
}

/* ---- the file ---- */

static void a_survey_is_read(void **state)
{
	static const char text[] = "# points of the room\r\n"
				   "corner 1.5 0 -1.5\r\n"
				   "\n"
				   "  table\t-0.25 0.8 1e-1 # measured\n"
				   "front-left -1.5 0 -1.5  0.1 -0.2 0.3 0 0 0 -1\n"
				   "pivot 1 2 3 0 0.6 0 0.8";
	struct survey_point *points, *again;
	size_t count, count_again, len;
	struct gr_diag diag = { 0 };
	char *written = NULL;
	uint8_t *copy = unit_copy(text, sizeof text - 1);
	FILE *file = open_memstream(&written, &len);

	(void)state;
	assert_int_equal(survey_parse((char *)copy, sizeof text - 1, "p", &points, &count, &diag), GR_OK);
	assert_int_equal(count, 4);
	assert_string_equal(points[1].name, "table");
	assert_true(points[1].known && !points[1].measured && points[1].room[2] == 0.1);
	assert_true(points[2].known && points[2].measured && points[2].q.q[3] == -1 && points[2].p[1] == -0.2);
	assert_true(!points[3].known && points[3].measured && points[3].p[2] == 3);
	for (size_t i = 0; i < count; i++)
		survey_write(file, &points[i]);
	fclose(file);
	assert_int_equal(survey_parse(written, len, "again", &again, &count_again, &diag), GR_OK);
	assert_int_equal(count_again, count);
	for (size_t i = 0; i < count; i++) {
		assert_string_equal(again[i].name, points[i].name);
		assert_true(distance(again[i].room, points[i].room) < 1e-9);
		assert_true(distance(again[i].p, points[i].p) < 1e-9);
		assert_true(again[i].known == points[i].known && again[i].measured == points[i].measured);
	}
	free(points);
	free(again);
	free(written);
	free(copy);
	gr_diag_finish(&diag);
}

static void faults_of_a_survey_are_named(void **state)
{
	static const struct {
		const char *text, *start, *says;
	} cases[] = {
		{ "", "p: ", "holds no point" },
		{ "# nothing\n", "p: ", "holds no point" },
		{ "a 1 2\n", "p:1: ", "2 numbers behind the name, must be 3" },
		{ "a 1 2 3 4\n", "p:1: ", "4 numbers" },
		{ "a 1 2 3 4 5 6 7 8 9 10 11\n", "p:1: ", "more than 10 numbers" },
		{ "ok 1 2 3\na 1 two 3\n", "p:2: ", "number 2 is none from -1000 to 1000" },
		{ "a 1 nan 3\n", "p:1: ", "number 2 is none" },
		{ "a 1 inf 3\n", "p:1: ", "number 2 is none" },
		{ "a 1 2 1001\n", "p:1: ", "number 3 is none" },
		{ "a 1-2 3\n", "p:1: ", "number 1 is none" },
		{ "a 1 2 3\nb 1 2 3\na 3 2 1\n", "p:3: ", "a point \"a\" is there already" },
		{ "a 1 2 3 0 0 0 0 0 0 2\n", "p:1: qx qy qz qw: ", "length 2, must be 1" },
		{ "a 1 2 3 0 0 0 0\n", "p:1: qx qy qz qw: ", "length 0, must be 1" },
		{ "0123456789012345678901234567890123 1 2 3\n", "p:1: ", "a name of 34 bytes, at most 31" },
		{ "a\001 1 2 3\n", "p:1: ", "control character" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct survey_point *points;
		struct gr_diag diag = { 0 };
		size_t count;

		assert_int_equal(survey_parse(cases[i].text, strlen(cases[i].text), "p", &points, &count, &diag),
				 GR_ERR_FORMAT);
		assert_null(points);
		if (!unit_diag_has(&diag, GR_DIAG_ERROR, cases[i].start, cases[i].says)) {
			unit_diag_print(&diag);
			fail_msg("of \"%s\" wanted %s...%s", cases[i].text, cases[i].start, cases[i].says);
		}
		gr_diag_finish(&diag);
	}
}

static void too_many_points_and_faults(void **state)
{
	char *text = NULL;
	size_t len, count;
	struct survey_point *points;
	struct gr_diag diag = { 0 };
	FILE *file = open_memstream(&text, &len);

	(void)state;
	for (int i = 0; i < 65; i++)
		fprintf(file, "p%d 1 2 3\n", i);
	fclose(file);
	assert_int_equal(survey_parse(text, len, "p", &points, &count, &diag), GR_ERR_FORMAT);
	assert_true(unit_diag_has(&diag, GR_DIAG_ERROR, "p:65: ", "more than 64 points of the room"));
	gr_diag_finish(&diag);
	free(text);
	file = open_memstream(&text, &len);
	for (int i = 0; i < 1000; i++)
		fprintf(file, "p%d what\n", i);
	fclose(file);
	assert_int_equal(survey_parse(text, len, "p", &points, &count, &diag), GR_ERR_FORMAT);
	assert_int_equal(diag.errors, 21);
	gr_diag_finish(&diag);
	free(text);
	assert_int_equal(survey_load("/nowhere/at/all", &points, &count, &diag), GR_ERR_IO);
	assert_int_equal(survey_load("/", &points, &count, &diag), GR_ERR_FORMAT);
	gr_diag_finish(&diag);
}

/* ---- matrices ---- */

static double off(const struct dmat3 *a, const struct dmat3 *b)
{
	double most = 0;

	for (int i = 0; i < 9; i++)
		most = fmax(most, fabs(a->m[i / 3][i % 3] - b->m[i / 3][i % 3]));
	return most;
}

static void singular_values(void **state)
{
	struct unit_random r = unit_random_start("singular values");
	const struct dmat3 one = DMAT3_IDENTITY;

	(void)state;
	for (int round = 0; round < 3000; round++) {
		const double size = pow(10, unit_random_range(&r, -100, 100));
		struct dmat3 a, u, back, square;
		struct svd3 d;

		/* Of rank 3, 2, 1 and 0. */
		for (int i = 0; i < 9; i++)
			a.m[i / 3][i % 3] = size * unit_random_range(&r, -1, 1);
		for (int i = 0; i < 3; i++) {
			if (round % 4 > 0)
				a.m[i][2] = a.m[i][0] - 2 * a.m[i][1];
			if (round % 4 > 1)
				a.m[i][1] = -3 * a.m[i][0];
			if (round % 4 > 2)
				a.m[i][0] = a.m[i][1] = a.m[i][2] = 0;
		}
		if (round % 4 == 2)
			for (int i = 0; i < 3; i++)
				a.m[i][2] = a.m[i][0];
		d = svd3(&a);
		assert_true(d.s[0] >= d.s[1] && d.s[1] >= d.s[2] && d.s[2] >= 0);
		u = d.u;
		for (int i = 0; i < 9; i++)
			u.m[i / 3][i % 3] *= d.s[i % 3];
		back = dmat3_transposed(&d.v);
		back = dmat3_mul(&u, &back);
		assert_true(off(&back, &a) <= 1e-14 * size);
		square = dmat3_transposed(&d.u);
		square = dmat3_mul(&square, &d.u);
		assert_true(off(&square, &one) < 1e-9);
		square = dmat3_transposed(&d.v);
		square = dmat3_mul(&square, &d.v);
		assert_true(off(&square, &one) < 1e-14);
	}
}

static struct dmat3 about(int axis, double angle)
{
	double v[3] = { 0 };
	struct rotation q;

	v[axis] = angle;
	q = rotation_exp(v);
	return dmat3_from_rotation(&q);
}

static void angles_of_any_turn(void **state)
{
	struct unit_random r = unit_random_start("angles");

	(void)state;
	for (int round = 0; round < 3000; round++) {
		const struct rotation q = align_turn(&r);
		struct dmat3 turn = dmat3_from_rotation(&q), again;
		double a[3];

		/* Straight up and down, and ever closer to it. */
		if (round % 2) {
			const struct dmat3 heading = about(1, unit_random_range(&r, -3, 3)),
					  pitch = about(0, (round % 4 > 1 ? 1 : -1) *
								   (M_PI / 2 - pow(10, unit_random_range(&r, -17, 0)))),
					  roll = about(2, unit_random_range(&r, -3, 3));

			turn = dmat3_mul(&heading, &pitch);
			turn = dmat3_mul(&turn, &roll);
		}
		dmat3_angles(&turn, a);
		assert_true(fabs(a[1]) <= M_PI / 2);
		again = about(1, a[0]);
		again = dmat3_mul(&again, &(struct dmat3[]){ about(0, a[1]) }[0]);
		again = dmat3_mul(&again, &(struct dmat3[]){ about(2, a[2]) }[0]);
		assert_true(off(&again, &turn) < 1e-8);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_pivot_gives_the_arm),
		cmocka_unit_test(turned_about_one_axis_it_is_refused),
		cmocka_unit_test(a_tip_that_slips),
		cmocka_unit_test(eyes_at_known_points),
		cmocka_unit_test(means_at_rest),
		cmocka_unit_test(a_survey_is_read),
		cmocka_unit_test(faults_of_a_survey_are_named),
		cmocka_unit_test(too_many_points_and_faults),
		cmocka_unit_test(singular_values),
		cmocka_unit_test(angles_of_any_turn),
	};

	return cmocka_run_group_tests_name("lever", tests, NULL, NULL);
}
