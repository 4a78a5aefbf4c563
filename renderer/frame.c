#include "renderer/frame.h"

#include <string.h>

/* A standing person of average size, looking to the front; the daemon's start pose replaces it. */
#define EYE_HEIGHT_M 1.7f
#define EYE_SEPARATION_M 0.065f

static void lamp_init(struct frame_lamp *lamp, const struct scene_lamp *from,
		      const struct render_frame *frame)
{
	struct gr_pose T_scene_head;

	lamp->on = from->on;
	memcpy(lamp->intensity, from->intensity, sizeof(vec3));
	memcpy(lamp->position, from->position, sizeof(vec3));
	memcpy(lamp->direction, from->direction, sizeof(vec3));
	switch (from->mount) {
	case SCENE_MOUNT_FIXED:
		break;
	case SCENE_MOUNT_ORBIT:
		memcpy(lamp->position, from->orbit_center, sizeof(vec3));
		lamp->position[0] += from->orbit_radius_m;
		break;
	case SCENE_MOUNT_WAND: /* without a wand the torch is held where the head is */
	case SCENE_MOUNT_HEAD:
		gr_pose_mul(&frame->T_scene_room, &frame->T_room_head, &T_scene_head);
		gr_pose_point(&T_scene_head, from->position, lamp->position);
		gr_pose_direction(&T_scene_head, from->direction, lamp->direction);
		break;
	}
}

struct tone_look render_frame_look(const struct render_frame *frame)
{
	return (struct tone_look){
		.curve = frame->curve,
		.exposure = (double)frame->exposure,
		.eye = { (double)frame->adaptation[0], (double)frame->adaptation[1],
			 (double)frame->pigment[0], (double)frame->pigment[1] },
		.luminance_max = (double)frame->luminance_max,
		.bias = (double)frame->tone_bias,
	};
}

void render_frame_init(struct render_frame *frame, const struct scene_file *file)
{
	const struct tone_look look = tone_look_of_scene(&file->tone);

	*frame = (struct render_frame){
		.T_scene_room = file->room,
		.T_room_head = GR_POSE_IDENTITY,
		.eye_separation_m = EYE_SEPARATION_M,
		.gi_on = file->gi.method != SCENE_GI_NONE,
		.gi_steps = file->gi.steps,
		.gi_gathers = file->gi.gathers,
		.gi_refine = 1,
		.gi_incremental = file->gi.incremental,
		.absorption_per_m = file->absorption_per_m,
		.scattering_per_m = file->scattering_per_m,
		.exposure = file->tone.exposure,
		.curve = file->tone.curve,
		.adaptation = { (float)look.eye.cone, (float)look.eye.rod },
		.pigment = { (float)look.eye.cone_pigment, (float)look.eye.rod_pigment },
		.luminance_max = file->tone.luminance_max,
		.tone_bias = file->tone.bias,
		.gamma_encode = file->tone.gamma_end_to_end / file->tone.gamma_display,
		.srgb = file->tone.srgb,
		.hand = { .T_room_wand = GR_POSE_IDENTITY, .scale = 1, .torch = -1 },
	};
	frame->T_room_head.p[1] = EYE_HEIGHT_M;
	for (size_t i = 0; i < file->lamp_count && i < SCENE_MAX_LAMPS; i++)
		lamp_init(&frame->lamps[i], &file->lamps[i], frame);
}
