#include "tools/bench/scenes.h"

#include "base/log.h"
#include "base/result.h"
#include "tools/bench/truth_traced.h"
#include "tools/load.h"

#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define POINTS_SEED 1
#define TRUTH_SEED 1
#define PIXELS 256

/* One scene while it is measured. */
struct bench_scene {
	struct scene_file *file;
	struct scene *scene;
	struct bench_points points;
	struct bench_truth truth;
	struct bench_cases cases;
	struct bench_view view;
	struct bench_result results[BENCH_CASES_MAX];
	size_t result_count;
	char name[64]; /* of its file, without folder and ending */
};

static void finish_scene(struct bench_scene *s)
{
	bench_truth_finish(&s->truth);
	bench_points_finish(&s->points);
	scene_destroy(&s->scene);
	scene_file_destroy(&s->file);
}

static void name_of(const char *path, char name[64])
{
	const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
	const char *dot = strrchr(base, '.');
	size_t len = dot && dot > base ? (size_t)(dot - base) : strlen(base);

	snprintf(name, 64, "%.*s", (int)(len < 63 ? len : 63), base);
}

static int load(struct bench_scene *s, const char *path)
{
	name_of(path, s->name);
	return load_scene(path, &s->file, &s->scene);
}

static int choose_camera(struct bench_scene *s, const struct bench_options *options)
{
	int index = options->camera ? scene_file_find_camera(s->file, options->camera) : 0;

	if (!s->file->camera_count || index < 0) {
		fprintf(stderr, "%s: has no camera%s%s\n", s->file->path, options->camera ? " " : "",
			options->camera ? options->camera : ": add one to its cameras");
		return GR_ERR_CONFIG;
	}
	s->view.camera = s->file->cameras[index];
	for (int i = 0; i < 2; i++)
		s->view.camera.pixels[i] = options->pixels[i] ? options->pixels[i] : PIXELS;
	return GR_OK;
}

static int find_truth(struct bench_scene *s, const struct bench_options *options)
{
	struct bench_traced traced = {
		.file = s->file, .scene = s->scene, .camera = s->view.camera, .seed = TRUTH_SEED,
		.point_samples = options->samples * BENCH_POINT_SAMPLES,
		.picture_samples = options->samples,
		.until_error = options->until_error_percent / 100,
		.progress = isatty(STDERR_FILENO) == 1,
	};
	const struct bench_truth_source source = bench_traced_source(&traced);
	uint8_t key[32];

	render_frame_init(&traced.frame, s->file);
	bench_traced_key(&traced, &s->points, key);
	return bench_truth_get(&s->truth, options->out, key, &s->points, &source);
}

static int prepare(struct bench_scene *s, const struct bench_options *options, const char *path)
{
	int result = load(s, path);

	if (result == GR_OK)
		result = choose_camera(s, options);
	if (result == GR_OK)
		result = bench_points_create(&s->points, s->scene, (size_t)options->points, POINTS_SEED);
	if (result == GR_NOTHING) {
		fprintf(stderr, "%s: no surface reflects diffusely: there is nothing to compare\n", path);
		result = GR_ERR_CONFIG;
	}
	if (result == GR_OK)
		result = bench_cases_make(&s->cases, s->file, options->methods, options->settings,
					  s->points.area * options->points, stderr);
	if (result == GR_OK)
		result = find_truth(s, options);
	s->view.file = s->file;
	s->view.scene = s->scene;
	s->view.points = &s->points;
	s->view.truth = &s->truth;
	s->view.frames = options->frames;
	return result;
}

static int open_target(struct target **out, const struct bench_view *view, int gpu)
{
	const struct target_params params = {
		.kind = TARGET_HEADLESS, .title = "grotto bench", .width = view->camera.pixels[0],
		.height = view->camera.pixels[1], .gpu = gpu,
	};

	return target_create(out, &params);
}

/* A case that cannot be is left out and said; the others go on. */
static int measure(struct bench_scene *s)
{
	for (size_t i = 0; i < s->cases.count; i++) {
		const struct bench_case *c = &s->cases.items[i];
		int result;

		if (isatty(STDERR_FILENO) == 1)
			fprintf(stderr, "\r  %s %s%*s\r", bench_method_name(c->gi.method), c->label, 40, "");
		result = bench_measure(&s->results[s->result_count], &s->view, c);
		if (result == GR_OK) {
			s->result_count++;
			continue;
		}
		fprintf(stderr, "%s: %s %s: %s: left out\n", s->name, bench_method_name(c->gi.method),
			c->label, gr_result_name(result));
		if (result == GR_ERR_NOMEM || i == 0)
			return result;
	}
	return GR_OK;
}

static int write_plot(const struct bench_report *report, const struct bench_options *options)
{
	char path[1100];
	FILE *file;
	int result;

	snprintf(path, sizeof path, "%s/%s.svg", options->out, report->scene);
	file = fopen(options->svg ? options->svg : path, "w");
	if (!file) {
		fprintf(stderr, "%s: %s\n", options->svg ? options->svg : path, strerror(errno));
		return GR_ERR_IO;
	}
	result = bench_report_plot(file, report);
	if (fclose(file) != 0)
		result = GR_ERR_IO;
	return result;
}

static int report(const struct bench_scene *s, const struct bench_options *options,
		  struct json_object *json)
{
	const struct bench_report report = {
		.scene = s->name, .path = s->file->path, .renderer = target_renderer_name(s->view.target),
		.view = &s->view, .point_samples = options->samples * BENCH_POINT_SAMPLES,
		.picture_samples = options->samples, .results = s->results, .count = s->result_count,
	};
	struct json_object *one = bench_report_json(&report);

	if (!one)
		return GR_ERR_NOMEM;
	json_object_array_add(json, one);
	bench_report_table(stdout, &report);
	if (options->fit)
		bench_report_fit(stdout, &report);
	fflush(stdout);
	return write_plot(&report, options);
}

static int bench_scene(const struct bench_options *options, const char *path, struct json_object *json)
{
	struct bench_scene *s = calloc(1, sizeof *s);
	int result = s ? prepare(s, options, path) : GR_ERR_NOMEM;

	if (result == GR_OK)
		result = open_target(&s->view.target, &s->view, options->gpu);
	if (result == GR_OK)
		result = measure(s);
	if (result == GR_OK)
		result = report(s, options, json);
	if (s) {
		target_destroy(&s->view.target);
		finish_scene(s);
	}
	free(s);
	return result;
}

static int write_json(const struct bench_options *options, struct json_object *json)
{
	char path[1100];
	const char *name = options->json;

	if (!name) {
		snprintf(path, sizeof path, "%s/bench.json", options->out);
		name = path;
	}
	if (json_object_to_file_ext(name, json, JSON_C_TO_STRING_PRETTY | JSON_C_TO_STRING_SPACED) == 0)
		return GR_OK;
	fprintf(stderr, "%s: cannot be written: %s\n", name, strerror(errno));
	return GR_ERR_IO;
}

int bench_scenes(const struct bench_options *options, char *const *paths, size_t count)
{
	struct json_object *json;
	int result = GR_OK;

	if (options->svg && count > 1) {
		fprintf(stderr, "--svg names one file: give one SCENE, or look for SCENE.svg in --out\n");
		return GR_ERR_CONFIG;
	}
	if (sodium_init() < 0)
		return GR_ERR_UNSUPPORTED;
	if (mkdir(options->out, 0777) != 0 && errno != EEXIST) {
		fprintf(stderr, "%s: %s\n", options->out, strerror(errno));
		return GR_ERR_CONFIG;
	}
	json = json_object_new_array();
	for (size_t i = 0; i < count && json && result == GR_OK; i++) {
		if (i > 0)
			printf("\n");
		result = bench_scene(options, paths[i], json);
	}
	if (result == GR_OK)
		result = json ? write_json(options, json) : GR_ERR_NOMEM;
	json_object_put(json);
	return result;
}
