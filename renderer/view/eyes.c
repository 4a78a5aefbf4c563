#include "renderer/view/eyes.h"

int eyes_count(enum renderer_eyes eyes)
{
	switch (eyes) {
	case RENDERER_QUAD_BUFFER:
	case RENDERER_SIDE_BY_SIDE:
	case RENDERER_TOP_BOTTOM:
		return 2;
	case RENDERER_MONO:
	case RENDERER_LEFT:
	case RENDERER_RIGHT:
		break;
	}
	return 1;
}

void eyes_position(enum renderer_eyes eyes, int index, const struct render_frame *frame,
		   vec3 out_room)
{
	vec3 in_head = { 0, 0, 0 };

	if (eyes == RENDERER_RIGHT || (eyes_count(eyes) == 2 && index == 1))
		in_head[0] = 0.5f * frame->eye_separation_m;
	else if (eyes != RENDERER_MONO)
		in_head[0] = -0.5f * frame->eye_separation_m;
	gr_pose_point(&frame->T_room_head, in_head, out_room);
}

struct eyes_place eyes_place(const struct renderer_params *params, int index)
{
	struct eyes_place place = { 0, 0, 0 };

	if (params->eyes == RENDERER_QUAD_BUFFER)
		place.buffer = index;
	else if (params->eyes == RENDERER_SIDE_BY_SIDE)
		place.x = index * params->width;
	else if (params->eyes == RENDERER_TOP_BOTTOM)
		place.y = index == 0 ? params->height : 0;
	return place;
}

void renderer_target_size(const struct renderer_params *params, int *width, int *height)
{
	*width = params->eyes == RENDERER_SIDE_BY_SIDE ? 2 * params->width : params->width;
	*height = params->eyes == RENDERER_TOP_BOTTOM ? 2 * params->height : params->height;
}
