/* grotto render SCENE: one still, without daemons. */
#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "config/scene_file.h"
#include "renderer/renderer.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/load.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A frame that takes longer than this on any machine hangs. */
#define FRAME_PATIENCE_NS INT64_C(600000000000)

struct render_options {
	const char *camera, *out;
	int size[2]; /* 0: the camera's */
	int frame;
	int gpu;
	bool indirect;
};

struct still {
	struct scene_file *file;
	struct scene *scene;
	struct target *target;
	struct renderer *renderer;
	struct scene_camera camera;
	bool exr;
};

static void still_finish(struct still *still)
{
	renderer_destroy(&still->renderer);
	target_destroy(&still->target);
	scene_destroy(&still->scene);
	scene_file_destroy(&still->file);
}

static bool ends_with(const char *text, const char *end)
{
	size_t n = strlen(text), m = strlen(end);

	return n > m && strcmp(text + n - m, end) == 0;
}

static int choose_camera(struct still *still, const char *name)
{
	int index = 0;

	if (still->file->camera_count == 0) {
		fprintf(stderr, "%s: has no camera: add one to its cameras\n", still->file->path);
		return GR_ERR_CONFIG;
	}
	if (name)
		index = scene_file_find_camera(still->file, name);
	if (index < 0) {
		fprintf(stderr, "%s: has no camera '%s'; it has", still->file->path, name);
		for (size_t i = 0; i < still->file->camera_count; i++)
			fprintf(stderr, " '%s'", still->file->cameras[i].name);
		fprintf(stderr, "\n");
		return GR_ERR_CONFIG;
	}
	still->camera = still->file->cameras[index];
	return GR_OK;
}

static int load(struct still *still, const char *path, const struct render_options *options)
{
	int result = load_scene(path, &still->file, &still->scene);

	if (result == GR_OK)
		result = choose_camera(still, options->camera);
	if (result == GR_OK && options->size[0] > 0)
		memcpy(still->camera.pixels, options->size, sizeof options->size);
	return result;
}

static int open_renderer(struct still *still, const struct render_options *options)
{
	struct target_params target = {
		.kind = TARGET_HEADLESS,
		.title = "grotto render",
		.width = still->camera.pixels[0],
		.height = still->camera.pixels[1],
		.gpu = options->gpu,
	};
	struct renderer_params params = {
		.width = still->camera.pixels[0],
		.height = still->camera.pixels[1],
		.eyes = RENDERER_MONO,
		.keep_radiance = still->exr,
	};
	int result = target_create(&still->target, &target);

	if (result != GR_OK)
		return result;
	return renderer_create(&still->renderer, still->target, &params, still->file,
			       still->scene);
}

static int draw(struct still *still, int frames)
{
	struct render_frame frame;

	render_frame_init(&frame, still->file);
	for (int i = 1; i <= frames; i++) {
		int result;

		frame.frame = (uint64_t)i;
		result = renderer_draw_camera(still->renderer, &frame, &still->camera);
		if (result != GR_OK)
			return result;
		result = renderer_finished(still->renderer, FRAME_PATIENCE_NS);
		if (result != GR_OK)
			return result == GR_NOTHING ? GR_ERR_TIMEOUT : result;
		timers_frame(renderer_timers(still->renderer));
	}
	return GR_OK;
}

static int save_exr(struct still *still, const struct render_options *options)
{
	struct image image = { 0 };
	int result = options->indirect ? renderer_read_indirect(still->renderer, 0, &image)
				       : renderer_read_radiance(still->renderer, 0, &image);

	if (result == GR_OK)
		result = image_write_exr(options->out, &image, NULL);
	image_finish(&image);
	return result;
}

static int save_png(struct still *still, const char *path)
{
	int width, height;
	uint8_t *rgb;
	int result;

	target_size(still->target, &width, &height);
	rgb = malloc((size_t)width * (size_t)height * 3);
	if (!rgb)
		return GR_ERR_NOMEM;
	result = renderer_read_rgb(still->renderer, rgb);
	if (result == GR_OK)
		result = image_write_png(path, width, height, rgb);
	free(rgb);
	return result;
}

static void print_stages(struct still *still)
{
	struct renderer_stats stats;

	printf("%s (%s)\n", target_renderer_name(still->target),
	       target_platform_name(still->target));
	for (int i = 0; i < TIMER_STAGES; i++) {
		struct timer_stats stage;

		timers_stats(renderer_timers(still->renderer), i, &stage);
		if (stage.name && stage.count > 0)
			printf("  %-16s %9.3f ms (mean of %llu)\n", stage.name, stage.mean_ms,
			       (unsigned long long)stage.count);
	}
	renderer_stats(still->renderer, &stats);
	if (stats.gl_errors || stats.nonfinite)
		fprintf(stderr, "warning: %llu GL errors, %llu values not finite\n",
			(unsigned long long)stats.gl_errors, (unsigned long long)stats.nonfinite);
}

static int render(struct still *still, const char *path, const struct render_options *options)
{
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	int result;

	still->exr = ends_with(options->out, ".exr");
	result = load(still, path, options);
	if (result == GR_OK)
		result = open_renderer(still, options);
	if (result == GR_OK)
		result = draw(still, options->frame);
	if (result == GR_OK)
		result = still->exr ? save_exr(still, options) : save_png(still, options->out);
	if (result == GR_OK) {
		print_stages(still);
		printf("%s: %dx%d, %d frame%s in %.3f s with loading\n", options->out,
		       still->camera.pixels[0], still->camera.pixels[1], options->frame,
		       options->frame == 1 ? "" : "s",
		       (double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9);
	} else {
		fprintf(stderr, "grotto render: %s: %s\n", path, gr_result_name(result));
	}
	return result;
}

int command_render(int argc, char **argv)
{
	struct render_options o = { .frame = 1, .gpu = -1 };
	const struct cli_option options[] = {
		{ "camera", 'c', CLI_TEXT, &o.camera, 0, 0, "NAME",
		  "a camera of the scene file (the first)" },
		{ "out", 'o', CLI_TEXT, &o.out, 0, 0, "FILE",
		  ".exr: scene-linear radiance; .png: as shown" },
		{ "size", 's', CLI_SIZE, o.size, 1, 16384, "WxH", "pixels (the camera's)" },
		{ "frame", 'f', CLI_INT, &o.frame, 1, 1000000, "N",
		  "draw N frames, keep the last (1)" },
		{ "indirect", 0, CLI_FLAG, &o.indirect, 0, 0, NULL,
		  "the indirect light alone (.exr)" },
		{ "gpu", 0, CLI_INT, &o.gpu, -1, 64, "N",
		  "EGL device, -1: the first that works (-1)" },
	};
	const struct cli_table table = {
		"grotto render SCENE [--camera NAME] -o FILE.exr|FILE.png",
		"Draws one still of a scene without daemons and prints the time of each stage.\n"
		"Lamps are where the scene file starts them.",
		options, sizeof options / sizeof options[0]
	};
	struct still still = { 0 };
	int words;
	int result;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (words != 1 || !o.out || !(ends_with(o.out, ".exr") || ends_with(o.out, ".png"))) {
		fprintf(stderr, "grotto render: needs one SCENE and -o FILE.exr or FILE.png\n");
		return GR_EXIT_CONFIG;
	}
	if (o.indirect && !ends_with(o.out, ".exr")) {
		fprintf(stderr, "grotto render: --indirect is radiance: give -o FILE.exr\n");
		return GR_EXIT_CONFIG;
	}
	result = render(&still, argv[1], &o);
	still_finish(&still);
	if (result == GR_OK)
		return GR_EXIT_OK;
	return result == GR_ERR_CONFIG ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
}
