#include "renderer/gi/lpv_private.h"

#include "base/result.h"
#include "renderer/gi/transfer.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>

/* ThesisBlock in shaders/lpv_thesis_step.comp (std140). */
struct thesis_block {
	float transfer[SECTOR_COUNT][4];
	int32_t neighbour[SECTOR_COUNT][4];
	float fraction[SECTOR_COUNT][4];
};
#define THESIS_BINDING_BLOCK 9

static unsigned image(const struct lattice *l)
{
	unsigned texture;

	glCreateTextures(GL_TEXTURE_3D, 1, &texture);
	glTextureStorage3D(texture, 1, GL_RGBA32F, l->size[0], l->size[1], l->size[2]);
	glClearTexImage(texture, 0, GL_RGBA, GL_FLOAT, NULL);
	return texture;
}

/* One sample of a surface into its cell; the fourth of `count` counts them. */
static void add_blocker(const struct lattice *l, const float position[3], const float normal[3],
			float *blockers, unsigned *count)
{
	int cell[3];
	float lobe[4];
	size_t at;

	for (int i = 0; i < 3; i++)
		cell[i] = (int)floorf((position[i] - l->origin[i]) / l->d);
	if (!lattice_inside(l, cell[0], cell[1], cell[2]))
		return;
	at = lattice_index(l, cell[0], cell[1], cell[2]);
	transfer_lobe(normal, lobe);
	for (int i = 0; i < 4; i++)
		blockers[4 * at + (size_t)i] += lobe[i];
	count[at]++;
}

/* Algorithm 1, on a regular set of points at most half a cell apart. */
static void sample_triangle(const struct scene *scene, const uint32_t *t, const struct lattice *l,
			    float *blockers, unsigned *count)
{
	float e[2][3], n[3], longest = 0, length;
	const float *p0 = scene->vertices[t[0]].position;
	int steps;

	for (int k = 0; k < 2; k++) {
		float square = 0;

		for (int i = 0; i < 3; i++) {
			e[k][i] = scene->vertices[t[k + 1]].position[i] - p0[i];
			square += e[k][i] * e[k][i];
		}
		longest = fmaxf(longest, sqrtf(square));
	}
	for (int i = 0; i < 3; i++)
		n[i] = e[0][(i + 1) % 3] * e[1][(i + 2) % 3] - e[0][(i + 2) % 3] * e[1][(i + 1) % 3];
	length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	if (!(length > 0))
		return;
	for (int i = 0; i < 3; i++)
		n[i] /= length;
	steps = (int)fminf(ceilf(2 * longest / l->d), 4 * LATTICE_MAX) + 1;
	for (int u = 0; u < steps; u++) {
		for (int v = 0; u + v < steps; v++) {
			float a = ((float)u + 1 / 3.0f) / (float)steps;
			float b = ((float)v + 1 / 3.0f) / (float)steps;
			float at[3];

			for (int i = 0; i < 3; i++)
				at[i] = p0[i] + a * e[0][i] + b * e[1][i];
			add_blocker(l, at, n, blockers, count);
		}
	}
}

static int fill_blockers(struct lpv_thesis *thesis, const struct lattice *l,
			 const struct scene *scene)
{
	size_t cells = lattice_cells(l);
	float *blockers = calloc(cells * 4, sizeof *blockers);
	unsigned *count = calloc(cells, sizeof *count);
	int result = GR_ERR_NOMEM;

	if (!blockers || !count)
		goto out;
	for (size_t i = 0; i + 2 < scene->index_count; i += 3)
		sample_triangle(scene, scene->indices + i, l, blockers, count);
	/* The mean: a cell's blocking must not depend on how densely it was sampled. */
	for (size_t i = 0; i < cells; i++)
		for (size_t k = 0; k < 4 && count[i]; k++)
			blockers[4 * i + k] /= (float)count[i];
	glTextureSubImage3D(thesis->images[6], 0, 0, 0, 0, l->size[0], l->size[1], l->size[2],
			    GL_RGBA, GL_FLOAT, blockers);
	result = GR_OK;
out:
	free(blockers);
	free(count);
	return result;
}

static void fill_table(struct lpv_thesis *thesis)
{
	struct thesis_block block = { 0 };
	struct transfer transfer;

	transfer_init(&transfer);
	for (int j = 0; j < SECTOR_COUNT; j++) {
		for (int i = 0; i < 4; i++)
			block.transfer[j][i] = transfer.vector[j][i];
		for (int i = 0; i < 3; i++)
			block.neighbour[j][i] = sector_offset[j][i];
		block.fraction[j][0] = transfer.fraction[j];
	}
	glCreateBuffers(1, &thesis->table);
	glNamedBufferStorage(thesis->table, sizeof block, &block, 0);
}

int lpv_thesis_init(struct lpv_thesis *thesis, const struct lattice *lattice,
		    const struct scene *scene)
{
	int result = program_create_compute(&thesis->start, "lpv_thesis_start.comp", NULL);

	if (result == GR_OK)
		result = program_create_compute(&thesis->step, "lpv_thesis_step.comp", NULL);
	if (result == GR_OK)
		result = program_create_compute(&thesis->store, "lpv_thesis_store.comp", NULL);
	if (result != GR_OK)
		return result;
	for (int i = 0; i < 7; i++)
		thesis->images[i] = image(lattice);
	fill_table(thesis);
	return fill_blockers(thesis, lattice, scene);
}

void lpv_thesis_finish(struct lpv_thesis *thesis)
{
	program_destroy(&thesis->start);
	program_destroy(&thesis->step);
	program_destroy(&thesis->store);
	glDeleteTextures(7, thesis->images);
	glDeleteBuffers(1, &thesis->table);
}

static void bind_images(const struct lpv_thesis *thesis, int from)
{
	for (int c = 0; c < 3; c++) {
		glBindImageTexture((GLuint)c, thesis->images[3 * from + c], 0, GL_TRUE, 0,
				   GL_READ_ONLY, GL_RGBA32F);
		glBindImageTexture((GLuint)(3 + c), thesis->images[3 * !from + c], 0, GL_TRUE, 0,
				   GL_WRITE_ONLY, GL_RGBA32F);
	}
	glBindImageTexture(6, thesis->images[6], 0, GL_TRUE, 0, GL_READ_ONLY, GL_RGBA32F);
}

void lpv_thesis_steps(struct lpv_thesis *thesis, const struct lattice *l, float absorption,
		      float scattering, int steps)
{
	float kept, scattered;

	transfer_medium(absorption, scattering, l->d, &kept, &scattered);
	glBindBufferBase(GL_UNIFORM_BUFFER, THESIS_BINDING_BLOCK, thesis->table);
	glUseProgram(thesis->step);
	glProgramUniform1f(thesis->step, 0, kept);
	glProgramUniform1f(thesis->step, 1, scattered);
	for (int i = 0; i < steps; i++) {
		bind_images(thesis, thesis->newest);
		glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
		glDispatchCompute(((unsigned)l->size[0] + 3) / 4, ((unsigned)l->size[1] + 3) / 4,
				  ((unsigned)l->size[2] + 3) / 4);
		thesis->newest = !thesis->newest;
	}
}

void lpv_thesis_frame(struct lpv *lpv, float last_share, float this_share, int steps)
{
	struct lpv_thesis *thesis = &lpv->thesis;

	glBindTextureUnit(LPV_UNIT_LIGHT, lpv->light[lpv->current].texture);
	glBindTextureUnit(LPV_UNIT_START_INJECT, lpv->inject.texture);
	bind_images(thesis, thesis->newest);
	glUseProgram(thesis->start);
	glProgramUniform2f(thesis->start, 0, last_share, this_share);
	glDispatchCompute(lpv->per_cell.x, lpv->per_cell.y, 1);
	thesis->newest = !thesis->newest;
	lpv_thesis_steps(thesis, &lpv->lattice, lpv->absorption, lpv->scattering, steps);
	lpv->current = !lpv->current;
	bind_images(thesis, thesis->newest);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, LPV_BINDING_NEXT,
			 lpv->light[lpv->current].buffer);
	glUseProgram(thesis->store);
	glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
	glDispatchCompute(lpv->per_cell.x, lpv->per_cell.y, 1);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
			GL_BUFFER_UPDATE_BARRIER_BIT |
			GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}
