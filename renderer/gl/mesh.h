/*
 * A scene on the GPU: one vertex array, one index buffer, materials in an
 * SSBO, textures. Drawn by draws that share a material.
 */
#ifndef GROTTO_RENDERER_GL_MESH_H
#define GROTTO_RENDERER_GL_MESH_H

#include "renderer/scene/scene.h"

struct gl_mesh;
int gl_mesh_create(struct gl_mesh **out, const struct scene *scene);
void gl_mesh_destroy(struct gl_mesh **mesh);

enum gl_mesh_what {
	GL_MESH_ALL,
	GL_MESH_ONE_SIDED, /* draw with GL_CULL_FACE where the pass culls */
	GL_MESH_TWO_SIDED,
};
/*
 * Vertex attributes 0 position, 1 normal, 2 uv. Binds the material SSBO to
 * binding 0 (struct in renderer/shaders/material.glsl), the draw's diffuse
 * texture to unit 0, emission texture to unit 1 (white where there is none),
 * and sets uniform location 0 (int) to the material's index.
 */
void gl_mesh_draw(const struct gl_mesh *mesh, enum gl_mesh_what what);
/* Positions only (shadow passes without textures): no uniform, no texture. */
void gl_mesh_draw_depth(const struct gl_mesh *mesh, enum gl_mesh_what what);

#endif
