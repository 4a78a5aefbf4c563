/*
 * Statistics of measured values. Pure functions; nothing is allocated, and
 * what cannot be said of the values is NaN.
 */
#ifndef GROTTO_TOOLS_BENCH_STATS_H
#define GROTTO_TOOLS_BENCH_STATS_H

#include <stdbool.h>
#include <stddef.h>

struct stats_spread {
	size_t count;
	double median, p10, p90; /* NaN without values */
};
/* Rising order; NaN must not be among them. */
void stats_sort(double *values, size_t count);
/* Of sorted values, linear between the nearest two (type 7 of Hyndman and Fan 1996); share in [0, 1]. */
double stats_quantile(const double *sorted, size_t count, double share);
/* Sorts them. */
struct stats_spread stats_spread(double *values, size_t count);

/* Found values against true ones, in bands, each point weighing as much as it stands for. */
struct stats_error {
	size_t count;
	double mean;  /* of the truth, weighed, over points and bands */
	double bias;  /* (mean found - mean true) / mean true */
	double nrmse; /* root of the mean square error / mean true */
	/*
	 * 95th percentile over the points of |found - true| / true, both averaged
	 * over the bands first. True is taken as at least STATS_DARK of the mean:
	 * where it is darker, a relative error says nothing.
	 */
	double p95;
	size_t nonfinite; /* found values that are NaN or infinite: left out */
};
#define STATS_DARK 0.01
/*
 * found, truth: count * bands; weights: count, NULL: all alike. scratch: count
 * values. GR_OK, GR_NOTHING when the truth is dark everywhere (all NaN then).
 */
int stats_compare(const float *found, const double *truth, const double *weights, size_t count,
		  size_t bands, double *scratch, struct stats_error *out);

/*
 * Flicker: |E(t-1) - 2 E(t) + E(t+1)| over the mean of all E, for series of
 * `points` values a frame. NaN with fewer than three frames or nothing lit.
 */
struct stats_flicker {
	double worst, mean;
};
struct stats_flicker stats_flicker(const float *series, size_t frames, size_t points);

/* Frames until the errors stay within the bound: 1 is the first; 0: not within these. */
size_t stats_frames_within(const double *errors, size_t frames, double bound);

struct stats_point {
	double cost, error;
};
/*
 * The points that none beats: no other costs as little and errs as little, or
 * less in one. Writes their indices, cost rising, and returns their number.
 * Points that are not finite take no part; of equal ones the first counts.
 */
size_t stats_pareto(const struct stats_point *points, size_t count, size_t *out_indices);

#endif
