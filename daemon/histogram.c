#include "daemon/histogram.h"

#include <math.h>

static int bucket_of(uint32_t us)
{
	int shift;

	if (us < 64)
		return (int)us;
	shift = 31 - __builtin_clz(us) - 6; /* us >> shift is in 64..127 */
	return (shift + 1) * 64 + (int)((us >> shift) - 64);
}

void histogram_add(struct histogram *histogram, int64_t us)
{
	uint32_t value = us < 0 ? 0 : us > INT32_MAX ? INT32_MAX : (uint32_t)us;

	histogram->buckets[bucket_of(value)]++;
	histogram->count++;
	if ((int64_t)value > histogram->max_us)
		histogram->max_us = value;
}

double histogram_percentile(const struct histogram *histogram, double share)
{
	uint64_t rank = (uint64_t)ceil(share * (double)histogram->count), seen = 0;

	if (histogram->count == 0)
		return 0;
	for (int i = 0; i < HISTOGRAM_BUCKETS; i++) {
		seen += histogram->buckets[i];
		if (seen < rank)
			continue;
		if (i < 64)
			return i;
		int shift = i / 64 - 1;
		double low = ldexp(64 + i % 64, shift), middle = low + (ldexp(1, shift) - 1) / 2;
		return middle > (double)histogram->max_us ? (double)histogram->max_us : middle;
	}
	return (double)histogram->max_us;
}
