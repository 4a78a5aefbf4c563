/*
 * Rotations in double precision: unit quaternions x y z w, and rotation
 * vectors (axis times angle, radians) as their logarithm. A filter that steps
 * a thousand times a second adds up what floats round off.
 */
#ifndef GROTTO_TRACKING_ROTATION_H
#define GROTTO_TRACKING_ROTATION_H

struct rotation {
	double q[4];
};

#define ROTATION_NONE ((struct rotation){ { 0, 0, 0, 1 } })

/* Of any length over 0. */
struct rotation rotation_from(const float q[4]);
void rotation_to(const struct rotation *r, float out[4]);
/* a then, in a's own frame, b. */
struct rotation rotation_mul(const struct rotation *a, const struct rotation *b);
struct rotation rotation_exp(const double v[3]);
/* The turn that takes a to b in a's frame, along the shorter arc: |out| <= pi. */
void rotation_between(const struct rotation *a, const struct rotation *b, double out[3]);
/* a turned by v in its own frame. */
struct rotation rotation_by(const struct rotation *a, const double v[3]);

#endif
