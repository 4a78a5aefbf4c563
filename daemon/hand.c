#include "daemon/hand_private.h"

#include "base/result.h"

#include <math.h>

static const char *const mode_names[HAND_MODES] = { "navigation", "lighting", "settings" };

const char *hand_mode_name(enum hand_mode mode)
{
	return (unsigned)mode < HAND_MODES ? mode_names[mode] : "unknown";
}

/* What a visitor would take for the torch: a lamp in the hand, else one to be taken; spots first. */
static int find_torch(const struct scene_file *scene)
{
	int best = -1, best_rank = 0;

	for (size_t i = 0; i < scene->lamp_count && i < PARAM_MAX_LAMPS; i++) {
		const struct scene_lamp *lamp = &scene->lamps[i];
		int rank = lamp->mount == SCENE_MOUNT_WAND ? 3 : 1;

		rank += lamp->kind == SCENE_LAMP_SPOT;
		if (lamp->mount == SCENE_MOUNT_HEAD || lamp->kind == SCENE_LAMP_DIRECTIONAL)
			rank = 0;
		if (rank > best_rank) {
			best = (int)i;
			best_rank = rank;
		}
	}
	return best;
}

void hand_init(struct hand *hand, const struct layout_hand *bindings, const struct scene_file *scene)
{
	*hand = (struct hand){ .bindings = bindings, .scene = scene, .torch = find_torch(scene) };
}

static bool is_place(const struct gr_pose *pose)
{
	return gr_pose_valid(pose) && fabsf(pose->p[0]) <= TRACK_PLACE_MAX_M &&
	       fabsf(pose->p[1]) <= TRACK_PLACE_MAX_M && fabsf(pose->p[2]) <= TRACK_PLACE_MAX_M;
}

static bool input_valid(const struct master_input *input)
{
	for (int i = 0; i < TRACK_AXES; i++)
		if (!(fabsf(input->axes[i]) <= 1)) /* NaN is not */
			return false;
	return input->step_ns >= 0 && is_place(&input->head.T_room_body) &&
	       is_place(&input->wand.T_room_body);
}

/* From the dead zone on, and finer near it: a small push is a small change. */
float hand_axis(const struct master_input *input, int index)
{
	float value, push;

	if (index < 0 || index >= TRACK_AXES)
		return 0;
	value = input->axes[index];
	push = (fabsf(value) - HAND_AXIS_DEAD) / (1 - HAND_AXIS_DEAD);
	return push > 0 ? copysignf(push * push, value) : 0;
}

static void count(uint32_t *value, enum param_id id, int more)
{
	const struct param_info *info = param_info(id);

	if (more > 0 ? *value < info->max : *value > info->min)
		*value += (uint32_t)more;
}

/* What was set beyond the most stays until it is pushed back. */
static void push(float *value, float by)
{
	if (by > 0)
		*value = fminf(*value + by, fmaxf(*value, HAND_MEDIUM_MOST));
	else if (by < 0)
		*value = fmaxf(*value + by, 0);
}

/* Layout 3: how the light is computed. */
static void set(struct hand *hand, const struct hand_moment *now, struct master_settings *settings)
{
	const struct layout_hand *b = hand->bindings;
	const int more = hand_has(now->pressed, b->more) - hand_has(now->pressed, b->fewer);

	if (more) { /* each method takes its own, and a scene has one */
		count(&settings->gi_steps, PARAM_GI_STEPS, more);
		count(&settings->gi_gathers, PARAM_GI_GATHERS, more);
	}
	if (hand_has(now->pressed, b->quality))
		hand->quality = !hand->quality;
	push(&settings->absorption, hand_axis(now->input, b->absorption) * HAND_MEDIUM_PER_S * now->step_s);
	push(&settings->scattering, hand_axis(now->input, b->scattering) * HAND_MEDIUM_PER_S * now->step_s);
}

int hand_step(struct hand *hand, const struct master_input *input, struct master_settings *settings,
	      struct gr_pose *T_scene_room)
{
	const int64_t step_ns = input->step_ns < HAND_STEP_MOST_NS ? input->step_ns : HAND_STEP_MOST_NS;
	uint32_t new = input->buttons & ~hand->buttons;
	struct hand_moment now = { .input = input, .step_s = (float)((double)step_ns * 1e-9) };

	if (!input_valid(input))
		return GR_ERR_RANGE;
	if (!input->wand.tracked) {
		hand->drag.on = hand->flight.on = false;
		hand->lost = true;
		return GR_OK;
	}
	if (hand->lost) /* pressed while nobody saw it */
		new = 0;
	hand->lost = false;
	hand->buttons = input->buttons;
	hand->stale &= input->buttons;
	if (hand_has(new, hand->bindings->next)) {
		hand->mode = (enum hand_mode)((hand->mode + 1) % HAND_MODES);
		hand->stale = input->buttons;
		hand->drag.on = hand->flight.on = false;
	}
	now.down = input->buttons & ~hand->stale;
	now.pressed = new & ~hand->stale;
	switch (hand->mode) {
	case HAND_NAVIGATION: hand_navigate(hand, &now, settings, T_scene_room); break;
	case HAND_LIGHTING: hand_light_up(hand, &now, settings, T_scene_room); break;
	case HAND_SETTINGS: set(hand, &now, settings); break;
	case HAND_MODES: break;
	}
	return GR_OK;
}
