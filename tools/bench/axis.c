#include "tools/bench/axis.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Decades from which on not every digit has its mark, nor 2 and 5 their label. */
#define DECADES_PLAIN 2.5
#define DECADES_MOST 12.0
/* Beyond, only some of the decades have marks. */
#define DECADES_MARKED 24.0
/* Room beside the outermost values, in decades. */
#define ROOM 0.06

static const double steps[] = { 1, 2, 5 };

/* The nearest of 1, 2, 5 times a power of ten that is not above, or not below. */
static double round_to_step(double value, bool up)
{
	double power = pow(10, floor(log10(value)) - 1);
	double best = power;

	for (int decade = 0; decade < 4; decade++, power *= 10) {
		for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
			double step = steps[i] * power;

			/* rounding of pow() must not leave a step out */
			if (up && step >= value * (1 - 1e-9))
				return step;
			if (!up && step <= value * (1 + 1e-9))
				best = step;
		}
	}
	return best;
}

static void add_tick(struct axis *axis, double value, bool labelled)
{
	struct axis_tick *tick;

	if (axis->tick_count >= AXIS_TICKS_MAX || value < axis->low * (1 - 1e-9) ||
	    value > axis->high * (1 + 1e-9))
		return;
	tick = &axis->ticks[axis->tick_count++];
	tick->value = value;
	tick->labelled = labelled;
	tick->label[0] = '\0';
	if (labelled)
		snprintf(tick->label, sizeof tick->label, "%.6g", value);
}

static void add_ticks(struct axis *axis)
{
	double decades = log10(axis->high) - log10(axis->low);
	int first = (int)floor(log10(axis->low) + 1e-9), last = (int)ceil(log10(axis->high));
	int stride = (int)fmax(1, ceil(decades / DECADES_MARKED));

	for (int e = first; e <= last; e += stride) {
		for (int digit = 1; digit <= 9; digit++) {
			bool round = digit == 1 || digit == 2 || digit == 5;

			if (digit > 1 && decades > DECADES_MOST)
				break;
			if (!round && decades > 2 * DECADES_PLAIN)
				continue;
			add_tick(axis, digit * pow(10, e), digit == 1 || (round && decades <= DECADES_PLAIN));
		}
	}
}

void axis_fit(struct axis *axis, const double *values, size_t count)
{
	double low = INFINITY, high = 0;

	memset(axis, 0, sizeof *axis);
	for (size_t i = 0; i < count; i++) {
		if (!isfinite(values[i]) || values[i] <= 0)
			continue;
		low = fmin(low, values[i]);
		high = fmax(high, values[i]);
	}
	if (high <= 0) {
		low = 0.1;
		high = 10;
	} else {
		/* not to the ends of what a double holds: ticks stand a decade beyond */
		low = fmax(low, 1e-290) * pow(10, -ROOM);
		high = fmin(high, 1e290) * pow(10, ROOM);
	}
	if (high < low * sqrt(10)) {
		double middle = sqrt(low) * sqrt(high);

		low = middle / pow(10, 0.25);
		high = middle * pow(10, 0.25);
	}
	axis->low = round_to_step(low, false);
	axis->high = round_to_step(high, true);
	add_ticks(axis);
}

double axis_place(const struct axis *axis, double value)
{
	return (log(value) - log(axis->low)) / (log(axis->high) - log(axis->low));
}
