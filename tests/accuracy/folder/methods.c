#include "tests/accuracy/folder/methods.h"

#include "base/clock.h"
#include "base/result.h"
#include "renderer/gi/gi.h"
#include "renderer/image/compare.h"
#include "renderer/renderer.h"
#include "renderer/trace/reference.h"

#include <string.h>

/* Largest side that is drawn. */
#define MOST_SIDE 2048
#define MOST_FRAMES 400
#define FRAME_PATIENCE_NS INT64_C(600000000000)

const struct method methods[] = {
	{ "lpv", SCENE_GI_LPV },
	{ "surfels", SCENE_GI_SURFELS },
	{ "probes", SCENE_GI_PROBES },
	{ NULL, SCENE_GI_NONE },
};

void made_finish(struct made *made)
{
	image_finish(&made->picture);
	image_finish(&made->indirect);
	image_finish(&made->error);
	image_finish(&made->indirect_error);
}

const char *method_unsuited(const struct folder *folder, enum scene_gi_method method)
{
	if (method == SCENE_GI_LPV && folder->surrounded)
		return "takes no light of an environment";
	if (method == SCENE_GI_LPV && !folder->scene->emissive && folder->file->lamp_count == 0)
		return "there is no lamp and nothing emits";
	return NULL;
}

int reference_make(const struct folder *folder, size_t camera, int coarse, int samples, int threads,
		   struct made *out)
{
	const struct reference_params params = { .seed = 1, .samples = samples,
						 .max_bounces = folder->max_bounces,
						 .threads = threads };
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	struct reference_film film = { 0 };
	struct reference *reference = NULL;
	struct reference_view view = { 0 };
	struct render_frame frame;
	int result;

	memset(out, 0, sizeof *out);
	render_frame_init(&frame, folder->file);
	result = reference_create(&reference, folder->scene, folder->file, &frame);
	if (result == GR_OK)
		result = reference_view_camera(&folder->file->cameras[camera], &view);
	view.width /= coarse;
	view.height /= coarse;
	if (result == GR_OK)
		result = reference_render(reference, &view, &params, &film);
	if (result == GR_OK)
		result = reference_film_images(&film, &out->picture, &out->error, &out->indirect);
	if (result == GR_OK)
		result = reference_film_indirect_error(&film, &out->indirect_error);
	out->nonfinite = film.nonfinite;
	out->seconds = (double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9;
	reference_film_finish(&film);
	reference_destroy(&reference);
	if (result != GR_OK)
		made_finish(out);
	return result;
}

static int longest_side(const struct folder *folder)
{
	return folder->width > folder->height ? folder->width : folder->height;
}

/* Our pixels along a side of one of theirs. */
static int oversampling(const struct folder *folder)
{
	int most = MOST_SIDE / longest_side(folder);

	return most < 1 ? 1 : most > 4 ? 4 : most;
}

int method_target_side(const struct folder *folder)
{
	return oversampling(folder) * longest_side(folder);
}

static int draw_until_steady(struct renderer *r, const struct folder *folder, size_t camera)
{
	struct render_frame frame;
	struct gi_stats stats = { 0 };

	render_frame_init(&frame, folder->file);
	for (int i = 1; i <= MOST_FRAMES && !stats.steady; i++) {
		int result;

		frame.frame = (uint64_t)i;
		result = renderer_draw_camera(r, &frame, &folder->file->cameras[camera]);
		if (result != GR_OK)
			return result;
		result = renderer_finished(r, FRAME_PATIENCE_NS);
		if (result != GR_OK)
			return result == GR_NOTHING ? GR_ERR_TIMEOUT : result;
		if (!renderer_gi_stats(r, &stats))
			break;
	}
	return GR_OK;
}

/* From points to means over pixels. */
static int read_means(struct renderer *r, int (*read)(struct renderer *, int, struct image *),
		      int side, struct image *out)
{
	struct image points = { 0 };
	int result = read(r, 0, &points);

	if (result == GR_OK)
		result = compare_block_means(&points, NULL, side, out);
	image_finish(&points);
	return result;
}

int method_make(struct folder *folder, size_t camera, enum scene_gi_method method,
		struct target *target, struct made *out)
{
	const int side = oversampling(folder);
	const struct renderer_params params = {
		.width = side * folder->width,
		.height = side * folder->height,
		.eyes = RENDERER_MONO,
		.keep_radiance = true,
	};
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	struct renderer *r = NULL;
	struct renderer_stats stats;
	int result;

	memset(out, 0, sizeof *out);
	folder->file->gi.method = method;
	result = renderer_create(&r, target, &params, folder->file, folder->scene);
	if (result == GR_OK)
		result = draw_until_steady(r, folder, camera);
	if (result == GR_OK)
		result = read_means(r, renderer_read_radiance, side, &out->picture);
	if (result == GR_OK)
		result = read_means(r, renderer_read_indirect, side, &out->indirect);
	if (r) {
		renderer_stats(r, &stats);
		out->nonfinite = stats.nonfinite;
	}
	out->seconds = (double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9;
	renderer_destroy(&r);
	if (result != GR_OK)
		made_finish(out);
	return result;
}
