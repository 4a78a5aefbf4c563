/*
 * A logarithmic axis: its range from the data and where its marks stand.
 * Pure functions.
 */
#ifndef GROTTO_TOOLS_BENCH_AXIS_H
#define GROTTO_TOOLS_BENCH_AXIS_H

#include <stdbool.h>
#include <stddef.h>

#define AXIS_TICKS_MAX 64
#define AXIS_LABEL_MAX 16

struct axis_tick {
	double value;
	bool labelled;
	char label[AXIS_LABEL_MAX]; /* "" unless labelled: "0.05", "20", "3e5" */
};

struct axis {
	double low, high; /* both on 1, 2 or 5 times a power of ten */
	struct axis_tick ticks[AXIS_TICKS_MAX];
	size_t tick_count;
};

/*
 * For values that are positive and finite; others do not count. Leaves some
 * room at both ends and is never narrower than half a decade. Without any
 * value it goes from 0.1 to 10.
 */
void axis_fit(struct axis *axis, const double *values, size_t count);
/* Where a value stands: 0 at low, 1 at high; logarithmic. */
double axis_place(const struct axis *axis, double value);

#endif
