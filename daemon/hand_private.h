/* Between the parts of the hand: hand.c has the ring of layouts and the settings, the others one layout each. */
#ifndef GROTTO_DAEMON_HAND_PRIVATE_H
#define GROTTO_DAEMON_HAND_PRIVATE_H

#include "daemon/hand.h"

/* One step, as a layout sees it. */
struct hand_moment {
	const struct master_input *input;
	float step_s;
	uint32_t down, pressed; /* of what was pressed since the layout is in use */
};

static inline bool hand_has(uint32_t buttons, int button)
{
	return button >= 0 && button < 32 && buttons >> button & 1;
}

/* -1..1, 0 for an axis that is at rest or none. */
float hand_axis(const struct master_input *input, int index);

void hand_navigate(struct hand *hand, const struct hand_moment *now, struct master_settings *settings,
		   struct gr_pose *T_scene_room);
void hand_light_up(struct hand *hand, const struct hand_moment *now, struct master_settings *settings,
		   const struct gr_pose *T_scene_room);

#endif
