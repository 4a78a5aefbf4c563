/*
 * Error over cost, both on logarithmic axes: a mark a point in the colour and
 * shape of its series, its label beside it, the Pareto front as stairs, a
 * legend. Written as SVG.
 */
#ifndef GROTTO_TOOLS_BENCH_PLOT_H
#define GROTTO_TOOLS_BENCH_PLOT_H

#include <stddef.h>
#include <stdio.h>

#define PLOT_POINTS_MAX 256
#define PLOT_SERIES_MAX 8

struct plot_point {
	const char *series; /* its name in the legend */
	const char *label;  /* beside the mark */
	double cost, error;
	double cost_low, cost_high; /* a whisker; NaN: none */
};

struct plot {
	const char *title, *subtitle;
	const char *cost_label, *error_label;
	const struct plot_point *points;
	size_t count;
	/* A level line, for what costs nothing; label NULL or an error that is not positive: none. */
	const char *level_label;
	double level;
};

/*
 * Points whose cost or error is not positive and finite are left out. GR_OK,
 * GR_ERR_RANGE with more points or series than fit, GR_ERR_IO.
 */
int plot_write(FILE *out, const struct plot *plot);

#endif
