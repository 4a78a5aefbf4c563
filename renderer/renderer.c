#include "renderer/renderer_private.h"

#include "base/clock.h"
#include "base/result.h"

#include <math.h>
#include <string.h>

/*
 * log2 of what a metre lets through, (1 - sigma). From sigma 1 on nothing gets
 * through, written as a number that stays finite times any distance.
 */
static float log2_transmittance(float sigma)
{
	if (sigma <= 0)
		return 0;
	return sigma < 1 ? log2f(1 - sigma) : -1e6f;
}

static void store_frame_block(struct renderer *r)
{
	struct frame_block block = {
		.medium = { log2_transmittance(r->absorption + r->scattering),
			    log2_transmittance(r->absorption), 0, 0 },
	};

	memcpy(block.bounds_min, r->scene->min, sizeof(r->scene->min));
	memcpy(block.bounds_max, r->scene->max, sizeof(r->scene->max));
	memcpy(block.background, r->backdrop.radiance, sizeof(block.background));
	glNamedBufferSubData(r->frame_buffer, 0, sizeof(block), &block);
}

/* True when the medium is not that of the last frame. */
static bool take_medium(struct renderer *r, const struct render_frame *frame)
{
	bool changed = r->fresh || r->absorption != frame->absorption_per_m ||
		       r->scattering != frame->scattering_per_m;

	if (changed) {
		r->absorption = frame->absorption_per_m;
		r->scattering = frame->scattering_per_m;
		store_frame_block(r);
	}
	glBindBufferBase(GL_UNIFORM_BUFFER, VIEW_BINDING_FRAME, r->frame_buffer);
	return changed;
}

/* Maps of what moved. True when the light on the surfaces is another one. */
static bool draw_shadow(struct renderer *r, const struct render_frame *frame, bool medium_changed)
{
	int change = r->shadow ? shadow_take(r->shadow, frame) : SHADOW_SAME;
	bool lamps = change != SHADOW_SAME || (r->shadow && medium_changed);
	bool emissive = r->emissive && emissive_wants(r->emissive, medium_changed);

	if (lamps || emissive) {
		timers_begin(r->timers, STAGE_SHADOW, "shadow");
		if (lamps)
			shadow_draw(r->shadow, medium_changed);
		if (emissive)
			emissive_draw(r->emissive);
		timers_end(r->timers, STAGE_SHADOW);
		r->stats.shadow_updates++;
	}
	return lamps || emissive;
}

static int times(int count, int factor, int most)
{
	return count < most / factor ? count * factor : most;
}

/*
 * The steps and gathers of a plan stand in for the file's, which the master
 * sends with each frame; a number that was set while running counts as it is.
 */
static int update_method(struct renderer *r, const struct render_frame *frame,
			 const struct gi_light *light)
{
	struct render_frame asked = *frame;

	if (r->is_planned && frame->gi_steps == r->file_steps)
		asked.gi_steps = r->light.plan.gi.steps;
	if (r->is_planned && frame->gi_gathers == r->file_gathers)
		asked.gi_gathers = r->light.plan.gi.gathers;
	if (frame->gi_refine > 1) {
		asked.gi_steps = times(asked.gi_steps, frame->gi_refine, GI_STEPS_MOST);
		asked.gi_gathers = times(asked.gi_gathers, frame->gi_refine, GI_GATHERS_MOST);
	}
	return r->gi->ops->update(r->gi, &asked, light);
}

/* The light field. *changed is set when it is another one. */
static int update_gi(struct renderer *r, const struct render_frame *frame, bool *changed)
{
	unsigned needs = r->gi ? r->gi->ops->needs : 0;
	struct gi_light light = { .version = r->light_version };
	struct gi_stats gi;
	int result;

	if (!r->gi)
		return GR_OK;
	if (r->fresh || frame->gi_on != r->gi_on)
		*changed = true;
	r->gi_on = frame->gi_on;
	if (!frame->gi_on)
		return GR_OK;
	if (*changed)
		light.version = ++r->light_version;
	if (r->rsm && needs & GI_NEEDS_RSM)
		light.rsm = rsm_frame(r->rsm);
	if (r->shadow && needs & GI_NEEDS_LAMPS) {
		shadow_bind(r->shadow);
		light.lamps = true;
	}
	timers_begin(r->timers, STAGE_GI, "gi");
	result = update_method(r, frame, &light);
	timers_end(r->timers, STAGE_GI);
	if (result < 0)
		return result;
	r->gi->ops->stats(r->gi, &gi);
	if (gi.ran) {
		r->stats.gi_updates++;
		*changed = true;
	}
	return GR_OK;
}

static bool take_tone(struct renderer *r, const struct render_frame *frame)
{
	const struct tone_look look = render_frame_look(frame);
	struct tone_values values = { .gamma_encode = frame->gamma_encode, .srgb = frame->srgb };
	bool changed;

	tone_factors(&look, &values.factors);
	changed = r->fresh || !tone_values_same(&values, &r->tone_values);
	if (changed)
		r->tone_values = values;
	return changed;
}

/* Where an eye is in the scene and what it sees the wall through. */
static int eye_view(struct renderer *r, int index, const struct render_frame *frame,
		    const struct scene_camera *camera, mat4 view_projection, vec3 position)
{
	struct projection p;
	vec3 eye;
	int result;

	if (camera) {
		memcpy(position, camera->position, sizeof(vec3));
		result = projection_camera(camera->position, camera->target, camera->up,
					   camera->vfov_rad,
					   (float)r->params.width / (float)r->params.height,
					   r->file->near_m, r->file->far_m, &p);
		if (result == GR_OK)
			glm_mat4_copy(p.view_projection, view_projection);
		return result;
	}
	eyes_position(r->params.eyes, index, frame, eye);
	memcpy(r->eyes[index].position_room, eye, sizeof(vec3));
	result = projection_off_axis(&r->params.wall, eye, r->file->near_m, r->file->far_m, &p);
	if (result == GR_OK) {
		struct gr_pose T_room_scene;
		mat4 m;

		gr_pose_inverse(&frame->T_scene_room, &T_room_scene);
		gr_pose_mat4(&T_room_scene, m);
		glm_mat4_mul(p.view_projection, m, view_projection);
		gr_pose_point(&frame->T_scene_room, eye, position);
	}
	return result;
}

/* Radiance of one eye. GR_NOTHING: no picture from there, the old one stays. */
static int draw_eye(struct renderer *r, int index, const struct render_frame *frame,
		    const struct scene_camera *camera, bool light_changed, bool *drawn)
{
	const struct shade_parts parts = { r->shadow, r->emissive, r->gi, &r->backdrop };
	struct renderer_eye *eye = &r->eyes[index];
	mat4 view_projection;
	vec3 position;
	bool moved;

	*drawn = false;
	if (eye_view(r, index, frame, camera, view_projection, position) != GR_OK) {
		r->stats.skipped_eyes++;
		/* its surfaces are lit as they were; they are shaded anew once it is back */
		if (light_changed)
			eye->drawn = false;
		return GR_NOTHING;
	}
	moved = !eye->drawn ||
		memcmp(view_projection, eye->view_projection, sizeof(mat4)) != 0 ||
		memcmp(position, eye->position, sizeof(vec3)) != 0;
	if (moved) {
		glm_mat4_copy(view_projection, eye->view_projection);
		memcpy(eye->position, position, sizeof(vec3));
		timers_begin(r->timers, STAGE_GBUFFER, "gbuffer");
		gbuffer_draw(&eye->gbuffer, r->gbuffer_program, r->mesh, view_projection);
		timers_end(r->timers, STAGE_GBUFFER);
	}
	if (moved || light_changed) {
		timers_begin(r->timers, STAGE_SHADE, "shade");
		shade_draw(&eye->picture, r->shade_program, &parts, &eye->gbuffer, view_projection,
			   position, r->gi_on);
		timers_end(r->timers, STAGE_SHADE);
		*drawn = true;
	}
	eye->drawn = true;
	return GR_OK;
}

/* The finished picture; hud: what is in the hand is seen from there. */
static void show_eye(struct renderer *r, int index, bool hud)
{
	const struct eyes_place place = eyes_place(&r->params, index);
	struct renderer_eye *eye = &r->eyes[index];

	/* of a window's two back buffers the framebuffer says nothing */
	target_bind(r->target, place.buffer, false);
	timers_begin(r->timers, STAGE_TONE, "tone");
	tone_draw(r->tone, &r->tone_values, r->eyes[index].picture.radiance,
		  target_framebuffer(r->target, place.buffer), place.x, place.y, r->params.width,
		  r->params.height);
	timers_end(r->timers, STAGE_TONE);
	if (!hud)
		return;
	const struct hud_eye from = {
		.wall = &r->params.wall,
		.position = { eye->position_room[0], eye->position_room[1], eye->position_room[2] },
		.position_scene = { eye->position[0], eye->position[1], eye->position[2] },
		.gbuffer = &eye->gbuffer,
		.x = place.x,
		.y = place.y,
	};

	timers_begin(r->timers, STAGE_HUD, "hud");
	hud_draw(r->hud, &from);
	timers_end(r->timers, STAGE_HUD);
}

/* What went wrong in the frame, counted; a line a minute. */
static void count_errors(struct renderer *r)
{
	uint64_t before = r->stats.nonfinite, since;
	GLenum error;

	for (int i = 0; i < 8 && (error = glGetError()) != GL_NO_ERROR; i++) {
		r->stats.gl_errors++;
		if (gr_log_limit(&r->error_limit, gr_clock_now(&gr_clock_monotonic), &since))
			gr_error("OpenGL error 0x%04x in frame %llu (%llu since the last such line)",
				 error, (unsigned long long)r->stats.frames,
				 (unsigned long long)since);
	}
	r->stats.nonfinite = tone_nonfinite(r->tone);
	if (r->stats.nonfinite != before &&
	    gr_log_limit(&r->nonfinite_limit, gr_clock_now(&gr_clock_monotonic), &since))
		gr_error("%llu pixels so far were not finite and are shown in magenta",
			 (unsigned long long)r->stats.nonfinite);
}

static void end_frame(struct renderer *r)
{
	tone_frame(r->tone);
	timers_frame(r->timers);
	glDeleteSync(r->fence);
	r->fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
	glFlush();
	r->stats.frames++;
	r->fresh = false;
	count_errors(r);
}

/* The scene's eye gets used to what it sees, and this curve shows it. */
static bool wants_gaze(const struct renderer *r, const struct render_frame *frame)
{
	return r->gaze && (frame->curve == SCENE_CURVE_DRAGO || frame->curve == SCENE_CURVE_PATTANAIK);
}

/* Of the first eye: the two see the same light but for a few centimetres. */
static void measure_gaze(struct renderer *r, const struct render_frame *frame, bool drawn)
{
	const vec3 ahead = { 0, 0, -1 };
	struct gaze_view view = { .wall = r->params.wall };
	vec3 eye, direction;

	eyes_position(r->params.eyes, 0, frame, eye);
	gr_pose_direction(&frame->T_room_head, ahead, direction);
	glm_vec3_normalize(direction);
	glm_vec3_copy(eye, view.eye);
	glm_vec3_copy(direction, view.direction);
	if (!drawn && r->gazed && memcmp(&view, &r->gaze_view, sizeof view) == 0)
		return;
	timers_begin(r->timers, STAGE_GAZE, "gaze");
	/* From behind its plane a wall shows nothing, and nothing of it is looked at. */
	r->gazed = gaze_measure(r->gaze, &view, r->eyes[0].picture.radiance, r->params.width,
				r->params.height, r->stats.frames + 1) == GR_OK;
	timers_end(r->timers, STAGE_GAZE);
	r->gaze_view = view;
}

static int draw_frame(struct renderer *r, const struct render_frame *frame,
		      const struct scene_camera *camera)
{
	bool medium = take_medium(r, frame);
	bool light = draw_shadow(r, frame, medium) || medium;
	int result = update_gi(r, frame, &light);
	bool tone = take_tone(r, frame);
	bool hud = r->hud && hud_take(r->hud, camera ? NULL : frame, r->file);

	if (result < 0)
		return result;
	result = GR_OK;
	for (int i = 0; i < r->eye_count; i++) {
		/* a window forgets its picture at the swap, a framebuffer does not */
		bool forgets = target_framebuffer(r->target, eyes_place(&r->params, i).buffer) == 0;
		bool drawn, seen = draw_eye(r, i, frame, camera, light, &drawn) == GR_OK;

		if (!seen)
			result = GR_NOTHING;
		if (drawn || tone || forgets || (hud && seen))
			show_eye(r, i, seen && r->hud && hud_shown(r->hud));
		if (i == 0 && !camera && wants_gaze(r, frame))
			measure_gaze(r, frame, drawn);
	}
	end_frame(r);
	return result;
}

static bool lamp_valid(const struct frame_lamp *lamp)
{
	for (int k = 0; k < 3; k++)
		if (!isfinite(lamp->position[k]) || !isfinite(lamp->direction[k]) ||
		    !isfinite(lamp->intensity[k]))
			return false;
	return true;
}

static bool frame_valid(const struct renderer *r, const struct render_frame *frame)
{
	const struct tone_look look = render_frame_look(frame);

	for (size_t i = 0; i < r->file->lamp_count; i++)
		if (frame->lamps[i].on && !lamp_valid(&frame->lamps[i]))
			return false;
	if (frame->hand.shown && (!gr_pose_valid(&frame->hand.T_room_wand) ||
				  !isfinite(frame->hand.scale) || frame->hand.scale <= 0))
		return false;
	return gr_pose_valid(&frame->T_scene_room) && gr_pose_valid(&frame->T_room_head) &&
	       isfinite(frame->eye_separation_m) && frame->absorption_per_m >= 0 &&
	       frame->scattering_per_m >= 0 && isfinite(frame->absorption_per_m) &&
	       isfinite(frame->scattering_per_m) && isfinite(frame->gi_incremental) &&
	       tone_look_valid(&look) && isfinite(frame->gamma_encode) && frame->gamma_encode > 0;
}

int renderer_glance(struct renderer *renderer, struct adapt_sample *out, uint64_t *out_frame)
{
	return renderer->gaze ? gaze_newest(renderer->gaze, out, out_frame) : GR_NOTHING;
}

int renderer_draw(struct renderer *renderer, const struct render_frame *frame)
{
	if (!renderer->params.wall_given)
		return GR_ERR_STATE;
	if (!frame_valid(renderer, frame))
		return GR_ERR_RANGE;
	return draw_frame(renderer, frame, NULL);
}

int renderer_draw_camera(struct renderer *renderer, const struct render_frame *frame,
			 const struct scene_camera *camera)
{
	if (renderer->params.eyes != RENDERER_MONO)
		return GR_ERR_STATE;
	if (!frame_valid(renderer, frame))
		return GR_ERR_RANGE;
	return draw_frame(renderer, frame, camera);
}

int renderer_finished(struct renderer *renderer, int64_t wait_ns)
{
	if (!renderer->fence)
		return GR_OK;
	switch (glClientWaitSync(renderer->fence, GL_SYNC_FLUSH_COMMANDS_BIT,
				 wait_ns > 0 ? (GLuint64)wait_ns : 0)) {
	case GL_ALREADY_SIGNALED:
	case GL_CONDITION_SATISFIED:
		glDeleteSync(renderer->fence);
		renderer->fence = NULL;
		return GR_OK;
	case GL_TIMEOUT_EXPIRED:
		return GR_NOTHING;
	default:
		return GR_ERR_GL;
	}
}
