#include "base/clock.h"

#include <time.h>

static int64_t monotonic_now(void *ctx)
{
	struct timespec ts;

	(void)ctx;
	clock_gettime(CLOCK_MONOTONIC, &ts);
	return (int64_t)ts.tv_sec * GR_NS_PER_S + ts.tv_nsec;
}

const struct gr_clock gr_clock_monotonic = { monotonic_now, 0 };
