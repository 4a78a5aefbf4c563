#include "renderer/renderer_private.h"

#include "base/plain.h"
#include "base/result.h"
#include "renderer/gi/choose.h"
#include "renderer/gi/surfel_store.h"
#include "renderer/gi/surfels.h"
#include "renderer/scene/environment.h"
#include "renderer/tone/projector.h"

#include <stdio.h>
#include <stdlib.h>

static int check_params(const struct renderer_params *params, const struct target *target)
{
	int want[2], have[2];

	if (params->width < 1 || params->height < 1) {
		gr_error("renderer: a picture of %d x %d pixels", params->width, params->height);
		return GR_ERR_RANGE;
	}
	renderer_target_size(params, &want[0], &want[1]);
	target_size(target, &have[0], &have[1]);
	if (have[0] < want[0] || have[1] < want[1]) {
		gr_error("renderer: the target has %d x %d pixels, the wall's eyes need %d x %d",
			 have[0], have[1], want[0], want[1]);
		return GR_ERR_RANGE;
	}
	return GR_OK;
}

/* gi.method = "auto": method and settings from what the scene holds and what this GPU costs. */
static void plan_light(struct renderer *r)
{
	const struct scene_file *file = r->file;

	r->file_steps = file->gi.steps;
	r->file_gathers = file->gi.gathers;
	if (file->gi.method != SCENE_GI_AUTO) {
		gi_facts_take(&r->light.facts, r->scene, file);
		return;
	}
	if (r->params.light)
		r->light = *r->params.light;
	else
		light_plan_make(&r->light, r->target, r->scene, file);
	r->planned = *file;
	r->planned.gi = r->light.plan.gi;
	r->file = &r->planned;
	r->is_planned = true;
	if (r->light.plan.adopted)
		gr_log(r->light.plan.within ? GR_LOG_NOTICE : GR_LOG_WARNING, "light, as the room has it: %s",
		       r->light.plan.why);
	else
		gr_log(r->light.plan.within ? GR_LOG_NOTICE : GR_LOG_WARNING,
		       "light, chosen for %s ms by %s: %s", gr_plain((double)file->gi.budget_ms, 3).text,
		       r->light.costs_from, r->light.plan.why);
}

/* A plan by what was baked, and what would be right where it exceeds the budget. */
static void settle_plan(struct renderer *r)
{
	struct gi_plan *plan = &r->light.plan, right;
	char settings[GI_PLAN_TEXT], advice[GI_PLAN_TEXT + 96];

	if (gi_plan_baked(plan, &r->light.facts, &r->light.costs, r->surfels, &right)) {
		gr_info("light, with %zu surfels as baked: %s ms a frame while it changes", r->surfels,
			gr_plain(plan->update_ms, 3).text);
		return;
	}
	gi_plan_settings(settings, sizeof settings, &right.gi);
	if (right.within)
		snprintf(advice, sizeof advice, "gi.budget_ms = %s would be right, or %s, named in the scene file",
			 gr_plain(gi_plan_budget_for(plan->update_ms), 3).text, settings);
	else
		snprintf(advice, sizeof advice, "nothing fits that, and gi.budget_ms = %s is the least that does",
			 gr_plain(gi_plan_budget_for(right.update_ms), 3).text);
	gr_warning("light: %zu surfels take %s ms, more than the budget of %s ms; %s", r->surfels,
		   gr_plain(plan->update_ms, 3).text, gr_plain((double)plan->gi.budget_ms, 3).text, advice);
}

/* What surfels and probes need of the scene, once, and then on the GPU. */
static int create_surfels(struct renderer *r, bool probes)
{
	const struct surfels_params params = {
		.gathers = r->file->gi.gathers,
		.probes = probes,
		.lamps = r->shadow != NULL,
	};
	struct surfel_bake_params bake;
	struct surfel_set *set = NULL;
	int result;

	surfel_bake_params_of(r->file, &bake);
	result = surfels_load_or_bake(&set, r->scene, r->file, &bake, r->params.alive);
	if (result == GR_OK) {
		r->surfels = set->count;
		result = gi_surfels_create(&r->gi, set, &params);
	}
	if (result == GR_OK && r->is_planned)
		settle_plan(r);
	surfel_set_destroy(&set);
	return result;
}

/* Shadow, emissive and illumination stages, each only where the scene has use for it. */
static int create_light(struct renderer *r, const struct emissive_patches *patches)
{
	int lamp_layers = shadow_layers(r->file);
	int layers = lamp_layers + emissive_layers(patches);
	int result = GR_OK;

	r->choice = gi_choose(r->file, r->scene, layers > 0);
	if (r->is_planned)
		r->choice.why = "chosen for this scene";
	if (r->choice.method == SCENE_GI_LPV)
		result = rsm_create(&r->rsm, r->file->gi.rsm_pixels, layers, lamp_layers > 0,
				    patches->count > 0);
	if (result == GR_OK && lamp_layers > 0)
		result = shadow_create(&r->shadow, r->file, r->scene, r->mesh, r->rsm);
	if (result == GR_OK && patches->count > 0)
		result = emissive_create(&r->emissive, patches, r->scene, r->mesh,
					 r->file->shadow_pixels, r->rsm, lamp_layers);
	if (result == GR_OK && r->choice.method == SCENE_GI_LPV)
		result = gi_lpv_create(&r->gi, r->scene, r->file);
	if (result == GR_OK &&
	    (r->choice.method == SCENE_GI_SURFELS || r->choice.method == SCENE_GI_PROBES))
		result = create_surfels(r, r->choice.method == SCENE_GI_PROBES);
	return result;
}

static int create_tone(struct renderer *r)
{
	const struct projector *projector = r->params.projector;
	int bits = target_bits(r->target);
	float (*map)[3] = NULL;
	int result;

	if (projector) {
		map = calloc(PROJECTOR_MAP, sizeof *map);
		if (!map)
			return GR_ERR_NOMEM;
		projector_map(projector, &r->file->tone, map);
	}
	result = tone_create(&r->tone, (const float (*)[3])map,
			     r->params.dither && bits < 16 ? bits : 0);
	free(map);
	r->params.projector = NULL; /* the caller's, and in the map now */
	if (result == GR_OK && r->file->tone.adapt != SCENE_ADAPT_FIXED && r->params.wall_given)
		result = gaze_create(&r->gaze);
	return result;
}

static int create_pictures(struct renderer *r)
{
	const struct shade_parts parts = { r->shadow, r->emissive, r->gi, &r->backdrop };
	bool emissive = r->emissive != NULL;
	int result = gbuffer_program(&r->gbuffer_program, emissive);

	if (result == GR_OK)
		result = backdrop_init(&r->backdrop, r->scene, r->file);
	if (result == GR_OK)
		result = shade_program(&r->shade_program, &parts, r->params.keep_radiance);
	for (int i = 0; i < r->eye_count && result == GR_OK; i++) {
		result = gbuffer_init(&r->eyes[i].gbuffer, r->params.width, r->params.height,
				      emissive);
		if (result == GR_OK)
			result = shade_picture_init(&r->eyes[i].picture, r->params.width,
						    r->params.height, r->params.keep_radiance);
	}
	if (result == GR_OK)
		result = create_tone(r);
	if (result == GR_OK && r->params.wall_given)
		result = hud_create(&r->hud);
	if (result == GR_OK)
		result = timers_create(&r->timers);
	if (result == GR_OK) {
		glCreateBuffers(1, &r->frame_buffer);
		glNamedBufferStorage(r->frame_buffer, sizeof(struct frame_block), NULL,
				     GL_DYNAMIC_STORAGE_BIT);
		if (glGetError() == GL_OUT_OF_MEMORY) {
			gr_error("renderer: the GPU's memory does not hold the pictures and maps");
			result = GR_ERR_GL;
		}
	}
	return result;
}

static void log_environment(const struct renderer *r)
{
	enum scene_gi_method method = r->choice.method;
	char text[256];

	if (!r->scene->environment)
		return;
	environment_describe(r->scene->environment, text, sizeof text);
	gr_info("environment: %s", text);
	if (method == SCENE_GI_NONE || method == SCENE_GI_LPV)
		gr_warning("the environment is seen, but lights no surface: gi.method = \"%s\" takes "
			   "none of its light; surfels and probes do",
			   method == SCENE_GI_NONE ? "none" : "lpv");
}

/* Baked light is thinned by the air of the scene file, and never scattered. A plan says so itself. */
static void log_medium(const struct renderer *r)
{
	if (r->is_planned || (r->choice.method != SCENE_GI_SURFELS && r->choice.method != SCENE_GI_PROBES))
		return;
	if (r->light.facts.scattering_per_m > 0)
		gr_warning("the air scatters, which surfels and probes do not carry; gi.method = \"lpv\" does");
}

static void log_stages(const struct renderer *r, const struct emissive_patches *patches)
{
	if (r->shadow)
		gr_info("stage shadow: %zu lamp%s, %d map%s of %d x %d, drawn when a lamp moves",
			r->file->lamp_count, r->file->lamp_count == 1 ? "" : "s",
			shadow_layers(r->file), shadow_layers(r->file) == 1 ? "" : "s", r->file->shadow_pixels,
			r->file->shadow_pixels);
	else
		gr_info("stage shadow: none, the scene has no lamps");
	if (r->emissive)
		gr_info("stage emissive: %zu emissive triangles as %d patches in %d groups, "
			"hemicubes of %d x %d drawn once, flux %s %s %s W",
			patches->triangles, patches->count, patches->group_count,
			emissive_pixels(r->emissive), emissive_pixels(r->emissive),
			gr_plain(patches->flux[0], 4).text, gr_plain(patches->flux[1], 4).text,
			gr_plain(patches->flux[2], 4).text);
	else
		gr_info("stage emissive: none, no surface of the scene emits");
	if (r->gi)
		gr_info("stage gi: %s, %s: %s", r->gi->ops->name, r->choice.why,
			r->gi->ops->describe(r->gi));
	else
		gr_info("stage gi: none, %s", r->choice.why);
	log_environment(r);
	log_medium(r);
	gr_info("stages gbuffer and shade: %d picture%s of %d x %d, drawn when the eye or the "
		"light changes",
		r->eye_count, r->eye_count > 1 ? "s" : "", r->params.width, r->params.height);
	gr_info("stage tone: %s, %s", tone_curve_name(r->file->tone.curve),
		r->file->tone.srgb ? "sRGB" : "power law");
	if (r->gaze)
		gr_info("stage gaze: %d cells of the wall at most, for the eye that gets used to what it looks at",
			GAZE_CELLS * GAZE_CELLS);
}

static int go_on(const struct renderer *r)
{
	return alive_go_on(r->params.alive) ? GR_OK : GR_NOTHING;
}

int renderer_create(struct renderer **out, struct target *target,
		    const struct renderer_params *params, const struct scene_file *file,
		    const struct scene *scene)
{
	struct emissive_patches patches;
	struct renderer *r;
	int result = check_params(params, target);

	*out = NULL;
	if (result != GR_OK)
		return result;
	r = calloc(1, sizeof(*r));
	if (!r)
		return GR_ERR_NOMEM;
	r->target = target;
	r->file = file;
	r->scene = scene;
	r->params = *params;
	r->eye_count = eyes_count(params->eyes);
	r->fresh = true;
	plan_light(r);
	result = go_on(r);
	if (result == GR_OK)
		result = gl_mesh_create(&r->mesh, scene);
	if (result == GR_OK)
		result = emissive_patches(scene, &patches);
	if (result == GR_OK)
		result = go_on(r);
	if (result == GR_OK)
		result = create_light(r, &patches);
	if (result == GR_OK)
		result = go_on(r);
	if (result == GR_OK)
		result = create_pictures(r);
	if (result != GR_OK) {
		if (result < 0)
			gr_error("renderer: %s", gr_result_name(result));
		renderer_destroy(&r);
		return result;
	}
	if (!params->quiet)
		log_stages(r, &patches);
	*out = r;
	return GR_OK;
}

void renderer_destroy(struct renderer **renderer)
{
	struct renderer *r = *renderer;

	if (!r)
		return;
	glDeleteSync(r->fence);
	glDeleteBuffers(1, &r->frame_buffer);
	timers_destroy(&r->timers);
	hud_destroy(&r->hud);
	tone_destroy(&r->tone);
	gaze_destroy(&r->gaze);
	backdrop_finish(&r->backdrop);
	for (int i = 0; i < EYES_MAX; i++) {
		shade_picture_finish(&r->eyes[i].picture);
		gbuffer_finish(&r->eyes[i].gbuffer);
	}
	program_destroy(&r->shade_program);
	program_destroy(&r->gbuffer_program);
	program_destroy(&r->irradiance_program);
	if (r->gi)
		r->gi->ops->destroy(r->gi);
	emissive_destroy(&r->emissive);
	shadow_destroy(&r->shadow);
	rsm_destroy(&r->rsm);
	gl_mesh_destroy(&r->mesh);
	free(r);
	*renderer = NULL;
}
