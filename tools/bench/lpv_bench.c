#include "tools/bench/lpv_bench.h"

#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static unsigned array_texture(GLenum format, int pixels, int layers)
{
	unsigned texture;

	glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &texture);
	glTextureStorage3D(texture, 1, format, pixels, pixels, layers);
	glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glClearTexImage(texture, 0, GL_RGBA, GL_FLOAT, NULL);
	return texture;
}

void bench_maps_init(struct rsm_set *set, int pixels, int layers)
{
	memset(set, 0, sizeof *set);
	set->pixels = pixels;
	set->layers = layers;
	set->position_area = array_texture(GL_RGBA32F, pixels, layers);
	set->normal = array_texture(GL_RGBA16F, pixels, layers);
	set->exitance = array_texture(GL_RGBA32F, pixels, layers);
	set->version = 1;
}

void bench_maps_fill(struct rsm_set *set, int layer, const struct truth_texel *texels, float factor)
{
	size_t count = (size_t)set->pixels * (size_t)set->pixels;
	float *rows = calloc(count * 12, sizeof *rows);

	if (!rows)
		abort();
	for (size_t k = 0; k < count; k++) {
		for (int i = 0; i < 3; i++) {
			rows[4 * k + (size_t)i] = texels[k].position[i];
			rows[4 * (count + k) + (size_t)i] = texels[k].normal[i];
			rows[4 * (2 * count + k) + (size_t)i] = texels[k].exitance[i] * factor;
		}
		rows[4 * k + 3] = texels[k].area;
	}
	const unsigned textures[3] = { set->position_area, set->normal, set->exitance };
	for (size_t t = 0; t < 3; t++)
		glTextureSubImage3D(textures[t], 0, 0, 0, layer, set->pixels, set->pixels, 1, GL_RGBA,
				    GL_FLOAT, rows + 4 * t * count);
	free(rows);
	set->version++;
	set->changed = 1;
}

void bench_maps_finish(struct rsm_set *set)
{
	glDeleteTextures(1, &set->position_area);
	glDeleteTextures(1, &set->normal);
	glDeleteTextures(1, &set->exitance);
}

void bench_file(struct scene_file *file, int lattice, int steps)
{
	memset(file, 0, sizeof *file);
	file->gi.method = SCENE_GI_LPV;
	file->gi.lattice = lattice;
	file->gi.steps = steps;
	file->gi.link_rays = 8;
	file->gi.rsm_pixels = 128;
	for (int c = 0; c < 3; c++)
		file->gi.albedo_override[c] = -1;
}

void bench_frame(struct render_frame *frame, const struct scene_file *file)
{
	memset(frame, 0, sizeof *frame);
	frame->gi_on = true;
	frame->gi_steps = file->gi.steps;
	frame->gi_incremental = file->gi.incremental;
	frame->absorption_per_m = file->absorption_per_m;
	frame->scattering_per_m = file->scattering_per_m;
}

struct truth_spot bench_spot(void)
{
	struct truth_spot spot = { { 2, 3.9f, 2 }, { 0.1f, -0.99f, 0.1f }, { 50, 50, 50 }, 0.6f };
	float length = sqrtf(spot.direction[0] * spot.direction[0] +
			     spot.direction[1] * spot.direction[1] +
			     spot.direction[2] * spot.direction[2]);

	for (int i = 0; i < 3; i++)
		spot.direction[i] /= length;
	return spot;
}

struct bench_probe {
	unsigned program;
};

/* Not among the product's shaders: built around the method's own. */
int bench_probe_create(struct bench_probe **out, const struct gi_method *method)
{
	char defines[256];
	struct bench_probe *probe = calloc(1, sizeof *probe);
	int result;

	if (!probe)
		abort();
	snprintf(defines, sizeof defines, "#define GI_SHADER \"%s\"\n", method->ops->shader_name);
	result = program_create_compute(&probe->program, "gi_probe.comp", defines);
	if (result != 0) {
		free(probe);
		probe = NULL;
	}
	*out = probe;
	return result;
}

void bench_probe_run(struct bench_probe *probe, const struct gi_method *method,
		     const struct truth_sample *samples, size_t count, float *found)
{
	float *rows = calloc(count * 8 + 8, sizeof *rows);
	unsigned buffers[2];

	if (!rows)
		abort();
	for (size_t k = 0; k < count; k++)
		for (int i = 0; i < 3; i++) {
			rows[8 * k + (size_t)i] = samples[k].position[i];
			rows[8 * k + 4 + (size_t)i] = samples[k].normal[i];
		}
	glCreateBuffers(2, buffers);
	glNamedBufferStorage(buffers[0], (GLsizeiptr)(count * 32), rows, 0);
	glNamedBufferStorage(buffers[1], (GLsizeiptr)(count * 16), NULL, 0);
	method->ops->bind(method);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers[0]);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers[1]);
	glUseProgram(probe->program);
	glProgramUniform1i(probe->program, 0, (int)count);
	glDispatchCompute(((unsigned)count + 63) / 64, 1, 1);
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glGetNamedBufferSubData(buffers[1], 0, (GLsizeiptr)(count * 16), rows);
	for (size_t k = 0; k < count; k++)
		memcpy(found + 3 * k, rows + 4 * k, 3 * sizeof *found);
	glDeleteBuffers(2, buffers);
	free(rows);
}

void bench_probe_destroy(struct bench_probe **probe)
{
	if (!*probe)
		return;
	program_destroy(&(*probe)->program);
	free(*probe);
	*probe = NULL;
}
