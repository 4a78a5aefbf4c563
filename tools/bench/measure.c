#include "tools/bench/measure.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/gi.h"
#include "tools/bench/motion.h"
#include "tools/bench/picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PATIENCE_NS INT64_C(600000000000)
#define WARM_UP 8       /* frames of motion that are not counted */
#define STILL_FRAMES 96 /* within which work must stop */
/* The truth counts as dark below this share of its mean. */
#define DARK 1e-6
#define DARK_LEAST 10 /* points, for a leak to be told */

struct run {
	const struct bench_view *view;
	struct scene_file file; /* with the case's gi; all else borrowed */
	struct renderer *renderer;
	struct bench_motion motion;
	struct render_frame frame;
	uint64_t number, epoch;
	float (*settled)[3]; /* steady light at the points */
	float (*found)[3];
};

/* One frame as a node draws it: submitted, then waited for. */
static int draw(struct run *run)
{
	int result;

	run->frame.frame = ++run->number;
	run->frame.gi_epoch = run->epoch;
	run->frame.gi_on = run->file.gi.method != SCENE_GI_NONE;
	result = renderer_draw_camera(run->renderer, &run->frame, &run->view->camera);
	if (result != GR_OK)
		return result < 0 ? result : GR_ERR_STATE;
	result = renderer_finished(run->renderer, PATIENCE_NS);
	return result == GR_NOTHING ? GR_ERR_TIMEOUT : result;
}

static int look(struct run *run, float (*out)[3])
{
	return renderer_read_irradiance(run->renderer, run->view->points->points,
					run->view->points->count, out);
}

static int open_run(struct run *run, struct bench_result *out)
{
	const struct renderer_params params = {
		.width = run->view->camera.pixels[0],
		.height = run->view->camera.pixels[1],
		.eyes = RENDERER_MONO,
		.keep_radiance = true,
	};
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	size_t count = run->view->points->count + 1;
	int result;

	run->found = calloc(count, sizeof *run->found);
	run->settled = calloc(count, sizeof *run->settled);
	if (!run->found || !run->settled)
		return GR_ERR_NOMEM;
	result = renderer_create(&run->renderer, run->view->target, &params, &run->file,
				 run->view->scene);
	if (result == GR_OK)
		out->surfels = renderer_surfels(run->renderer);
	out->create_s = (double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9;
	return result;
}

/* Mean found where the truth is dark over the mean truth where it is not. */
static double leak_of(const float (*found)[3], const struct bench_truth *truth, double mean)
{
	double dark = 0, lit = 0;
	size_t dark_count = 0;

	for (size_t k = 0; k < truth->count; k++) {
		double t = (truth->irradiance[k][0] + truth->irradiance[k][1] + truth->irradiance[k][2]) / 3;

		if (t > DARK * mean) {
			lit += t;
			continue;
		}
		dark += (double)(found[k][0] + found[k][1] + found[k][2]) / 3;
		dark_count++;
	}
	if (dark_count < DARK_LEAST || dark_count == truth->count)
		return NAN;
	return dark / (double)dark_count / (lit / (double)(truth->count - dark_count));
}

static int compare_points(struct run *run, struct bench_result *out)
{
	const struct bench_truth *truth = run->view->truth;
	double *scratch = calloc(truth->count + 1, sizeof *scratch);
	int result = scratch ? GR_OK : GR_ERR_NOMEM;

	if (result == GR_OK)
		result = stats_compare(&run->settled[0][0], &truth->irradiance[0][0], NULL, truth->count, 3,
				       scratch, &out->irradiance);
	free(scratch);
	/* the truth's noise is no error of the method's: independent, so squares add */
	out->nrmse_raw = out->irradiance.nrmse;
	if (result == GR_OK && truth->noise > 0)
		out->irradiance.nrmse = sqrt(fmax(out->nrmse_raw * out->nrmse_raw -
						  truth->noise * truth->noise, 0));
	out->leak = result == GR_OK ? leak_of((const float(*)[3])run->settled, truth,
					      out->irradiance.mean) : (double)NAN;
	return result < 0 ? result : GR_OK;
}

static int compare_pictures(struct run *run, struct bench_result *out)
{
	const struct bench_truth *truth = run->view->truth;
	const struct bench_picture_error unknown = { .ssim = NAN, .flip = NAN,
						     .blocks = { .bias = NAN, .nrmse = NAN, .p95 = NAN } };
	struct image image = { 0 };
	int result = renderer_read_radiance(run->renderer, 0, &image);

	out->total = out->indirect = unknown;
	if (result == GR_OK && truth->radiance.data)
		result = bench_picture_compare(&image, &truth->radiance, &run->file.tone, &out->total);
	image_finish(&image);
	if (result != GR_OK || !truth->indirect.data)
		return result;
	result = renderer_read_indirect(run->renderer, 0, &image);
	if (result == GR_OK)
		result = bench_picture_compare(&image, &truth->indirect, &run->file.tone, &out->indirect);
	image_finish(&image);
	return result;
}

/* The steady state at rest against the truth, and that work stops then. */
static int measure_rest(struct run *run, struct bench_result *out)
{
	struct gi_stats stats = { 0 };
	int result;

	bench_motion_frame(&run->motion, 0, &run->frame);
	run->epoch++;
	result = draw(run);
	if (result == GR_OK)
		result = look(run, run->settled);
	if (result == GR_OK)
		result = compare_points(run, out);
	if (result == GR_OK)
		result = compare_pictures(run, out);
	out->still_frames = -1;
	for (int i = 0; i < STILL_FRAMES && result == GR_OK && out->still_frames < 0; i++) {
		result = draw(run);
		if (!renderer_gi_stats(run->renderer, &stats) || !stats.ran)
			out->still_frames = i;
	}
	out->gpu_bytes = stats.gpu_bytes;
	return result;
}

static void take_stages(struct run *run, struct bench_result *out)
{
	double ms[TIMER_WINDOW];

	out->frame_ms = 0;
	for (int i = 0; i < TIMER_STAGES; i++) {
		struct timer_stats stats;
		size_t count = timers_window(renderer_timers(run->renderer), i, ms);

		timers_stats(renderer_timers(run->renderer), i, &stats);
		if (!count || !stats.name)
			continue;
		out->stages[i].name = stats.name;
		out->stages[i].ms = stats_spread(ms, count);
		out->frame_ms += out->stages[i].ms.median;
	}
}

/* Where the lamp is in frame i of a ride through its place. */
static double place_of(const struct run *run, int i)
{
	return i - WARM_UP - run->view->frames / 2;
}

static int measure_cost(struct run *run, struct bench_result *out)
{
	struct timers *timers = renderer_timers(run->renderer);
	int result = GR_OK;

	for (int i = 0; i < WARM_UP + run->view->frames && result == GR_OK; i++) {
		if (i == WARM_UP)
			timers_reset(timers);
		bench_motion_frame(&run->motion, place_of(run, i), &run->frame);
		result = draw(run);
		timers_frame(timers);
	}
	/* the last ones may still be on their way */
	for (int i = 0; i < 8; i++)
		timers_frame(timers);
	take_stages(run, out);
	return result;
}

/* The same ride again, looked at in every frame. */
static int measure_flicker(struct run *run, struct bench_result *out)
{
	size_t count = 3 * run->view->points->count;
	size_t frames = (size_t)run->view->frames;
	float *series = calloc(frames * count + 1, sizeof *series);
	int result = series ? GR_OK : GR_ERR_NOMEM;

	for (int i = 0; i < WARM_UP + run->view->frames && result == GR_OK; i++) {
		bench_motion_frame(&run->motion, place_of(run, i), &run->frame);
		if (i == 0)
			run->epoch++;
		result = draw(run);
		if (result == GR_OK && i >= WARM_UP)
			result = look(run, (float(*)[3])(void *)(series + (size_t)(i - WARM_UP) * count));
	}
	if (result == GR_OK)
		out->flicker = stats_flicker(series, frames, count);
	free(series);
	return result;
}

/* From darkness, by the ordinary way of frames, to where a restart gets at once. */
static int measure_switch(struct run *run, struct bench_result *out)
{
	const size_t count = run->view->points->count;
	double errors[BENCH_SWITCH_FRAMES], *truth = calloc(3 * count + 1, sizeof *truth);
	double *scratch = calloc(count + 1, sizeof *scratch);
	int result = truth && scratch ? GR_OK : GR_ERR_NOMEM;
	size_t frames = 0;

	for (size_t k = 0; result == GR_OK && k < count; k++)
		for (size_t c = 0; c < 3; c++)
			truth[3 * k + c] = (double)run->settled[k][c];
	if (result == GR_OK) {
		bench_motion_dark(&run->motion, &run->frame);
		run->epoch++;
		result = draw(run);
	}
	bench_motion_frame(&run->motion, 0, &run->frame);
	while (result == GR_OK && frames < BENCH_SWITCH_FRAMES) {
		struct stats_error error;

		result = draw(run);
		if (result == GR_OK)
			result = look(run, run->found);
		if (result == GR_OK)
			stats_compare(&run->found[0][0], truth, NULL, count, 3, scratch, &error);
		if (result == GR_OK)
			errors[frames++] = error.nrmse;
		/* it stays there: three frames within half of the narrower bound are enough */
		if (frames >= 3 && errors[frames - 1] < 0.005 && errors[frames - 2] < 0.005 &&
		    errors[frames - 3] < 0.005)
			break;
	}
	out->frames_to_10 = stats_frames_within(errors, frames, 0.1);
	out->frames_to_1 = stats_frames_within(errors, frames, 0.01);
	free(truth);
	free(scratch);
	return result;
}

static int measure_all(struct run *run, struct bench_result *out)
{
	bool light = run->file.gi.method != SCENE_GI_NONE;
	int result = open_run(run, out);

	if (result == GR_OK)
		result = measure_rest(run, out);
	if (result == GR_OK)
		result = measure_cost(run, out);
	if (result == GR_OK && light && out->moves && run->view->points->count)
		result = measure_flicker(run, out);
	if (result == GR_OK && light && out->moves && run->view->points->count)
		result = measure_switch(run, out);
	return result;
}

int bench_measure(struct bench_result *out, const struct bench_view *view,
		  const struct bench_case *c)
{
	struct run run = { .view = view, .file = *view->file };
	struct renderer_stats stats;
	int result;

	*out = (struct bench_result){ .used = *c, .flicker = { NAN, NAN }, .leak = NAN };
	run.file.gi = c->gi;
	run.file.path = NULL; /* nothing baked is kept or taken: baking is measured, too */
	bench_motion_init(&run.motion, &run.file);
	out->moves = run.motion.lamp >= 0;
	result = measure_all(&run, out);
	if (run.renderer) {
		renderer_stats(run.renderer, &stats);
		out->nonfinite = stats.nonfinite;
		out->gl_errors = stats.gl_errors;
	}
	renderer_destroy(&run.renderer);
	free(run.found);
	free(run.settled);
	return result;
}
