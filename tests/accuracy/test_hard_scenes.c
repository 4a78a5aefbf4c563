/*
 * Scenes that nobody would build, as files and through every method: each is
 * imported, lit and drawn as by a node, and what comes out is finite and near
 * to the reference, which is traced through the same file; black where nothing
 * shines, and as the plain room is where the fault takes nothing from the light.
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

#define SIDE HARD_PIXELS
#define POINTS HARD_POINTS
#define LONG_NS INT64_C(600000000000)

static struct target *target;
static char folder[64];

/* --- what is wrong with the others --- */

static void broken_triangles(struct model *model)
{
	static const float a[3] = { 1, 1, 1 }, b[3] = { 2, 1, 1 }, c[3] = { 3, 1, 1 };
	static const float nan[3] = { NAN, 1, 2 }, infinite[3] = { 1, INFINITY, 2 };

	hard_plain(model);
	model_triangle(model, 0, a, a, a);        /* a point, */
	model_triangle(model, 0, a, b, a);        /* an edge, */
	model_triangle(model, 1, a, b, c);        /* a line, */
	model_triangle(model, 1, a, b, nan);      /* nothing, */
	model_triangle(model, 0, infinite, b, c); /* and everywhere */
}

/* Three sheets and a fourth that ends on one of them share an edge; a wall has a corner in another's edge. */
static void non_manifold(struct model *model)
{
	int wall = model_material(model, "wall", 0.6f, 0.55f, 0.5f);
	int sheet = model_material(model, "sheet", 0.3f, 0.5f, 0.6f);

	hard_walls(model, wall);
	model->materials[sheet].two_sided = true;
	for (int i = 0; i < 3; i++) {
		float angle = 2.2f * (float)i + 0.3f;

		model_quad(model, sheet, (float[3]){ 1.4f, 0.3f, 1.4f }, (float[3]){ 0, 1, 0 },
			   (float[3]){ 0.8f * cosf(angle), 0, 0.8f * sinf(angle) });
	}
	model_triangle(model, sheet, (float[3]){ 1.4f, 0.3f, 1.4f }, (float[3]){ 1.4f, 1.3f, 1.4f },
		       (float[3]){ 1.4f, 0.8f, 0.7f });
}

static void block_inside_out(struct model *model)
{
	hard_walls(model, model_material(model, "wall", 0.6f, 0.55f, 0.5f));
	hard_block(model, model_material(model, "block", 0.3f, 0.5f, 0.6f), true);
}

/* Nothing in it shows the lamp a front. */
static void room_inside_out(struct model *model)
{
	model_box(model, model_material(model, "wall", 0.6f, 0.55f, 0.5f), (float[3]){ 0, 0, 0 }, hard_room,
		  false);
}

/* Every face twice, and the block once more inside out. */
static void coincident_faces(struct model *model)
{
	hard_plain(model);
	hard_walls(model, 0);
	hard_block(model, 1, false);
	hard_block(model, 1, true);
}

static void black(struct model *model)
{
	hard_walls(model, model_material(model, "wall", 0, 0, 0));
	hard_block(model, model_material(model, "block", 0, 0, 0), false);
}

static void bright_emitter(struct model *model)
{
	int light;

	hard_plain(model);
	light = model_material(model, "light", 0, 0, 0);
	for (int i = 0; i < 3; i++)
		model->materials[light].emission[i] = 1e9f;
	model_quad(model, light, (float[3]){ 2.2f, 2.99f, 0.8f }, (float[3]){ 0.8f, 0, 0 },
		   (float[3]){ 0, 0, 0.8f });
}

/* Walls that are seen and stop light from both sides. */
static void two_sided(struct model *model)
{
	hard_plain(model);
	model->materials[0].two_sided = true;
}

enum wanted { AS_TRACED, BLACK };

struct hard_case {
	const char *name;
	void (*build)(struct model *model);
	float scale;     /* metres for a metre of the plain room */
	float intensity; /* of the lamp, for a room of 4 m; 0: there is none */
	const char *more; /* lines of the scene file */
	enum wanted wanted;
	/* most that a point's light may be off the plain room's (times the lamps' ratio), of the mean; 0: not looked at */
	double as_plain;
	bool no_camera; /* it is smaller than near_m can be */
};

static const struct hard_case cases[] = {
	{ "plain", hard_plain, 1, 60, "", AS_TRACED, 0, false },
	{ "zero-area, NaN and infinite triangles", broken_triangles, 1, 60, "", AS_TRACED, 1e-6, false },
	{ "non-manifold", non_manifold, 1, 60, "", AS_TRACED, 0, false },
	{ "block inside out", block_inside_out, 1, 60, "", AS_TRACED, 0, false },
	{ "room inside out", room_inside_out, 1, 60, "", BLACK, 0, false },
	{ "coincident faces", coincident_faces, 1, 60, "", AS_TRACED, 0.15, false },
	{ "10 km wide", hard_plain, 2500, 60, "", AS_TRACED, 0.1, false },
	{ "1 mm wide", hard_plain, 0.00025f, 60, "", AS_TRACED, 0.1, true },
	{ "emitter of 1e9", bright_emitter, 1, 0, "", AS_TRACED, 0, false },
	{ "emitter of 1e9, 1 mm", bright_emitter, 0.00025f, 0, "", AS_TRACED, 0, true },
	{ "emitter of 1e9, 10 km", bright_emitter, 2500, 0, "", AS_TRACED, 0, false },
	{ "emitter in absorbing air", bright_emitter, 1, 0, "medium = { absorption_per_m = 0.1; };",
	  AS_TRACED, 0, false },
	{ "lamp of 1e9", hard_plain, 1, 1e9f, "", AS_TRACED, 1e-5, false },
	{ "closed black box", black, 1, 60, "", BLACK, 0, false },
	{ "no lamps at all", hard_plain, 1, 0, "", BLACK, 0, false },
	{ "closed, 1e9 outside", two_sided, 1, 60,
	  "environment = { kind = \"constant\"; radiance = [1e9, 1e9, 1e9]; };", AS_TRACED, 0.15, false },
};
#define CASES (sizeof cases / sizeof *cases)

/* --- methods --- */

static const struct {
	enum scene_gi_method method;
	const char *name;
	double bias, nrmse; /* most, against the reference, at points of the walls */
	double picture;     /* most that a picture's mean is off */
} methods[] = {
	{ SCENE_GI_SURFELS, "surfels", 0.05, 0.09, 0.06 },
	{ SCENE_GI_PROBES, "probes", 0.05, 0.12, 0.06 },
	{ SCENE_GI_LPV, "lpv", 0.12, 0.30, 0.06 },
};
#define METHODS (sizeof methods / sizeof *methods)

/* Mean over bands of all points. */
struct light {
	double at[POINTS];
	double mean;
	double picture; /* mean of the camera's */
};

static struct light plain_lit[METHODS];

static void write_scene(const struct hard_case *c, const char *path)
{
	const struct hard_scene scene = { .scale = c->scale, .intensity = { c->intensity },
					  .gathers = 4, .steps = 16, .more = c->more };

	hard_write_scene(&scene, path, "hard.glb");
}

static void trace(const struct scene *scene, const struct scene_file *file, bool camera,
		  const struct renderer_point at[POINTS], struct light *out)
{
	struct reference_params params = { .seed = 1, .samples = 1024, .max_bounces = 64 };
	struct reference_point points[POINTS] = { 0 };
	struct reference_film film = { 0 };
	struct reference *reference;
	struct reference_view view;
	struct render_frame frame;
	struct image picture;
	uint64_t nonfinite;

	render_frame_init(&frame, file);
	assert_int_equal(reference_create(&reference, scene, file, &frame), GR_OK);
	for (size_t i = 0; i < POINTS; i++) {
		memcpy(points[i].position, at[i].position, sizeof points[i].position);
		memcpy(points[i].normal, at[i].normal, sizeof points[i].normal);
	}
	assert_int_equal(reference_irradiance(reference, &params, points, POINTS, &nonfinite), GR_OK);
	assert_int_equal(nonfinite, 0);
	memset(out, 0, sizeof *out);
	for (size_t i = 0; i < POINTS; i++) {
		for (int c = 0; c < 3; c++) {
			assert_true(isfinite(points[i].indirect[c]) && points[i].indirect[c] >= 0);
			out->at[i] += points[i].indirect[c] / 3;
		}
		out->mean += out->at[i] / POINTS;
	}
	if (camera) {
		params.samples = 64;
		assert_int_equal(reference_view_camera(&file->cameras[0], &view), GR_OK);
		assert_int_equal(reference_render(reference, &view, &params, &film), GR_OK);
		assert_int_equal(film.nonfinite, 0);
		assert_int_equal(reference_film_images(&film, &picture, NULL, NULL), GR_OK);
		out->picture = hard_mean(&picture);
		image_finish(&picture);
		reference_film_finish(&film);
	}
	reference_destroy(&reference);
}

static void light(const struct scene *scene, const struct scene_file *file, bool camera,
		  const struct renderer_point at[POINTS], struct light *out)
{
	const struct renderer_params params = { .width = SIDE, .height = SIDE, .eyes = RENDERER_MONO,
						.keep_radiance = true, .quiet = true };
	static float found[POINTS][3];
	static uint8_t rgb[SIDE * SIDE * 3];
	struct renderer_stats stats;
	struct renderer *renderer;
	struct render_frame frame;
	struct gi_stats gi;
	struct image picture;

	assert_int_equal(renderer_create(&renderer, target, &params, file, scene), GR_OK);
	render_frame_init(&frame, file);
	for (frame.frame = 1; frame.frame <= 4; frame.frame++) {
		assert_int_equal(renderer_draw_camera(renderer, &frame, &file->cameras[0]), GR_OK);
		assert_int_equal(renderer_finished(renderer, LONG_NS), GR_OK);
	}
	assert_int_equal(renderer_read_irradiance(renderer, at, POINTS, found), GR_OK);
	memset(out, 0, sizeof *out);
	for (size_t i = 0; i < POINTS; i++) {
		for (int c = 0; c < 3; c++) {
			assert_true(isfinite(found[i][c]) && found[i][c] >= 0);
			out->at[i] += (double)found[i][c] / 3;
		}
		out->mean += out->at[i] / POINTS;
	}
	assert_int_equal(renderer_read_radiance(renderer, 0, &picture), GR_OK);
	out->picture = camera ? hard_mean(&picture) : 0;
	image_finish(&picture);
	assert_int_equal(renderer_read_rgb(renderer, rgb), GR_OK);
	/* counts come some frames later */
	for (int i = 0; i < 4; i++, frame.frame++) {
		frame.exposure *= 1.5f;
		assert_int_equal(renderer_draw_camera(renderer, &frame, &file->cameras[0]), GR_OK);
		assert_int_equal(renderer_finished(renderer, LONG_NS), GR_OK);
	}
	renderer_stats(renderer, &stats);
	assert_int_equal(stats.nonfinite, 0);
	assert_int_equal(stats.gl_errors, 0);
	if (renderer_gi_stats(renderer, &gi))
		assert_int_equal(gi.nonfinite, 0);
	renderer_destroy(&renderer);
}

static bool agrees(const struct hard_case *c, size_t m, const struct light *traced, const struct light *lit)
{
	double square = 0, bias, nrmse, picture, from_plain = 0;
	bool good = true;

	if (c->wanted == BLACK) {
		printf("#   %-8s indirect light %g, picture off by %g\n", methods[m].name, lit->mean,
		       lit->picture - traced->picture);
		return lit->mean == 0 && fabs(lit->picture - traced->picture) <= 0.03 * traced->picture;
	}
	for (size_t i = 0; i < POINTS; i++)
		square += (lit->at[i] - traced->at[i]) * (lit->at[i] - traced->at[i]) / POINTS;
	bias = lit->mean / traced->mean - 1;
	nrmse = sqrt(square) / traced->mean;
	picture = traced->picture > 0 ? lit->picture / traced->picture - 1 : 0;
	good = traced->mean > 0 && fabs(bias) < methods[m].bias && nrmse < methods[m].nrmse &&
	       fabs(picture) < methods[m].picture;
	printf("#   %-8s indirect light: bias %+.2f %%, nRMSE %.1f %%; picture %+.2f %%", methods[m].name,
	       100 * bias, 100 * nrmse, 100 * picture);
	if (c->as_plain > 0) {
		double factor = (double)(c->intensity / cases[0].intensity);

		for (size_t i = 0; i < POINTS; i++)
			from_plain = fmax(from_plain, fabs(lit->at[i] / factor - plain_lit[m].at[i]));
		from_plain /= plain_lit[m].mean;
		good = good && from_plain <= c->as_plain;
		printf("; %.1e of the plain room's", from_plain);
	}
	printf("\n");
	return good;
}

static void every_case(void **state)
{
	struct renderer_point points[POINTS];
	char scene_path[128], model_path[128], kept[128];
	int failed = 0;

	(void)state;
	snprintf(scene_path, sizeof scene_path, "%s/hard.scene", folder);
	snprintf(model_path, sizeof model_path, "%s/hard.glb", folder);
	snprintf(kept, sizeof kept, "%s/hard.surfels", folder);
	for (size_t i = 0; i < CASES; i++) {
		const struct hard_case *c = &cases[i];
		static struct model model;
		struct scene_file *file = NULL;
		struct scene *scene = NULL;
		struct gr_diag diag = { 0 };
		struct light traced;

		memset(&model, 0, sizeof model);
		c->build(&model);
		model_write(&model, model_path);
		write_scene(c, scene_path);
		assert_int_equal(scene_file_load(scene_path, &file, &diag), GR_OK);
		assert_int_equal(scene_import(file, &scene, &diag), GR_OK);
		gr_diag_finish(&diag);
		hard_points(c->scale, points);
		trace(scene, file, !c->no_camera, points, &traced);
		printf("# %s: indirect light %.4g W/m^2, picture %.4g\n", c->name, traced.mean, traced.picture);
		for (size_t m = 0; m < METHODS; m++) {
			struct light lit;

			file->gi.method = methods[m].method;
			light(scene, file, !c->no_camera, points, &lit);
			unlink(kept); /* one of surfels is none of probes */
			if (c == cases)
				plain_lit[m] = lit;
			failed += !agrees(c, m, &traced, &lit);
			fflush(stdout);
		}
		scene_destroy(&scene);
		scene_file_destroy(&file);
	}
	unlink(scene_path);
	unlink(model_path);
	assert_int_equal(failed, 0);
}

/* What is not there is named before anything is drawn; no method is asked. */
static void missing_texture(void **state)
{
	char scene_path[128], model_path[128];
	static struct model model;
	struct scene_file *file = NULL;
	struct scene *scene = NULL;
	struct gr_diag diag = { 0 };

	(void)state;
	snprintf(scene_path, sizeof scene_path, "%s/hard.scene", folder);
	snprintf(model_path, sizeof model_path, "%s/hard.glb", folder);
	memset(&model, 0, sizeof model);
	hard_plain(&model);
	model.materials[1].texture = "gone.png";
	/* nobody has texture coordinates for it either */
	model_write(&model, model_path);
	write_scene(&cases[0], scene_path);
	assert_int_equal(scene_file_load(scene_path, &file, &diag), GR_OK);
	assert_int_equal(scene_import(file, &scene, &diag), GR_ERR_CONFIG);
	assert_null(scene);
	assert_int_equal(diag.errors, 1);
	printf("# %s\n", diag.items[diag.count - 1].text);
	assert_non_null(strstr(diag.items[diag.count - 1].text, "gone.png"));
	gr_diag_finish(&diag);
	scene_file_destroy(&file);
	unlink(scene_path);
	unlink(model_path);
}

int main(void)
{
	const struct target_params params = { .kind = TARGET_HEADLESS, .width = SIDE, .height = SIDE,
					      .gpu = -1 };
	const struct CMUnitTest tests[] = { cmocka_unit_test(missing_texture), cmocka_unit_test(every_case) };
	int failed;

	gr_log_init("test_hard_scenes", GR_LOG_WARNING);
	if (target_create(&target, &params) != GR_OK) {
		printf("# no OpenGL 4.5 here: skipped\n");
		return 77;
	}
	snprintf(folder, sizeof folder, "/tmp/grotto-hard-XXXXXX");
	if (!mkdtemp(folder))
		return 1;
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	rmdir(folder);
	target_destroy(&target);
	return failed;
}
