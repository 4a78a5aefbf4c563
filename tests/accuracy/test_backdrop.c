/* Where no surface is, the picture shows the environment: every pixel against its own look-up. */
#include "base/log.h"
#include "base/result.h"
#include "base/sunlight.h"
#include "renderer/renderer.h"
#include "renderer/scene/environment.h"
#include "renderer/scene/sky.h"
#include "tests/accuracy/cornell.h"
#include "tests/unit/gl.h"
#include "tests/unit/unit.h"

#define SIDE 64

/* One small plate, which the camera does not see. */
static void plate(struct scene *scene)
{
	static const struct quad quad = {
		0, { { -1, -1, 9 }, { 1, -1, 9 }, { 1, 1, 9 }, { -1, 1, 9 } }
	};
	static const struct scene_material grey = { .diffuse = { 0.5f, 0.5f, 0.5f },
						    .diffuse_image = -1, .emission_image = -1 };

	quads_scene(scene, &quad, 1, &grey, 1);
}

static struct environment *picture(bool upper_only)
{
	const struct scene_environment said = { .kind = SCENE_ENVIRONMENT_IMAGE, .scale = 2,
						.heading_rad = 0.7f, .upper_only = upper_only };
	struct gr_diag diag = { 0 };
	struct environment *e;
	struct image image;

	assert_int_equal(image_create(&image, 32, 16, 3), GR_OK);
	for (int i = 0; i < 3 * 32 * 16; i++)
		image.data[i] = (float)(2 + sin(i * 0.7) + cos(i * 0.13));
	assert_int_equal(environment_from_image(&e, &image, &said, "test", &diag), GR_OK);
	image_finish(&image);
	return e;
}

/* Worst relative difference between a picture and environment_radiance along its rays. */
static double compare(struct renderer *r, const struct environment *e, const double eye[3],
		      const double corner[3], const double right[3], const double down[3])
{
	struct image got;
	double worst = 0;

	assert_int_equal(renderer_read_radiance(r, 0, &got), GR_OK);
	for (int y = 0; y < SIDE; y++) {
		for (int x = 0; x < SIDE; x++) {
			float d[3], want[3];
			double length = 0;

			for (int i = 0; i < 3; i++) {
				d[i] = (float)(corner[i] + right[i] * (x + 0.5) / SIDE +
					       down[i] * (y + 0.5) / SIDE - eye[i]);
				length += (double)d[i] * (double)d[i];
			}
			for (int i = 0; i < 3; i++)
				d[i] /= (float)sqrt(length);
			environment_radiance(e, d, want);
			/* on the horizon rounding decides */
			if (fabsf(d[1]) < 1e-4f)
				continue;
			for (int i = 0; i < 3; i++)
				worst = fmax(worst, fabs((double)got.data[3 * (y * SIDE + x) + i] -
							 (double)want[i]) / 8);
		}
	}
	image_finish(&got);
	return worst;
}

static void check(struct target *target, struct environment *environment, const char *what)
{
	const struct renderer_params params = {
		.width = SIDE, .height = SIDE, .eyes = RENDERER_MONO, .keep_radiance = true,
		.wall_given = true,
		.wall = { { -1, 0, -2 }, { 2, 0, -1 }, { -1, 2, -2 } },
	};
	const struct scene_camera camera = { .position = { 1, 2, 3 }, .target = { 1, 2, -3 },
					     .up = { 0, 1, 0 }, .vfov_rad = 2 };
	const double t = tan(1.0), eye[3] = { 1, 2, 3 }, corner[3] = { 1 - t, 2 + t, 2 };
	const double right[3] = { 2 * t, 0, 0 }, down[3] = { 0, -2 * t, 0 };
	const double wall_corner[3] = { -1, 2, -2 }, wall_right[3] = { 3, 0, 1 };
	const double wall_down[3] = { 0, -2, 0 }, head[3] = { 0.3, 1.2, 0.4 };
	struct scene_file file = quads_file();
	struct render_frame frame;
	struct scene scene;
	struct renderer *r;
	double by_camera, by_wall;

	plate(&scene);
	scene.environment = environment;
	assert_int_equal(renderer_create(&r, target, &params, &file, &scene), GR_OK);
	render_frame_init(&frame, &file);
	assert_int_equal(renderer_draw_camera(r, &frame, &camera), GR_OK);
	by_camera = compare(r, environment, eye, corner, right, down);
	for (int i = 0; i < 3; i++)
		frame.T_room_head.p[i] = (float)head[i];
	assert_int_equal(renderer_draw(r, &frame), GR_OK);
	by_wall = compare(r, environment, head, wall_corner, wall_right, wall_down);
	printf("# %s: worst difference over the brightest %.1e through a camera, %.1e through a wall\n",
	       what, by_camera, by_wall);
	assert_true(by_camera < 5e-3);
	assert_true(by_wall < 5e-3);
	renderer_destroy(&r);
	quads_free(&scene);
	environment_destroy(&environment);
}

static void pictures(void **state)
{
	check(*state, picture(false), "picture");
	check(*state, picture(true), "picture, from above only");
}

static void constants(void **state)
{
	struct scene_file file = quads_file();
	struct environment *e;

	for (int upper = 0; upper < 2; upper++) {
		file.environment = (struct scene_environment){
			.kind = SCENE_ENVIRONMENT_CONSTANT, .radiance = { 1, 2, 4 }, .upper_only = upper,
		};
		assert_int_equal(environment_create(&e, &file, NULL), GR_OK);
		check(*state, e, upper ? "constant, from above only" : "constant");
	}
}

/* Irradiance of open ground from a sky, by a sum of its own. */
static void sum_sky(const struct sky *sky, double sum[3])
{
	for (int i = 0; i < 200; i++)
		for (int k = 0; k < 400; k++) {
			const double y = (i + 0.5) / 200, r = sqrt(1 - y * y), p = 2 * M_PI * (k + 0.5) / 400;
			const double d[3] = { r * cos(p), y, r * sin(p) };
			double rgb[3];

			sky_radiance(sky, d, rgb);
			for (int c = 0; c < 3; c++)
				sum[c] += rgb[c] * y * 2 * M_PI / 200 / 400;
		}
}

/* What a scene file's sky and sun make of grey ground, through lamp, surfels and shading. */
static void ground_under_a_sky(void **state)
{
	static const char text[] =
		"model = \"m.obj\"; environment = { kind = \"sky\"; turbidity = 2.5; sun_elevation_deg = 40.0; "
		"sun_azimuth_deg = 120.0; }; gi = { method = \"surfels\"; surfels = { spacing_m = 4.0; }; }; "
		"cameras = ( { name = \"down\"; position = [0.0, 10.0, 0.0]; target = [0.0, 0.0, 0.0]; "
		"up = [0.0, 0.0, -1.0]; vfov_deg = 20.0; } );";
	static const struct quad quad = {
		0, { { -20, 0, 20 }, { 20, 0, 20 }, { 20, 0, -20 }, { -20, 0, -20 } }
	};
	static const struct scene_material grey = { .diffuse = { 0.5f, 0.5f, 0.5f },
						    .diffuse_image = -1, .emission_image = -1 };
	const struct renderer_params params = { .width = SIDE, .height = SIDE, .keep_radiance = true,
						.quiet = true };
	double sun[3], to_sun[3], want[3] = { 0 }, worst = 0;
	struct gr_diag diag = { 0 };
	struct render_frame frame;
	struct scene_file *file;
	struct renderer *r;
	struct scene scene;
	struct image got;
	struct sky sky;

	assert_int_equal(scene_file_parse(text, strlen(text), "sky.scene", &file, &diag), GR_OK);
	quads_scene(&scene, &quad, 1, &grey, 1);
	assert_int_equal(environment_create(&scene.environment, file, &diag), GR_OK);
	assert_int_equal(renderer_create(&r, *state, &params, file, &scene), GR_OK);
	render_frame_init(&frame, file);
	assert_int_equal(renderer_draw_camera(r, &frame, &file->cameras[0]), GR_OK);
	assert_int_equal(renderer_read_radiance(r, 0, &got), GR_OK);
	for (int i = 0; i < 3; i++)
		to_sun[i] = (double)file->environment.to_sun[i];
	sky_init(&sky, 2.5, to_sun);
	sum_sky(&sky, want);
	sunlight_irradiance(2.5, asin(to_sun[1]), sun);
	for (int i = 0; i < 3; i++) {
		want[i] = 0.5 / M_PI * (want[i] + sun[i] * to_sun[1]);
		worst = fmax(worst, fabs((double)got.data[3 * (SIDE / 2 * SIDE + SIDE / 2) + i] / want[i] - 1));
	}
	printf("# ground under a sky and its sun: %.3f %.3f %.3f W/(m2 sr), off by %.1e\n", want[0], want[1],
	       want[2], worst);
	assert_true(worst < 1e-3);
	image_finish(&got);
	renderer_destroy(&r);
	environment_destroy(&scene.environment);
	quads_free(&scene);
	scene_file_destroy(&file);
	gr_diag_finish(&diag);
}

int main(void)
{
	struct target *target = gl_target_or_skip(SIDE, SIDE);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(pictures, target),
		cmocka_unit_test_prestate(constants, target),
		cmocka_unit_test_prestate(ground_under_a_sky, target),
	};
	int failed;

	gr_log_init("test_backdrop", GR_LOG_ERROR);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	return failed;
}
