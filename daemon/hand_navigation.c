/* Layout 1: the room moves and turns in the scene. */
#include "daemon/hand_private.h"

#include <math.h>
#include <string.h>

float hand_fly_speed(float distance_m)
{
	const float d = fminf(fmaxf(distance_m, 0.0f), HAND_REACH_MOST_M);

	return HAND_WALK_M_S * powf(d / HAND_ARM_M, 2.5f);
}

static void fly(struct hand *hand, const struct master_input *input, float step_s,
		struct gr_pose *T_scene_room)
{
	const vec3 ahead = { 0, 0, -1 };
	const float *head = input->head.T_room_body.p, *wand = input->wand.T_room_body.p;
	const float speed = hand_fly_speed(hypotf(wand[0] - head[0], wand[2] - head[2]));
	vec3 velocity;

	gr_pose_direction(&input->wand.T_room_body, ahead, velocity);
	gr_pose_direction(T_scene_room, velocity, velocity);
	glm_vec3_scale(velocity, speed, velocity);
	/*
	 * From the frame in which the button went down to the one in which it is still down, at the
	 * mean of both ends of each: the error of a moving hand falls with the square of the step.
	 */
	for (int i = 0; i < 3 && hand->flight.on; i++)
		T_scene_room->p[i] += 0.5f * step_s * (velocity[i] + hand->flight.velocity[i]);
	memcpy(hand->flight.velocity, velocity, sizeof velocity);
	hand->flight.on = true;
}

/* The part of a turn that is about the vertical. */
static void level(versor turn)
{
	const float length = hypotf(turn[1], turn[3]);

	turn[0] = turn[2] = 0;
	turn[1] = length > 0 ? turn[1] / length : 0;
	turn[3] = length > 0 ? turn[3] / length : 1;
}

/*
 * The scene turns with the hand as if it held it: seen from the room its turn
 * is that of the wand since the button went down, and the room's in the scene
 * the opposite one. From the orientations at the beginning, so no error adds
 * up. The thesis turns about the room's origin; here the scene turns about who
 * stands in it, wherever that is.
 */
static void drag(struct hand *hand, const struct master_input *input, struct gr_pose *T_scene_room)
{
	float *wand = (float *)input->wand.T_room_body.q;
	vec3 before, after;
	versor from, turn;

	if (!hand->drag.on) {
		hand->drag.on = true;
		glm_quat_copy(wand, hand->drag.wand);
		glm_quat_copy(T_scene_room->q, hand->drag.room);
		return;
	}
	glm_quat_conjugate(hand->drag.wand, from);
	glm_quat_mul(wand, from, turn);
	if (hand->bindings->turn == LAYOUT_TURN_LEVEL)
		level(turn);
	glm_quat_conjugate(turn, turn);
	gr_pose_point(T_scene_room, input->head.T_room_body.p, before);
	glm_quat_mul(hand->drag.room, turn, T_scene_room->q);
	glm_quat_normalize(T_scene_room->q);
	gr_pose_point(T_scene_room, input->head.T_room_body.p, after);
	for (int i = 0; i < 3; i++)
		T_scene_room->p[i] += before[i] - after[i];
}

static uint32_t carried(const struct scene_file *scene)
{
	uint32_t bits = 0;

	for (size_t i = 0; i < scene->lamp_count && i < PARAM_MAX_LAMPS; i++)
		if (scene->lamps[i].mount == SCENE_MOUNT_WAND)
			bits |= 1u << i;
	return bits;
}

/* All on or all off, also when the control socket left them mixed; one that was put down comes back. */
static void switch_lamps(struct hand *hand, struct master_settings *settings)
{
	const uint32_t lamps = carried(hand->scene);

	if (settings->lamp_on & lamps) {
		settings->lamp_on &= ~lamps;
		return;
	}
	settings->lamp_on |= lamps;
	if (hand->torch >= 0 && lamps >> hand->torch & 1)
		hand->put_down = false;
}

void hand_navigate(struct hand *hand, const struct hand_moment *now, struct master_settings *settings,
		   struct gr_pose *T_scene_room)
{
	const struct layout_hand *b = hand->bindings;
	const bool flies = hand_has(now->down, b->fly), drags = hand_has(now->down, b->drag);

	if (hand_has(now->pressed, b->lamps))
		switch_lamps(hand, settings);
	if (hand_has(now->pressed, b->reset)) {
		*T_scene_room = hand->scene->room;
		hand->drag.on = hand->flight.on = false;
		return;
	}
	if (drags)
		drag(hand, now->input, T_scene_room);
	if (flies)
		fly(hand, now->input, now->step_s, T_scene_room);
	hand->drag.on = drags;
	hand->flight.on = flies;
}
