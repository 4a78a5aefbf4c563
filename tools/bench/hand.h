/*
 * A hand that works: reaches of least jerk (Flash and Hogan 1985) of 5 to 60 cm
 * and up to 90 degrees, 0.3 to 1 s long as their distance asks, each with a bend
 * to the side, and rests between them. A function of seed and time; its
 * accelerations are continuous. Position in metres about the origin.
 */
#ifndef GROTTO_TOOLS_BENCH_HAND_H
#define GROTTO_TOOLS_BENCH_HAND_H

#include "tracking/rotation.h"

#include <stdint.h>

struct hand_pose {
	double p[3];
	struct rotation q;
};

struct hand;
/* NULL: no memory. */
struct hand *hand_create(double seconds, uint64_t seed);
void hand_destroy(struct hand *hand);
/* Outside of 0..seconds: as at the nearest end. */
struct hand_pose hand_at(const struct hand *hand, double t);

#endif
