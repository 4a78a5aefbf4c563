#include "daemon/node_vitals.h"

#include "renderer/gl/timer.h"

#include <math.h>
#include <stdio.h>

#define FRAMES 60 /* that a mean is of, at most */

static double mean_ms(const struct timers *timers, int stage)
{
	double ms[TIMER_WINDOW], sum = 0;
	const size_t count = timers_window(timers, stage, ms),
		     some = count < FRAMES ? count : FRAMES;

	for (size_t i = count - some; i < count; i++)
		sum += ms[i];
	return some ? sum / (double)some : 0;
}

void node_vitals_tell(struct renderer *renderer, struct fdp_node *fdp)
{
	const struct timers *timers = renderer_timers(renderer);
	struct fdp_vitals_stage stages[FDP_VITALS_STAGES] = { { "", 0 } };
	unsigned count = 0;

	for (int i = 0; timers && i < TIMER_STAGES && count < FDP_VITALS_STAGES; i++) {
		struct timer_stats stats;

		timers_stats(timers, i, &stats);
		if (!stats.name || !stats.name[0])
			continue;
		snprintf(stages[count].name, sizeof stages[count].name, "%.*s", FDP_VITALS_NAME - 1,
			 stats.name);
		stages[count++].us =
			(uint32_t)lrint(fmin(fmax(mean_ms(timers, i), 0) * 1e3, UINT32_MAX));
	}
	fdp_node_stages(fdp, stages, count);
}
