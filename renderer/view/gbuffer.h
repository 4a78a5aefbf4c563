/*
 * What an eye sees, before light (seed 004 section 3.3.3): per pixel scene
 * position and shininess, normal, diffuse, specular and, where the scene has
 * any, emission. One for each eye, kept until the eye moves.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_VIEW_GBUFFER_H
#define GROTTO_RENDERER_VIEW_GBUFFER_H

#include "renderer/gl/mesh.h"

#include <cglm/cglm.h>
#include <stdbool.h>

#define GBUFFER_IMAGES 5

struct gbuffer {
	unsigned images[GBUFFER_IMAGES]; /* position, normal, diffuse, specular, emission (or 0) */
	unsigned depth;                  /* renderbuffer */
	unsigned framebuffer;
	int width, height, count;
};

/* Zeroed first; finish also after a failure. */
int gbuffer_init(struct gbuffer *gbuffer, int width, int height, bool emissive);
void gbuffer_finish(struct gbuffer *gbuffer);
int gbuffer_program(unsigned *out_program, bool emissive);
void gbuffer_draw(const struct gbuffer *gbuffer, unsigned program, const struct gl_mesh *mesh,
		  mat4 view_projection);
/* To texture units 0 on. */
void gbuffer_bind(const struct gbuffer *gbuffer);

#endif
