/*
 * Lamps without extent: their values on the GPU, their shadow maps and their
 * layers of the reflective shadow maps. A spot up to 120 degrees wide has one
 * map, a wider one and a point lamp the six faces of a cube, a directional
 * lamp one that fits the scene's bounds.
 *
 * A map is drawn when its lamp moved, and only then: a lamp that stands still
 * costs nothing after the first frame.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_VIEW_SHADOW_H
#define GROTTO_RENDERER_VIEW_SHADOW_H

#include "renderer/frame.h"
#include "renderer/gl/mesh.h"
#include "renderer/scene/scene.h"
#include "renderer/view/rsm.h"

struct shadow_stage;
/* Layers that the lamps of a scene file take in shadow and reflective shadow maps. */
int shadow_layers(const struct scene_file *file);
/*
 * rsm may be NULL (no global illumination); the lamps' layers there are the
 * first ones. file, scene, mesh and rsm must outlive the stage.
 */
int shadow_create(struct shadow_stage **out, const struct scene_file *file,
		  const struct scene *scene, const struct gl_mesh *mesh, struct rsm *rsm);
void shadow_destroy(struct shadow_stage **stage);

enum shadow_change {
	SHADOW_SAME = 0,
	SHADOW_LIGHT = 1, /* intensities: the pictures change */
	SHADOW_MAPS = 2,  /* some map has to be drawn again */
};
/* Takes over the frame's lamps; what changed, as a sum. Draws nothing. */
int shadow_take(struct shadow_stage *stage, const struct render_frame *frame);
/* Draws what shadow_take found to be old. */
void shadow_draw(struct shadow_stage *stage, bool medium_changed);
void shadow_bind(const struct shadow_stage *stage);

#endif
