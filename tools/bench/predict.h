/*
 * How far a filter's poses are from the truth, some time ahead of the last
 * sample, on motion whose truth is known.
 */
#ifndef GROTTO_TOOLS_BENCH_PREDICT_H
#define GROTTO_TOOLS_BENCH_PREDICT_H

#include "tools/bench/hand.h"
#include "tracking/filter.h"

#include <stdbool.h>
#include <stddef.h>

/* Where the body truly is at t seconds. */
struct predict_motion {
	struct hand_pose (*at)(const void *ctx, double t);
	const void *ctx;
	double seconds;
};

struct predict_samples {
	double rate_hz;
	double noise_m, noise_rad; /* standard deviation per axis */
	uint64_t seed;
};

struct predict_error {
	double rms_m, p99_m, rms_rad, p99_rad;
	/*
	 * By how much what is shown comes after the truth, in seconds, over all
	 * times at which the body moves: the shift that leaves the least error.
	 * NaN for a body that rests.
	 */
	double lag_s;
};
/*
 * Filters all samples and asks for the pose `horizon_s` after each. params NULL:
 * the last sample as it is. The first second does not count. False: no memory.
 */
bool predict_measure(const struct predict_motion *motion, const struct predict_samples *samples,
		     const struct track_filter_params *params, double horizon_s,
		     struct predict_error *out);

/* Standard deviation per axis of what is shown of a body that rests, 10 s of it. */
struct predict_rest {
	double m, rad;
};
struct predict_rest predict_rest(const struct predict_samples *samples,
				 const struct track_filter_params *params);

#endif
