/*
 * Time in nanoseconds. Logic never reads a clock: it is handed the time, so
 * that a whole cluster can be simulated. Only event loops and benchmarks call
 * gr_clock_now().
 */
#ifndef GROTTO_BASE_CLOCK_H
#define GROTTO_BASE_CLOCK_H

#include <stdint.h>

#define GR_NS_PER_S INT64_C(1000000000)
#define GR_NS_PER_MS INT64_C(1000000)
#define GR_NS_PER_US INT64_C(1000)

/* A source of monotonic time; `now` must not go backwards. */
struct gr_clock {
	int64_t (*now)(void *ctx);
	void *ctx;
};

/* CLOCK_MONOTONIC. */
extern const struct gr_clock gr_clock_monotonic;

static inline int64_t gr_clock_now(const struct gr_clock *clock)
{
	return clock->now(clock->ctx);
}

#endif
