#include "renderer/gi/surfels_private.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SIDE SURFEL_PROBE_SIDE
#define TILE (SIDE + 2) /* with a border, so that the GPU's filter reads across the seams */

/* Probes in shaders/gi_probes.glsl (std140). */
struct probes_block {
	float origin[4];   /* w: metres between probes */
	int32_t size[4];   /* w: tiles in a row of the atlas */
	float texture_[4]; /* xy: 1 / size of the atlas in texels */
};

/* Real spherical harmonics of three bands: Y00, Y1-1, Y10, Y11, Y2-2 .. Y22. */
static void basis(const float d[3], float out[SURFEL_SH])
{
	float x = d[0], y = d[1], z = d[2];

	out[0] = 0.28209479f;
	out[1] = 0.48860251f * y;
	out[2] = 0.48860251f * z;
	out[3] = 0.48860251f * x;
	out[4] = 1.09254843f * x * y;
	out[5] = 1.09254843f * y * z;
	out[6] = 0.31539157f * (3 * z * z - 1);
	out[7] = 1.09254843f * x * z;
	out[8] = 0.54627422f * (x * x - y * y);
}

static int upload_links(struct surfels *s, const struct surfel_probes *from)
{
	size_t number = from->count * from->links_each;
	uint32_t *links = malloc(number * sizeof *links);
	float *rows = calloc(from->links_each + 1, SURFEL_SH * sizeof *rows);
	int result = GR_ERR_NOMEM;

	if (links && rows) {
		for (size_t k = 0; k < number; k++)
			links[k] = from->links[k] < s->count ? from->links[k] : (uint32_t)s->count;
		for (size_t k = 0; k < from->links_each; k++)
			basis(from->directions[k], rows + SURFEL_SH * k);
		result = surfels_storage(s, &s->probes.links, "links of probes", GL_R32UI,
					 number * sizeof *links, links);
	}
	if (result == GR_OK)
		result = surfels_storage(s, &s->probes.basis, "directions of probes", GL_R32F,
					 from->links_each * SURFEL_SH * sizeof *rows, rows);
	free(links);
	free(rows);
	return result;
}

static int upload_fixed(struct surfels *s, const struct surfel_probes *from)
{
	size_t number = from->count * SURFEL_SH;
	float *rows = calloc(4 * number, sizeof *rows);
	int result;

	if (!rows)
		return GR_ERR_NOMEM;
	for (size_t k = 0; k < number; k++)
		memcpy(rows + 4 * k, from->fixed[k / SURFEL_SH][k % SURFEL_SH], 3 * sizeof *rows);
	result = surfels_storage(s, &s->probes.fixed, "fixed light of probes", GL_RGBA32F,
				 4 * number * sizeof *rows, rows);
	free(rows);
	if (result == GR_OK)
		result = surfels_storage(s, &s->probes.ways, "ways of probes' light", GL_RG32F,
					 from->count * sizeof *from->fixed_way, from->fixed_way);
	if (result == GR_OK)
		result = surfels_storage(s, &s->probes.light, "light of probes", GL_RGBA32F,
					 4 * number * sizeof *rows, NULL);
	return result;
}

/* Texel of the map that a texel of a bordered tile shows: over an edge the octahedron folds. */
static size_t unfolded(int x, int y)
{
	if (x < 0 || x >= SIDE) {
		x = x < 0 ? 0 : SIDE - 1;
		y = SIDE - 1 - y;
	}
	if (y < 0 || y >= SIDE) {
		y = y < 0 ? 0 : SIDE - 1;
		x = SIDE - 1 - x;
	}
	return (size_t)y * SIDE + (size_t)x;
}

static int upload_distance(struct surfels *s, const struct surfel_probes *from)
{
	struct surfels_probes *p = &s->probes;
	int columns = (int)ceil(sqrt((double)from->count));
	int rows = ((int)from->count + columns - 1) / columns;
	GLint most = 0;
	float (*tile)[2] = malloc(sizeof *tile * TILE * TILE);

	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	if (!tile)
		return GR_ERR_NOMEM;
	if (columns * TILE > most) {
		gr_error("surfels: distance maps of %zu probes are %d texels wide, this GPU's textures %d; "
			 "fewer gi.probes help",
			 from->count, columns * TILE, most);
		free(tile);
		return GR_ERR_RANGE;
	}
	glCreateTextures(GL_TEXTURE_2D, 1, &p->distance);
	glTextureStorage2D(p->distance, 1, GL_RG32F, columns * TILE, rows * TILE);
	s->stats.gpu_bytes += (uint64_t)(columns * TILE) * (uint64_t)(rows * TILE) * 8;
	glTextureParameteri(p->distance, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTextureParameteri(p->distance, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	for (size_t i = 0; i < from->count; i++) {
		for (int y = 0; y < TILE; y++)
			for (int x = 0; x < TILE; x++)
				memcpy(tile[y * TILE + x], from->distance[i][unfolded(x - 1, y - 1)],
				       sizeof *tile);
		glTextureSubImage2D(p->distance, 0, (int)(i % (size_t)columns) * TILE,
				    (int)(i / (size_t)columns) * TILE, TILE, TILE, GL_RG, GL_FLOAT, tile);
	}
	free(tile);
	s->bytes += (size_t)columns * (size_t)rows * TILE * TILE * 8;
	const struct probes_block block = {
		.origin = { from->origin[0], from->origin[1], from->origin[2], from->cell_m },
		.size = { from->size[0], from->size[1], from->size[2], columns },
		.texture_ = { 1 / (float)(columns * TILE), 1 / (float)(rows * TILE), 0, 0 },
	};
	glCreateBuffers(1, &p->block);
	glNamedBufferStorage(p->block, sizeof block, &block, 0);
	return GR_OK;
}

/* Probes inside of solid things light nothing. */
static int upload_alive(struct surfels *s, const struct surfel_probes *from)
{
	uint32_t *rows = calloc(from->count, sizeof *rows);
	int result;

	if (!rows)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < from->count; i++)
		rows[i] = from->alive[i] != 0;
	result = surfels_storage(s, &s->probes.alive, "probes", GL_R32UI, from->count * sizeof *rows,
				 rows);
	free(rows);
	return result;
}

int surfels_probes_init(struct surfels *s, const struct surfel_set *set)
{
	const struct surfel_probes *from = &set->probes;
	struct surfels_probes *p = &s->probes;
	int result = program_create_compute(&p->program, "probe_gather.comp", NULL);

	if (result == GR_OK)
		result = program_create_compute(&p->check, "probe_check.comp", NULL);
	p->count = from->count;
	p->links_each = from->links_each;
	if (result == GR_OK)
		result = dispatch_plan((uint64_t)p->count * SURFEL_SH, SURFELS_GROUP, &p->all);
	if (result == GR_OK)
		result = dispatch_plan(p->count, SURFELS_GROUP, &p->each);
	if (result == GR_OK)
		result = upload_links(s, from);
	if (result == GR_OK)
		result = upload_fixed(s, from);
	if (result == GR_OK)
		result = upload_alive(s, from);
	if (result == GR_OK)
		result = upload_distance(s, from);
	return result;
}

void surfels_probes_finish(struct surfels *s)
{
	struct surfels_probes *p = &s->probes;

	program_destroy(&p->program);
	program_destroy(&p->check);
	surfels_storage_finish(&p->links);
	surfels_storage_finish(&p->basis);
	surfels_storage_finish(&p->fixed);
	surfels_storage_finish(&p->ways);
	surfels_storage_finish(&p->light);
	surfels_storage_finish(&p->alive);
	glDeleteTextures(1, &p->distance);
	glDeleteBuffers(1, &p->block);
}

void surfels_probes_gather(struct surfels *s)
{
	struct surfels_probes *p = &s->probes;
	const struct surfels_buffer *const from[3] = { &p->links, &p->basis, &p->fixed };
	float sigma = s->absorption + s->scattering;

	if (!p->program)
		return;
	for (unsigned i = 0; i < 3; i++)
		glBindTextureUnit(SURFELS_UNIT_PARTS + i, from[i]->texture);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_FOUND, p->light.buffer);
	glBindBufferBase(GL_UNIFORM_BUFFER, SURFELS_BINDING_BLOCK, p->block);
	glBindTextureUnit(SURFELS_UNIT_RADIOSITY, s->radiosity[s->current].texture);
	glBindTextureUnit(SURFELS_UNIT_TEXELS, s->texels.texture);
	glBindTextureUnit(SURFELS_UNIT_WAYS, p->ways.texture);
	glUseProgram(p->program);
	glProgramUniform2ui(p->program, 0, (unsigned)p->count * SURFEL_SH, p->links_each);
	glProgramUniform1f(p->program, 1, sigma <= 0 ? 0 : sigma < 1 ? log2f(1 - sigma) : -1e6f);
	glProgramUniform1f(p->program, 2, s->air.more);
	glDispatchCompute(p->all.x, p->all.y, 1);
	surfels_barrier();
}

void surfels_probes_check(struct surfels *s)
{
	struct surfels_probes *p = &s->probes;

	if (!p->program)
		return;
	glBindTextureUnit(SURFELS_UNIT_PROBES, p->light.texture);
	glUseProgram(p->check);
	glProgramUniform1ui(p->check, 0, (unsigned)p->count);
	glDispatchCompute(p->each.x, p->each.y, 1);
}

void surfels_probes_bind(const struct surfels *s)
{
	const struct surfels_probes *p = &s->probes;

	glBindBufferBase(GL_UNIFORM_BUFFER, SURFELS_BINDING_BLOCK, p->block);
	glBindTextureUnit(SURFELS_UNIT_PROBES, p->light.texture);
	glBindTextureUnit(SURFELS_UNIT_DISTANCE, p->distance);
	glBindTextureUnit(SURFELS_UNIT_ALIVE, p->alive.texture);
}
