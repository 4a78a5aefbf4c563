/*
 * A body that is held still: the mean of its samples, and how far it moved
 * meanwhile. Pure; metres.
 */
#ifndef GROTTO_TRACKING_STILL_H
#define GROTTO_TRACKING_STILL_H

#include "tracking/rotation.h"

#include <stddef.h>

/* Zero-initialise. */
struct still {
	size_t count;
	double p[3];       /* mean of the sensor's place */
	double at[3], squares; /* mean of the body's place, and of what is spread about it */
	double q[4], first[4]; /* sum of quaternions of the first's sign */
};

/* p, q: of the sensor; at: of the body on it, whose movement counts. */
void still_add(struct still *still, const double p[3], const struct rotation *q, const double at[3]);
/* Root of the mean square distance of the body from its mean. */
double still_spread_m(const struct still *still);
/* The mean turn, of turns that are close together (Markley et al., JGCD 30, 2007, to first order). */
struct rotation still_turn(const struct still *still);

#endif
