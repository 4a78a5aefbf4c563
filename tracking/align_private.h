/* Shared by align.c (least squares), align_robust.c (which points) and align_explain.c (why not). */
#ifndef GROTTO_TRACKING_ALIGN_PRIVATE_H
#define GROTTO_TRACKING_ALIGN_PRIVATE_H

#include "tracking/align.h"

/* Which points count: their numbers. */
struct align_subset {
	size_t count;
	unsigned char of[ALIGN_POINTS];
};

/*
 * Least squares over a subset of at least 3: R, t and scale of `out`, and every
 * point's residual. False: no scale above 0 fits.
 */
bool align_least_squares(const struct align_point *points, size_t count,
			 const struct align_subset *subset, bool scale, struct align_fit *out);
/* Sum of squared residuals of a subset, by out->residual_m. */
double align_squares(const struct align_fit *fit, const struct align_subset *subset);
/* One standard deviation of a coordinate of a point; 0 where nothing is left to tell. */
double align_noise(const struct align_fit *fit, const struct align_subset *subset, bool scale);
/* Standard deviations along the three main axes of a set, falling; and their middle. */
void align_spread(const struct align_point *points, const struct align_subset *subset, bool room,
		  double out_m[3], double middle[3]);
/* The variance of where a fit to the subset puts a place, in units of a coordinate's: large far from it. */
double align_leverage(const struct align_point *points, const struct align_subset *subset, bool scale,
		      const double at[3]);

struct align_subset align_all(size_t count);
/* How many of `count` points may be wrong. */
size_t align_wrong_most(size_t count);
/* Fit to the points that agree; out->wrong are the others. False: no scale fits. */
bool align_consensus(const struct align_point *points, size_t count,
		     const struct align_params *params, struct align_fit *out);
/* Whether they agree better as the mirror image of what the device says, which `other` is then. */
bool align_mirrored(const struct align_point *points, size_t count, const struct align_params *params,
		    const struct align_fit *fit, struct align_fit *other);
/* Says why points do not agree, into out->fault and why: GR_ERR_MISMATCH. */
int align_explain(const struct align_point *points, size_t count, const struct align_params *params,
		  struct align_fit *out, char *why, size_t size);
/* A line into `why`; returns `result`. */
int align_say(char *why, size_t size, int result, const char *format, ...)
	__attribute__((format(printf, 4, 5)));

#endif
