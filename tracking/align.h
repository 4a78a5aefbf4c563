/*
 * Where a device's frame is in the room, from points of the room at which a
 * body was while the device said where its sensor is: rotation, translation
 * and, where it is asked for, scale of least squares (Umeyama, IEEE PAMI 13,
 * 1991), with points that do not agree with the others found and left out.
 *
 *     room_i = R (scale base_i + arm_i) + t
 *
 * base_i is what the device says, in its metres; arm_i is the lever arm from
 * sensor to body, in true metres, turned as the sensor was into the base's
 * axes. With an arm and a scale both, Umeyama's step and the scale's are done
 * in turns until they stand; without one of them his solution is at once there.
 *
 * Wrong points. Of n points as many may be wrong as leave a majority of them
 * and four: none of 4, 1 of 5, 2 of 6, 3 of 7 or 8, 4 of 9. Of the fits through
 * each three points that one is taken that leaves the least sum of squares, no
 * point counted for more than most_m (MSAC: Torr and Zisserman, CVIU 78, 2000; of so
 * few points all triples are tried). A fit to the points nearest by it, as many as
 * cannot all be wrong, begins; to it are added, the nearest first and with a new fit
 * each time, points whose distance, over sqrt(1 + their leverage), is below 1 cm or
 * 6 (1 + 4 / f) standard deviations of a coordinate, f = 3 n - 6 of the n that count so
 * far. What is never added is wrong.
 *
 * Pure; lengths in metres, doubles.
 */
#ifndef GROTTO_TRACKING_ALIGN_H
#define GROTTO_TRACKING_ALIGN_H

#include "tracking/dmat3.h"

#include <stdbool.h>
#include <stddef.h>

#define ALIGN_POINTS 64
#define ALIGN_WHY 240

struct align_point {
	double room[3], base[3], arm[3];
};

struct align_params {
	bool scale;    /* fit it, too; else it is 1 */
	double most_m; /* the largest rms residual that is a calibration */
};
#define ALIGN_DEFAULTS ((struct align_params){ .most_m = 0.03 })

enum align_fault {
	ALIGN_GOOD,
	ALIGN_COUNT,      /* fewer than 3, or more than ALIGN_POINTS */
	ALIGN_NOT_FINITE, /* NaN or infinity among the numbers */
	ALIGN_TOO_FAR,    /* over 1000 m */
	ALIGN_COINCIDENT, /* all within 5 cm */
	ALIGN_COLLINEAR,  /* all on a line, up to 2 cm or a twentieth of their spread along it */
	ALIGN_MIRRORED,   /* the device's axes look left-handed */
	ALIGN_ORDER,      /* they would agree in another order */
	ALIGN_SCALE,      /* they would agree with another scale, or no scale can be */
	ALIGN_DISAGREE,   /* they are further apart than most_m, nobody knows why */
};

struct align_fit {
	enum align_fault fault;
	struct dmat3 R; /* R_room_base */
	double t[3];   /* where the base's origin is in the room */
	double scale;  /* room metres per metre of the device */
	double residual_m[ALIGN_POINTS]; /* of every point, wrong or not */
	bool wrong[ALIGN_POINTS];
	size_t used;          /* points that are not wrong */
	double rms_m, most_m; /* of their residuals */
	/* One standard deviation, from the residuals: of a coordinate of a point; of the turn, as an
	 * angle; of the place, at `middle`; of the scale. */
	double noise_m, turn_rad, place_m, scale_error;
	double middle[3]; /* of the used points, room */
};

/*
 * GR_OK; GR_ERR_RANGE: no fit can be (count, degenerate, not finite);
 * GR_ERR_MISMATCH: the points do not agree, and what would make them agree. Both
 * with a line in `why`; out->fault says which. Of `out` the fit is set as far as
 * it came with GR_ERR_MISMATCH, too.
 */
int align_fit(const struct align_point *points, size_t count, const struct align_params *params,
	      struct align_fit *out, char *why, size_t size);
/* What `out` makes of a point of the base: R (scale base + arm) + t. */
void align_apply(const struct align_fit *fit, const double base[3], const double arm[3],
		 double out[3]);
/* The point at which measurement `of` was taken after all, as close as those that agree; -1: none. */
int align_meant(const struct align_point *points, size_t count, const struct align_fit *fit, size_t of);

#endif
