#include "renderer/gl/mesh.h"

#include "base/log.h"
#include "base/result.h"

#include <epoxy/gl.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* As struct Material in renderer/shaders/material.glsl (std430). */
struct gpu_material {
	float diffuse[4];
	float specular[4];
	float emission[4];
	uint32_t flags[4];
};

struct mesh_draw {
	GLsizei count;
	const void *first; /* offset into the index buffer */
	GLint material;
	GLuint textures[2];
	bool two_sided;
};

/* Draws without materials, neighbours joined: what glMultiDrawElements takes. */
struct mesh_ranges {
	GLsizei *counts;
	const void **firsts;
	GLsizei count;
};

struct gl_mesh {
	GLuint vao, vertices, indices, materials, white;
	GLuint *textures;
	size_t texture_count;
	struct mesh_draw *draws;
	size_t draw_count;
	struct mesh_ranges ranges[3]; /* by gl_mesh_what */
};

static bool draw_wanted(const struct mesh_draw *draw, enum gl_mesh_what what)
{
	return what == GL_MESH_ALL || draw->two_sided == (what == GL_MESH_TWO_SIDED);
}

static int create_geometry(struct gl_mesh *mesh, const struct scene *scene)
{
	static const struct {
		GLint size;
		size_t offset;
	} attributes[] = {
		{ 3, offsetof(struct scene_vertex, position) },
		{ 3, offsetof(struct scene_vertex, normal) },
		{ 2, offsetof(struct scene_vertex, uv) },
	};

	glCreateBuffers(1, &mesh->vertices);
	glNamedBufferStorage(mesh->vertices,
			     (GLsizeiptr)(scene->vertex_count * sizeof scene->vertices[0]),
			     scene->vertices, 0);
	glCreateBuffers(1, &mesh->indices);
	glNamedBufferStorage(mesh->indices,
			     (GLsizeiptr)(scene->index_count * sizeof scene->indices[0]),
			     scene->indices, 0);
	glCreateVertexArrays(1, &mesh->vao);
	glVertexArrayVertexBuffer(mesh->vao, 0, mesh->vertices, 0, sizeof(struct scene_vertex));
	glVertexArrayElementBuffer(mesh->vao, mesh->indices);
	for (GLuint i = 0; i < 3; i++) {
		glEnableVertexArrayAttrib(mesh->vao, i);
		glVertexArrayAttribFormat(mesh->vao, i, attributes[i].size, GL_FLOAT, GL_FALSE,
					  (GLuint)attributes[i].offset);
		glVertexArrayAttribBinding(mesh->vao, i, 0);
	}
	return GR_OK;
}

static int create_materials(struct gl_mesh *mesh, const struct scene *scene)
{
	struct gpu_material *gpu = calloc(scene->material_count, sizeof *gpu);

	if (!gpu)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < scene->material_count; i++) {
		const struct scene_material *m = &scene->materials[i];

		memcpy(gpu[i].diffuse, m->diffuse, sizeof m->diffuse);
		memcpy(gpu[i].specular, m->specular, sizeof m->specular);
		memcpy(gpu[i].emission, m->emission, sizeof m->emission);
		gpu[i].specular[3] = m->shininess;
		gpu[i].emission[3] = m->tinted_specular ? 1.0f : 0.0f;
		gpu[i].flags[0] = m->two_sided;
	}
	glCreateBuffers(1, &mesh->materials);
	glNamedBufferStorage(mesh->materials, (GLsizeiptr)(scene->material_count * sizeof *gpu),
			     gpu, 0);
	free(gpu);
	return GR_OK;
}

static GLuint create_texture(const uint8_t *rgba, int width, int height, bool srgb)
{
	GLuint texture;
	GLsizei levels = 1;

	for (int side = width > height ? width : height; side > 1; side /= 2)
		levels++;
	glCreateTextures(GL_TEXTURE_2D, 1, &texture);
	glTextureStorage2D(texture, levels, srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, width, height);
	glTextureSubImage2D(texture, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
	glGenerateTextureMipmap(texture);
	glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
	glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_REPEAT);
	glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_REPEAT);
	return texture;
}

static int create_textures(struct gl_mesh *mesh, const struct scene *scene)
{
	static const uint8_t white[4] = { 255, 255, 255, 255 };
	GLint most = 0;

	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	mesh->white = create_texture(white, 1, 1, false);
	if (scene->image_count == 0)
		return GR_OK;
	mesh->textures = calloc(scene->image_count, sizeof mesh->textures[0]);
	if (!mesh->textures)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < scene->image_count; i++) {
		const struct scene_image *image = &scene->images[i];

		if (image->width > most || image->height > most) {
			gr_error("texture %s: %d x %d, this OpenGL takes %d a side", image->name,
				 image->width, image->height, most);
			return GR_ERR_UNSUPPORTED;
		}
		mesh->textures[i] = create_texture(image->rgba, image->width, image->height,
						   image->srgb);
		mesh->texture_count = i + 1;
	}
	return GR_OK;
}

static int create_draws(struct gl_mesh *mesh, const struct scene *scene)
{
	mesh->draws = calloc(scene->draw_count, sizeof mesh->draws[0]);
	if (!mesh->draws)
		return GR_ERR_NOMEM;
	mesh->draw_count = scene->draw_count;
	for (size_t i = 0; i < scene->draw_count; i++) {
		const struct scene_draw *from = &scene->draws[i];
		const struct scene_material *material = &scene->materials[from->material];
		struct mesh_draw *draw = &mesh->draws[i];

		draw->count = (GLsizei)from->index_count;
		draw->first = (const void *)(from->first_index * sizeof scene->indices[0]);
		draw->material = (GLint)from->material;
		draw->two_sided = material->two_sided;
		draw->textures[0] = material->diffuse_image < 0 ? mesh->white
							       : mesh->textures[material->diffuse_image];
		draw->textures[1] = material->emission_image < 0
					    ? mesh->white
					    : mesh->textures[material->emission_image];
	}
	return GR_OK;
}

static int create_ranges(struct gl_mesh *mesh, enum gl_mesh_what what)
{
	struct mesh_ranges *r = &mesh->ranges[what];
	const char *end = NULL;

	r->counts = calloc(mesh->draw_count, sizeof r->counts[0]);
	r->firsts = calloc(mesh->draw_count, sizeof r->firsts[0]);
	if (!r->counts || !r->firsts)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < mesh->draw_count; i++) {
		const struct mesh_draw *draw = &mesh->draws[i];

		if (!draw_wanted(draw, what))
			continue;
		if (r->count > 0 && (const char *)draw->first == end) {
			r->counts[r->count - 1] += draw->count;
		} else {
			r->counts[r->count] = draw->count;
			r->firsts[r->count] = draw->first;
			r->count++;
		}
		end = (const char *)draw->first + (size_t)draw->count * sizeof(uint32_t);
	}
	return GR_OK;
}

int gl_mesh_create(struct gl_mesh **out, const struct scene *scene)
{
	struct gl_mesh *mesh = calloc(1, sizeof *mesh);
	int result;

	*out = NULL;
	if (!mesh)
		return GR_ERR_NOMEM;
	result = create_geometry(mesh, scene);
	if (result == GR_OK)
		result = create_materials(mesh, scene);
	if (result == GR_OK)
		result = create_textures(mesh, scene);
	if (result == GR_OK)
		result = create_draws(mesh, scene);
	for (int what = 0; what < 3 && result == GR_OK; what++)
		result = create_ranges(mesh, (enum gl_mesh_what)what);
	if (result == GR_OK && glGetError() == GL_OUT_OF_MEMORY) {
		gr_error("the GPU's memory does not hold the scene (%zu vertices, %zu textures)",
			 scene->vertex_count, scene->image_count);
		result = GR_ERR_GL;
	}
	if (result == GR_OK)
		*out = mesh;
	else
		gl_mesh_destroy(&mesh);
	return result;
}

void gl_mesh_destroy(struct gl_mesh **mesh)
{
	struct gl_mesh *m = *mesh;

	if (!m)
		return;
	for (int what = 0; what < 3; what++) {
		free(m->ranges[what].counts);
		free(m->ranges[what].firsts);
	}
	free(m->draws);
	if (m->textures)
		glDeleteTextures((GLsizei)m->texture_count, m->textures);
	free(m->textures);
	glDeleteTextures(1, &m->white);
	glDeleteVertexArrays(1, &m->vao);
	glDeleteBuffers(1, &m->materials);
	glDeleteBuffers(1, &m->indices);
	glDeleteBuffers(1, &m->vertices);
	free(m);
	*mesh = NULL;
}

void gl_mesh_draw(const struct gl_mesh *mesh, enum gl_mesh_what what)
{
	glBindVertexArray(mesh->vao);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, mesh->materials);
	for (size_t i = 0; i < mesh->draw_count; i++) {
		const struct mesh_draw *draw = &mesh->draws[i];

		if (!draw_wanted(draw, what))
			continue;
		glUniform1i(0, draw->material);
		glBindTextures(0, 2, draw->textures);
		glDrawElements(GL_TRIANGLES, draw->count, GL_UNSIGNED_INT, draw->first);
	}
}

void gl_mesh_draw_depth(const struct gl_mesh *mesh, enum gl_mesh_what what)
{
	const struct mesh_ranges *r = &mesh->ranges[what];

	if (r->count == 0)
		return;
	glBindVertexArray(mesh->vao);
	glMultiDrawElements(GL_TRIANGLES, r->counts, GL_UNSIGNED_INT, r->firsts, r->count);
}
