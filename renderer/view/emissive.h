/*
 * Emissive surfaces as lamps: their patches on the GPU, a hemicube of depth
 * maps at each, and their layers of the reflective shadow maps. Nothing here
 * moves, so all of it is drawn once; the reflective maps again when the
 * medium changes.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_VIEW_EMISSIVE_H
#define GROTTO_RENDERER_VIEW_EMISSIVE_H

#include "renderer/gl/mesh.h"
#include "renderer/view/patches.h"
#include "renderer/view/rsm.h"

struct emissive_stage;
/* Layers that the groups take in the reflective shadow maps. */
int emissive_layers(const struct emissive_patches *patches);
/* rsm may be NULL; its layers from first_layer on are used. mesh and rsm must outlive the stage. */
int emissive_create(struct emissive_stage **out, const struct emissive_patches *patches,
		    const struct scene *scene, const struct gl_mesh *mesh, int shadow_pixels,
		    struct rsm *rsm, int first_layer);
void emissive_destroy(struct emissive_stage **stage);
/* Whether something has to be drawn, given that the medium changed or not. */
bool emissive_wants(const struct emissive_stage *stage, bool medium_changed);
void emissive_draw(struct emissive_stage *stage);
void emissive_bind(const struct emissive_stage *stage);
int emissive_pixels(const struct emissive_stage *stage);

#endif
