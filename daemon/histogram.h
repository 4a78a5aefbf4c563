/*
 * Counts durations in buckets of 1/64 of a power of two, so that a percentile
 * over any number of frames costs no memory and no sorting; its error is
 * under 1.6 %. Values below 64 us are exact.
 */
#ifndef GROTTO_DAEMON_HISTOGRAM_H
#define GROTTO_DAEMON_HISTOGRAM_H

#include <stdint.h>

#define HISTOGRAM_BUCKETS (64 * 27)

struct histogram {
	uint64_t count;
	int64_t max_us;
	uint32_t buckets[HISTOGRAM_BUCKETS];
};

/* Microseconds; negative counts as 0, above 2^31 us as that. */
void histogram_add(struct histogram *histogram, int64_t us);
/* Nearest rank; share in (0, 1]. The middle of the bucket in us, 0 when empty. */
double histogram_percentile(const struct histogram *histogram, double share);

#endif
