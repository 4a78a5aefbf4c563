/* The bench's parts around a run: settings, points, kept truth, pictures, and one small run itself. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "tests/unit/gl.h"
#include "tools/bench/motion.h"
#include "tools/bench/picture.h"
#include "tools/bench/report.h"

#include <fcntl.h>
#include <math.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

static struct target *target;
static struct scene_file *file;
static struct scene *scene;

static int load(void **state)
{
	const char *source = getenv("srcdir");
	struct gr_diag diag = { 0 };
	char path[1024];

	(void)state;
	snprintf(path, sizeof path, "%s/scenes/box.scene", source ? source : ".");
	if (sodium_init() < 0 || scene_file_load(path, &file, &diag) != GR_OK ||
	    scene_import(file, &scene, &diag) != GR_OK)
		return -1;
	gr_diag_finish(&diag);
	return 0;
}

static int unload(void **state)
{
	(void)state;
	scene_destroy(&scene);
	scene_file_destroy(&file);
	return 0;
}

static int make(struct bench_cases *cases, const char *methods, const char *settings, char **said)
{
	size_t size;
	FILE *err = open_memstream(said, &size);
	int result = bench_cases_make(cases, file, methods, settings, 100, err);

	fclose(err);
	return result;
}

static void settings_become_cases(void **state)
{
	static struct bench_cases cases;
	char *said;

	(void)state;
	assert_int_equal(make(&cases, "lpv", "lpv.lattice=16 lpv.lattice=24,lpv.steps=4", &said), GR_OK);
	assert_string_equal(said, "");
	free(said);
	assert_int_equal(cases.count, 3);
	assert_int_equal(cases.items[0].gi.method, SCENE_GI_NONE);
	assert_int_equal(cases.items[1].gi.lattice, 16);
	assert_int_equal(cases.items[1].gi.steps, file->gi.steps);
	assert_string_equal(cases.items[2].label, "24 cells, 4 steps");
	assert_int_equal(make(&cases, "none,lpv", NULL, &said), GR_OK);
	free(said);
	assert_int_equal(cases.count, 4);
	assert_int_equal(make(&cases, "surfels", NULL, &said), GR_OK);
	free(said);
	assert_true(cases.count == 4 && cases.items[1].gi.spacing_m > cases.items[2].gi.spacing_m);
}

static void wrong_settings_are_refused(void **state)
{
	static const struct {
		const char *methods, *settings, *says;
	} wrong[] = {
		{ "lvp", NULL, "'lvp' is no method: there are none lpv" },
		{ "lpv", "lattice=3", "METHOD.KEY=VALUE" },
		{ "lpv", "lpv.lattice", "METHOD.KEY=VALUE" },
		{ "lpv", "lpv.latice=16", "'latice' is no setting of lpv; there are lattice" },
		{ "lpv", "lpv.lattice=many", "'many' cannot be the value" },
		{ "lpv", "lpv.lattice=16.5", "cannot be the value" },
		{ "lpv", "lpv.lattice=nan", "cannot be the value" },
		{ "lpv", "lpv.lattice=4", "lattice" },
		{ "lpv", "lpv.lattice=16,surfels.links=64", "another method" },
		{ "lpv", "surfels.links=64", "not among 'lpv'" },
		{ "lpv", "none.x=1", "no setting of none" },
	};
	static struct bench_cases cases;

	(void)state;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		char *said;

		assert_int_equal(make(&cases, wrong[i].methods, wrong[i].settings, &said), GR_ERR_CONFIG);
		if (!strstr(said, wrong[i].says))
			fail_msg("'%s' does not say '%s'", said, wrong[i].says);
		free(said);
	}
}

static void points_lie_on_lit_sides(void **state)
{
	struct bench_points points, again;
	double high = 0;

	(void)state;
	assert_int_equal(bench_points_create(&points, scene, 500, 1), GR_OK);
	assert_int_equal(bench_points_create(&again, scene, 500, 1), GR_OK);
	assert_true(points.count > 400 && points.count <= 500);
	assert_int_equal(points.count, again.count);
	assert_memory_equal(points.points, again.points, points.count * sizeof *points.points);
	for (size_t k = 0; k < points.count; k++) {
		const struct renderer_point *p = &points.points[k];
		double length = 0;

		for (int i = 0; i < 3; i++) {
			assert_true(p->position[i] >= scene->min[i] - 1e-4f && p->position[i] <= scene->max[i] + 1e-4f);
			length += (double)p->normal[i] * (double)p->normal[i];
		}
		assert_true(fabs(length - 1) < 1e-5);
		high += p->normal[1] > 0.9f;
	}
	/* floor and tops: 34 of about 160 m^2 */
	printf("# %zu points, %.3f of them look up\n", points.count, high / (double)points.count);
	assert_true(fabs(high / (double)points.count - 0.21) < 0.03);
	bench_points_finish(&points);
	bench_points_finish(&again);
	assert_null(points.points);
}

/* A source that counts how often it is asked. */
struct asked {
	int points, picture;
};

static int known_points(void *ctx, const struct bench_points *points, double (*irradiance)[3],
			double *error)
{
	((struct asked *)ctx)->points++;
	for (size_t k = 0; k < points->count; k++) {
		for (int c = 0; c < 3; c++)
			irradiance[k][c] = 2 + (double)k;
		error[k] = 0.01;
	}
	return GR_OK;
}

static int known_picture(void *ctx, struct image *radiance, struct image *indirect, double *noise)
{
	((struct asked *)ctx)->picture++;
	*noise = 0.02;
	(void)indirect;
	if (image_create(radiance, 64, 64, 3) != GR_OK)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < 3 * 64 * 64; i++)
		radiance->data[i] = 0.5f;
	return GR_OK;
}

static void flip_a_bit(const char *path, long at)
{
	int fd = open(path, O_RDWR);
	char byte;

	assert_true(fd >= 0);
	assert_int_equal(pread(fd, &byte, 1, at), 1);
	byte ^= 0x10;
	assert_int_equal(pwrite(fd, &byte, 1, at), 1);
	close(fd);
}

static void truth_is_kept(void **state)
{
	struct renderer_point place[3] = { { { 0, 0, 0 }, { 0, 1, 0 } } };
	const struct bench_points points = { 3, place, 1 };
	struct asked asked = { 0 };
	const struct bench_truth_source source = { known_points, known_picture, &asked };
	uint8_t key[32] = { 0xab, 0xcd };
	char folder[] = "/tmp/grotto-bench-XXXXXX", path[128], picture[128];
	struct bench_truth truth;
	struct stat status;

	(void)state;
	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/abcd0000000000000000000000000000.truth", folder);
	snprintf(picture, sizeof picture, "%s/abcd0000000000000000000000000000.exr", folder);
	for (int round = 0; round < 2; round++) {
		assert_int_equal(bench_truth_get(&truth, folder, key, &points, &source), GR_OK);
		assert_int_equal(truth.kept, round > 0);
		assert_int_equal(asked.points, 1);
		assert_true(fabs(truth.irradiance[2][1] - 4) < 1e-12);
		assert_true(fabs(truth.noise - 0.01 / 3) < 1e-12);
		assert_true(fabs(truth.picture_noise - 0.02) < 1e-12);
		assert_true(truth.radiance.data && fabsf(truth.radiance.data[5] - 0.5f) < 1e-6f);
		assert_null(truth.indirect.data);
		bench_truth_finish(&truth);
	}
	/* any byte of it changed, cut short or grown, or the picture changed: traced anew */
	assert_int_equal(stat(path, &status), 0);
	for (long at = 0; at < status.st_size; at += 7) {
		flip_a_bit(path, at);
		assert_int_equal(bench_truth_get(&truth, folder, key, &points, &source), GR_OK);
		assert_false(truth.kept);
		bench_truth_finish(&truth);
	}
	for (int change = -1; change <= 1; change += 2) {
		assert_int_equal(truncate(path, status.st_size + change), 0);
		assert_int_equal(bench_truth_get(&truth, folder, key, &points, &source), GR_OK);
		assert_false(truth.kept);
		bench_truth_finish(&truth);
	}
	assert_int_equal(unlink(picture), 0);
	assert_int_equal(bench_truth_get(&truth, folder, key, &points, &source), GR_OK);
	assert_false(truth.kept);
	bench_truth_finish(&truth);
	/* no folder: nothing kept, nothing wrong; nor with one that cannot be written */
	assert_int_equal(bench_truth_get(&truth, NULL, key, &points, &source), GR_OK);
	bench_truth_finish(&truth);
	assert_int_equal(bench_truth_get(&truth, "/proc/nowhere", key, &points, &source), GR_OK);
	bench_truth_finish(&truth);
	unlink(path);
	unlink(picture);
	rmdir(folder);
}

static void pictures_are_compared_by_blocks(void **state)
{
	struct image a, b, small, shown;
	struct bench_picture_error error;

	(void)state;
	assert_int_equal(image_create(&a, 32, 24, 3), GR_OK);
	assert_int_equal(image_create(&b, 32, 24, 3), GR_OK);
	assert_int_equal(image_create(&small, 16, 24, 3), GR_OK);
	for (size_t i = 0; i < 3 * 32 * 24; i++) {
		/* noise of a chessboard is gone in the means */
		a.data[i] = 1.1f;
		b.data[i] = (i / 3 + i / 96) % 2 ? 1.5f : 0.5f;
	}
	assert_int_equal(bench_picture_compare(&a, &b, &file->tone, &error), GR_OK);
	assert_int_equal(error.blocks.count, 12);
	assert_true(fabs(error.blocks.bias - 0.1) < 1e-6);
	assert_true(fabs(error.blocks.nrmse - 0.1) < 1e-6);
	assert_true(fabs(error.blocks.p95 - 0.1) < 1e-6);
	assert_true(error.flip > 0 && error.flip < 1 && error.ssim < 1);
	assert_int_equal(bench_picture_compare(&small, &b, &file->tone, &error), GR_ERR_RANGE);
	assert_int_equal(bench_picture_compare(&b, &b, &file->tone, &error), GR_OK);
	assert_true(error.flip < 1e-6 && error.ssim > 1 - 1e-6);
	assert_int_equal(bench_picture_show(&a, &file->tone, &shown), GR_OK); /* exposure 2, L/(1+L) */
	assert_true(fabsf(shown.data[7] - (1.055f * powf(2.2f / 3.2f, 1 / 2.4f) - 0.055f)) < 1e-5f);
	image_finish(&shown);
	image_finish(&a);
	image_finish(&b);
	image_finish(&small);
}

static void the_lamp_moves_level(void **state)
{
	struct bench_motion motion;
	struct render_frame from, to;

	(void)state;
	bench_motion_init(&motion, file);
	assert_int_equal(motion.lamp, 0);
	bench_motion_frame(&motion, -1, &from);
	bench_motion_frame(&motion, 2, &to);
	assert_true(fabsf(glm_vec3_distance(from.lamps[0].position, to.lamps[0].position) - 0.024f) < 1e-6f);
	assert_true(fabsf(from.lamps[0].position[1] - to.lamps[0].position[1]) < 1e-9f);
	bench_motion_dark(&motion, &to);
	assert_false(to.lamps[0].on);
}

/* All the way through, on a small lattice, against a made-up truth. */
static void a_case_is_measured(void **state)
{
	static struct bench_cases cases;
	static struct bench_result results[2];
	struct bench_points points;
	struct bench_truth truth;
	struct asked asked = { 0 };
	const struct bench_truth_source source = { known_points, known_picture, &asked };
	const uint8_t key[32] = { 0 };
	struct bench_view view = { .target = target, .file = file, .scene = scene, .frames = 5 };
	struct bench_report report = { .scene = "box", .path = "box.scene", .renderer = "x", .view = &view,
				       .results = results, .count = 2 };
	char *said, *table;
	size_t size;
	FILE *out;

	(void)state;
	view.camera = file->cameras[0];
	view.camera.pixels[0] = view.camera.pixels[1] = 64;
	assert_int_equal(bench_points_create(&points, scene, 60, 1), GR_OK);
	assert_int_equal(bench_truth_get(&truth, NULL, key, &points, &source), GR_OK);
	view.points = &points;
	view.truth = &truth;
	assert_int_equal(make(&cases, "lpv", "lpv.lattice=12,lpv.link_rays=4", &said), GR_OK);
	free(said);
	for (size_t i = 0; i < 2; i++)
		assert_int_equal(bench_measure(&results[i], &view, &cases.items[i]), GR_OK);
	assert_true(fabs(results[0].irradiance.bias + 1) < 1e-9);
	assert_true(results[1].irradiance.bias > -1 && isfinite(results[1].irradiance.nrmse));
	assert_int_equal(results[1].still_frames, 0);
	assert_true(results[1].gpu_bytes > 100000);
	assert_true(results[1].flicker.worst >= results[1].flicker.mean && results[1].flicker.mean > 0);
	assert_true(results[1].frames_to_10 > 0 && results[1].frames_to_1 >= results[1].frames_to_10);
	assert_int_equal(results[1].nonfinite, 0);
	assert_true(results[1].frame_ms > 0 && isfinite(bench_added_ms(&report, 1)));
	assert_true(isfinite(results[1].total.blocks.nrmse));
	assert_true(isnan(results[1].indirect.blocks.nrmse));
	out = open_memstream(&table, &size);
	bench_report_table(out, &report);
	bench_report_fit(out, &report);
	assert_int_equal(bench_report_plot(out, &report), GR_OK);
	fclose(out);
	assert_non_null(strstr(table, "12 cells, 8 steps"));
	assert_non_null(strstr(table, "fit box lpv"));
	assert_non_null(strstr(table, "no indirect light"));
	free(table);
	struct json_object *json = bench_report_json(&report), *list, *member;

	assert_true(json_object_object_get_ex(json, "results", &list));
	assert_int_equal(json_object_array_length(list), 2);
	assert_true(json_object_object_get_ex(json_object_array_get_idx(list, 1), "stages_ms", &member));
	assert_true(json_object_object_get_ex(member, "gi", NULL));
	json_object_put(json);
	bench_truth_finish(&truth);
	bench_points_finish(&points);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(settings_become_cases),
		cmocka_unit_test(wrong_settings_are_refused),
		cmocka_unit_test(points_lie_on_lit_sides),
		cmocka_unit_test(truth_is_kept),
		cmocka_unit_test(pictures_are_compared_by_blocks),
		cmocka_unit_test(the_lamp_moves_level),
		cmocka_unit_test(a_case_is_measured),
	};
	int failed;

	gr_log_init("test_bench", GR_LOG_ERROR);
	target = gl_target_or_skip(64, 64);
	failed = cmocka_run_group_tests(tests, load, unload);
	target_destroy(&target);
	return failed;
}
