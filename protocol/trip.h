/*
 * How long a peer takes to answer, and how long to wait before asking again:
 * RFC 6298's smoothed mean and deviation. A sample may have in it that something
 * was lost and asked for again: that makes the wait longer for a while, within its
 * bounds, and never leaves it without samples.
 */
#ifndef GROTTO_PROTOCOL_TRIP_H
#define GROTTO_PROTOCOL_TRIP_H

#include <stdint.h>

/* No wait is shorter: waking up takes some of it, and a lost datagram costs no more than this anyway. */
#define FDP_WAIT_LEAST_NS INT64_C(300000)

struct fdp_trip {
	int64_t mean_ns, spread_ns; /* 0, 0: no sample yet */
};

static inline void fdp_trip_take(struct fdp_trip *t, int64_t ns)
{
	int64_t off;

	if (ns < 1)
		ns = 1;
	if (!t->mean_ns) {
		*t = (struct fdp_trip){ ns, ns / 2 };
		return;
	}
	off = ns - t->mean_ns;
	t->spread_ns += ((off < 0 ? -off : off) - t->spread_ns) / 4;
	t->mean_ns += off / 8;
	if (t->mean_ns < 1)
		t->mean_ns = 1;
}

/* most_ns: bound, and what is waited before anything is known. */
static inline int64_t fdp_trip_wait(const struct fdp_trip *t, int64_t most_ns)
{
	const int64_t ns = t->mean_ns + 4 * t->spread_ns;
	const int64_t least = FDP_WAIT_LEAST_NS < most_ns ? FDP_WAIT_LEAST_NS : most_ns;

	if (!t->mean_ns || ns > most_ns)
		return most_ns;
	return ns < least ? least : ns;
}

#endif
