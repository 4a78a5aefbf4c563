/*
 * Points on the surfaces of a scene at which light is compared: spread evenly
 * by area over all sides that reflect diffusely, none right beside another
 * surface, where a point is in one patch and its neighbour in the next, and none
 * inside of a solid thing, where nobody sees it.
 */
#ifndef GROTTO_TOOLS_BENCH_POINTS_H
#define GROTTO_TOOLS_BENCH_POINTS_H

#include "renderer/renderer.h"
#include "renderer/scene/scene.h"

#include <stdint.h>

/* Distance that a point keeps from other surfaces, as a share of the longest side of the bounds. */
#define POINTS_MARGIN 0.004

struct bench_points {
	size_t count;
	struct renderer_point *points;
	double area; /* m^2 that each stands for */
};
/*
 * About `wanted` of them, fewer where surfaces are close together. The same
 * for the same scene, wanted and seed. GR_OK, GR_NOTHING when no side reflects
 * diffusely, GR_ERR_NOMEM.
 */
int bench_points_create(struct bench_points *out, const struct scene *scene, size_t wanted,
			uint64_t seed);
void bench_points_finish(struct bench_points *points);

#endif
