/*
 * What a ray that hit a scene's triangle met there: diffuse reflectance of
 * the lit side (textures included) and the normal on that side. For what is
 * computed on the CPU once. Read only after create; thread safe.
 */
#ifndef GROTTO_RENDERER_GI_SURFACE_H
#define GROTTO_RENDERER_GI_SURFACE_H

#include "renderer/scene/scene.h"
#include "renderer/trace/rays.h"

struct surface_lookup;
/* The scene must outlive it. GR_OK or GR_ERR_NOMEM. */
int surface_lookup_create(struct surface_lookup **out, const struct scene *scene);
void surface_lookup_destroy(struct surface_lookup **lookup);

struct surface_point {
	float albedo[3]; /* 0..1; 0 on the back of a one-sided material */
	float facing[3]; /* unit geometric normal towards the ray's origin */
	bool back;	 /* the unlit side of a one-sided material */
};
/* albedo_override as scene_gi's: components >= 0 replace the material's on lit sides. */
void surface_at(const struct surface_lookup *lookup, const struct ray_hit *hit,
		const float direction[3], const float albedo_override[3],
		struct surface_point *out);

#endif
