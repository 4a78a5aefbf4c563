#include "renderer/gi/surfels_private.h"

#include "base/log.h"
#include "base/result.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REST 1e-5		 /* of the light before a change, when work stops */
#define BOUND_WORK 200000000	 /* links read for the bound, at most about */
#define BOUND_BOUNCES 8
#define SETTLE_MOST 512		 /* gathers; a closed room of white walls never settles */

int surfels_storage(struct surfels *s, struct surfels_buffer *out, const char *what,
		    unsigned format, size_t bytes, const void *data)
{
	GLint64 most = 0;
	GLint texels = 0;
	size_t texel = format == GL_R32UI || format == GL_R32F ? 4 : format == GL_RGBA16F || format == GL_RG32UI || format == GL_RG32F ? 8 : 16;

	glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
	glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
	if (format && bytes / texel > (size_t)texels) {
		gr_error("surfels: %s: %zu texels, this GPU's buffer textures hold %d; a larger spacing_m helps",
			 what, bytes / texel, texels);
		return GR_ERR_RANGE;
	}
	if (format && bytes > (size_t)most) {
		gr_error("surfels: %s: %zu bytes, this GPU's storage blocks hold %lld; a larger spacing_m helps",
			 what, bytes, (long long)most);
		return GR_ERR_RANGE;
	}
	if (bytes < 16) {
		bytes = 16;
		data = NULL;
	}
	glCreateBuffers(1, &out->buffer);
	glNamedBufferStorage(out->buffer, (GLsizeiptr)bytes, data, GL_DYNAMIC_STORAGE_BIT);
	s->stats.gpu_bytes += bytes;
	if (!data)
		glClearNamedBufferData(out->buffer, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
	if (format) {
		glCreateTextures(GL_TEXTURE_BUFFER, 1, &out->texture);
		glTextureBuffer(out->texture, format, out->buffer);
	}
	s->bytes += bytes;
	return GR_OK;
}

void surfels_storage_finish(struct surfels_buffer *buffer)
{
	glDeleteTextures(1, &buffer->texture);
	glDeleteBuffers(1, &buffer->buffer);
	buffer->texture = buffer->buffer = 0;
}

/* Place of entry k of surfel i in blocks of SURFELS_GROUP (surfel_entry in surfel_slice.glsl). */
static size_t entry(size_t i, size_t each, size_t k)
{
	return (i / SURFELS_GROUP * each + k) * SURFELS_GROUP + i % SURFELS_GROUP;
}

/*
 * Entries of all surfels, `texels` of four words each, seen in parts of so many
 * surfels, whole groups, as a buffer texture can have at once.
 */
static int upload_parts(struct surfels *s, struct surfels_buffer *to, const char *what, size_t padded,
			size_t texels, const void *data, uint32_t *out)
{
	GLint most = 0;
	int result;

	glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
	size_t groups = texels > 0 ? (size_t)most / (texels * SURFELS_GROUP) : 0;

	if (groups == 0) {
		gr_error("surfels: %s of %d surfels are %zu texels, this GPU's buffer textures hold %d", what,
			 SURFELS_GROUP, texels * SURFELS_GROUP, most);
		return GR_ERR_RANGE;
	}
	*out = groups > UINT32_MAX / SURFELS_GROUP / 2 ? UINT32_MAX / 2 / SURFELS_GROUP * SURFELS_GROUP
						       : (uint32_t)(groups * SURFELS_GROUP);
	result = surfels_storage(s, to, what, 0, padded * texels * 16, data);
	if (result != GR_OK)
		return result;
	glCreateTextures(GL_TEXTURE_BUFFER, 1, &to->texture);
	glTextureBufferRange(to->texture, GL_RGBA32UI, to->buffer, 0,
			     (GLsizeiptr)((padded < *out ? padded : *out) * texels * 16));
	return GR_OK;
}

/* Four a texel; nothing is the dark surfel at the end. */
static int upload_links(struct surfels *s, const struct surfel_set *set)
{
	size_t padded = (set->count + SURFELS_GROUP - 1) / SURFELS_GROUP * SURFELS_GROUP;
	size_t texels = surfels_link_texels(set->links_each);
	uint32_t *links = malloc(padded * texels * 16);
	int result;

	if (!links)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < padded; i++)
		for (size_t k = 0; k < 4 * texels; k++) {
			uint32_t link = i < set->count && k < set->links_each
						? set->links[i * set->links_each + k]
						: SURFEL_NONE;

			links[4 * entry(i, texels, k / 4) + k % 4] =
				link < set->count ? link : (uint32_t)set->count;
		}
	result = upload_parts(s, &s->links, "links", padded, texels, links, &s->links_part);
	free(links);
	return result;
}

static int upload_taps(struct surfels *s, const struct surfel_set *set)
{
	size_t padded = (set->count + SURFELS_GROUP - 1) / SURFELS_GROUP * SURFELS_GROUP;
	struct surfel_tap *taps = calloc(padded * set->taps_each, sizeof *taps);
	int result;

	_Static_assert(sizeof *taps == 16, "a texel");
	if (!taps)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < set->count; i++)
		for (size_t k = 0; k < set->taps_each; k++)
			taps[entry(i, set->taps_each, k)] = set->taps[i * set->taps_each + k];
	result = upload_parts(s, &s->taps, "taps", padded, set->taps_each, taps, &s->taps_part);
	free(taps);
	return result;
}

/* One more, of zeros, at the end, for links that bring nothing. */
static int upload_texels(struct surfels *s, const struct surfel_set *set)
{
	int result = surfels_storage(s, &s->texels, "surfels", GL_RGBA32UI,
				     (set->count + 1) * sizeof *set->surfels, NULL);

	_Static_assert(sizeof *set->surfels == 32, "two texels");
	if (result == GR_OK)
		glNamedBufferSubData(s->texels.buffer, 0, (GLsizeiptr)(set->count * sizeof *set->surfels),
				     set->surfels);
	return result;
}

/* Three floats a surfel as four; the last: `fourth` of each, NULL: 0. */
static int upload_colours(struct surfels *s, struct surfels_buffer *out, const char *what,
			  const float (*from)[3], const float *fourth, size_t count)
{
	float *rows = calloc(4 * (count + 1), sizeof *rows);
	int result;

	if (!rows)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < count; i++) {
		memcpy(rows + 4 * i, from[i], sizeof from[i]);
		rows[4 * i + 3] = fourth ? fourth[i] : 0;
	}
	result = surfels_storage(s, out, what, GL_RGBA32F, (count + 1) * 4 * sizeof *rows, rows);
	free(rows);
	return result;
}

static int upload_grid(struct surfels *s, const struct surfel_set *set)
{
	const struct surfel_grid *g = &set->grid;
	size_t slots = g->slots ? g->slots
				: (size_t)g->size[0] * (size_t)g->size[1] * (size_t)g->size[2];
	int result = surfels_storage(s, &s->first, "cells of the grid", GL_R32UI,
				     (slots + 1) * sizeof *g->first, g->first);

	if (result == GR_OK)
		result = surfels_storage(s, &s->members, "surfels in cells", GL_R32UI,
					 g->member_count * sizeof *g->members, g->members);
	if (result == GR_OK)
		result = surfels_storage(s, &s->keys, "keys of the grid", GL_R32UI,
					 g->slots * sizeof *g->keys, g->keys);
	return result;
}

static void upload_block(struct surfels *s, const struct surfel_set *set)
{
	const struct surfel_grid *g = &set->grid;
	const struct surfels_block block = {
		.grid = { g->origin[0], g->origin[1], g->origin[2], g->cell_m },
		.cells = { g->size[0], g->size[1], g->size[2], (int32_t)g->slots },
		.kernel = { 1 / set->radius_m, set->radius_m, 1 / (SURFEL_PLANE * set->spacing_m),
			    1 / (1.41421356f * set->radius_m) },
		.counts = { (uint32_t)set->count, set->links_each, set->taps_each, 0 },
	};

	glCreateBuffers(1, &s->block);
	glNamedBufferStorage(s->block, sizeof block, &block, 0);
}

/*
 * With M = albedo times the mean over the links, what is left of a change after
 * n gathers is at most |M^n|/(1 - |M|) of it, in the norm of the largest value,
 * and |M^n| is the largest value of M^n 1. Reflectances: the largest of the
 * bands. A few bounces are followed, and |M^(a+b)| <= |M^a| |M^b| for the rest.
 */
static int settle_gathers(const struct surfel_set *set, int *out)
{
	double work = (double)set->count * (double)set->links_each + 1;
	int bounces = (int)fmin(fmax(BOUND_WORK / work, 1), BOUND_BOUNCES);
	float *from = malloc((set->count + 1) * sizeof *from), *to = malloc((set->count + 1) * sizeof *to);
	double norm = 1;

	if (!from || !to) {
		free(from);
		free(to);
		return GR_ERR_NOMEM;
	}
	for (size_t i = 0; i < set->count; i++)
		from[i] = 1;
	for (int n = 0; n < bounces; n++) {
		float largest = 0;

		for (size_t i = 0; i < set->count; i++) {
			const uint32_t *links = set->links + i * set->links_each;
			const float *a = set->albedo[i];
			double sum = 0;

			for (size_t k = 0; k < set->links_each; k++)
				sum += links[k] < set->count ? (double)from[links[k]] : 0;
			to[i] = fmaxf(a[0], fmaxf(a[1], a[2])) * (float)(sum / set->links_each);
			largest = fmaxf(largest, to[i]);
		}
		norm = (double)largest;
		float *swap = from;
		from = to;
		to = swap;
	}
	free(from);
	free(to);
	double rate = pow(norm, 1.0 / bounces); /* of one bounce, 0..1 */

	*out = SETTLE_MOST;
	if (rate < 0.1)
		rate = 0.1;
	if (rate < 0.999)
		*out = (int)fmin(ceil(log(REST * (1 - rate)) / log(rate)) + 1, SETTLE_MOST);
	return GR_OK;
}

int surfels_upload(struct surfels *s, const struct surfel_set *set)
{
	size_t colours = (set->count + 1) * 4 * sizeof(float);
	struct surfels_buffer *const work[6] = { &s->direct, &s->found,	       &s->half,
						&s->shown,  &s->radiosity[0], &s->radiosity[1] };
	int result = upload_texels(s, set);

	if (result == GR_OK)
		result = settle_gathers(set, &s->settle_gathers);
	if (result == GR_OK)
		result = upload_links(s, set);
	if (result == GR_OK)
		result = upload_taps(s, set);
	if (result == GR_OK)
		result = upload_colours(s, &s->albedo, "reflectances", (const float(*)[3])set->albedo,
					set->area, set->count);
	if (result == GR_OK)
		result = upload_colours(s, &s->emissive, "light of emissive surfaces",
					(const float(*)[3])set->fixed_emissive, NULL, set->count);
	if (result == GR_OK)
		result = upload_colours(s, &s->other, "fixed light",
					(const float(*)[3])set->fixed_other, NULL, set->count);
	for (size_t i = 0; i < 6 && result == GR_OK; i++)
		result = surfels_storage(s, work[i], "light", GL_RGBA32F, colours, NULL);
	if (result == GR_OK)
		result = upload_grid(s, set);
	if (result == GR_OK)
		upload_block(s, set);
	return result;
}

void surfels_upload_finish(struct surfels *s)
{
	struct surfels_buffer *const all[15] = {
		&s->texels, &s->links, &s->taps,  &s->albedo,	    &s->emissive,
		&s->other,  &s->direct, &s->found, &s->half,	    &s->shown,
		&s->radiosity[0], &s->radiosity[1], &s->first, &s->members, &s->keys,
	};

	for (size_t i = 0; i < 15; i++)
		surfels_storage_finish(all[i]);
	glDeleteBuffers(1, &s->block);
}
