/*
 * A scene as the tracer sees it: rays, what a hit surface is, and points to
 * start rays from. Made once, read by all threads.
 */
#ifndef GROTTO_RENDERER_TRACE_WORLD_H
#define GROTTO_RENDERER_TRACE_WORLD_H

#include "renderer/scene/scene.h"
#include "renderer/scene/texel.h"
#include "renderer/trace/bsdf.h"
#include "renderer/trace/rays.h"
#include "renderer/trace/vector.h"

#include <float.h>

struct world {
	const struct scene *scene;
	struct rays *rays;
	uint32_t *material; /* per triangle */
	struct texel_curve curve;
	float lift; /* enough for any point of a surface */
};
/* The scene must outlive it. threads: for building. GR_OK, GR_ERR_NOMEM, GR_ERR_UNSUPPORTED. */
int world_init(struct world *out, const struct scene *scene, int threads);
void world_finish(struct world *world);

/* A point of a surface, seen along a ray. */
struct surface_hit {
	struct v3 position;
	struct v3 facing;   /* unit geometric normal towards the viewer */
	struct v3 shading;  /* unit interpolated normal, turned likewise */
	struct v3 emission; /* W/(m^2 sr) towards the viewer */
	float lift;         /* metres along facing: a ray that starts there misses this surface */
	bool dark;          /* the unlit side of a one-sided material: absorbs all */
	unsigned triangle;
	float u, v;
};
void world_hit(const struct world *world, const struct ray_hit *hit, struct v3 direction,
	       struct surface_hit *out);
/* Whether rounding may have put a hit beyond an edge of its triangle. */
bool world_at_edge(const struct world *world, const struct surface_hit *hit);
void world_bsdf(const struct world *world, const struct surface_hit *hit, struct v3 viewer,
		struct bsdf *out);

/* The same side of a triangle as its front. */
struct v3 world_emission(const struct world *world, unsigned triangle, float u, float v);
struct v3 world_corner(const struct world *world, unsigned triangle, int corner);
const struct scene_material *world_material(const struct world *world, unsigned triangle);

/*
 * How far off a surface a ray must start so that rounding does not make it hit
 * that surface again: a multiple of the coordinates' rounding (after Waechter
 * and Binder 2019, "A Fast and Robust Method for Avoiding Self-Intersection"),
 * so that it suits scenes of any size. corners: the triangle's.
 */
static inline float world_lift(struct v3 a, struct v3 b, struct v3 c)
{
	return RAYS_ROUNDINGS * FLT_EPSILON *
	       larger_of(v3_widest(a), larger_of(v3_widest(b), v3_widest(c)));
}

#endif
