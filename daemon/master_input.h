/* What a frame is made from: where head and wand are, and what the hand does. Plain values. */
#ifndef GROTTO_DAEMON_MASTER_INPUT_H
#define GROTTO_DAEMON_MASTER_INPUT_H

#include "base/pose.h"
#include "tracking/report.h"

#include <stdbool.h>
#include <stdint.h>

/* A body at the photon time; what a tracker never saw is at the layout's start pose. */
struct master_body {
	struct gr_pose T_room_body;
	bool tracked;
};

struct master_input {
	int64_t time_ns; /* scene time of the frame, >= 0 */
	int64_t step_ns; /* since the frame before */
	struct master_body head, wand;
	uint32_t buttons; /* of the wand; none is down while it is not tracked */
	float axes[TRACK_AXES]; /* likewise; -1..1, right and up +; what it does not have is 0 */
};

#endif
