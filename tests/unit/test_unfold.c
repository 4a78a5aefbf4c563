/* The unfolded room: edges stay shared, nothing overlaps, whatever the room. */
#include "tests/unit/unit.h"

#include "base/result.h"
#include "tools/unfold.h"

#include <math.h>

/* A wall from three corners. */
#define WALL(llx, lly, llz, lrx, lry, lrz, ulx, uly, ulz) \
	{ { llx, lly, llz }, { lrx, lry, lrz }, { ulx, uly, ulz } }

enum { FRONT, LEFT, RIGHT, FLOOR, CEILING, BACK, SIDES };

/* A box 4 m wide, 3 m high, 2 m deep, with the person in its middle. */
static const struct unfold_wall box[SIDES] = {
	[FRONT] = WALL(-2, 0, -1, 2, 0, -1, -2, 3, -1),
	[LEFT] = WALL(-2, 0, 1, -2, 0, -1, -2, 3, 1),
	[RIGHT] = WALL(2, 0, -1, 2, 0, 1, 2, 3, -1),
	[FLOOR] = WALL(-2, 0, 1, 2, 0, 1, -2, 0, -1),
	[CEILING] = WALL(-2, 3, -1, 2, 3, -1, -2, 3, 1),
	[BACK] = WALL(2, 0, 1, -2, 0, 1, 2, 3, 1),
};

static void assert_near(double a, double b)
{
	if (!(fabs(a - b) < 1e-5))
		fail_msg("%g is not %g", a, b);
}

static void assert_box(const struct unfold_place *place, double x0, double y0, double x1,
		       double y1)
{
	struct unfold_box b = unfold_place_box(place);

	assert_near(b.x0, x0);
	assert_near(b.y0, y0);
	assert_near(b.x1, x1);
	assert_near(b.y1, y1);
}

static void test_box(void **state)
{
	struct unfold_place places[SIDES];
	double size[2];

	(void)state;
	assert_int_equal(unfold_room(box, SIDES, places, size), GR_OK);
	assert_near(size[0], 2 + 4 + 2 + 4);
	assert_near(size[1], 2 + 3 + 2);
	assert_box(&places[LEFT], 0, 2, 2, 5);
	assert_box(&places[FRONT], 2, 2, 6, 5);
	assert_box(&places[RIGHT], 6, 2, 8, 5);
	assert_box(&places[BACK], 8, 2, 12, 5);
	assert_box(&places[FLOOR], 2, 0, 6, 2);
	assert_box(&places[CEILING], 2, 5, 6, 7);
	for (int i = 0; i < SIDES; i++)
		assert_int_equal(places[i].turns, 0);
}

/* A floor measured from another corner is turned, and still lies below the front. */
static void test_turned_floor(void **state)
{
	static const struct unfold_wall walls[2] = {
		WALL(-2, 0, -1, -2, 0, 1, 2, 0, -1), /* its right is +Z, its up +X */
		WALL(-2, 0, -1, 2, 0, -1, -2, 3, -1),
	};
	struct unfold_place places[2];
	double size[2], corner[2];

	(void)state;
	assert_int_equal(unfold_room(walls, 2, places, size), GR_OK);
	assert_box(&places[0], 0, 0, 4, 2);
	assert_int_equal(places[0].turns, 3);
	unfold_point(&places[0], 0, 0, corner); /* (-2, 0, -1): the front's lower left */
	assert_near(corner[0], 0);
	assert_near(corner[1], 2);
	assert_int_equal(places[0].parent, 1);
}

static void test_apart(void **state)
{
	static const struct unfold_wall walls[2] = {
		WALL(-2, 0, -1, 2, 0, -1, -2, 3, -1),
		WALL(5, 0, -1, 5, 0, 1, 5, 3, -1), /* 3 m away from the first */
	};
	struct unfold_place places[2];
	double size[2];

	(void)state;
	assert_int_equal(unfold_room(walls, 2, places, size), GR_OK);
	assert_int_equal(places[1].parent, UNFOLD_NO_PARENT);
	assert_true(unfold_place_box(&places[1]).x0 > unfold_place_box(&places[0]).x1);
}

/* Two half walls one over the other, and gaps of millimetres. */
static void test_powerwall(void **state)
{
	static const struct unfold_wall walls[4] = {
		WALL(-2.004f, 0, -1, -0.002f, 0, -1, -2.004f, 1, -1),
		WALL(0.003f, 0, -1, 2, 0, -1, 0.003f, 1, -1.002f),
		WALL(-2, 1.004f, -1, 0, 1.004f, -1, -2, 2, -1),
		WALL(0, 1.002f, -1, 2, 1.002f, -1, 0, 2, -1),
	};
	struct unfold_place places[4];
	double size[2];
	int roots = 0;

	(void)state;
	assert_int_equal(unfold_room(walls, 4, places, size), GR_OK);
	for (int i = 0; i < 4; i++)
		roots += places[i].parent == UNFOLD_NO_PARENT;
	assert_int_equal(roots, 1);
	assert_true(fabs(size[0] - 4) < 0.02 && fabs(size[1] - 2) < 0.02);
}

static void test_refusals(void **state)
{
	struct unfold_wall flat[1] = { WALL(0, 0, 0, 1, 0, 0, 0, 0, 0) };
	struct unfold_place place;
	double size[2];

	(void)state;
	assert_int_equal(unfold_room(flat, 0, &place, size), GR_ERR_RANGE);
	assert_int_equal(unfold_room(flat, 1, &place, size), GR_ERR_RANGE);
	flat[0].upper_left[1] = NAN;
	assert_int_equal(unfold_room(flat, 1, &place, size), GR_ERR_RANGE);
}

/* A point of the room, on the wall at (u, v). */
static void wall_point(const struct unfold_wall *w, double u, double v, double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = w->lower_left[i] + u * ((double)w->lower_right[i] - w->lower_left[i]) +
			 v * ((double)w->upper_left[i] - w->lower_left[i]);
}

/*
 * Along the shared edge the plane and the room agree: the point of the plane
 * where a wall meets its parent is the same point of the room on both.
 */
static void check_seam(const struct unfold_wall *walls, const struct unfold_place *places,
		       size_t child)
{
	size_t parent = places[child].parent;
	static const double mid_u[4] = { 0.5, 1, 0.5, 0 }, mid_v[4] = { 0, 0.5, 1, 0.5 };
	int seams = 0;

	for (int edge = 0; edge < 4; edge++) {
		double at[2], u, v, p[3], q[3], distance = 0;

		unfold_point(&places[child], mid_u[edge], mid_v[edge], at);
		unfold_wall_point(&places[parent], at, &u, &v);
		if (u < -1e-6 || u > 1 + 1e-6 || v < -1e-6 || v > 1 + 1e-6)
			continue;
		wall_point(&walls[child], mid_u[edge], mid_v[edge], p);
		wall_point(&walls[parent], u, v, q);
		for (int i = 0; i < 3; i++)
			distance = fmax(distance, fabs(p[i] - q[i]));
		assert_true(distance < 1e-5);
		seams++;
	}
	assert_int_equal(seams, 1);
}

/* Boxes of any size, any subset of their sides, corners named in any of four ways. */
static void test_sweep(void **state)
{
	struct unit_random r = unit_random_start("unfold");

	(void)state;
	for (int round = 0; round < 2000; round++) {
		struct unfold_wall walls[SIDES];
		struct unfold_place places[SIDES];
		float scale[3];
		double size[2];
		size_t n = 0;

		for (int i = 0; i < 3; i++)
			scale[i] = (float)unit_random_range(&r, 0.1, 10);
		for (int side = 0; side < SIDES; side++) {
			int turn = side == FRONT ? 0 : (int)(unit_random_u32(&r) & 3);
			vec3 c[4];

			if (side != FRONT && (unit_random_u32(&r) & 3) == 0)
				continue;
			glm_vec3_copy((float *)box[side].lower_left, c[0]);
			glm_vec3_copy((float *)box[side].lower_right, c[1]);
			glm_vec3_copy((float *)box[side].upper_left, c[3]);
			glm_vec3_add(c[1], c[3], c[2]);
			glm_vec3_sub(c[2], c[0], c[2]);
			for (int i = 0; i < 4; i++)
				glm_vec3_mul(c[i], scale, c[i]);
			glm_vec3_copy(c[turn], walls[n].lower_left);
			glm_vec3_copy(c[(turn + 1) & 3], walls[n].lower_right);
			glm_vec3_copy(c[(turn + 3) & 3], walls[n].upper_left);
			n++;
		}
		assert_int_equal(unfold_room(walls, n, places, size), GR_OK);
		for (size_t i = 0; i < n; i++) {
			struct unfold_box b = unfold_place_box(&places[i]);

			assert_true(b.x0 > -1e-6 && b.y0 > -1e-6);
			assert_true(b.x1 < size[0] + 1e-6 && b.y1 < size[1] + 1e-6);
			if (places[i].parent != UNFOLD_NO_PARENT)
				check_seam(walls, places, i);
			for (size_t j = 0; j < i; j++) {
				struct unfold_box o = unfold_place_box(&places[j]);

				assert_true(fmin(b.x1, o.x1) - fmax(b.x0, o.x0) < 1e-4 ||
					    fmin(b.y1, o.y1) - fmax(b.y0, o.y0) < 1e-4);
			}
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_box),      cmocka_unit_test(test_turned_floor),
		cmocka_unit_test(test_apart),    cmocka_unit_test(test_powerwall),
		cmocka_unit_test(test_refusals), cmocka_unit_test(test_sweep),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
