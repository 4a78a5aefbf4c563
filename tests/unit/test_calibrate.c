/* Calibration on this OpenGL: bounded, sensible, kept; a plan for a scene comes of it. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "renderer/calibrate.h"
#include "renderer/gi/costs_file.h"
#include "renderer/renderer.h"
#include "tests/unit/gl.h"

#include <math.h>
#include <sodium.h>
#include <unistd.h>

static struct target *target;
static char folder[] = "/tmp/grotto-calibrate-XXXXXX";

static void costs_are_measured(void **state)
{
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	struct gi_costs costs;
	double seconds;

	(void)state;
	assert_int_equal(calibrate(&costs, target), GR_OK);
	seconds = (double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9;
	assert_true(gi_costs_valid(&costs));
	printf("# %s: %.2f s; lattice %.4g ms + %.4g ns a cell and step; surfels %.4g ms + %.4g ns a tap + %.4g ns a link\n",
	       target_renderer_name(target), seconds, costs.lattice_frame * 1e-6, costs.lattice_cell_step,
	       costs.surfel_frame * 1e-6, costs.surfel_tap, costs.surfel_link);
	/* a machine that does other things, too, may take longer over the last part */
	assert_true(seconds < 10 * CALIBRATE_SECONDS);
}

static void costs_are_kept(void **state)
{
	struct gi_costs first, second;
	const char *from;

	(void)state;
	calibrate_kept(&first, target, &from);
	assert_string_equal(from, "costs measured now");
	calibrate_kept(&second, target, &from);
	assert_string_equal(from, "costs kept from before");
	assert_true(fabs(first.surfel_link - second.surfel_link) <= 1e-3);
	assert_true(fabs(first.lattice_cell_step - second.lattice_cell_step) <= 1e-3);
	setenv("CACHE_DIRECTORY", "/proc/nowhere", 1);
	calibrate_kept(&second, target, &from); /* goes on without */
	assert_string_equal(from, "costs measured now");
	setenv("CACHE_DIRECTORY", folder, 1);
}

static void auto_draws(void **state)
{
	const struct renderer_params params = { .width = 32, .height = 32, .eyes = RENDERER_MONO };
	const char *source = getenv("srcdir");
	struct gr_diag diag = { 0 };
	struct scene_file *file;
	struct scene *scene;
	struct renderer *renderer;
	struct render_frame frame;
	const struct gi_plan *plan;
	char path[1024];

	(void)state;
	snprintf(path, sizeof path, "%s/scenes/box.scene", source ? source : ".");
	assert_int_equal(scene_file_load(path, &file, &diag), GR_OK);
	assert_int_equal(scene_import(file, &scene, &diag), GR_OK);
	gr_diag_finish(&diag);
	free(file->path);
	file->path = NULL; /* nothing baked is kept */
	file->gi.method = SCENE_GI_AUTO;
	file->gi.budget_ms = 2;
	assert_int_equal(renderer_create(&renderer, target, &params, file, scene), GR_OK);
	plan = renderer_plan(renderer);
	assert_non_null(plan);
	printf("# %s\n", plan->why);
	assert_int_not_equal(plan->gi.method, SCENE_GI_AUTO);
	render_frame_init(&frame, file);
	frame.frame = 1;
	assert_int_equal(renderer_draw_camera(renderer, &frame, &file->cameras[0]), GR_OK);
	assert_int_equal(renderer_finished(renderer, INT64_C(60000000000)), GR_OK);
	assert_true(renderer_light_hash(renderer) != 0);
	renderer_destroy(&renderer);
	file->gi.method = SCENE_GI_LPV;
	file->gi.lattice = 8;
	assert_int_equal(renderer_create(&renderer, target, &params, file, scene), GR_OK);
	assert_null(renderer_plan(renderer));
	renderer_destroy(&renderer);
	scene_destroy(&scene);
	scene_file_destroy(&file);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(costs_are_measured),
		cmocka_unit_test(costs_are_kept),
		cmocka_unit_test(auto_draws),
	};
	char command[64];
	int failed;

	gr_log_init("test_calibrate", GR_LOG_WARNING);
	if (sodium_init() < 0 || !mkdtemp(folder))
		return 1;
	setenv("CACHE_DIRECTORY", folder, 1);
	target = gl_target_or_skip(64, 64);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	snprintf(command, sizeof command, "rm -r %s", folder);
	return system(command) == 0 ? failed : 1;
}
