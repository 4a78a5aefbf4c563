/*
 * Direct light against closed forms (reference/analytic/analytic.csv) and
 * against the direct part of path-traced pictures (reference/renders).
 * Pictures are compared as means over blocks of 8 x 8 reference pixels.
 */
#include "base/log.h"
#include "base/result.h"
#include "renderer/renderer.h"
#include "tests/accuracy/cornell.h"
#include "tests/unit/gl.h"
#include "tests/unit/shared.h"
#include "tests/unit/unit.h"

#define SMALL 9     /* pictures whose middle pixel is looked at */
#define OVERSAMPLE 2 /* our pixels a side for one of the reference's */
#define REFERENCE 256
#define LARGE (OVERSAMPLE * REFERENCE)
#define BLOCK 8

static FILE *open_analytic(void)
{
	char path[1024];
	FILE *f = NULL;

	if (shared_file("reference/analytic/analytic.csv", path))
		f = fopen(path, "r");
	if (!f)
		skip();
	return f;
}

static struct renderer *start(struct target *target, int pixels, const struct scene_file *file,
			      const struct scene *scene)
{
	const struct renderer_params params = { .width = pixels, .height = pixels,
						.eyes = RENDERER_MONO, .keep_radiance = true };
	struct renderer *r;

	assert_int_equal(renderer_create(&r, target, &params, file, scene), GR_OK);
	return r;
}

static void no_faults(struct renderer *r)
{
	struct renderer_stats stats;

	assert_int_equal(renderer_finished(r, INT64_C(10000000000)), GR_OK);
	renderer_stats(r, &stats);
	assert_int_equal(stats.gl_errors, 0);
	assert_int_equal(stats.nonfinite, 0);
}

/* Radiance of the point that a camera half a metre off it along n sees. */
static void look_at(struct renderer *r, const struct render_frame *frame, const double point[3],
		    const double n[3], float out[3])
{
	struct scene_camera camera = { .vfov_rad = 0.02f };
	struct image image;

	for (int i = 0; i < 3; i++) {
		camera.target[i] = (float)point[i];
		camera.position[i] = (float)(point[i] + 0.5 * n[i]);
	}
	camera.up[fabs(n[1]) > 0.5 ? 2 : 1] = 1;
	assert_int_equal(renderer_draw_camera(r, frame, &camera), GR_OK);
	assert_int_equal(renderer_read_radiance(r, 0, &image), GR_OK);
	memcpy(out, image.data + 3 * (SMALL * (SMALL / 2) + SMALL / 2), 3 * sizeof(float));
	image_finish(&image);
}

static void point_light(void **state)
{
	static const struct quad plane = {
		0, { { -20, 0, 20 }, { 20, 0, 20 }, { 20, 0, -20 }, { -20, 0, -20 } }
	};
	const struct scene_material grey = { .diffuse = { 0.5f, 0.5f, 0.5f }, .diffuse_image = -1,
					     .emission_image = -1 };
	const double up[3] = { 0, 1, 0 };
	struct scene_file file = quads_file();
	struct scene_lamp lamp = { .name = "point", .kind = SCENE_LAMP_POINT,
				   .direction = { 0, -1, 0 }, .on = true };
	struct render_frame frame;
	struct scene scene;
	struct renderer *r;
	FILE *f = open_analytic();
	double worst = 0;
	char line[1024];
	int lines = 0;

	file.lamps = &lamp;
	file.lamp_count = 1;
	quads_scene(&scene, &plane, 1, &grey, 1);
	r = start(*state, SMALL, &file, &scene);
	render_frame_init(&frame, &file);
	while (fgets(line, sizeof(line), f)) {
		double intensity, h, rho, d, want;
		float got[3];

		if (sscanf(line, "point light over plane,%*[^,],I=%lf;h=%lf;rho=%lf;d=%lf,%lf",
			   &intensity, &h, &rho, &d, &want) != 5)
			continue;
		const double point[3] = { d, 0, 0 };

		for (int i = 0; i < 3; i++)
			frame.lamps[0].intensity[i] = (float)intensity;
		frame.lamps[0].position[1] = (float)h;
		look_at(r, &frame, point, up, got);
		worst = fmax(worst, fabs((double)got[1] * rho / 0.5 / want - 1));
		lines++;
	}
	fclose(f);
	no_faults(r);
	renderer_destroy(&r);
	quads_free(&scene);
	printf("# point light over a plane: %d values, worst relative error %.2g\n", lines, worst);
	assert_true(lines > 0);
	assert_true(worst < 1e-5);
}

static void rectangle_lamp(void **state)
{
	struct quad quads[4] = {
		{ CORNELL_WHITE, { { -9, 0, 9 }, { 9, 0, 9 }, { 9, 0, -9 }, { -9, 0, -9 } } },
		{ CORNELL_WHITE, { { 0, 0, 9 }, { 0, 0, -9 }, { 0, 9, -9 }, { 0, 9, 9 } } },
		{ CORNELL_WHITE,
		  { { 9, 0, 5.592f }, { 0, 0, 5.592f }, { 0, 9, 5.592f }, { 9, 9, 5.592f } } },
	};
	struct scene_file file = quads_file();
	struct render_frame frame;
	struct scene scene;
	struct renderer *r;
	FILE *f = open_analytic();
	double worst = 0;
	char line[1024];
	int lines = 0;

	for (size_t i = 0; i < CORNELL_QUADS; i++)
		if (cornell_quads[i].material == CORNELL_LIGHT)
			quads[3] = cornell_quads[i];
	quads_scene(&scene, quads, 4, cornell_materials, CORNELL_MATERIALS);
	r = start(*state, SMALL, &file, &scene);
	render_frame_init(&frame, &file);
	while (fgets(line, sizeof(line), f)) {
		double p[3], n[3], want;
		const char *at = strstr(line, "point=("), *value = strstr(line, ")]\",");
		float got[3];

		if (strncmp(line, "rectangle light", 15) != 0 || !at || !value ||
		    sscanf(at, "point=(%lf, %lf, %lf);normal=(%lf, %lf, %lf)", &p[0], &p[1], &p[2],
			   &n[0], &n[1], &n[2]) != 6 ||
		    sscanf(value, ")]\",%lf", &want) != 1)
			continue;
		look_at(r, &frame, p, n, got);
		for (int i = 0; i < 3; i++) {
			double l = want * (double)cornell_materials[CORNELL_LIGHT].emission[i] *
				   (double)cornell_materials[CORNELL_WHITE].diffuse[i] / M_PI;

			worst = fmax(worst, fabs((double)got[i] / l - 1));
		}
		lines++;
	}
	fclose(f);
	no_faults(r);
	renderer_destroy(&r);
	quads_free(&scene);
	printf("# rectangle lamp: %d points, worst relative error %.2g\n", lines, worst);
	assert_true(lines > 0);
	assert_true(worst < 8e-4);
}

struct compared {
	double bias, rms; /* relative to the reference's mean over lit blocks */
	double p95;       /* of |difference| / mean */
	int blocks;
};

static int by_size(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* Blocks with a pixel of radiance `brightest` or more see an emitter and are left out. */
static void compare(const struct image *ours, const struct image *reference,
		    const struct image *indirect, float brightest, struct compared *out)
{
	static double differences[REFERENCE / BLOCK * REFERENCE / BLOCK * 3];
	double sum = 0, difference = 0, squares = 0;
	int n = 0;

	for (int by = 0; by < REFERENCE; by += BLOCK)
		for (int bx = 0; bx < REFERENCE; bx += BLOCK) {
			double a[3] = { 0 }, b[3] = { 0 };
			float most = 0;

			for (int y = by; y < by + BLOCK; y++)
				for (int x = bx; x < bx + BLOCK; x++)
					for (int i = 0; i < 3; i++) {
						size_t k = 3 * ((size_t)y * REFERENCE + (size_t)x) +
							   (size_t)i;
						float d = reference->data[k] - indirect->data[k];

						b[i] += (double)d;
						most = fmaxf(most, d);
					}
			for (int y = OVERSAMPLE * by; y < OVERSAMPLE * (by + BLOCK); y++)
				for (int x = OVERSAMPLE * bx; x < OVERSAMPLE * (bx + BLOCK); x++)
					for (int i = 0; i < 3; i++)
						a[i] += (double)ours->data[3 * ((size_t)y * LARGE +
										(size_t)x) +
									   (size_t)i] /
							(OVERSAMPLE * OVERSAMPLE);
			if (most >= brightest)
				continue;
			for (int i = 0; i < 3; i++) {
				double d = (a[i] - b[i]) / (BLOCK * BLOCK);

				sum += b[i] / (BLOCK * BLOCK);
				difference += d;
				squares += d * d;
				differences[n++] = fabs(d);
			}
		}
	qsort(differences, (size_t)n, sizeof(*differences), by_size);
	out->blocks = n / 3;
	out->bias = difference / sum;
	out->rms = sqrt(squares / n) / (sum / n);
	out->p95 = differences[n * 95 / 100] / (sum / n);
}

static void read_part(const char *scene, const char *camera, const char *part, struct image *out)
{
	struct gr_diag diag = { 0 };
	char name[256], path[1024];

	snprintf(name, sizeof(name), "reference/renders/%s/%s%s.exr", scene, camera, part);
	if (!shared_file(name, path))
		skip();
	assert_int_equal(image_read_exr(path, out, &diag), GR_OK);
	assert_int_equal(out->width, REFERENCE);
	assert_int_equal(out->height, REFERENCE);
	assert_int_equal(out->channels, 3);
	gr_diag_finish(&diag);
}

struct view {
	const char *scene, *camera;
	struct scene_camera from;
	float brightest; /* of what only reflects */
	double bias, rms, p95; /* bounds */
};

static void check_view(struct renderer *r, const struct render_frame *frame,
		       const struct view *view)
{
	struct image reference, indirect, ours;
	struct compared c;

	read_part(view->scene, view->camera, "", &reference);
	read_part(view->scene, view->camera, "_indirect", &indirect);
	assert_int_equal(renderer_draw_camera(r, frame, &view->from), GR_OK);
	assert_int_equal(renderer_read_radiance(r, 0, &ours), GR_OK);
	compare(&ours, &reference, &indirect, view->brightest, &c);
	printf("# direct part of %s %s: bias %+.2f %%, rms %.2f %%, 95 %% of blocks under %.2f %% "
	       "of the mean (%d blocks)\n",
	       view->scene, view->camera, 100 * c.bias, 100 * c.rms, 100 * c.p95, c.blocks);
	image_finish(&ours);
	image_finish(&indirect);
	image_finish(&reference);
	assert_true(fabs(c.bias) < view->bias);
	assert_true(c.rms < view->rms);
	assert_true(c.p95 < view->p95);
}

#define CAMERA_A { .position = { 2.78f, 2.73f, -8 }, .target = { 2.78f, 2.73f, 0 }, \
		   .up = { 0, 1, 0 }, .vfov_rad = 0.68604784f }

static void area_lamp_pictures(void **state)
{
	static const struct view views[] = {
		{ "a_cornell", "camA", CAMERA_A, 2, 0.004, 0.048, 0.095 },
		{ "a_cornell", "camB",
		  { .position = { 4.7f, 4.5f, 0.6f }, .target = { 2, 0.9f, 3.3f },
		    .up = { 0, 1, 0 }, .vfov_rad = 1.30899694f },
		  2, 0.004, 0.022, 0.04 },
	};
	struct scene_file file = quads_file();
	struct render_frame frame;
	struct scene scene;
	struct renderer *r;

	quads_scene(&scene, cornell_quads, CORNELL_QUADS, cornell_materials, CORNELL_MATERIALS);
	r = start(*state, LARGE, &file, &scene);
	render_frame_init(&frame, &file);
	for (size_t i = 0; i < sizeof(views) / sizeof(views[0]); i++)
		check_view(r, &frame, &views[i]);
	no_faults(r);
	renderer_destroy(&r);
	quads_free(&scene);
}

static void spot_pictures(void **state)
{
	static const struct view views[] = {
		{ "c_spot", "camA", CAMERA_A, INFINITY, 0.002, 0.065, 0.034 },
		{ "c_spot", "camD",
		  { .position = { 2.78f, 0.8f, 0.2f }, .target = { 2.78f, 3.3f, 5 },
		    .up = { 0, 1, 0 }, .vfov_rad = 1.48352986f },
		  INFINITY, 0.002, 0.006, 0.007 },
	};
	const float intensity = (float)(4000 / (4 * M_PI));
	struct scene_lamp lamp = {
		.name = "spot", .kind = SCENE_LAMP_SPOT, .position = { 2.78f, 5.48f, 2.795f },
		.direction = { 0, -1, 0 }, .intensity = { intensity, intensity, intensity },
		.cone_rad = 0.87266463f, .on = true,
	};
	struct scene_material materials[CORNELL_MATERIALS];
	struct scene_file file = quads_file();
	struct render_frame frame;
	struct scene scene;
	struct renderer *r;

	memcpy(materials, cornell_materials, sizeof(materials));
	materials[CORNELL_LIGHT] = materials[CORNELL_WHITE]; /* the ceiling has no hole */
	file.lamps = &lamp;
	file.lamp_count = 1;
	quads_scene(&scene, cornell_quads, CORNELL_QUADS, materials, CORNELL_MATERIALS);
	r = start(*state, LARGE, &file, &scene);
	render_frame_init(&frame, &file);
	for (size_t i = 0; i < sizeof(views) / sizeof(views[0]); i++)
		check_view(r, &frame, &views[i]);
	no_faults(r);
	renderer_destroy(&r);
	quads_free(&scene);
}

int main(void)
{
	struct target *target = gl_target_or_skip(LARGE, LARGE);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(point_light, target),
		cmocka_unit_test_prestate(rectangle_lamp, target),
		cmocka_unit_test_prestate(area_lamp_pictures, target),
		cmocka_unit_test_prestate(spot_pictures, target),
	};
	int failed;

	gr_log_init("test_direct", GR_LOG_WARNING);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	return failed;
}
