#include "tracking/device_clock.h"

#include "base/line_fit.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#define SANE_NS (INT64_MAX / 16) /* 18 years: differences of such times cannot overflow */
#define DRIFT_PRIOR 300e-6	 /* crystals, and rates that are named rounder than they are */
#define DRIFT_MOST 5e-3
#define NOISE_LEAST_NS 20e3 /* of the least difference in a bin */

void track_clock_init(struct track_clock *c)
{
	const uint64_t steps = c->steps;

	*c = (struct track_clock){ .newest = -1, .steps = steps };
	for (int i = 0; i < TRACK_CLOCK_BINS; i++)
		c->bins[i].epoch = -1;
}

static bool in_window(const struct track_clock *c, const struct track_clock_bin *bin)
{
	return bin->epoch >= 0 && bin->epoch > c->newest - TRACK_CLOCK_BINS;
}

/* Seconds and ns from the newest bin's. */
static double bin_x(const struct track_clock *c, const struct track_clock_bin *bin)
{
	return (double)(bin->at_ns - c->at_ns) * 1e-9;
}

static double bin_y(const struct track_clock *c, const struct track_clock_bin *bin)
{
	return (double)(bin->ahead_ns - c->ahead_ns);
}

/* How far the lowest bin lies above a line of this slope through the newest; <= 0. */
static double lowest(const struct track_clock *c, double slope)
{
	double least = 0;

	for (int i = 0; i < TRACK_CLOCK_BINS; i++)
		if (in_window(c, &c->bins[i]))
			least = fmin(least, bin_y(c, &c->bins[i]) - slope * bin_x(c, &c->bins[i]));
	return least;
}

static void fit(struct track_clock *c)
{
	const struct track_clock_bin *newest = &c->bins[c->newest % TRACK_CLOCK_BINS];
	struct gr_line_fit line = { 0 };
	double slope = c->drift * 1e9, y0, least;

	c->at_ns = newest->at_ns;
	c->ahead_ns = newest->ahead_ns;
	/* A bin without a quick report lies high above the others and says little. */
	least = lowest(c, slope);
	for (int i = 0; i < TRACK_CLOCK_BINS; i++) {
		const struct track_clock_bin *bin = &c->bins[i];
		double x, y, off;

		if (!in_window(c, bin))
			continue;
		x = bin_x(c, bin);
		y = bin_y(c, bin);
		off = NOISE_LEAST_NS + (y - slope * x - least);
		gr_line_fit_add(&line, x, y, 1 / (off * off));
	}
	gr_line_fit_solve(&line, DRIFT_PRIOR * 1e9, DRIFT_MOST * 1e9, &y0, &slope, NULL);
	c->drift = slope * 1e-9;
	/* Under all of them: no report was there before it was measured. */
	c->ahead_ns += llrint(lowest(c, slope));
}

static int64_t ahead_at(const struct track_clock *c, int64_t arrived_ns)
{
	return c->ahead_ns + llrint(c->drift * (double)(arrived_ns - c->at_ns));
}

/* True when the line has to be drawn anew. */
static bool keep(struct track_clock *c, int64_t arrived_ns, int64_t ahead_ns)
{
	const int64_t epoch = arrived_ns / TRACK_CLOCK_BIN_NS;
	struct track_clock_bin *bin = &c->bins[epoch % TRACK_CLOCK_BINS];

	if (bin->epoch == epoch && bin->ahead_ns <= ahead_ns)
		return false;
	*bin = (struct track_clock_bin){ epoch, arrived_ns, ahead_ns };
	if (epoch > c->newest)
		c->newest = epoch;
	return true;
}

static bool sane(int64_t ns)
{
	return ns > -SANE_NS && ns < SANE_NS;
}

int64_t track_clock_map(struct track_clock *c, int64_t device_ns, int64_t arrived_ns, bool *stepped)
{
	int64_t mapped, ahead_ns;

	if (stepped)
		*stepped = false;
	if (!sane(device_ns) || !sane(arrived_ns) || arrived_ns < 0)
		return arrived_ns;
	ahead_ns = arrived_ns - device_ns;
	if (c->newest >= 0 && (llabs(ahead_ns - ahead_at(c, arrived_ns)) > TRACK_CLOCK_STEP_NS ||
			       arrived_ns / TRACK_CLOCK_BIN_NS <= c->newest - TRACK_CLOCK_BINS)) {
		track_clock_init(c);
		c->steps++;
		if (stepped)
			*stepped = true;
	}
	if (keep(c, arrived_ns, ahead_ns))
		fit(c);
	mapped = device_ns + ahead_at(c, arrived_ns);
	return mapped < arrived_ns ? mapped : arrived_ns;
}

double track_clock_drift_ppm(const struct track_clock *c)
{
	return -c->drift * 1e6;
}
