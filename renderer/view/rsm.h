/*
 * Reflective shadow maps: where the light of each lamp falls first, as the
 * global illumination takes it (struct rsm_set in renderer/gi/gi.h). Layers
 * of lamps come first, then those of emissive groups.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_VIEW_RSM_H
#define GROTTO_RENDERER_VIEW_RSM_H

#include "renderer/gi/gi.h"
#include "renderer/gl/mesh.h"
#include "renderer/view/maps.h"

struct rsm;
/* programs for lamps and for patches are made only where asked for. */
int rsm_create(struct rsm **out, int pixels, int layers, bool lamps, bool patches);
void rsm_destroy(struct rsm **rsm);

struct rsm_view {
	struct map_layer layer; /* for rsm->pixels; tiles: no margin */
	float origin[3];        /* perspective: where it looks from */
	float axis[3];          /* unit, where it looks to */
};
/* Draws one layer for lamp `lamp` of the lamp block. */
void rsm_draw_lamp(struct rsm *rsm, int index, const struct rsm_view *view, int lamp,
		   const struct gl_mesh *mesh);
/* Draws one layer lit by patches first .. first + count - 1 of the patch block. */
void rsm_draw_patches(struct rsm *rsm, int index, const struct rsm_view *view, int first,
		      int count, const struct gl_mesh *mesh);
/* A lamp that is off: nothing was hit. */
void rsm_clear(struct rsm *rsm, int index);
int rsm_pixels(const struct rsm *rsm);
/* What was drawn since the last call is in `changed`. Kept by rsm. */
const struct rsm_set *rsm_frame(struct rsm *rsm);

#endif
