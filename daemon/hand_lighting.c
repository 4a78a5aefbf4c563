/* Layout 2: the torch, its place and its colour. */
#include "daemon/hand_color.h"
#include "daemon/hand_private.h"

#include <math.h>

/* Where the hand holds it: as the scene file has it in the wand, else its light along the wand. */
static void hold_torch(struct hand *hand, const struct master_input *input,
		       const struct gr_pose *T_scene_room)
{
	const struct scene_lamp *lamp = &hand->scene->lamps[hand->torch];
	const vec3 tip = { 0, 0, 0 }, ahead = { 0, 0, -1 };
	const bool own = lamp->mount == SCENE_MOUNT_WAND;
	struct gr_pose T_scene_wand;

	gr_pose_mul(T_scene_room, &input->wand.T_room_body, &T_scene_wand);
	gr_pose_point(&T_scene_wand, own ? lamp->position : tip, hand->position);
	gr_pose_direction(&T_scene_wand, own ? lamp->direction : ahead, hand->direction);
	hand->put_down = true;
}

static void colour_torch(struct hand *hand, const struct hand_moment *now,
			 struct master_settings *settings)
{
	const struct layout_hand *b = hand->bindings;
	const float hue = hand_axis(now->input, b->hue) * HAND_HUE_PER_S * now->step_s;
	const float saturation = hand_axis(now->input, b->saturation) * HAND_SATURATION_PER_S * now->step_s;
	const int brighter = hand_has(now->down, b->brighter) - hand_has(now->down, b->dimmer);
	float *rgb = settings->lamp_intensity + 3 * (ptrdiff_t)hand->torch;
	struct hand_color c;

	/* Else it stays to the bit. */
	if (hue == 0 && saturation == 0 && brighter == 0)
		return;
	hand_color_of(rgb, hand->hue, &c);
	c.hue += hue;
	c.saturation = fminf(fmaxf(c.saturation + saturation, 0), 1);
	if (brighter > 0)
		c.value = fminf(fmaxf(c.value * exp2f(HAND_OCTAVES_PER_S * now->step_s), HAND_INTENSITY_LEAST),
				fmaxf(c.value, HAND_INTENSITY_MOST));
	else if (brighter < 0)
		c.value = fmaxf(c.value * exp2f(-HAND_OCTAVES_PER_S * now->step_s),
				fminf(c.value, HAND_INTENSITY_LEAST));
	hand->hue = c.hue - floorf(c.hue);
	hand_color_rgb(&c, rgb);
}

void hand_light_up(struct hand *hand, const struct hand_moment *now, struct master_settings *settings,
		   const struct gr_pose *T_scene_room)
{
	if (hand->torch < 0)
		return;
	if (hand_has(now->pressed, hand->bindings->torch))
		settings->lamp_on |= 1u << hand->torch;
	if (hand_has(now->down, hand->bindings->torch))
		hold_torch(hand, now->input, T_scene_room);
	colour_torch(hand, now, settings);
}
