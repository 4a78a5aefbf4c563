/*
 * The lever arm of a body that a sensor is on: where the wand's tip, or the
 * midpoint between the eyes, is in the sensor's frame.
 *
 * Pivot: the tip stays on one point, wherever that is, while the wand is turned
 * about it: p_i + R_i arm = tip for all i, linear in arm and tip. With the means
 * taken off, arm solves
 *
 *     sum (R_i - R)^T (R_i - R) arm = - sum (R_i - R)^T (p_i - p)
 *
 * whose matrix over n is I - R^T R, R the mean of the R_i. Its smallest
 * eigenvalue is the mean square of how far the end of a unit arm along the
 * direction that was turned least moves about its mean: turned about one axis
 * alone it is 0, and the arm along that axis cannot be told. Samples over 5 mm
 * and 4 standard deviations off are left out, as long as few are.
 *
 * Known points: the base's place is known, and so is where the body was.
 *
 * Pure; true metres (the device's times its scale), base's axes, doubles.
 */
#ifndef GROTTO_TRACKING_LEVER_H
#define GROTTO_TRACKING_LEVER_H

#include "tracking/dmat3.h"

#include <stdbool.h>
#include <stddef.h>

#define LEVER_SAMPLES 60000 /* a minute at 1 kHz */
#define LEVER_POINTS 64
#define LEVER_LEAST 10       /* samples of a pivot */
#define LEVER_TURN_LEAST 0.1 /* rad: square root of the smallest eigenvalue */
#define LEVER_RMS_MOST_M 0.01
#define LEVER_ARM_MOST_M 10.0 /* as a layout has it */

struct lever_sample {
	double p[3];       /* of the sensor */
	struct rotation q; /* T_base_sensor's */
};

enum lever_fault {
	LEVER_GOOD,
	LEVER_COUNT,
	LEVER_NOT_FINITE,
	LEVER_NOT_TURNED, /* about one axis, or hardly at all */
	LEVER_SLIPPED,    /* the tip moved, or points do not agree */
	LEVER_TOO_LONG,   /* over LEVER_ARM_MOST_M */
};

struct lever_fit {
	enum lever_fault fault;
	double arm[3]; /* sensor's frame */
	double tip[3]; /* pivot: where it stood, base */
	size_t used;
	double rms_m, most_m;    /* residuals of the used */
	double turned_rad[3];    /* pivot: rms turns, the most first */
	double least_turned[3];  /* the direction of arm that was turned least, sensor's frame */
	double error_m;          /* one standard deviation of the arm along that, from the residuals */
	double residual_m[LEVER_POINTS]; /* known points: of each */
	bool wrong[LEVER_POINTS];
};

/*
 * GR_OK; GR_ERR_RANGE (count, not finite, not turned), GR_ERR_MISMATCH (slipped,
 * too long) with a line in `why`; GR_ERR_NOMEM.
 */
int lever_pivot(const struct lever_sample *samples, size_t count, struct lever_fit *out, char *why,
		size_t size);
/*
 * body: for each sample where the body was, in the base's axes. At least one; a
 * point over 1 cm and 5 times their rms from the mean of the others is wrong, as
 * long as a majority, and two, are left. most_m: the largest rms that is one arm.
 */
int lever_points(const struct lever_sample *samples, const double (*body)[3], size_t count, double most_m,
		 struct lever_fit *out, char *why, size_t size);

#endif
