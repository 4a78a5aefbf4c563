#include "daemon/swap_wait.h"

#include "base/clock.h"

#include <errno.h>
#include <sched.h>
#include <time.h>

void swap_give_way(void)
{
	sched_yield();
}

int64_t swap_wait(int64_t at_ns, int64_t busy_ns)
{
	const int64_t until_ns = at_ns - busy_ns;
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic);

	if (now_ns < until_ns) {
		const struct timespec ts = { until_ns / GR_NS_PER_S, until_ns % GR_NS_PER_S };

		while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &ts, NULL) == EINTR)
			;
		now_ns = gr_clock_now(&gr_clock_monotonic);
	}
	while (now_ns < at_ns) {
		sched_yield();
		now_ns = gr_clock_now(&gr_clock_monotonic);
	}
	return now_ns;
}
