/*
 * Air that is set while all runs, over light that was fixed at baking: of an emitter, of a
 * mirror that shows it, and of what is outside. Through the whole renderer, against the
 * reference and against the same air in the scene file.
 */
#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/gi.h"
#include "renderer/renderer.h"
#include "renderer/trace/reference.h"
#include "tests/accuracy/hard/room.h"
#include "tests/unit/unit.h"

#include <math.h>
#include <unistd.h>

#define LONG_NS INT64_C(600000000000)
#define AIR 0.1f

static struct target *target;
static char folder[64];

static void emitter(struct model *model)
{
	int light;

	hard_plain(model);
	light = model_material(model, "light", 0, 0, 0);
	for (int i = 0; i < 3; i++)
		model->materials[light].emission[i] = 20;
	model_quad(model, light, (float[3]){ 2.2f, 2.99f, 0.8f }, (float[3]){ 0.8f, 0, 0 },
		   (float[3]){ 0, 0, 0.8f });
}

/* A floor, a ceiling and one wall, with the sky on three sides. */
static void open_room(struct model *model)
{
	int wall = model_material(model, "wall", 0.6f, 0.55f, 0.5f);

	model_material(model, "block", 0.3f, 0.5f, 0.6f);
	model_quad(model, wall, (float[3]){ 0, 0, 0 }, (float[3]){ 0, 0, 4 }, (float[3]){ 4, 0, 0 });
	model_quad(model, wall, (float[3]){ 0, 3, 0 }, (float[3]){ 4, 0, 0 }, (float[3]){ 0, 0, 4 });
	model_quad(model, wall, (float[3]){ 0, 0, 0 }, (float[3]){ 4, 0, 0 }, (float[3]){ 0, 3, 0 });
	hard_block(model, 1, false);
}

static const struct {
	const char *name;
	void (*build)(struct model *model);
	const char *more; /* lines of the scene file */
	bool sky;         /* which shading takes from the surfels, too, where it shines directly */
} cases[] = {
	{ "emitter", emitter, "", false },
	{ "emitter and a mirror", emitter,
	  "materials = ( { material = \"block\"; kind = \"mirror\"; reflectance = [0.9, 0.9, 0.9]; } );", false },
	{ "sky", open_room, "environment = { kind = \"constant\"; radiance = [1.0, 1.0, 1.0]; };", true },
};
#define CASES (sizeof cases / sizeof *cases)

static const struct {
	enum scene_gi_method method;
	const char *name;
	double reference; /* most that all of it is off */
	double as_file;   /* most that it is off from the same air in the file */
} methods[] = {
	{ SCENE_GI_SURFELS, "surfels", 0.03, 0.001 },
	/* one way for light from all directions, where it comes from outside */
	{ SCENE_GI_PROBES, "probes", 0.04, 0.035 },
};
#define METHODS (sizeof methods / sizeof *methods)

struct room {
	struct scene_file *file;
	struct scene *scene;
	struct renderer *renderer;
	struct render_frame frame;
};

static void load(struct room *r, size_t which, bool air, enum scene_gi_method method)
{
	static struct model model;
	char more[512], path[128];
	const struct hard_scene wanted = { .scale = 1, .gathers = 2, .steps = 8, .more = more };
	const struct renderer_params params = { .width = HARD_PIXELS, .height = HARD_PIXELS,
						.eyes = RENDERER_MONO, .keep_radiance = true,
						.quiet = true };
	struct gr_diag diag = { 0 };

	model = (struct model){ 0 };
	cases[which].build(&model);
	snprintf(path, sizeof path, "%s/air.glb", folder);
	model_write(&model, path);
	snprintf(more, sizeof more, "%s%s", cases[which].more,
		 air ? " medium = { absorption_per_m = 0.1; };" : "");
	snprintf(path, sizeof path, "%s/air.scene", folder);
	hard_write_scene(&wanted, path, "air.glb");
	assert_int_equal(scene_file_load(path, &r->file, &diag), GR_OK);
	assert_int_equal(scene_import(r->file, &r->scene, &diag), GR_OK);
	gr_diag_finish(&diag);
	r->file->gi.method = method;
	free(r->file->path);
	r->file->path = NULL; /* nothing baked is kept */
	assert_int_equal(renderer_create(&r->renderer, target, &params, r->file, r->scene), GR_OK);
	render_frame_init(&r->frame, r->file);
}

static void unload(struct room *r)
{
	struct renderer_stats stats;
	struct gi_stats gi;

	renderer_stats(r->renderer, &stats);
	assert_true(renderer_gi_stats(r->renderer, &gi));
	assert_int_equal(stats.nonfinite + stats.gl_errors + gi.nonfinite, 0);
	renderer_destroy(&r->renderer);
	scene_destroy(&r->scene);
	scene_file_destroy(&r->file);
}

/* The points' light in so much air, settled; anew: from the start, else as it follows from before. */
static double lit(struct room *r, float air, bool anew, const struct renderer_point *points,
		  size_t count, float (*found)[3])
{
	double sum = 0;

	r->frame.absorption_per_m = air;
	r->frame.gi_epoch += anew;
	for (int i = 0; i < (anew ? 1 : 30); i++) {
		r->frame.frame++;
		assert_int_equal(renderer_draw_camera(r->renderer, &r->frame, &r->file->cameras[0]), GR_OK);
		assert_int_equal(renderer_finished(r->renderer, LONG_NS), GR_OK);
	}
	assert_int_equal(renderer_read_irradiance(r->renderer, points, count, found), GR_OK);
	for (size_t i = 0; i < count; i++)
		for (int c = 0; c < 3; c++)
			sum += (double)found[i][c] / (3 * (double)count);
	return sum;
}

static double traced(const struct room *r, float air, bool total, const struct renderer_point *at,
		     size_t count)
{
	const struct reference_params params = { .seed = 1, .samples = 1024, .max_bounces = 64 };
	struct reference_point points[HARD_POINTS] = { 0 };
	struct render_frame frame = r->frame;
	struct reference *reference;
	uint64_t nonfinite;
	double sum = 0;

	frame.absorption_per_m = air;
	assert_int_equal(reference_create(&reference, r->scene, r->file, &frame), GR_OK);
	for (size_t i = 0; i < count; i++) {
		memcpy(points[i].position, at[i].position, sizeof points[i].position);
		memcpy(points[i].normal, at[i].normal, sizeof points[i].normal);
	}
	assert_int_equal(reference_irradiance(reference, &params, points, count, &nonfinite), GR_OK);
	assert_int_equal(nonfinite, 0);
	for (size_t i = 0; i < count; i++)
		for (int c = 0; c < 3; c++)
			sum += (total ? points[i].total[c] : points[i].indirect[c]) / (3 * (double)count);
	reference_destroy(&reference);
	return sum;
}

static double rms(float (*a)[3], float (*b)[3], size_t count, double mean)
{
	double sum = 0;

	for (size_t i = 0; i < count; i++)
		for (int c = 0; c < 3; c++)
			sum += pow((double)(a[i][c] - b[i][c]), 2) / (3 * (double)count);
	return sqrt(sum) / mean;
}

/* Of the room's, those on walls that there are. */
static size_t points_of(size_t which, struct renderer_point points[HARD_POINTS])
{
	size_t count = 0;

	hard_points(1, points);
	for (size_t i = 0; i < HARD_POINTS; i++)
		if (!cases[which].sky || fabsf(points[i].normal[1]) > 0.5f || points[i].normal[2] > 0.5f)
			points[count++] = points[i];
	return count;
}

static void set_while_running(void **state)
{
	static float in_file[HARD_POINTS][3], set[HARD_POINTS][3], clear[HARD_POINTS][3], again[HARD_POINTS][3];
	struct renderer_point points[HARD_POINTS];

	(void)state;
	for (size_t c = 0; c < CASES; c++)
		for (size_t m = 0; m < METHODS; m++) {
			double truth, thick, thin, filed;
			size_t count = points_of(c, points);
			struct room r;

			load(&r, c, true, methods[m].method);
			filed = lit(&r, AIR, true, points, count, in_file);
			lit(&r, 0, true, points, count, again);
			unload(&r);
			load(&r, c, false, methods[m].method);
			truth = traced(&r, AIR, cases[c].sky, points, count);
			thin = lit(&r, 0, true, points, count, clear);
			thick = lit(&r, AIR, false, points, count, set);
			printf("# %s, %s: air of 0.1/m set later leaves %.4f of the clear room's light, %+.2f %% off "
			       "the reference, in the scene file %+.2f %%; the two are %.1e apart; in clear air what was baked in "
			       "such air %.1e\n",
			       cases[c].name, methods[m].name, thick / thin, 100 * (thick / truth - 1),
			       100 * (filed / truth - 1), rms(set, in_file, count, filed), rms(again, clear, count, thin));
			assert_true(fabs(thick / truth - 1) < methods[m].reference);
			assert_true(rms(set, in_file, count, filed) < methods[m].as_file);
			assert_true(rms(again, clear, count, thin) < methods[m].as_file);
			/* back in clear air all is as it was */
			lit(&r, 0, true, points, count, again);
			assert_memory_equal(clear, again, count * sizeof *clear);
			unload(&r);
		}
}

int main(void)
{
	const struct target_params params = { .kind = TARGET_HEADLESS, .width = HARD_PIXELS,
					      .height = HARD_PIXELS, .gpu = -1 };
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(set_while_running),
	};
	char command[128];
	int failed;

	gr_log_init("test_hard_air", GR_LOG_WARNING);
	if (target_create(&target, &params) != GR_OK) {
		printf("# no OpenGL 4.5 here: skipped\n");
		return 77;
	}
	strcpy(folder, "/tmp/grotto-air-XXXXXX");
	if (!mkdtemp(folder))
		return 1;
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	snprintf(command, sizeof command, "rm -r %s", folder);
	return system(command) == 0 ? failed : 1;
}
