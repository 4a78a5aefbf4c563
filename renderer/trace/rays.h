/*
 * CPU rays through a scene (Embree). Used for what is computed once: link
 * transmittance of the lattice, baking and the reference. Two-sided: every
 * triangle stops a ray, unless a query says otherwise.
 *
 * Thread safety: queries may run on several threads at once.
 */
#ifndef GROTTO_RENDERER_TRACE_RAYS_H
#define GROTTO_RENDERER_TRACE_RAYS_H

#include "renderer/scene/scene.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct rays;
/* Builds the acceleration structure; the scene may go after. */
int rays_create(struct rays **out, const struct scene *scene);
/* The same, built by several threads; 0: one a core. The structure is the same for any number. */
int rays_create_threads(struct rays **out, const struct scene *scene, int threads);
void rays_destroy(struct rays **rays);

struct ray_hit {
	float distance;
	unsigned triangle; /* index of the triangle: indices[3 * triangle] */
	float u, v;
	float normal[3]; /* geometric, unit, front side */
};
/* Largest coordinate of an origin or a direction; a ray beyond, or with NaN, meets nothing. */
#define RAYS_MOST 1e18f
static inline bool rays_valid(const float origin[3], const float direction[3])
{
	bool valid = true;

	for (int i = 0; i < 3; i++)
		valid = valid && fabsf(origin[i]) <= RAYS_MOST && fabsf(direction[i]) <= RAYS_MOST;
	return valid;
}
bool rays_nearest(const struct rays *rays, const float origin[3], const float direction[3],
		  float max_distance, struct ray_hit *out);
/*
 * How far the same point found twice may lie apart, in rounding errors of its
 * largest coordinate: a barycentric sum of three corners is off by up to about
 * three, and Embree's distance by as many; the rest is room.
 */
#define RAYS_ROUNDINGS 24.0f
/*
 * As rays_nearest, but where two faces coincide, back to back, either may come
 * first: it is the one that shows its front, or is two-sided. Unit direction.
 */
bool rays_nearest_front(const struct rays *rays, const float origin[3], const float direction[3],
			float max_distance, struct ray_hit *out);
/* Many rays of unit directions, however far; finds what rays_nearest_front finds, sooner. */
#define RAYS_NONE UINT32_MAX
struct ray_start {
	float origin[3], direction[3];
};
struct ray_met {
	float distance;
	uint32_t triangle; /* RAYS_NONE: nothing */
	float u, v;        /* in it */
	bool back;         /* of the triangle is what the ray meets */
};
void rays_nearest_many(const struct rays *rays, size_t count, const struct ray_start *starts,
		       struct ray_met *out);
/* As the renderer draws: what shows its back and is one-sided is not there. */
bool rays_nearest_drawn(const struct rays *rays, const float origin[3], const float direction[3],
			float max_distance, struct ray_hit *out);
/* Anything from origin to max_distance along a unit direction. */
bool rays_blocked_along(const struct rays *rays, const float origin[3], const float direction[3],
			float max_distance);
/* Anything strictly between the points a and b. */
bool rays_blocked(const struct rays *rays, const float a[3], const float b[3]);

#endif
