/*
 * What an eye sees where no surface is: the scene's environment, or the scene
 * file's background. A constant one goes into the frame's block; a picture
 * becomes a texture that shading looks up by direction. It lights nothing: that
 * is the global illumination's work.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_VIEW_BACKDROP_H
#define GROTTO_RENDERER_VIEW_BACKDROP_H

#include "renderer/scene/scene.h"

#include <cglm/cglm.h>
#include <stdbool.h>

struct backdrop {
	float radiance[4]; /* for frame_block.background: rgb; a: 1 when only from above the horizon */
	unsigned image;    /* RGBA32F, latitude-longitude; 0: constant */
	float heading_rad;
};

/* Finish also after a failure. GR_ERR_UNSUPPORTED: larger than this OpenGL takes. */
int backdrop_init(struct backdrop *backdrop, const struct scene *scene,
		  const struct scene_file *file);
void backdrop_finish(struct backdrop *backdrop);
/* Whether shading must know each pixel's direction, and #defines for shade.frag when it does. */
bool backdrop_is_directed(const struct backdrop *backdrop);
const char *backdrop_defines(const struct backdrop *backdrop);
/* Texture and uniforms of the program in use; the matrix takes the scene to clip space. */
void backdrop_bind(const struct backdrop *backdrop, const mat4 view_projection, const float eye[3]);

#endif
