/*
 * Where two walls meet they must show the same light: the scene-linear
 * pictures of two renderers are compared along the edge that their walls
 * share, with direct light, soft shadows and the light field on.
 */
#include "base/log.h"
#include "base/result.h"
#include "renderer/renderer.h"
#include "tests/accuracy/cornell.h"
#include "tests/unit/gl.h"
#include "tests/unit/unit.h"

/*
 * Each picture is half a pixel larger than its wall all round, so that its
 * outermost pixel centres lie on the wall's edges: there both pictures have a
 * pixel for the very same ray, and nothing has to be interpolated.
 */
#define STEPS 180
#define PIXELS (STEPS + 1)
#define WALLS 4
#define HEADS 3
#define FRAMES 6 /* until the light field is near its steady state */

static const char *const wall_names[WALLS] = { "front", "left", "right", "floor" };

/* As layouts/cave4: 3 m wide, 2.25 m high. */
static const struct projection_wall walls[WALLS] = {
	{ { -1.5f, 0, -1.5f }, { 1.5f, 0, -1.5f }, { -1.5f, 2.25f, -1.5f } },
	{ { -1.5f, 0, 1.5f }, { -1.5f, 0, -1.5f }, { -1.5f, 2.25f, 1.5f } },
	{ { 1.5f, 0, -1.5f }, { 1.5f, 0, 1.5f }, { 1.5f, 2.25f, -1.5f } },
	{ { -1.5f, 0, 1.5f }, { 1.5f, 0, 1.5f }, { -1.5f, 0, -1.5f } },
};

static const float heads[HEADS][3] = {
	{ 0, 1.7f, 0 }, { 0.6f, 1.2f, -0.3f }, { -1.4f, 1.5f, -1.4f } /* 10 cm from a corner */
};

static const struct {
	int a, b;
	float from[3], to[3];
} seams[] = {
	{ 0, 1, { -1.5f, 0, -1.5f }, { -1.5f, 2.25f, -1.5f } },
	{ 0, 2, { 1.5f, 0, -1.5f }, { 1.5f, 2.25f, -1.5f } },
	{ 0, 3, { -1.5f, 0, -1.5f }, { 1.5f, 0, -1.5f } },
	{ 1, 3, { -1.5f, 0, 1.5f }, { -1.5f, 0, -1.5f } },
	{ 2, 3, { 1.5f, 0, 1.5f }, { 1.5f, 0, -1.5f } },
};
#define SEAMS (sizeof(seams) / sizeof(seams[0]))

static void widen(const struct projection_wall *wall, struct projection_wall *out)
{
	const float half = 0.5f / STEPS;

	for (int i = 0; i < 3; i++) {
		float right = (wall->lower_right[i] - wall->lower_left[i]) * half;
		float up = (wall->upper_left[i] - wall->lower_left[i]) * half;

		out->lower_left[i] = wall->lower_left[i] - right - up;
		out->lower_right[i] = wall->lower_right[i] + right - up;
		out->upper_left[i] = wall->upper_left[i] - right + up;
	}
}

/* Pixel (row 0 top) whose centre is at a point of the wall. */
static size_t pixel_of(const struct projection_wall *w, const float p[3])
{
	double u = 0, v = 0, uu = 0, vv = 0;

	for (int i = 0; i < 3; i++) {
		double right = (double)w->lower_right[i] - (double)w->lower_left[i];
		double up = (double)w->upper_left[i] - (double)w->lower_left[i];
		double to = (double)p[i] - (double)w->lower_left[i];

		u += right * to;
		uu += right * right;
		v += up * to;
		vv += up * up;
	}
	double x = u / uu * STEPS, y = (1 - v / vv) * STEPS;

	assert_true(fabs(x - round(x)) < 1e-3 && fabs(y - round(y)) < 1e-3);
	assert_true(round(x) >= 0 && round(x) < PIXELS && round(y) >= 0 && round(y) < PIXELS);
	return (size_t)lround(y) * PIXELS + (size_t)lround(x);
}

/* Mean of |a - b| over pixels and bands, relative to the mean of both. */
static double seam_difference(size_t seam, const struct image pictures[WALLS], double *level,
			      int *apart)
{
	double difference = 0, sum = 0;

	*apart = 0;
	for (int k = 0; k <= STEPS; k++) {
		double t = (double)k / STEPS, here = 0, light = 0;
		float p[3];

		for (int i = 0; i < 3; i++)
			p[i] = (float)((1 - t) * (double)seams[seam].from[i] +
				       t * (double)seams[seam].to[i]);
		const float *a = pictures[seams[seam].a].data +
				 3 * pixel_of(&walls[seams[seam].a], p);
		const float *b = pictures[seams[seam].b].data +
				 3 * pixel_of(&walls[seams[seam].b], p);

		for (int c = 0; c < 3; c++) {
			here += fabs((double)a[c] - (double)b[c]);
			light += 0.5 * ((double)a[c] + (double)b[c]);
		}
		*apart += here > 0.01 * light;
		difference += here;
		sum += light;
	}
	*level = sum / (3 * (STEPS + 1));
	return difference / sum;
}

static void seams_agree(void **state)
{
	static const struct scene_lamp lamp = {
		.name = "spot", .kind = SCENE_LAMP_SPOT, .position = { 1.5f, 4.5f, 0.8f },
		.direction = { 0.2f, -0.8f, 0.5656854f }, .intensity = { 30, 35, 40 },
		.cone_rad = 1.4f, .penumbra_rad = 0.2f, .radius_m = 0.1f, .on = true,
	};
	struct scene_lamp lamps[1] = { lamp };
	struct scene_file file = quads_file();
	struct renderer *renderers[WALLS];
	uint64_t hashes[WALLS];
	struct render_frame frame;
	struct scene scene;
	double worst = 0;

	file.lamps = lamps;
	file.lamp_count = 1;
	file.gi.method = SCENE_GI_LPV;
	file.gi.lattice = 16;
	file.gi.steps = 16;
	file.gi.rsm_pixels = 64;
	/* in the middle of the box, the front towards its back wall */
	file.room = (struct gr_pose){ { 2.78f, 0.7f, 2.6f }, { 0, 1, 0, 0 } };
	quads_scene(&scene, cornell_quads, CORNELL_QUADS, cornell_materials, CORNELL_MATERIALS);
	render_frame_init(&frame, &file);
	for (int w = 0; w < WALLS; w++) {
		struct renderer_params params = { .width = PIXELS, .height = PIXELS,
						  .eyes = RENDERER_MONO, .wall_given = true,
						  .keep_radiance = true };

		widen(&walls[w], &params.wall);
		assert_int_equal(renderer_create(&renderers[w], *state, &params, &file, &scene),
				 GR_OK);
		/* the light field gets to its steady state with a head that no wall sees */
		frame.T_room_head.p[1] = 1.7f;
		for (frame.frame = 0; frame.frame < FRAMES; frame.frame++) {
			frame.T_room_head.p[2] = frame.frame + 1 < FRAMES ? 50.0f : 0.0f;
			frame.T_room_head.p[0] = frame.frame + 1 < FRAMES ? 50.0f : 0.0f;
			assert_true(renderer_draw(renderers[w], &frame) >= 0);
		}
		hashes[w] = renderer_light_hash(renderers[w]);
		assert_int_equal(hashes[w], hashes[0]);
	}
	for (int h = 0; h < HEADS; h++) {
		struct image pictures[WALLS];

		for (int i = 0; i < 3; i++)
			frame.T_room_head.p[i] = heads[h][i];
		for (int w = 0; w < WALLS; w++) {
			struct renderer_stats stats;

			frame.frame++;
			assert_int_equal(renderer_draw(renderers[w], &frame), GR_OK);
			assert_int_equal(renderer_read_radiance(renderers[w], 0, &pictures[w]),
					 GR_OK);
			renderer_stats(renderers[w], &stats);
			assert_int_equal(stats.nonfinite, 0);
			assert_int_equal(stats.gl_errors, 0);
		}
		for (size_t s = 0; s < SEAMS; s++) {
			double level, d;
			int apart;

			d = seam_difference(s, pictures, &level, &apart);
			printf("# head %.1f %.1f %.1f: %s and %s differ by %.3f %% of %.3g W/(m2 sr); "
			       "%d of %d pixels by over 1 %%\n",
			       (double)heads[h][0], (double)heads[h][1], (double)heads[h][2],
			       wall_names[seams[s].a], wall_names[seams[s].b], 100 * d, level, apart,
			       STEPS + 1);
			assert_true(level > 0);
			worst = fmax(worst, d);
		}
		for (int w = 0; w < WALLS; w++)
			image_finish(&pictures[w]);
	}
	printf("# worst mean relative difference along a seam: %.3f %%\n", 100 * worst);
	assert_true(worst < 0.003);
	for (int w = 0; w < WALLS; w++)
		renderer_destroy(&renderers[w]);
	quads_free(&scene);
}

int main(void)
{
	struct target *target = gl_target_or_skip(PIXELS, PIXELS);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(seams_agree, target),
	};
	int failed;

	gr_log_init("test_seam", GR_LOG_WARNING);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	return failed;
}
