/* The scene file's `materials`, put over those of the model. Inside of renderer/scene. */
#ifndef GROTTO_RENDERER_SCENE_SCENE_SURFACE_H
#define GROTTO_RENDERER_SCENE_SCENE_SURFACE_H

#include "base/diag.h"
#include "renderer/scene/scene.h"

/*
 * Every material of that name is changed; a name that the model does not have is
 * an error with those that it has. Tables are loaded once each. Neither
 * `emissive` nor `hash` follows: see scene.h. GR_OK, GR_ERR_CONFIG, GR_ERR_NOMEM.
 */
int scene_apply_surfaces(struct scene *scene, const struct scene_file *file, struct gr_diag *diag);

#endif
