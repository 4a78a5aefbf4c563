/* gi.method = "auto" for commands without a renderer: what a node of this machine would choose. */
#ifndef GROTTO_TOOLS_PLAN_H
#define GROTTO_TOOLS_PLAN_H

#include "config/scene_file.h"
#include "renderer/scene/scene.h"

/*
 * The settings in *out (which may be the file's), and on stdout what was chosen and why. gpu: EGL device, -1: the
 * first that works. GR_OK; GR_NOTHING where there is no OpenGL: *out is as the file says,
 * and a warning on stderr says that a node may choose otherwise; a GPU that was named
 * and is not there: as target_create.
 */
int plan_as_node(struct scene_gi *out, const struct scene_file *file, const struct scene *scene, int gpu);

#endif
