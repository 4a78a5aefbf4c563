#include "daemon/node_input.h"

#include <math.h>
#include <string.h>

bool node_input_wanted(const struct layout *layout)
{
	for (size_t i = 0; i < layout->tracker_count; i++)
		if (layout->trackers[i].kind == LAYOUT_TRACKER_WINDOW)
			return true;
	return false;
}

void node_input_tell(const struct target *target, struct fdp_node *fdp)
{
	struct target_input from;
	struct fdp_input input;

	if (!target_input(target, &from))
		return;
	input = (struct fdp_input){
		.buttons = from.buttons,
		.wheel = fminf(fmaxf(from.wheel, -FDP_INPUT_WHEEL_MOST), FDP_INPUT_WHEEL_MOST),
	};
	memcpy(input.axes, from.axes, sizeof input.axes);
	memcpy(input.pointer, from.pointer, sizeof input.pointer);
	fdp_node_input(fdp, &input);
}
