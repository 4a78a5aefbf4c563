#include "renderer/calibrate.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "renderer/calibrate_room.h"
#include "renderer/gi/costs_file.h"
#include "renderer/renderer_private.h"

#include <config.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PIXELS 16
#define FRAMES 9     /* timed; the first also waits for the driver's compiler and is left out */
#define STEP_M 0.008f
#define WAIT_MS 15000 /* for another process that measures */
#define PATIENCE_NS INT64_C(10000000000)

/*
 * In the order in which they are wanted. Surfels: links from the number of
 * gathers, taps from their own; two lattices part the frame from the step.
 */
enum part { SURFELS, SURFELS_GATHERS, SURFELS_TAPS, LATTICE_LARGE, LATTICE_SMALL, PARTS };

static void settings_of(enum part part, struct scene_gi *gi)
{
	gi->method = part >= LATTICE_LARGE ? SCENE_GI_LPV : SCENE_GI_SURFELS;
	switch (part) {
	case LATTICE_SMALL: gi->lattice = 8; break;
	case LATTICE_LARGE: gi->lattice = 20; break;
	case SURFELS_GATHERS: gi->gathers = 5; break;
	case SURFELS_TAPS:
		gi->taps = 64;
		gi->links = 16;
		break;
	case SURFELS:
	case PARTS: break;
	}
}

/* The least that the light's stage takes, nanoseconds: other work on the machine can only add. */
static int time_frames(struct renderer *renderer, const struct scene_file *file, double *out_ns)
{
	const struct scene_camera camera = {
		.position = { 0.5f, 1.7f, 0.5f }, .target = { 3, 1, 3 }, .up = { 0, 1, 0 },
		.vfov_rad = 1, .pixels = { PIXELS, PIXELS },
	};
	double ms[TIMER_WINDOW];
	struct render_frame frame;
	size_t count;

	render_frame_init(&frame, file);
	for (int i = 0; i <= FRAMES; i++) {
		int result;

		frame.frame = (uint64_t)i + 1;
		frame.lamps[0].position[0] += STEP_M;
		if (i == 1)
			timers_reset(renderer->timers);
		result = renderer_draw_camera(renderer, &frame, &camera);
		if (result == GR_OK)
			result = renderer_finished(renderer, PATIENCE_NS);
		if (result != GR_OK)
			return result < 0 ? result : GR_ERR_TIMEOUT;
		timers_frame(renderer->timers);
	}
	count = timers_window(renderer->timers, STAGE_GI, ms);
	if (!count)
		return GR_ERR_UNSUPPORTED;
	*out_ns = ms[0] * 1e6;
	for (size_t i = 1; i < count; i++)
		*out_ns = fmin(*out_ns, ms[i] * 1e6);
	return GR_OK;
}

static int measure(enum part part, struct target *target, const struct scene *scene, double *out_ns)
{
	const struct renderer_params params = { .width = PIXELS, .height = PIXELS, .eyes = RENDERER_MONO,
						.quiet = true };
	struct renderer *renderer;
	struct scene_lamp lamp;
	struct scene_file file;
	int result;

	calibrate_room_file(&file, &lamp);
	settings_of(part, &file.gi);
	result = renderer_create(&renderer, target, &params, &file, scene);
	if (result != GR_OK)
		return result;
	result = time_frames(renderer, &file, out_ns);
	renderer_destroy(&renderer);
	return result;
}

/*
 * From times to units. A difference that noise made too small counts as a
 * twentieth of the whole: so nothing is free.
 */
static double per_unit(double more, double less, double units)
{
	return fmax(more - less, 0.05 * more) / units;
}

/* What this GPU takes for a part over what the usual one does. */
static double pace_of(enum part part, const struct gi_facts *facts, double ns)
{
	struct scene_lamp lamp;
	struct scene_file file;

	calibrate_room_file(&file, &lamp);
	settings_of(part, &file.gi);
	return ns * 1e-6 / gi_plan_cost_ms(facts, &file.gi, &gi_costs_usual);
}

static void solve_surfels(struct gi_costs *out, const double ns[PARTS], double surfels)
{
	double taps;

	out->surfel_link = per_unit(ns[SURFELS_GATHERS], ns[SURFELS], surfels * 256 * 4);
	/* 48 taps more and 240 links fewer */
	taps = ns[SURFELS_TAPS] + surfels * 240 * out->surfel_link;
	out->surfel_tap = per_unit(taps, ns[SURFELS], surfels * 48);
	out->surfel_frame = fmax(0, ns[SURFELS] - surfels * (256 * out->surfel_link + 16 * out->surfel_tap));
}

static void solve_lattice(struct gi_costs *out, const double ns[PARTS])
{
	const double small = 8 * 8 * 8 * 8, large = 20 * 20 * 20 * 8;

	out->lattice_cell_step = per_unit(ns[LATTICE_LARGE], ns[LATTICE_SMALL], large - small);
	out->lattice_frame = fmax(0, ns[LATTICE_SMALL] - small * out->lattice_cell_step);
}

/* What there was no time for is as the usual GPU's, at the pace of the first part. */
static void solve(struct gi_costs *out, const double ns[PARTS], int parts, const struct gi_facts *facts)
{
	double pace = pace_of(SURFELS, facts, ns[SURFELS]);
	struct scene_lamp lamp;
	struct scene_file file;

	*out = gi_costs_usual;
	out->surfel_frame *= pace;
	out->surfel_link *= pace;
	out->surfel_tap *= pace;
	out->lattice_frame *= pace;
	out->lattice_cell_step *= pace;
	calibrate_room_file(&file, &lamp);
	if (parts > SURFELS_TAPS)
		solve_surfels(out, ns, gi_plan_surfels(facts, &file.gi));
	if (parts > LATTICE_SMALL)
		solve_lattice(out, ns);
}

int calibrate(struct gi_costs *out, struct target *target)
{
	int64_t start = gr_clock_now(&gr_clock_monotonic), spent = 0;
	struct scene_lamp lamp;
	struct scene_file file;
	struct scene *scene;
	struct gi_facts facts;
	double ns[PARTS] = { 0 };
	int part = 0, result = calibrate_room(&scene);

	for (; part < PARTS && result == GR_OK && (double)spent < CALIBRATE_SECONDS * 1e9; part++) {
		result = measure((enum part)part, target, scene, &ns[part]);
		spent = gr_clock_now(&gr_clock_monotonic) - start;
		if (result == GR_OK)
			gr_debug("calibration: part %d takes %.4g ms, after %.2f s", part, ns[part] * 1e-6,
				 (double)spent * 1e-9);
	}
	if (result == GR_OK) {
		calibrate_room_file(&file, &lamp);
		gi_facts_take(&facts, scene, &file);
		solve(out, ns, part, &facts);
		result = gi_costs_valid(out) ? GR_OK : GR_ERR_RANGE;
	}
	scene_destroy(&scene);
	return result;
}

/* Whom the figures are of. */
static void name_device(char name[COSTS_DEVICE_MAX], const struct target *target)
{
	const char *version = (const char *)glGetString(GL_VERSION);

	snprintf(name, COSTS_DEVICE_MAX, "%s, OpenGL %s, grotto %s", target_renderer_name(target),
		 version ? version : "?", PACKAGE_VERSION);
}

static bool load(struct gi_costs *out, const char *path, const char *device)
{
	const char *why;
	int result = gi_costs_load(path, device, out, &why);

	if (result != GR_OK && result != GR_NOTHING)
		gr_notice("%s: %s: measured anew", path, why);
	return result == GR_OK;
}

static void measure_kept(struct gi_costs *out, struct target *target, const char *path,
			 const char *device, const char **out_from)
{
	int result = calibrate(out, target);

	if (result != GR_OK) {
		gr_warning("what light costs on this GPU cannot be measured (%s): planned with usual costs",
			   gr_result_name(result));
		*out = gi_costs_usual;
		*out_from = "usual costs";
		return;
	}
	*out_from = "costs measured now";
	if (!path)
		gr_notice("no folder for a cache: what light costs is measured at every start");
	else if (gi_costs_save(path, device, out) != GR_OK)
		gr_notice("%s: %s: what light costs is measured at every start", path, strerror(errno));
}

void calibrate_kept(struct gi_costs *out, struct target *target, const char **out_from)
{
	char device[COSTS_DEVICE_MAX];
	char *folder = gi_costs_folder(), *path = NULL;
	int lock;

	name_device(device, target);
	if (folder)
		path = gi_costs_path(folder, device);
	*out_from = "costs kept from before";
	if (!path || !load(out, path, device)) {
		lock = path ? gi_costs_lock(path, WAIT_MS) : -1;
		/* another process may have been faster */
		if (lock < 0 || !load(out, path, device))
			measure_kept(out, target, path, device, out_from);
		gi_costs_unlock(lock);
	}
	free(path);
	free(folder);
}
