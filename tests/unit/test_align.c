/* Where a device is in the room: the fit, its goal, points that are wrong, and what is no calibration. */
#include "tests/unit/align_room.h"

#include "base/result.h"

#define SETUPS 1000
#define DEG (180 / M_PI)

static int fit(const struct align_room *room, bool scale, struct align_fit *out, char *why)
{
	const struct align_params params = { .scale = scale, .most_m = ALIGN_DEFAULTS.most_m };

	return align_fit(room->points, room->count, &params, out, why, ALIGN_WHY);
}

/* ---- the fit ---- */

static void exact_points_give_the_truth(void **state)
{
	struct unit_random r = unit_random_start("exact");
	double worst_turn = 0, worst_place = 0;

	(void)state;
	for (int round = 0; round < 500; round++) {
		struct align_room room = align_room_make(&r, 3 + (size_t)round % 12, 0);
		struct align_fit f;
		char why[ALIGN_WHY];
		bool scale = round % 2;

		if (scale)
			room.scale = pow(10, unit_random_range(&r, -2, 2.5));
		for (size_t k = 0; k < room.count; k++)
			align_room_measure(&room, k, &r, 0);
		/* Three points may lie on a line. */
		if (fit(&room, scale, &f, why) == GR_ERR_RANGE && room.count < 5)
			continue;
		assert_int_equal(f.fault, ALIGN_GOOD);
		assert_int_equal(f.used, room.count);
		assert_true(fabs(f.scale / room.scale - 1) < 1e-9);
		worst_turn = fmax(worst_turn, align_turn_error(&room, &f));
		worst_place = fmax(worst_place, align_place_error(&room, &f, room.t));
		assert_true(f.rms_m < 1e-8);
	}
	printf("# exact points: turn off by %.1e rad at most, place by %.1e m\n", worst_turn, worst_place);
	assert_true(worst_turn < 1e-7 && worst_place < 1e-7);
}

static void points_of_a_floor_do(void **state)
{
	struct unit_random r = unit_random_start("floor");

	(void)state;
	for (int round = 0; round < 200; round++) {
		struct align_room room = align_room_make(&r, 8, 0);
		struct align_fit f;
		char why[ALIGN_WHY];

		for (size_t k = 0; k < room.count; k++) {
			room.points[k].room[1] = 0;
			align_room_measure(&room, k, &r, 0.001);
		}
		assert_int_equal(fit(&room, false, &f, why), GR_OK);
		assert_int_equal(f.used, 8);
		assert_true(dmat3_det(&f.R) > 0);
		assert_true(align_turn_error(&room, &f) * DEG < 0.5);
	}
}

/* ---- the goal: 8 points with 1 mm of noise, 1,000 set-ups ---- */

static int rising(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void print_errors(const char *what, const char *unit, double *errors, double goal)
{
	size_t within = 0;

	for (size_t i = 0; i < SETUPS; i++)
		within += errors[i] <= goal;
	qsort(errors, SETUPS, sizeof *errors, rising);
	printf("#   %-32s median %.4f, 95 %% %.4f, 99 %% %.4f, most %.4f %s; within %g: %zu of %d\n", what,
	       errors[SETUPS / 2], errors[SETUPS * 95 / 100], errors[SETUPS * 99 / 100], errors[SETUPS - 1], unit,
	       goal, within, SETUPS);
}

/* That the square of a normal vector of three coordinates with deviation 1 is beyond x. */
static double beyond(double x)
{
	return erfc(sqrt(x / 2)) + sqrt(2 * x / M_PI) * exp(-x / 2);
}

/* As many as chance allows, by five of its standard deviations. */
static void assert_chance(double found, double p)
{
	const double expected = p * SETUPS;

	assert_true(fabs(found - expected) <= 5 * sqrt(expected * (1 - p)) + 3);
}

/*
 * sigma_m: of a coordinate. The errors are those that no unbiased estimator can
 * be below (Cramer and Rao): sigma / sqrt(8) a coordinate in the middle of the points,
 * and of the turn what the points' spread gives; so the sums of squares in units of
 * these have the mean 3, whatever the set-ups.
 */
static void measure_goal(const char *name, double sigma_m)
{
	struct unit_random r = unit_random_start(name);
	const double centre[3] = { 0, 1, 0 };
	double turn[SETUPS], middle[SETUPS], room_off[SETUPS], base[SETUPS], turn2 = 0, place2 = 0, beyond_1mm = 0;
	size_t left_out = 0, turned = 0;

	for (size_t i = 0; i < SETUPS; i++) {
		const struct align_room room = align_room_make(&r, 8, sigma_m);
		struct align_fit f;
		char why[ALIGN_WHY];
		double bound;

		assert_int_equal(fit(&room, false, &f, why), GR_OK);
		left_out += f.used != 8;
		turn[i] = align_turn_error(&room, &f) * DEG;
		middle[i] = align_place_error(&room, &f, f.middle) * 1e3;
		room_off[i] = align_place_error(&room, &f, centre) * 1e3;
		base[i] = align_place_error(&room, &f, room.t) * 1e3;
		bound = f.turn_rad * sigma_m / f.noise_m * DEG;
		turn2 += turn[i] * turn[i] / (bound * bound) / SETUPS;
		place2 += middle[i] * middle[i] / (3 * sigma_m * sigma_m * 1e6 / 8) / SETUPS;
		beyond_1mm += middle[i] > 1;
	}
	printf("# 8 points, noise %.3f mm a coordinate, %.3f mm as a length (rms):\n", sigma_m * 1e3,
	       sigma_m * 1e3 * sqrt(3));
	print_errors("turn", "degrees", turn, 0.1);
	print_errors("place, middle of the points", "mm", middle, 1);
	print_errors("place, middle of the room", "mm", room_off, 1);
	print_errors("place, the base's origin", "mm", base, 1);
	printf("#   mean square error over the least that can be: turn %.3f, place %.3f\n", turn2, place2);
	printf("#   beyond 1 mm in the middle of the points: %.0f, by chance %.1f\n", beyond_1mm,
	       SETUPS * beyond(8 * 1e-6 / (sigma_m * sigma_m)));
	assert_int_equal(left_out, 0);
	/* Of 1,000 means of squares: 5.5 standard deviations of chance, and no better than can be. */
	assert_true(fabs(turn2 - 1) < 0.2 && fabs(place2 - 1) < 0.15);
	assert_chance(beyond_1mm, beyond(8 * 1e-6 / (sigma_m * sigma_m)));
	/* The turn's goal, but for sets of points that chance puts almost on a line. */
	for (size_t i = 0; i < SETUPS; i++)
		turned += turn[i] > 0.1;
	assert_true(turned <= (sigma_m < 0.0009 ? 2 : 15));
}

static void goal_with_1_mm_as_a_length(void **state)
{
	(void)state;
	measure_goal("1 mm as a length", 0.001 / sqrt(3));
}

static void goal_with_1_mm_a_coordinate(void **state)
{
	(void)state;
	measure_goal("1 mm a coordinate", 0.001);
}

/* ---- wrong points ---- */

static void move_measurement(struct align_room *room, size_t k, struct unit_random *r, double by_m)
{
	double v[3], n = 0;

	for (int i = 0; i < 3; i++) {
		v[i] = align_normal(r);
		n += v[i] * v[i];
	}
	for (int i = 0; i < 3; i++)
		room->points[k].base[i] += by_m * v[i] / sqrt(n);
}

/* One of n points is 20 cm off. Returns how often just that one was named. */
static int named(struct unit_random *r, size_t count, double noise_m, int rounds)
{
	int right = 0;

	for (int round = 0; round < rounds; round++) {
		struct align_room room = align_room_make(r, count, noise_m);
		const size_t off = unit_random_u32(r) % count;
		struct align_fit f;
		char why[ALIGN_WHY];

		move_measurement(&room, off, r, 0.2);
		right += fit(&room, false, &f, why) == GR_OK && f.used == count - 1 && f.wrong[off] &&
			 f.residual_m[off] > 0.1;
	}
	return right;
}

static void one_that_is_20_cm_off_is_named(void **state)
{
	struct unit_random r = unit_random_start("one wrong");

	(void)state;
	for (size_t count = 5; count <= 10; count++) {
		const int fine = named(&r, count, 0.001, 300), rough = named(&r, count, 0.005, 300);

		printf("# %zu points, one 20 cm off: named in %d of 300 with 1 mm of noise a coordinate, in %d with 5 mm\n",
		       count, fine, rough);
		if (count >= 8)
			assert_true(fine >= 299);
		assert_true(fine >= 270);
	}
}

static void several_may_be_wrong(void **state)
{
	struct unit_random r = unit_random_start("several wrong");
	int right = 0;

	(void)state;
	for (int round = 0; round < 200; round++) {
		struct align_room room = align_room_make(&r, 12, 0.001);
		unsigned order[12];
		struct align_fit f;
		char why[ALIGN_WHY];
		bool all = true;

		unit_shuffle(&r, order, 12);
		for (int i = 0; i < 4; i++)
			move_measurement(&room, order[i], &r, unit_random_range(&r, 0.05, 2));
		assert_int_equal(fit(&room, false, &f, why), GR_OK);
		for (int i = 0; i < 4; i++)
			all = all && f.wrong[order[i]];
		right += all && f.used == 8;
	}
	printf("# 4 of 12 points 5 cm to 2 m off: all named in %d of 200\n", right);
	assert_true(right >= 195);
}

/* Nothing is wrong: nothing is called so. */
static void noise_is_not_wrong(void **state)
{
	struct unit_random r = unit_random_start("none wrong");
	static const double noise_mm[] = { 0, 1, 3, 5, 8 };

	(void)state;
	for (size_t n = 0; n < sizeof noise_mm / sizeof *noise_mm; n++) {
		int called = 0;

		for (int round = 0; round < 500; round++) {
			const struct align_room room = align_room_make(&r, 8, noise_mm[n] * 1e-3);
			struct align_fit f;
			char why[ALIGN_WHY];

			if (fit(&room, false, &f, why) != GR_OK)
				fail_msg("%s", why);
			called += f.used != 8;
		}
		printf("# 8 good points with %g mm of noise a coordinate: one called wrong in %d of 500\n",
		       noise_mm[n], called);
		assert_true(called <= (noise_mm[n] <= 1 ? 0 : 8));
	}
}

static void two_in_each_others_place(void **state)
{
	struct unit_random r = unit_random_start("swapped");

	(void)state;
	for (int round = 0; round < 100; round++) {
		struct align_room room = align_room_make(&r, 9, 0.001);
		const struct align_point first = room.points[0];
		struct align_fit f;
		char why[ALIGN_WHY];

		/* Far enough apart to be two places. */
		room.points[1].room[0] = first.room[0] + (first.room[0] < 0 ? 1 : -1);
		align_room_measure(&room, 1, &r, 0.001);
		memcpy(room.points[0].base, room.points[1].base, sizeof first.base);
		memcpy(room.points[0].arm, room.points[1].arm, sizeof first.arm);
		memcpy(room.points[1].base, first.base, sizeof first.base);
		memcpy(room.points[1].arm, first.arm, sizeof first.arm);
		assert_int_equal(fit(&room, false, &f, why), GR_OK);
		assert_true(f.wrong[0] && f.wrong[1] && f.used == 7);
		assert_int_equal(align_meant(room.points, room.count, &f, 0), 1);
		assert_int_equal(align_meant(room.points, room.count, &f, 1), 0);
		assert_int_equal(align_meant(room.points, room.count, &f, 2), 2);
	}
}

/* ---- what is no calibration ---- */

static void assert_refused(const struct align_room *room, bool scale, enum align_fault fault, const char *says)
{
	struct align_fit f;
	char why[ALIGN_WHY] = "";
	const int r = fit(room, scale, &f, why);

	if (r == GR_OK || f.fault != fault || !strstr(why, says))
		fail_msg("%d, fault %d, wanted %d; says \"%s\", wanted \"%s\"", r, (int)f.fault, (int)fault, why,
			 says);
}

static void what_cannot_be_fitted(void **state)
{
	struct unit_random r = unit_random_start("degenerate");
	const double bad[] = { NAN, INFINITY, -INFINITY };
	struct align_room room = align_room_make(&r, 8, 0.001), other;

	(void)state;
	for (size_t count = 0; count < 3; count++) {
		room.count = count;
		assert_refused(&room, false, ALIGN_COUNT, "at least 3 are needed");
	}
	room.count = ALIGN_POINTS + 1;
	assert_refused(&room, false, ALIGN_COUNT, "at most 64");
	room.count = 8;
	for (int i = 0; i < 3 * 9; i++) {
		double *value;

		other = room;
		value = i / 9 == 0 ? other.points[5].room : i / 9 == 1 ? other.points[5].base : other.points[5].arm;
		value[i % 3] = bad[i % 9 / 3];
		assert_refused(&other, i % 2, ALIGN_NOT_FINITE, "finite");
		value[i % 3] = i % 2 ? 1e300 : -1e6;
		assert_refused(&other, i % 2, ALIGN_TOO_FAR, "metres");
	}
	for (size_t k = 0; k < 8; k++)
		for (int i = 0; i < 3; i++)
			room.points[k].room[i] = 1 + 0.001 * (double)k;
	assert_refused(&room, false, ALIGN_COINCIDENT, "the points are all in one place");
	room = align_room_make(&r, 8, 0.001);
	for (size_t k = 0; k < 8; k++)
		memcpy(room.points[k].base, room.points[0].base, sizeof room.points[k].base);
	assert_refused(&room, false, ALIGN_COINCIDENT, "the device said are all in one place");
	assert_refused(&room, true, ALIGN_COINCIDENT, "the device said are all in one place");
}

static void points_on_a_line(void **state)
{
	struct unit_random r = unit_random_start("line");

	(void)state;
	for (int round = 0; round < 100; round++) {
		struct align_room room = align_room_make(&r, 3 + (size_t)round % 10, 0);
		const struct rotation turn = align_turn(&r);
		const struct dmat3 any = dmat3_from_rotation(&turn);
		const double *along = any.m[0]; /* of length 1 */

		for (size_t k = 0; k < room.count; k++) {
			for (int i = 0; i < 3; i++)
				room.points[k].room[i] = 0.3 * (double)(k + 1) * along[i] + 0.002 * align_normal(&r);
			align_room_measure(&room, k, &r, 0.001);
		}
		assert_refused(&room, round % 2, ALIGN_COLLINEAR, "on a line");
	}
}

/* x turned round, or two axes exchanged. */
static void a_left_handed_device_is_said_to_be_so(void **state)
{
	struct unit_random r = unit_random_start("mirrored");

	(void)state;
	for (int round = 0; round < 100; round++) {
		struct align_room room = align_room_make(&r, 8, 0.001);

		memset(room.arm, 0, sizeof room.arm);
		for (size_t k = 0; k < room.count; k++) {
			double *p = room.points[k].base;

			align_room_measure(&room, k, &r, 0.001);
			if (round % 2) {
				p[0] = -p[0];
			} else {
				const double y = p[1];

				p[1] = p[2];
				p[2] = y;
			}
		}
		assert_refused(&room, false, ALIGN_MIRRORED, "the device's axes look left-handed");
	}
}

static void points_in_another_order(void **state)
{
	struct unit_random r = unit_random_start("order");

	(void)state;
	for (int round = 0; round < 60; round++) {
		const struct align_room room = align_room_make(&r, 8, 0.001);
		struct align_room other = room;
		unsigned order[8];
		struct align_fit f;
		char why[ALIGN_WHY];

		for (size_t k = 0; k < 8; k++) {
			/* backwards; one on; anyhow, but none in its place */
			const size_t from = round % 3 == 0 ? 7 - k : (k + 1) % 8;

			memcpy(other.points[k].base, room.points[from].base, sizeof room.points[k].base);
			memcpy(other.points[k].arm, room.points[from].arm, sizeof room.points[k].arm);
		}
		if (round % 3 < 2) {
			assert_refused(&other, false, ALIGN_ORDER, "if they had been taken");
			continue;
		}
		unit_shuffle(&r, order, 8);
		for (size_t k = 0; k < 8; k++) {
			const unsigned to = order[k], from = order[(k + 1) % 8];

			memcpy(other.points[to].base, room.points[from].base, sizeof room.points[k].base);
			memcpy(other.points[to].arm, room.points[from].arm, sizeof room.points[k].arm);
		}
		assert_int_equal(fit(&other, false, &f, why), GR_ERR_MISMATCH);
		assert_true(f.fault == ALIGN_DISAGREE || f.fault == ALIGN_ORDER);
	}
}

static void a_device_in_inches(void **state)
{
	struct unit_random r = unit_random_start("inches");

	(void)state;
	for (int round = 0; round < 50; round++) {
		struct align_room room = align_room_make(&r, 8, 0);
		struct align_fit f;
		char why[ALIGN_WHY];

		room.scale = 0.0254;
		for (size_t k = 0; k < room.count; k++)
			align_room_measure(&room, k, &r, 0.001);
		assert_refused(&room, false, ALIGN_SCALE, "if a metre of the device is 0.02");
		assert_int_equal(fit(&room, true, &f, why), GR_OK);
		assert_true(fabs(f.scale / 0.0254 - 1) < 6 * f.scale_error / 0.0254 + 1e-9);
		assert_true(f.scale_error / 0.0254 < 0.002);
	}
}

static void four_that_do_not_agree(void **state)
{
	struct unit_random r = unit_random_start("four");
	struct align_room room = align_room_make(&r, 4, 0.001);

	(void)state;
	/* A tetrahedron, or chance might make a line of three. */
	for (size_t k = 0; k < 4; k++) {
		memset(room.points[k].room, 0, sizeof room.points[k].room);
		if (k > 0)
			room.points[k].room[k - 1] = 1.5;
		align_room_measure(&room, k, &r, 0.001);
	}
	move_measurement(&room, 2, &r, 0.5);
	assert_refused(&room, false, ALIGN_DISAGREE, "a fifth would show which is wrong");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(exact_points_give_the_truth),
		cmocka_unit_test(points_of_a_floor_do),
		cmocka_unit_test(goal_with_1_mm_as_a_length),
		cmocka_unit_test(goal_with_1_mm_a_coordinate),
		cmocka_unit_test(one_that_is_20_cm_off_is_named),
		cmocka_unit_test(several_may_be_wrong),
		cmocka_unit_test(noise_is_not_wrong),
		cmocka_unit_test(two_in_each_others_place),
		cmocka_unit_test(what_cannot_be_fitted),
		cmocka_unit_test(points_on_a_line),
		cmocka_unit_test(a_left_handed_device_is_said_to_be_so),
		cmocka_unit_test(points_in_another_order),
		cmocka_unit_test(a_device_in_inches),
		cmocka_unit_test(four_that_do_not_agree),
	};

	return cmocka_run_group_tests_name("align", tests, NULL, NULL);
}
