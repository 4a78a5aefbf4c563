#include "daemon/node_frame.h"

#include "base/result.h"
#include "daemon/master_state.h"

#include <math.h>
#include <string.h>

static bool get_pose(const struct param_state *params, enum param_id position,
		     enum param_id rotation, struct gr_pose *out)
{
	const float *q = param_f32(params, rotation);

	*out = GR_POSE_IDENTITY;
	memcpy(out->p, param_f32(params, position), sizeof out->p);
	if (q[0] != 0 || q[1] != 0 || q[2] != 0 || q[3] != 0)
		memcpy(out->q, q, sizeof out->q);
	return gr_pose_valid(out);
}

static bool get_lamps(struct render_frame *out, const struct scene_file *scene,
		      const struct param_state *params)
{
	const float *position = param_f32(params, PARAM_LAMP_POSITION);
	const float *direction = param_f32(params, PARAM_LAMP_DIRECTION);
	const float *intensity = param_f32(params, PARAM_LAMP_INTENSITY);
	uint32_t on = *param_u32(params, PARAM_LAMP_ON);

	for (size_t i = 0; i < scene->lamp_count && i < PARAM_MAX_LAMPS; i++) {
		struct frame_lamp *lamp = &out->lamps[i];
		float length2 = 0;

		lamp->on = on >> i & 1;
		memcpy(lamp->position, position + 3 * i, sizeof(vec3));
		memcpy(lamp->direction, direction + 3 * i, sizeof(vec3));
		memcpy(lamp->intensity, intensity + 3 * i, sizeof(vec3));
		for (int k = 0; k < 3; k++)
			length2 += lamp->direction[k] * lamp->direction[k];
		if (lamp->on && scene->lamps[i].kind != SCENE_LAMP_POINT &&
		    fabsf(length2 - 1) > 1e-2f)
			return false;
	}
	return true;
}

static bool get_hand(struct frame_hand *out, const struct scene_file *scene,
		     const struct param_state *params)
{
	const uint32_t flags = *param_u32(params, PARAM_HAND_FLAGS), torch = *param_u32(params, PARAM_HAND_TORCH);

	out->shown = flags & HAND_FLAG_HUD && *param_u32(params, PARAM_TRACK_FLAGS) & MASTER_TRACK_WAND;
	if (!out->shown) /* where the wand is then is of no interest */
		return true;
	out->scale = *param_f32(params, PARAM_HUD_SCALE);
	out->mode = (enum frame_hand_mode)*param_u32(params, PARAM_HAND_MODE);
	out->quality = flags & HAND_FLAG_QUALITY;
	out->torch_hue = *param_f32(params, PARAM_HAND_HUE);
	out->torch = torch <= scene->lamp_count && torch <= PARAM_MAX_LAMPS ? (int)torch - 1 : -1;
	return get_pose(params, PARAM_WAND_POSITION, PARAM_WAND_ROTATION, &out->T_room_wand);
}

_Static_assert((int)FRAME_HAND_MODES == (int)HAND_MODES &&
		       (int)FRAME_HAND_SETTINGS == (int)HAND_SETTINGS,
	       "the layouts go as they are");

int node_frame_fill(struct render_frame *out, const struct scene_file *scene,
		    const struct param_state *params, uint64_t frame, const char **refused)
{
	struct render_frame f = *out;

	f.frame = frame;
	if (!get_pose(params, PARAM_ROOM_POSITION, PARAM_ROOM_ROTATION, &f.T_scene_room)) {
		*refused = param_info(PARAM_ROOM_ROTATION)->name;
		return GR_ERR_RANGE;
	}
	if (!get_pose(params, PARAM_HEAD_POSITION, PARAM_HEAD_ROTATION, &f.T_room_head)) {
		*refused = param_info(PARAM_HEAD_ROTATION)->name;
		return GR_ERR_RANGE;
	}
	if (!get_lamps(&f, scene, params)) {
		*refused = param_info(PARAM_LAMP_DIRECTION)->name;
		return GR_ERR_RANGE;
	}
	if (!get_hand(&f.hand, scene, params)) {
		*refused = param_info(PARAM_WAND_ROTATION)->name;
		return GR_ERR_RANGE;
	}
	f.eye_separation_m = *param_f32(params, PARAM_EYE_SEPARATION);
	f.gi_on = *param_u32(params, PARAM_GI_ON) != 0;
	f.gi_epoch = *(const uint64_t *)param_get(params, PARAM_GI_EPOCH);
	f.gi_steps = (int)*param_u32(params, PARAM_GI_STEPS);
	f.gi_gathers = (int)*param_u32(params, PARAM_GI_GATHERS);
	f.gi_refine = (int)*param_u32(params, PARAM_GI_REFINE);
	f.gi_incremental = *param_f32(params, PARAM_GI_INCREMENTAL);
	f.absorption_per_m = *param_f32(params, PARAM_ABSORPTION);
	f.scattering_per_m = *param_f32(params, PARAM_SCATTERING);
	f.exposure = *param_f32(params, PARAM_EXPOSURE);
	f.curve = (enum scene_curve)*param_u32(params, PARAM_TONE_CURVE);
	memcpy(f.adaptation, param_f32(params, PARAM_ADAPTATION), sizeof f.adaptation);
	memcpy(f.pigment, param_f32(params, PARAM_PIGMENT), sizeof f.pigment);
	f.luminance_max = *param_f32(params, PARAM_LUMINANCE_MAX);
	f.tone_bias = *param_f32(params, PARAM_TONE_BIAS);
	f.gamma_encode = *param_f32(params, PARAM_GAMMA_ENCODE);
	*out = f;
	return GR_OK;
}
