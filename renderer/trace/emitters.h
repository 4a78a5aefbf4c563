/*
 * Emissive triangles as lamps: one is drawn by its power (Walker's alias
 * method), a point on it evenly.
 *
 * Read only after init; any thread.
 */
#ifndef GROTTO_RENDERER_TRACE_EMITTERS_H
#define GROTTO_RENDERER_TRACE_EMITTERS_H

#include "renderer/trace/world.h"

struct emitter {
	unsigned triangle;
	float share;    /* alias table: how much of this slot is its own */
	unsigned alias; /* whose the rest is */
	bool two_sided, textured;
	struct v3 corner, ab, ac; /* a corner and the edges from it */
	struct v3 normal;         /* unit, the front */
	struct v3 radiance;       /* W/(m^2 sr), without a texture */
	float lift;               /* as world_lift */
};

struct emitters {
	struct emitter *emitters;
	size_t count;
	float *density; /* per triangle of the scene, 1/m^2: of drawing a point of it; NULL without emitters */
};
/* GR_OK; GR_ERR_RANGE: a material's emission is no finite number; GR_ERR_NOMEM. */
int emitters_init(struct emitters *out, const struct world *world);
void emitters_finish(struct emitters *emitters);

struct emitter_light {
	struct v3 direction; /* unit, to the point */
	struct v3 target;    /* the point, lifted off its triangle towards the lit one */
	float distance;
	struct v3 radiance;  /* W/(m^2 sr) */
	float pdf;           /* 1/sr */
};
/* choose, u: numbers in [0, 1). false: nothing arrives from there. */
bool emitters_sample(const struct emitters *emitters, const struct world *world, struct v3 from,
		     float choose, const float u[2], struct emitter_light *out);

/* Density, 1/sr, with which the above draws a hit that is `distance` away. */
static inline float emitters_pdf(const struct emitters *emitters, unsigned triangle, float distance,
				 float cosine)
{
	float density = emitters->density ? emitters->density[triangle] : 0.0f;

	return density > 0.0f ? density * distance * distance / cosine : 0.0f;
}

#endif
