#include "tools/bench/packing.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/renderer.h"
#include "tools/bench/measure.h"
#include "tools/bench/motion.h"
#include "tools/load.h"

#include <stdio.h>
#include <stdlib.h>

#define PIXELS 32 /* a side; the light does not depend on them */
#define PATIENCE_NS INT64_C(600000000000)

struct light {
	struct scene_file *file;
	struct scene *scene;
	struct target *target;
	struct renderer *renderer;
	uint8_t *slice;
	size_t size;
};

static bool open_light(struct light *l, const char *path, unsigned nodes)
{
	const struct target_params target = {
		.kind = TARGET_HEADLESS, .title = "bench-packing", .width = PIXELS, .height = PIXELS,
	};
	const struct renderer_params params = {
		.width = PIXELS, .height = PIXELS, .eyes = RENDERER_MONO, .quiet = true,
	};

	if (load_scene(path, &l->file, &l->scene) != GR_OK || target_create(&l->target, &target) != GR_OK ||
	    renderer_create(&l->renderer, l->target, &params, l->file, l->scene) != GR_OK)
		return false;
	l->size = renderer_share_bytes(l->renderer, nodes);
	l->slice = l->size ? malloc(l->size) : NULL;
	if (!l->slice || !l->file->camera_count || renderer_share_set(l->renderer, 0, nodes) < 0) {
		fprintf(stderr, "bench-packing: %s: its light cannot be shared, or it has no camera\n", path);
		return false;
	}
	return true;
}

static void close_light(struct light *l)
{
	free(l->slice);
	renderer_destroy(&l->renderer);
	target_destroy(&l->target);
	scene_destroy(&l->scene);
	scene_file_destroy(&l->file);
}

bool packing_light(const char *scene, unsigned nodes, unsigned frames, packing_keep_fn *keep, void *ctx)
{
	struct light l = { 0 };
	bool ok = open_light(&l, scene, nodes);
	struct bench_motion motion;
	struct scene_camera camera;

	if (ok) {
		bench_motion_init(&motion, l.file);
		camera = l.file->cameras[0];
		camera.pixels[0] = camera.pixels[1] = PIXELS;
	}
	for (unsigned i = 1; ok && i <= frames; i++) {
		struct render_frame frame;
		size_t len = 0;

		bench_motion_frame(&motion, (double)i, &frame);
		frame.frame = i;
		ok = renderer_draw_camera(l.renderer, &frame, &camera) == GR_OK &&
		     renderer_finished(l.renderer, PATIENCE_NS) == GR_OK &&
		     renderer_share_take(l.renderer, l.slice, l.size, &len) >= GR_OK &&
		     (!len || keep(ctx, l.slice, len));
	}
	close_light(&l);
	return ok;
}
