#include "renderer/gi/lpv_private.h"

#include "base/log.h"
#include "base/plain.h"
#include "base/result.h"
#include "renderer/gl/program.h"
#include "renderer/trace/rays.h"

#include <epoxy/gl.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct lpv *lpv_of(struct gi_method *method)
{
	return (struct lpv *)method;
}

static const struct lpv *lpv_of_const(const struct gi_method *method)
{
	return (const struct lpv *)method;
}

/* Buffers are written as storage and read as textures, uploaded and read back. */
static const GLbitfield barriers = GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
				   GL_BUFFER_UPDATE_BARRIER_BIT;

static struct lpv_buffer storage(GLenum format, size_t bytes, const void *data)
{
	struct lpv_buffer b;

	glCreateBuffers(1, &b.buffer);
	glNamedBufferStorage(b.buffer, (GLsizeiptr)(bytes ? bytes : 16), bytes ? data : NULL, 0);
	if (!data)
		glClearNamedBufferData(b.buffer, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
	glCreateTextures(GL_TEXTURE_BUFFER, 1, &b.texture);
	glTextureBuffer(b.texture, format, b.buffer);
	return b;
}

static void storage_finish(struct lpv_buffer *b)
{
	glDeleteTextures(1, &b->texture);
	glDeleteBuffers(1, &b->buffer);
}

static void bind_storage(enum lpv_binding at, const struct lpv_buffer *b)
{
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, at, b->buffer);
}

/* Whether a link to another cell of the lattice is not all open; others lead to darkness. */
static bool stopped_inside(const struct links *links, size_t index, const struct link_surface *s)
{
	const int *size = links->lattice.size;
	int x = (int)(index % (size_t)size[0]);
	int y = (int)(index / (size_t)size[0] % (size_t)size[1]);
	int z = (int)(index / (size_t)size[0] / (size_t)size[1]);

	for (int j = 0; j < SECTOR_COUNT; j++) {
		const signed char *o = sector_offset[j];

		if (s->through[j] != LINK_OPEN &&
		    lattice_inside(&links->lattice, x + o[0], y + o[1], z + o[2]))
			return true;
	}
	return false;
}

/*
 * The cells that meet surfaces, those that lpv_reflect does as a whole first,
 * and by the number of their stopped links: neighbours in the list take as long.
 */
static int upload_surface_cells(struct lpv *lpv, const struct links *links)
{
	size_t cells = lattice_cells(&links->lattice), start = 0;
	size_t after[2 * (SECTOR_COUNT + 1) + 1] = { 0 };
	uint8_t *whole = calloc(cells, sizeof *whole);
	uint32_t (*list)[2] = calloc(links->surface_count + 1, sizeof *list);

	if (!whole || !list) {
		free(whole);
		free(list);
		return GR_ERR_NOMEM;
	}
	for (int pass = 0; pass < 2; pass++) {
		for (size_t i = 0; i < cells; i++) {
			uint32_t record = links->surface_of[i];
			const struct link_surface *s = &links->surfaces[record ? record - 1 : 0];

			if (!record)
				continue;
			whole[i] = stopped_inside(links, i, s);
			size_t bin = SECTOR_COUNT - s->count + (whole[i] ? 0 : SECTOR_COUNT + 1);
			if (pass == 0) {
				after[bin + 1]++;
				lpv->whole_count += whole[i];
				continue;
			}
			list[after[bin]][0] = (uint32_t)i;
			list[after[bin]++][1] = record;
		}
		for (size_t bin = 0; pass == 0 && bin < sizeof after / sizeof *after; bin++)
			start = after[bin] += start;
	}
	lpv->surface_cells = storage(GL_RG32UI, (links->surface_count + 1) * sizeof *list, list);
	lpv->whole = storage(GL_R8UI, cells, whole);
	free(whole);
	free(list);
	return GR_OK;
}

/* Surface records and blocks as the shaders read them. */
static int upload_links(struct lpv *lpv, const struct links *links)
{
	size_t count = links->surface_count + 1;
	uint32_t *records = calloc(count * 8, sizeof *records);
	uint32_t *of = calloc(lattice_cells(&links->lattice) * 2, sizeof *of);
	struct link_block *blocks = calloc(links->block_count + 1, sizeof *blocks);
	int result = GR_ERR_NOMEM;

	if (!records || !of || !blocks)
		goto out;
	/* record 0: all open, nothing stopped */
	for (int w = 0; w < 7; w++)
		records[w] = LINK_OPEN * UINT32_C(0x01010101);
	for (size_t i = 0; i < lattice_cells(&links->lattice); i++) {
		of[2 * i] = links->surface_of[i];
		of[2 * i + 1] = links->fronts.of[i];
	}
	for (size_t i = 0; i < links->surface_count; i++) {
		const struct link_surface *s = &links->surfaces[i];

		for (int j = 0; j < SECTOR_COUNT; j++)
			records[8 * (i + 1) + (size_t)j / 4] |= (uint32_t)s->through[j] << (8 * (j % 4));
		records[8 * (i + 1) + 7] = s->first | s->count << 27;
	}
	lpv->surfaces = storage(GL_RGBA32UI, count * 8 * sizeof *records, records);
	lpv->surface_count = (int)links->surface_count;
	lpv->surface_of = storage(GL_RG32UI, lattice_cells(&links->lattice) * 2 * sizeof *of, of);
	lpv->fronts = storage(GL_R32UI, links->fronts.count * FRONT_MASKS * sizeof(uint32_t),
			      links->fronts.masks);
	/* the shader's record byte for byte, but for the direction, which it has unpacked */
	for (size_t i = 0; i < links->block_count; i++) {
		const signed char *o = sector_offset[links->blocks[i].j];

		blocks[i] = links->blocks[i];
		blocks[i].j = (uint32_t)((o[0] + 1) | (o[1] + 1) << 2 | (o[2] + 1) << 4 |
					 sector_kind((int)links->blocks[i].j) << 6);
	}
	_Static_assert(sizeof(struct link_block) == 32, "two vec4");
	lpv->blocks = storage(GL_RGBA32F, links->block_count * sizeof *blocks, blocks);
	result = upload_surface_cells(lpv, links);
	if (result == GR_OK)
		result = dispatch_plan((uint64_t)lpv->whole_count, 64, &lpv->per_whole);
	if (result == GR_OK)
		result = dispatch_plan((uint64_t)(lpv->surface_count - lpv->whole_count), 64,
				       &lpv->per_surface);
out:
	free(records);
	free(of);
	free(blocks);
	return result;
}

static void upload_block(struct lpv *lpv)
{
	const struct sectors *s = &lpv->sectors;
	const struct lattice *l = &lpv->lattice;
	struct sector_medium medium;
	struct lattice_block block = {
		.size = { l->size[0], l->size[1], l->size[2], (int32_t)lattice_cells(l) },
		.origin = { l->origin[0], l->origin[1], l->origin[2], l->d },
		.point = { lpv->point[0], lpv->point[1], lpv->point[2], 0 },
	};
	double scale = (double)lpv->calibration / ((double)l->d * (double)l->d);

	sectors_medium(s, (double)lpv->absorption, (double)lpv->scattering, (double)l->d, &medium);
	for (int k = 0; k < SECTOR_KINDS; k++) {
		block.sector_a[k] = (float)medium.a[k];
		block.sector_b[k] = (float)medium.b[k];
		block.sector_mu[k] = (float)s->mu[k];
	}
	block.sector_a[3] = (float)(3 * medium.a[0] + 6 * medium.a[1] + 4 * medium.a[2]);
	block.sector_mu[3] = lpv->is_thesis ? 1.0f : (float)s->lobe; /* it makes its own of F n */
	block.look[0] = (float)(scale * s->look_f * 0.25);
	block.look[1] = (float)(scale * s->look_v * 0.5);
	glNamedBufferSubData(lpv->block, 0, sizeof block, &block);
}

static void bind(const struct gi_method *method)
{
	const struct lpv *lpv = lpv_of_const(method);

	glBindBufferBase(GL_UNIFORM_BUFFER, LPV_BINDING_BLOCK, lpv->block);
	glBindTextureUnit(LPV_UNIT_LIGHT, lpv->light[lpv->current].texture);
	glBindTextureUnit(LPV_UNIT_SURFACE_OF, lpv->surface_of.texture);
	glBindTextureUnit(LPV_UNIT_SURFACES, lpv->surfaces.texture);
	glBindTextureUnit(LPV_UNIT_FRONTS, lpv->fronts.texture);
}

static void reflect(struct lpv *lpv)
{
	glBindTextureUnit(LPV_UNIT_BLOCKS, lpv->blocks.texture);
	glBindTextureUnit(LPV_UNIT_INJECT, lpv->inject.texture);
	glBindTextureUnit(LPV_UNIT_SURFACE_CELLS, lpv->surface_cells.texture);
	bind_storage(LPV_BINDING_INJECT, &lpv->emitted); /* written there */
	if (lpv->whole_count > 0) {
		glUseProgram(lpv->gather);
		glDispatchCompute(lpv->per_whole.x, lpv->per_whole.y, 1);
	}
	if (lpv->whole_count < lpv->surface_count) {
		glUseProgram(lpv->reflect);
		glDispatchCompute(lpv->per_surface.x, lpv->per_surface.y, 1);
	}
	glMemoryBarrier(barriers);
}

void lpv_propagate(struct lpv *lpv, int steps, int looks)
{
	const int *size = lpv->lattice.size;

	glBindTextureUnit(LPV_UNIT_SURFACE_OF, lpv->surface_of.texture);
	glBindTextureUnit(LPV_UNIT_SURFACES, lpv->surfaces.texture);
	for (int i = 0; i < steps; i++) {
		bool look = i >= steps - looks;

		glBindTextureUnit(LPV_UNIT_SENT, lpv->sent[lpv->sending].texture);
		glMemoryBarrier(barriers);
		if (lpv->surface_count > 0)
			reflect(lpv);
		if (look) {
			lpv->current = !lpv->current;
			bind_storage(LPV_BINDING_NEW_LIGHT, &lpv->light[lpv->current]);
		}
		glUseProgram(look ? lpv->last_step : lpv->step);
		glBindTextureUnit(LPV_UNIT_EMITTED, lpv->emitted.texture);
		glBindTextureUnit(LPV_UNIT_WHOLE, lpv->whole.texture);
		bind_storage(LPV_BINDING_NEXT, &lpv->sent[!lpv->sending]);
		glDispatchCompute(((unsigned)size[0] + 15) / 16, ((unsigned)size[2] + 7) / 8,
				  3 * (((unsigned)size[1] + LPV_SEGMENT - 1) / LPV_SEGMENT));
		lpv->sending = !lpv->sending;
	}
	glMemoryBarrier(barriers);
}

static void go_dark(struct lpv *lpv)
{
	const unsigned buffers[4] = { lpv->light[0].buffer, lpv->light[1].buffer,
				      lpv->sent[0].buffer, lpv->sent[1].buffer };

	for (int i = 0; i < 4; i++)
		glClearNamedBufferData(buffers[i], GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
}

/*
 * Equation 3.4. The thesis divides by the last frame's energy; where that is
 * nothing (a lamp has just been switched on) there is nothing to keep either.
 */
static void thesis_frame(struct lpv *lpv, const struct render_frame *frame, bool restart, int steps)
{
	float energy = 0, last = 0;
	float incremental = fminf(fmaxf(frame->gi_incremental, 0), 1);

	for (int i = 0; i < SCENE_MAX_LAMPS; i++)
		for (int c = 0; c < 3 && frame->lamps[i].on; c++)
			energy += frame->lamps[i].intensity[c];
	if (!restart && lpv->thesis.energy > 0)
		last = energy / lpv->thesis.energy * incremental;
	lpv->thesis.energy = energy;
	lpv->thesis.steps = steps;
	lpv_thesis_frame(lpv, last, last > 0 ? 1 - incremental : 1, steps);
}

static int update(struct gi_method *method, const struct render_frame *frame,
		  const struct gi_light *light)
{
	const struct rsm_set *rsm = light->rsm;
	struct lpv *lpv = lpv_of(method);
	bool restart = !lpv->started || frame->gi_epoch != lpv->epoch;
	bool medium = frame->absorption_per_m != lpv->absorption ||
		      frame->scattering_per_m != lpv->scattering;
	bool lamps = restart || rsm->version != lpv->rsm_version;
	int steps = frame->gi_steps > 0 ? frame->gi_steps : 0;

	lpv_check_collect(lpv);
	lpv->stats.ran = false;
	lpv->stats.steps = 0;
	if (!frame->gi_on)
		return GR_NOTHING;
	if (restart || medium || lamps || (lpv->is_thesis && steps != lpv->thesis.steps))
		lpv->steps_since_change = 0;
	else if (lpv->steps_since_change >= lpv->settle_steps)
		return GR_NOTHING;
	if (medium || restart) {
		lpv->absorption = frame->absorption_per_m;
		lpv->scattering = frame->scattering_per_m;
		upload_block(lpv);
	}
	bind(method);
	if (lamps)
		lpv_splat(lpv, rsm);
	if (restart)
		go_dark(lpv);
	if (lpv->is_thesis) {
		thesis_frame(lpv, frame, restart, steps);
	} else {
		/* the check compares two lights: the last two steps', or two frames' */
		if (restart)
			lpv_start(lpv);
		else
			lpv_propagate(lpv, steps, 1);
	}
	lpv_check_submit(lpv);
	lpv->started = true;
	lpv->epoch = frame->gi_epoch;
	lpv->rsm_version = rsm->version;
	if (restart && !lpv->is_thesis) {
		lpv->steps_since_change = lpv->settle_steps;
		steps = lpv_start_steps(lpv);
	} else {
		lpv->steps_since_change += steps;
	}
	lpv->stats.ran = true;
	lpv->stats.steps = steps;
	lpv->stats.steady = lpv->steps_since_change >= lpv->settle_steps;
	return GR_OK;
}

static const char *describe(const struct gi_method *method)
{
	return lpv_of_const(method)->description;
}

static void stats(const struct gi_method *method, struct gi_stats *out)
{
	*out = lpv_of_const(method)->stats;
}

static uint64_t hash(const struct gi_method *method)
{
	static const unsigned char key[crypto_shorthash_KEYBYTES] = "grotto lattice";
	const struct lpv *lpv = lpv_of_const(method);
	size_t bytes = lattice_cells(&lpv->lattice) * LPV_LIGHT_FLOATS * sizeof(float);
	unsigned char *light = malloc(bytes);
	unsigned char digest[crypto_shorthash_BYTES];
	uint64_t value = 0;

	if (!light)
		return 0;
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glGetNamedBufferSubData(lpv->light[lpv->current].buffer, 0, (GLsizeiptr)bytes, light);
	crypto_shorthash(digest, light, bytes, key);
	for (int i = 0; i < 8; i++)
		value |= (uint64_t)digest[i] << (8 * i);
	free(light);
	return value;
}

static void destroy(struct gi_method *method)
{
	struct lpv *lpv = lpv_of(method);

	if (lpv->is_thesis)
		lpv_thesis_finish(&lpv->thesis);
	lpv_splat_finish(lpv);
	lpv_check_finish(lpv);
	lpv_start_finish(lpv);
	program_destroy(&lpv->step);
	program_destroy(&lpv->last_step);
	program_destroy(&lpv->reflect);
	program_destroy(&lpv->gather);
	glDeleteBuffers(1, &lpv->block);
	for (int i = 0; i < 2; i++) {
		storage_finish(&lpv->light[i]);
		storage_finish(&lpv->sent[i]);
	}
	storage_finish(&lpv->surface_of);
	storage_finish(&lpv->fronts);
	storage_finish(&lpv->surfaces);
	storage_finish(&lpv->surface_cells);
	storage_finish(&lpv->whole);
	storage_finish(&lpv->inject);
	storage_finish(&lpv->emitted);
	storage_finish(&lpv->blocks);
	free(lpv);
}

static const struct gi_method_ops repaired_ops = {
	.name = "lpv",
	.describe = describe,
	.needs = GI_NEEDS_RSM,
	.update = update,
	.bind = bind,
	.shader_name = "gi_lpv.glsl",
	.stats = stats,
	.hash = hash,
	.destroy = destroy,
};

static const struct gi_method_ops thesis_ops = {
	.name = "lpv (thesis)",
	.describe = describe,
	.needs = GI_NEEDS_RSM,
	.update = update,
	.bind = bind,
	.shader_name = "gi_lpv_thesis.glsl",
	.stats = stats,
	.hash = hash,
	.destroy = destroy,
};

static int create_step(struct lpv *lpv)
{
	const int *size = lpv->lattice.size;
	char defines[256];
	size_t length;
	int result;

	snprintf(defines, sizeof defines,
		 "#define LATTICE_X %d\n#define LATTICE_Y %d\n#define LATTICE_Z %d\n#define SEGMENT %d\n",
		 size[0], size[1], size[2], LPV_SEGMENT);
	length = strlen(defines);
	result = program_create_compute(&lpv->step, "lpv_step.comp", defines);
	if (result == GR_OK)
		result = program_create_compute(&lpv->reflect, "lpv_reflect.comp", defines);
	if (result != GR_OK)
		return result;
	glProgramUniform1i(lpv->reflect, 0, lpv->whole_count);
	glProgramUniform1i(lpv->reflect, 1, lpv->surface_count);
	snprintf(defines + length, sizeof defines - length, "#define WITH_GATHER\n");
	result = program_create_compute(&lpv->gather, "lpv_reflect.comp", defines);
	if (result != GR_OK)
		return result;
	glProgramUniform1i(lpv->gather, 0, 0);
	glProgramUniform1i(lpv->gather, 1, lpv->whole_count);
	snprintf(defines + length, sizeof defines - length, "#define WITH_LOOK\n");
	return program_create_compute(&lpv->last_step, "lpv_step.comp", defines);
}

static int create_gl(struct lpv *lpv, const struct links *links)
{
	const int *size = lpv->lattice.size;
	size_t cells = lattice_cells(&lpv->lattice);
	size_t bordered = (size_t)(size[0] + 2) * (size_t)(size[1] + 2) * (size_t)(size[2] + 2);
	int result = dispatch_plan(cells, 64, &lpv->per_cell);

	if (result == GR_OK)
		result = upload_links(lpv, links);
	if (result == GR_OK)
		result = create_step(lpv);
	if (result == GR_OK)
		result = lpv_splat_init(lpv);
	if (result == GR_OK)
		result = lpv_check_init(lpv);
	if (result == GR_OK)
		result = lpv_start_init(lpv);
	if (result != GR_OK)
		return result;
	for (int i = 0; i < 2; i++) {
		lpv->light[i] = storage(GL_RGBA32F, cells * LPV_LIGHT_FLOATS * sizeof(float), NULL);
		lpv->sent[i] = storage(GL_RGBA32F, bordered * LPV_LIGHT_FLOATS * sizeof(float), NULL);
	}
	lpv->inject = storage(GL_RGBA32F, cells * LPV_LIGHT_FLOATS * sizeof(float), NULL);
	lpv->emitted = storage(GL_RGBA32F, cells * LPV_LIGHT_FLOATS * sizeof(float), NULL);
	glCreateBuffers(1, &lpv->block);
	glNamedBufferStorage(lpv->block, sizeof(struct lattice_block), NULL,
			     GL_DYNAMIC_STORAGE_BIT);
	upload_block(lpv);
	return glGetError() == GL_NO_ERROR ? GR_OK : GR_ERR_GL;
}

static uint64_t gpu_bytes(const struct lpv *lpv)
{
	const unsigned buffers[] = {
		lpv->surface_of.buffer, lpv->fronts.buffer, lpv->surfaces.buffer,
		lpv->surface_cells.buffer, lpv->whole.buffer, lpv->inject.buffer,
		lpv->emitted.buffer, lpv->blocks.buffer, lpv->light[0].buffer,
		lpv->light[1].buffer, lpv->sent[0].buffer, lpv->sent[1].buffer,
		lpv->block, lpv->splat, lpv->checks, lpv->start.oldest, lpv->start.sums,
	};
	uint64_t sum = 0;

	for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) {
		GLint64 bytes = 0;

		glGetNamedBufferParameteri64v(buffers[i], GL_BUFFER_SIZE, &bytes);
		sum += (uint64_t)bytes;
	}
	if (lpv->is_thesis)
		sum += sizeof lpv->thesis.images / sizeof *lpv->thesis.images * 4 * sizeof(float) *
		       lattice_cells(&lpv->lattice);
	return sum;
}

static void say(struct lpv *lpv, const struct links *links, const struct scene_file *file)
{
	const int *size = lpv->lattice.size;

	snprintf(lpv->description, sizeof lpv->description,
		 "light propagation volumes%s, %d x %d x %d cells of %s m, %d steps a frame: diffuse "
		 "light between surfaces; %zu cells meet surfaces (%zu rays, once), steady after %d steps, from darkness "
		 "after %d",
		 lpv->is_thesis ? " (thesis scheme)" : "", size[0], size[1], size[2],
		 gr_plain((double)lpv->lattice.d, 3).text, file->gi.steps,
		 links->surface_count, links->rays, lpv->settle_steps, lpv_start_steps(lpv));
}

int gi_lpv_create(struct gi_method **out, const struct scene *scene,
		  const struct scene_file *file)
{
	struct lpv *lpv = calloc(1, sizeof *lpv);
	struct rays *rays = NULL;
	struct links *links = NULL;
	int result = GR_ERR_NOMEM;

	*out = NULL;
	if (!lpv)
		return result;
	lpv->is_thesis = file->gi.lpv_mode == SCENE_LPV_THESIS;
	lpv->base.ops = lpv->is_thesis ? &thesis_ops : &repaired_ops;
	result = lattice_init(&lpv->lattice, scene->min, scene->max, file->gi.lattice);
	if (result != GR_OK) {
		gr_error("light lattice: %d cells over a scene of %s x %s x %s m cannot be", file->gi.lattice,
			 gr_plain((double)(scene->max[0] - scene->min[0]), 4).text,
			 gr_plain((double)(scene->max[1] - scene->min[1]), 4).text,
			 gr_plain((double)(scene->max[2] - scene->min[2]), 4).text);
		goto out;
	}
	result = rays_create(&rays, scene);
	if (result != GR_OK)
		goto out;
	result = links_create(&links, scene, rays, &lpv->lattice, file->gi.link_rays,
			      file->gi.albedo_override);
	if (result != GR_OK)
		goto out;
	sectors_init(&lpv->sectors);
	lpv->calibration = 1;
	lpv->settle_steps = links->settle_steps;
	memcpy(lpv->point, links->point, sizeof lpv->point);
	lpv->absorption = file->absorption_per_m;
	lpv->scattering = file->scattering_per_m;
	result = create_gl(lpv, links);
	if (result != GR_OK)
		goto out;
	if (lpv->is_thesis) {
		result = lpv_thesis_init(&lpv->thesis, &lpv->lattice, scene);
		if (result != GR_OK)
			goto out;
	}
	lpv->stats.gpu_bytes = gpu_bytes(lpv);
	say(lpv, links, file);
	*out = &lpv->base;
	lpv = NULL;
out:
	links_destroy(&links);
	rays_destroy(&rays);
	if (lpv)
		destroy(&lpv->base);
	return result;
}
