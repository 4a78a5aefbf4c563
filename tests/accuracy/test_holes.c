/*
 * Indirect light leaves no holes: in closed lit rooms no surface that a camera
 * sees gets none. And, with the path-traced pictures at hand (GROTTO_SHARED),
 * how far the indirect light is from them.
 */
#include "base/diag.h"
#include "base/log.h"
#include "base/result.h"
#include "renderer/image/image.h"
#include "renderer/renderer.h"
#include "tests/unit/shared.h"
#include "tests/unit/unit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIDE 256

static struct target *target;

static const char *source_dir(void)
{
	const char *dir = getenv("srcdir");

	return dir ? dir : ".";
}

static const char *method_name(enum scene_gi_method method)
{
	return method == SCENE_GI_LPV ? "lattice" : "surfels";
}

/*
 * What a camera of a scene sees: the indirect part, and which pixels show a
 * surface. By a method with its usual settings: what "auto" would choose
 * depends on the machine.
 */
static void draw(const char *name, enum scene_gi_method method, int camera, bool no_black,
		 struct image *indirect, bool surface[SIDE * SIDE])
{
	const struct renderer_params params = { .width = SIDE, .height = SIDE,
						.eyes = RENDERER_MONO, .keep_radiance = true };
	const float sky = -7; /* no surface has it */
	struct gr_diag diag = { 0 };
	struct scene_file *file = NULL;
	struct scene *scene = NULL;
	struct renderer *renderer = NULL;
	struct render_frame frame;
	struct image all;
	char path[1024];

	snprintf(path, sizeof path, "%s/scenes/%s.scene", source_dir(), name);
	assert_int_equal(scene_file_load(path, &file, &diag), GR_OK);
	assert_int_equal(scene_import(file, &scene, &diag), GR_OK);
	gr_diag_finish(&diag);
	free(file->path);
	file->path = NULL; /* nothing baked is kept */
	file->gi.method = method;
	assert_true((size_t)camera < file->camera_count);
	/* a lamp's black surface would hide what falls on it */
	for (size_t m = 0; m < scene->material_count && no_black; m++)
		for (int c = 0; c < 3; c++)
			scene->materials[m].diffuse[c] = fmaxf(scene->materials[m].diffuse[c], 0.05f);
	struct scene_camera eye = file->cameras[camera];
	eye.pixels[0] = eye.pixels[1] = SIDE;
	for (int c = 0; c < 3; c++)
		file->background[c] = sky;
	assert_int_equal(renderer_create(&renderer, target, &params, file, scene), GR_OK);
	render_frame_init(&frame, file);
	frame.frame = 1;
	assert_int_equal(renderer_draw_camera(renderer, &frame, &eye), GR_OK);
	assert_int_equal(renderer_finished(renderer, INT64_C(600000000000)), GR_OK);
	assert_int_equal(renderer_read_indirect(renderer, 0, indirect), GR_OK);
	assert_int_equal(renderer_read_radiance(renderer, 0, &all), GR_OK);
	for (size_t k = 0; k < SIDE * SIDE; k++)
		surface[k] = all.data[3 * k] != sky;
	image_finish(&all);
	renderer_destroy(&renderer);
	scene_destroy(&scene);
	scene_file_destroy(&file);
}

static void no_holes_in(const char *name, enum scene_gi_method method, int camera)
{
	static bool surface[SIDE * SIDE];
	struct image indirect;
	size_t holes = 0, seen = 0;
	double sum = 0, least = INFINITY;

	draw(name, method, camera, true, &indirect, surface);
	for (size_t k = 0; k < SIDE * SIDE; k++) {
		const float *v = indirect.data + 3 * k;
		double mean = ((double)v[0] + (double)v[1] + (double)v[2]) / 3;

		if (!surface[k])
			continue;
		seen++;
		sum += mean;
		least = fmin(least, mean);
		holes += !(mean > 0);
	}
	image_finish(&indirect);
	printf("# %s, %s, camera %d: %zu of %zu pixels without indirect light, darkest %.1e of the mean\n",
	       name, method_name(method), camera, holes, seen, least / (sum / (double)seen));
	assert_true(seen > SIDE * SIDE / 2);
	assert_int_equal(holes, 0);
}

static void no_holes(void **state)
{
	const enum scene_gi_method methods[] = { SCENE_GI_SURFELS, SCENE_GI_LPV };

	(void)state;
	for (size_t i = 0; i < 2; i++) {
		no_holes_in("grotto", methods[i], 0);
		no_holes_in("box", methods[i], 0);
		if (!getenv("GROTTO_LONG"))
			continue;
		no_holes_in("cornell", methods[i], 1);
		no_holes_in("cornell-spot", methods[i], 1);
	}
}

/* Weighed by what is there: pixels of the reference that are lit. */
static void near_truth_of(const char *name, enum scene_gi_method method, const char *reference,
			  double bias, double nrmse)
{
	static bool surface[SIDE * SIDE];
	struct image indirect, truth;
	struct gr_diag diag = { 0 };
	char path[1024];
	double n = 0, t = 0, f = 0, square = 0;

	if (!shared_file(reference, path))
		return;
	assert_int_equal(image_read_exr(path, &truth, &diag), GR_OK);
	gr_diag_finish(&diag);
	assert_int_equal(truth.width, SIDE);
	assert_int_equal(truth.height, SIDE);
	draw(name, method, 0, false, &indirect, surface);
	for (size_t k = 0; k < 3 * SIDE * SIDE; k++) {
		double a = (double)truth.data[k], b = (double)indirect.data[k];

		if (!(a > 0) || !surface[k / 3])
			continue;
		n++;
		t += a;
		f += b;
		square += (a - b) * (a - b);
	}
	image_finish(&indirect);
	image_finish(&truth);
	printf("# %s, %s against path tracing: bias %+.1f %%, nRMSE %.1f %%\n", name, method_name(method), 100 * (f / t - 1),
	       100 * sqrt(square / n) / (t / n));
	assert_true(fabs(f / t - 1) < bias);
	assert_true(sqrt(square / n) / (t / n) < nrmse);
}

static void near_truth(void **state)
{
	(void)state;
	near_truth_of("cornell-spot", SCENE_GI_SURFELS, "reference/renders/c_spot/camA_indirect.exr", 0.01, 0.1);
	near_truth_of("cornell-spot", SCENE_GI_LPV, "reference/renders/c_spot/camA_indirect.exr", 0.07, 0.57);
	if (!getenv("GROTTO_LONG"))
		return;
	near_truth_of("cornell", SCENE_GI_SURFELS, "reference/renders/a_cornell/camA_indirect.exr", 0.01, 0.08);
	near_truth_of("cornell", SCENE_GI_LPV, "reference/renders/a_cornell/camA_indirect.exr", 0.2, 0.46);
}

int main(void)
{
	const struct target_params params = { .kind = TARGET_HEADLESS, .width = SIDE,
					      .height = SIDE, .gpu = -1 };
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_holes),
		cmocka_unit_test(near_truth),
	};
	int failed;

	gr_log_init("test_holes", GR_LOG_WARNING);
	if (target_create(&target, &params) != GR_OK) {
		printf("# no OpenGL 4.5 here: skipped\n");
		return 77;
	}
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	return failed;
}
