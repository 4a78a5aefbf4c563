/*
 * Emissive triangles gathered into few rectangles that light the scene, for
 * Lambert's polygon formula (Lambert, Photometria, 1760; Baum et al. 1989).
 *
 * The triangles are cut where they are large, gathered top-down by place and
 * direction, and each cluster becomes the rectangle that it is, or, where it
 * is none, the one with the same area vector, flux, centroid and second
 * moments. So a rectangular lamp is exact; anything else is right in flux and
 * from some distance. A model with more separate lamps than PATCHES_MAX shares
 * the rectangles among neighbours.
 *
 * Pure, any thread.
 */
#ifndef GROTTO_RENDERER_VIEW_PATCHES_H
#define GROTTO_RENDERER_VIEW_PATCHES_H

#include "renderer/scene/scene.h"

#define PATCHES_MAX 16
/* Groups share reflective shadow maps; the patches of one lie side by side. */
#define PATCH_GROUPS_MAX 4

struct emissive_patch {
	float centre[3];
	float u[3], v[3]; /* half sides; u x v along the normal */
	float normal[3];
	float origin[3];   /* a point of the surface, lifted by 1 mm */
	float radiance[3]; /* W/(m^2 sr) */
};

struct emissive_group {
	int first, count; /* patches */
	float origin[3], normal[3];
};

struct emissive_patches {
	struct emissive_patch patches[PATCHES_MAX];
	int count;
	struct emissive_group groups[PATCH_GROUPS_MAX];
	int group_count;
	double flux[3]; /* of all emissive triangles, W per band */
	size_t triangles;
};

/* GR_OK (count 0 where nothing emits) or GR_ERR_NOMEM. */
int emissive_patches(const struct scene *scene, struct emissive_patches *out);

#endif
