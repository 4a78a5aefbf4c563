/*
 * One light path, from the eye or from a surface point, to every source of
 * light: at each vertex one light of each kind is drawn (next event estimation)
 * and one direction by the surface; the two are weighed by the power heuristic
 * (Veach 1997, section 9.2). Russian roulette by throughput from the fourth
 * vertex on divides by what it keeps.
 *
 * Any thread; the scene is read only. Nothing is allocated.
 */
#ifndef GROTTO_RENDERER_TRACE_PATH_H
#define GROTTO_RENDERER_TRACE_PATH_H

#include "renderer/trace/emitters.h"
#include "renderer/trace/lamps.h"
#include "renderer/trace/medium.h"
#include "renderer/trace/sampler.h"
#include "renderer/trace/world.h"

struct path_scene {
	struct world world;
	struct emitters emitters;
	struct lamps lamps;
	struct medium medium;
	struct v3 background; /* W/(m^2 sr), seen directly only */
	int max_bounces;
};

/* total, indirect: as in reference.h. */
struct path_light {
	struct v3 total, indirect;
	/* Of what emitters send straight here: mean of the bands times metres of way, and their squares. */
	float way, way2;
	unsigned rays; /* traced for it */
};

/* Radiance that arrives at the eye along a unit direction. Pair 0 of the sampler is the caller's. */
struct path_light path_from_eye(const struct path_scene *scene, const struct sampler *sampler,
				struct v3 eye, struct v3 direction);
/* Irradiance on the side of a surface point that the unit normal shows. */
struct path_light path_irradiance(const struct path_scene *scene, const struct sampler *sampler,
				  struct v3 position, struct v3 normal);

#endif
