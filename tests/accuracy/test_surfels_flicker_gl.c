/* How evenly the surfels' light follows a lamp: hard cones, hard shadows, coarse surfels. */
#include "base/result.h"
#include "tests/accuracy/surfels_gl.h"
#include "tests/unit/unit.h"
#include "tools/bench/lpv_bench.h"
#include "tools/bench/room.h"

#include <math.h>

#define FRAMES 24
#define WARM_UP 5 /* frames until bounces follow */

struct ride {
	const struct scene *scene;
	struct truth_spot lamp; /* half_angle 0: a sun */
	const struct truth_sample *at;
	size_t count;
};

/* Frame i of a lamp that moves sideways 8 mm a frame, or turns by 1 mrad. */
static void move(const struct ride *ride, int i, struct frame_lamp *lamp)
{
	float *turned = lamp->direction;

	if (ride->lamp.half_angle > 0) {
		lamp->position[0] = ride->lamp.position[0] - 0.008f * (float)i;
		return;
	}
	glm_vec3_copy((float *)ride->lamp.direction, turned);
	turned[0] -= 0.001f * (float)i;
	glm_vec3_normalize(turned);
}

/* Worst second difference at a point over the mean. */
static double flicker(const struct ride *ride, float spacing, int taps)
{
	static float found[3][3 * LIT_POINTS];
	struct surfel_set *set = lit_bake(ride->scene, spacing, 128, taps, 0);
	double worst = 0, mean = 0;
	struct lit s;

	lit_begin_with(&s, ride->scene, set, &ride->lamp, 1, false);
	for (int i = 0; i < FRAMES; i++) {
		float *now = found[i % 3], *last = found[(i + 2) % 3], *before = found[(i + 1) % 3];

		move(ride, i, &s.rig.frame.lamps[0]);
		lit_frame(&s);
		mean = lit_mean_at(s.method, ride->at, ride->count, now);
		for (size_t k = 0; k < 3 * ride->count && i >= WARM_UP; k++)
			worst = fmax(worst, fabs((double)(now[k] - 2 * last[k] + before[k])));
	}
	lit_end(&s);
	surfel_set_destroy(&set);
	return worst / mean;
}

/* The room's spot has a hard edge, and its boxes throw hard shadows. */
static void hard_spot(void **state)
{
	static const float spacings[] = { 0.16f, 0.25f, 0.44f };
	const struct ride ride = { lit_room.scene, bench_spot(), lit_room.samples, lit_room.count };

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		double few = flicker(&ride, spacings[i], 16), usual = flicker(&ride, spacings[i], 64);

		printf("# hard spot moving 8 mm a frame, surfels %.2f m apart: worst second difference %.2f %% "
		       "of mean E, %.2f %% with 16 taps\n",
		       (double)spacings[i], 100 * usual, 100 * few);
		assert_true(usual < 0.05);
	}
}

/* A yard of 6 m with two pillars, open to the sky. */
static struct scene *yard(void)
{
	static const float zero[3] = { 0, 0, 0 }, across[3] = { 6, 0, 0 }, up[3] = { 0, 2.5f, 0 },
			   along[3] = { 0, 0, 6 };
	struct room_builder b;

	room_begin(&b);
	uint32_t m = room_material(&b, 0.6f, 0.6f, 0.6f);
	room_quad(&b, m, zero, along, across);
	room_quad(&b, m, zero, up, along);
	room_quad(&b, m, zero, across, up);
	room_quad(&b, m, across, along, up);
	room_quad(&b, m, along, up, across);
	room_box(&b, m, (float[3]){ 2, 1.2f, 2 }, (float[3]){ 0.3f, 1.2f, 0.3f }, 0);
	room_box(&b, m, (float[3]){ 4, 1.2f, 3.5f }, (float[3]){ 0.3f, 1.2f, 0.3f }, 0.4f);
	return room_end(&b);
}

static void hard_sun(void **state)
{
	static const float spacings[] = { 0.25f, 0.5f };
	static struct truth_sample at[LIT_POINTS];
	const struct truth_spot sun = { .direction = { -0.4829629f, -0.8660254f, -0.1294095f },
					.intensity = { 10, 9.5f, 8.5f } };
	struct scene *scene = yard();
	struct truth truth;
	struct ride ride = { scene, sun, at, 0 };

	(void)state;
	assert_int_equal(truth_init(&truth, scene, &sun), GR_OK);
	ride.count = truth_points(&truth, 2, 0.02f, at, LIT_POINTS);
	for (size_t i = 0; i < 2; i++) {
		double few = flicker(&ride, spacings[i], 16), usual = flicker(&ride, spacings[i], 64);

		printf("# sun turning 1 mrad a frame, surfels %.2f m apart: worst second difference %.2f %% of "
		       "mean E, %.2f %% with 16 taps\n",
		       (double)spacings[i], 100 * usual, 100 * few);
		assert_true(usual < 0.05);
	}
	truth_finish(&truth);
	room_free(&scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(hard_spot),
		cmocka_unit_test(hard_sun),
	};
	int failed = lit_open("test_surfels_flicker_gl");

	if (failed)
		return failed;
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	lit_close();
	return failed;
}
