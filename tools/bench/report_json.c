#include "tools/bench/report.h"

#include <math.h>

/* What JSON cannot say (NaN) is null. */
static void number(struct json_object *to, const char *key, double value)
{
	json_object_object_add(to, key, isfinite(value) ? json_object_new_double(value) : NULL);
}

static void integer(struct json_object *to, const char *key, int64_t value)
{
	json_object_object_add(to, key, json_object_new_int64(value));
}

static void text(struct json_object *to, const char *key, const char *value)
{
	json_object_object_add(to, key, json_object_new_string(value));
}

static struct json_object *object(struct json_object *to, const char *key)
{
	struct json_object *made = json_object_new_object();

	json_object_object_add(to, key, made);
	return made;
}

static void error(struct json_object *to, const struct stats_error *e)
{
	number(to, "bias", e->bias);
	number(to, "nrmse", e->nrmse);
	number(to, "p95", e->p95);
	number(to, "mean_true", e->mean);
	integer(to, "count", (int64_t)e->count);
	integer(to, "nonfinite", (int64_t)e->nonfinite);
}

static void picture(struct json_object *to, const struct bench_picture_error *e)
{
	error(to, &e->blocks);
	number(to, "ssim", e->ssim);
	number(to, "flip", e->flip);
}

static void settings(struct json_object *to, const struct scene_gi *gi)
{
	if (gi->method == SCENE_GI_LPV) {
		text(to, "mode", gi->lpv_mode == SCENE_LPV_THESIS ? "thesis" : "repaired");
		integer(to, "lattice", gi->lattice);
		integer(to, "steps", gi->steps);
		integer(to, "rsm_pixels", gi->rsm_pixels);
		integer(to, "link_rays", gi->link_rays);
	} else if (gi->method == SCENE_GI_SURFELS || gi->method == SCENE_GI_PROBES) {
		number(to, "spacing_m", (double)gi->spacing_m);
		integer(to, "links", gi->links);
		integer(to, "gathers", gi->gathers);
		integer(to, "taps", gi->taps);
		integer(to, "probes", gi->probes);
	} else if (gi->method == SCENE_GI_AUTO) {
		number(to, "budget_ms", (double)gi->budget_ms);
	}
}

static void stages(struct json_object *to, const struct bench_result *r)
{
	for (int i = 0; i < TIMER_STAGES; i++) {
		struct json_object *stage;

		if (!r->stages[i].name)
			continue;
		stage = object(to, r->stages[i].name);
		number(stage, "median", r->stages[i].ms.median);
		number(stage, "p10", r->stages[i].ms.p10);
		number(stage, "p90", r->stages[i].ms.p90);
		integer(stage, "frames", (int64_t)r->stages[i].ms.count);
	}
}

static struct json_object *result(const struct bench_report *report, size_t i)
{
	const struct bench_result *r = &report->results[i];
	struct json_object *o = json_object_new_object();

	text(o, "method", bench_method_name(r->used.gi.method));
	text(o, "label", r->used.label);
	settings(object(o, "settings"), &r->used.gi);
	number(o, "create_s", r->create_s);
	integer(o, "gpu_bytes", (int64_t)r->gpu_bytes);
	integer(o, "surfels", (int64_t)r->surfels);
	stages(object(o, "stages_ms"), r);
	number(o, "frame_ms", r->frame_ms);
	number(o, "added_ms", bench_added_ms(report, i));
	integer(o, "still_frames", r->still_frames);
	error(object(o, "irradiance"), &r->irradiance);
	number(o, "irradiance_nrmse_with_noise", r->nrmse_raw);
	number(o, "leak", r->leak);
	picture(object(o, "picture"), &r->total);
	picture(object(o, "indirect_picture"), &r->indirect);
	number(o, "flicker_worst", r->flicker.worst);
	number(o, "flicker_mean", r->flicker.mean);
	integer(o, "frames_to_10_percent", (int64_t)r->frames_to_10);
	integer(o, "frames_to_1_percent", (int64_t)r->frames_to_1);
	integer(o, "nonfinite", (int64_t)r->nonfinite);
	integer(o, "gl_errors", (int64_t)r->gl_errors);
	return o;
}

struct json_object *bench_report_json(const struct bench_report *report)
{
	const struct bench_view *view = report->view;
	struct json_object *o = json_object_new_object(), *truth, *results = json_object_new_array();

	if (!o || !results) {
		json_object_put(o);
		json_object_put(results);
		return NULL;
	}
	text(o, "scene", report->scene);
	integer(o, "triangles", (int64_t)(view->scene->index_count / 3));
	text(o, "file", report->path);
	text(o, "renderer", report->renderer);
	text(o, "camera", view->camera.name);
	integer(o, "width", view->camera.pixels[0]);
	integer(o, "height", view->camera.pixels[1]);
	integer(o, "frames", view->frames);
	truth = object(o, "truth");
	integer(truth, "points", (int64_t)view->truth->count);
	integer(truth, "point_samples", report->point_samples);
	number(truth, "noise", view->truth->noise);
	integer(truth, "picture_samples", report->picture_samples);
	number(truth, "picture_noise", view->truth->picture_noise);
	number(truth, "seconds", view->truth->seconds);
	json_object_object_add(o, "results", results);
	for (size_t i = 0; i < report->count; i++)
		json_object_array_add(results, result(report, i));
	return o;
}
