#include "renderer/gi/surfels_private.h"

#include "base/cursor.h"
#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/*
 * A slice, little endian:
 *   u32 magic, u8[8] hash of the surfel set, u16 index, u16 count,
 *   u32 first surfel, u32 number of surfels, u16 scales of radiosity and irradiance,
 *   per surfel u32 radiosity, u32 irradiance (shaders/surfel_packed.glsl)
 */
#define MAGIC UINT32_C(0x31534c47) /* "GLS1": its last character is the version */
#define HEADER_BYTES 28
#define SCALE_MOST 254	    /* exponent of a float */
#define NOT_FINITE 31	    /* in a word's exponent */
#define FRESH SURFELS_SLICES_MAX /* place of this node's newest slice among the scales */

enum { PEAK, PACK, UNPACK };

static struct surfels *surfels_of(struct gi_method *method)
{
	return (struct surfels *)method;
}

static struct surfels_run run_of(size_t surfels, unsigned index, unsigned count)
{
	uint64_t groups = (surfels + SURFELS_GROUP - 1) / SURFELS_GROUP;
	uint64_t slices = count > 0 ? count : 1;
	uint64_t first = groups * index / slices * SURFELS_GROUP;
	uint64_t last = groups * (index + 1) / slices * SURFELS_GROUP;

	return (struct surfels_run){ (uint32_t)first, (uint32_t)(last < surfels ? last : surfels) };
}

struct surfels_run surfels_share_run(const struct surfels *s, unsigned index)
{
	return run_of(s->count, index, s->share.count);
}

static size_t words_of(struct surfels_run run)
{
	return 2 * (size_t)(run.last - run.first);
}

int surfels_share_init(struct surfels *s, const struct surfel_set *set)
{
	static const GLbitfield flags = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
	static const char *const names[3] = { "surfel_pack.comp", "surfel_pack.comp",
					      "surfel_unpack.comp" };
	struct surfels_share *share = &s->share;
	GLsizeiptr bytes = (GLsizeiptr)(s->count * 8), scales = (FRESH + 1) * 16;
	uint64_t set_hash = surfel_set_hash(set);
	int result = GR_OK;

	for (int i = 0; i < 8; i++)
		share->set_hash[i] = (unsigned char)(set_hash >> (8 * i));
	for (int i = 0; i < 3 && result == GR_OK; i++) {
		char define[32];

		snprintf(define, sizeof define, "#define STAGE %d\n", i);
		result = program_create_compute(&share->programs[i], names[i], define);
	}
	if (result != GR_OK)
		return result;
	share->sent = calloc(s->count + 1, 8);
	share->arrived = calloc(s->count + 1, 8);
	if (!share->sent || !share->arrived)
		return GR_ERR_NOMEM;
	unsigned *const buffers[3] = { &share->used, &share->fresh, &share->scales };
	for (int i = 0; i < 3; i++) {
		glCreateBuffers(1, buffers[i]);
		glNamedBufferStorage(*buffers[i], i == 2 ? scales : bytes, NULL, GL_DYNAMIC_STORAGE_BIT);
		glClearNamedBufferData(*buffers[i], GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
	}
	glCreateTextures(GL_TEXTURE_BUFFER, 1, &share->used_texture);
	glTextureBuffer(share->used_texture, GL_RG32UI, share->used);
	glCreateTextures(GL_TEXTURE_BUFFER, 1, &share->scales_texture);
	glTextureBuffer(share->scales_texture, GL_RGBA32UI, share->scales);
	glCreateBuffers(1, &share->staging);
	glNamedBufferStorage(share->staging, bytes + 8, NULL, flags);
	share->staging_map = glMapNamedBufferRange(share->staging, 0, bytes + 8, flags);
	s->bytes += 3 * (size_t)bytes;
	return share->staging_map ? GR_OK : GR_ERR_GL;
}

void surfels_share_finish(struct surfels *s)
{
	struct surfels_share *share = &s->share;

	if (share->staging_map)
		glUnmapNamedBuffer(share->staging);
	share->staging_map = NULL;
	glDeleteTextures(1, &share->used_texture);
	glDeleteTextures(1, &share->scales_texture);
	const unsigned buffers[4] = { share->used, share->fresh, share->scales, share->staging };
	glDeleteBuffers(4, buffers);
	for (int i = 0; i < 3; i++)
		program_destroy(&share->programs[i]);
	free(share->sent);
	free(share->arrived);
}

static void bind_words(struct surfels *s, unsigned words)
{
	glBindBufferBase(GL_UNIFORM_BUFFER, SURFELS_BINDING_BLOCK, s->block);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_WORDS, words);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_FOUND, s->found.buffer);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_OTHER, s->share.scales);
}

/* Newest light of a run into words. */
static void pack(struct surfels *s, struct surfels_run run, unsigned words, unsigned place)
{
	bind_words(s, words);
	glBindTextureUnit(SURFELS_UNIT_RADIOSITY, s->radiosity[s->current].texture);
	glBindTextureUnit(SURFELS_UNIT_BEFORE, s->found.texture);
	glClearNamedBufferSubData(s->share.scales, GL_R32UI, place * 16, 16, GL_RED_INTEGER,
				  GL_UNSIGNED_INT, NULL);
	for (int i = PEAK; i <= PACK; i++) {
		surfels_barrier();
		glProgramUniform1ui(s->share.programs[i], 1, place);
		surfels_dispatch(s->share.programs[i], run);
	}
	surfels_barrier();
}

/* What is in use of a run, to where it is worked with. */
static void unpack(struct surfels *s, struct surfels_run run)
{
	struct surfels_share *share = &s->share;

	glBindBufferBase(GL_UNIFORM_BUFFER, SURFELS_BINDING_BLOCK, s->block);
	glBindTextureUnit(SURFELS_UNIT_RADIOSITY, share->used_texture);
	glBindTextureUnit(SURFELS_UNIT_BEFORE, share->scales_texture);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_FOUND, s->found.buffer);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_DIRECT, s->radiosity[0].buffer);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_RADIOSITY, s->radiosity[1].buffer);
	surfels_barrier();
	glProgramUniform2ui(share->programs[UNPACK], 1, share->count,
			    (uint32_t)((s->count + SURFELS_GROUP - 1) / SURFELS_GROUP));
	surfels_dispatch(share->programs[UNPACK], run);
	surfels_barrier();
}

static void unpack_all(struct surfels *s)
{
	unpack(s, (struct surfels_run){ 0, (uint32_t)s->count });
}

void surfels_share_restore(struct surfels *s)
{
	unpack(s, surfels_share_run(s, s->share.index));
}

static void stage(struct surfels *s, unsigned words, unsigned place)
{
	struct surfels_run own = surfels_share_run(s, s->share.index);

	glCopyNamedBufferSubData(s->share.scales, s->share.staging, place * 16 + 8, 0, 8);
	if (own.last > own.first)
		glCopyNamedBufferSubData(words, s->share.staging, (GLintptr)own.first * 8, 8,
					 (GLsizeiptr)(words_of(own) * 4));
	glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
	s->share.staged = true;
	s->share.staged_fresh = place == FRESH;
}

void surfels_share_recut(struct surfels *s)
{
	struct surfels_share *share = &s->share;

	share->other_slices = false;
	share->taken = share->staged = share->sent_valid = false;
	memset(share->has_arrived, 0, sizeof share->has_arrived);
	if (share->count == 1)
		return;
	for (unsigned i = 0; i < share->count; i++)
		pack(s, surfels_share_run(s, i), share->used, i);
	unpack_all(s);
	stage(s, share->used, share->index);
}

void surfels_share_pack(struct surfels *s)
{
	pack(s, surfels_share_run(s, s->share.index), s->share.fresh, FRESH);
	stage(s, s->share.fresh, FRESH);
}

bool surfels_share_apply(struct surfels *s)
{
	struct surfels_share *share = &s->share;
	bool any = share->taken;

	if (share->taken) {
		struct surfels_run own = surfels_share_run(s, share->index);

		surfels_barrier();
		glCopyNamedBufferSubData(share->fresh, share->used, (GLintptr)own.first * 8,
					 (GLintptr)own.first * 8, (GLsizeiptr)(words_of(own) * 4));
		glCopyNamedBufferSubData(share->scales, share->scales, FRESH * 16, share->index * 16,
					 16);
		share->taken = false;
	}
	for (unsigned i = 0; i < share->count; i++) {
		struct surfels_run run = surfels_share_run(s, i);

		if (!share->has_arrived[i])
			continue;
		glNamedBufferSubData(share->used, (GLintptr)run.first * 8,
				     (GLsizeiptr)(words_of(run) * 4),
				     share->arrived + 2 * (size_t)run.first);
		glNamedBufferSubData(share->scales, i * 16 + 8, 8, share->arrived_scales[i]);
		share->has_arrived[i] = false;
		any = true;
	}
	/* and this node's own slice, which the last frame's gathers have written over */
	if (any)
		unpack_all(s);
	return any;
}

uint64_t surfels_share_hash(const struct surfels *s)
{
	uint64_t scales = 0;

	/* the largest values beside the scales are of no further use, and differ */
	for (unsigned i = 0; i < s->share.count; i++) {
		uint32_t words[2];

		glGetNamedBufferSubData(s->share.scales, i * 16 + 8, 8, words);
		scales = scales * UINT64_C(6364136223846793005) + (words[0] | (uint64_t)words[1] << 32);
	}
	return surfels_hash_buffer(s->share.used, s->count * 8, scales);
}

/* Value of band c of a word in units of its own exponent, and that. */
static unsigned band(uint32_t word, int c)
{
	return word >> (9 * c) & 511;
}

/* Whether two words are more than one rounding step of the coarser one apart. */
static bool differs(uint32_t a, uint32_t scale_a, uint32_t b, uint32_t scale_b)
{
	int e_a = (int)(scale_a < 30 ? 30 : scale_a) + (int)(a >> 27);
	int e_b = (int)(scale_b < 30 ? 30 : scale_b) + (int)(b >> 27);
	int down = e_a > e_b ? e_a - e_b : e_b - e_a;

	if (a == b && scale_a == scale_b)
		return false;
	if (a >> 27 == NOT_FINITE || b >> 27 == NOT_FINITE)
		return a != b;
	for (int c = 0; c < 3; c++) {
		long fine = (long)band(e_a > e_b ? b : a, c), coarse = (long)band(e_a > e_b ? a : b, c);
		long step, apart;

		if (down > 10) {
			/* the finer one is nothing to the coarser */
			step = 1;
			apart = coarse;
		} else {
			step = 1L << down;
			apart = (coarse << down) - fine;
		}
		if (apart > step || apart < -step)
			return true;
	}
	return false;
}

static int set(struct gi_method *method, unsigned index, unsigned count)
{
	struct surfels *s = surfels_of(method);
	struct surfels_share *share = &s->share;

	if (count < 1 || count > SURFELS_SLICES_MAX || index >= count)
		return GR_ERR_RANGE;
	if (index == share->index && count == share->count)
		return GR_OK;
	/* the passes' own place holds what gathers found; what is in use goes on */
	if (share->count > 1 && s->started && !share->other_slices)
		surfels_share_restore(s);
	share->index = index;
	share->count = count;
	share->other_slices = true;
	share->taken = share->staged = false;
	memset(share->has_arrived, 0, sizeof share->has_arrived);
	s->lit = false;
	return GR_OK;
}

static size_t bytes_max(const struct gi_method *method, unsigned count)
{
	const struct surfels *s = (const struct surfels *)method;
	size_t most = 0;

	for (unsigned i = 0; i < count && count <= SURFELS_SLICES_MAX; i++) {
		size_t words = words_of(run_of(s->count, i, count));

		most = words > most ? words : most;
	}
	return HEADER_BYTES + most * 4;
}

static int take(struct gi_method *method, uint8_t *bytes, size_t size, size_t *len)
{
	struct surfels *s = surfels_of(method);
	struct surfels_share *share = &s->share;
	struct surfels_run own = surfels_share_run(s, share->index);
	size_t words = words_of(own);
	struct gr_writer w = gr_writer(bytes, size);
	uint32_t *now = share->arrived + 2 * (size_t)own.first; /* of others' slices: this one is free */
	uint32_t head[2];

	*len = 0;
	if (share->count < 2 || share->other_slices || !share->staged)
		return GR_NOTHING;
	if (size < HEADER_BYTES + 4 * words)
		return GR_ERR_RANGE;
	share->staged = false;
	head[0] = share->staging_map[0];
	head[1] = share->staging_map[1];
	for (size_t k = 0; k < words; k++)
		now[k] = share->staging_map[2 + k];
	bool same = share->sent_valid;
	for (size_t k = 0; k < words && same; k++)
		same = !differs(now[k], head[k & 1], share->sent[2 + k], share->sent[k & 1]);
	if (same)
		return GR_NOTHING;
	gr_write_u32(&w, MAGIC);
	gr_write_bytes(&w, share->set_hash, sizeof share->set_hash);
	gr_write_u16(&w, (uint16_t)share->index);
	gr_write_u16(&w, (uint16_t)share->count);
	gr_write_u32(&w, own.first);
	gr_write_u32(&w, own.last - own.first);
	gr_write_u16(&w, (uint16_t)head[0]);
	gr_write_u16(&w, (uint16_t)head[1]);
	for (size_t k = 0; k < words; k++)
		gr_write_u32(&w, now[k]);
	memcpy(share->sent, head, sizeof head);
	memcpy(share->sent + 2, now, words * sizeof *now);
	share->taken = share->staged_fresh;
	share->sent_valid = true;
	*len = w.len;
	return w.ok ? GR_OK : GR_ERR_RANGE;
}

/* A word that packing can make: NaN has no mantissas. */
static bool word_valid(uint32_t word)
{
	return word >> 27 != NOT_FINITE || word << 5 == 0;
}

static int put(struct gi_method *method, const uint8_t *bytes, size_t len)
{
	struct surfels *s = surfels_of(method);
	struct surfels_share *share = &s->share;
	struct gr_reader r = gr_reader(bytes, len);
	uint32_t magic = gr_read_u32(&r);
	const uint8_t *set_hash = gr_read_bytes(&r, sizeof share->set_hash);
	unsigned index = gr_read_u16(&r), count = gr_read_u16(&r);
	uint32_t first = gr_read_u32(&r), number = gr_read_u32(&r);
	uint32_t scales[2];

	scales[0] = gr_read_u16(&r);
	scales[1] = gr_read_u16(&r);
	if (!r.ok || magic != MAGIC || share->count < 2 || count != share->count || index >= count ||
	    index == share->index ||
	    memcmp(set_hash, share->set_hash, sizeof share->set_hash) != 0 ||
	    scales[0] > SCALE_MOST || scales[1] > SCALE_MOST)
		return GR_ERR_FORMAT;
	struct surfels_run run = surfels_share_run(s, index);
	if (first != run.first || number != run.last - run.first ||
	    gr_reader_left(&r) != words_of(run) * 4)
		return GR_ERR_FORMAT;
	struct gr_reader look = r;
	for (size_t k = 0; k < words_of(run); k++)
		if (!word_valid(gr_read_u32(&look)))
			return GR_ERR_FORMAT;
	for (size_t k = 0; k < words_of(run); k++)
		share->arrived[2 * (size_t)run.first + k] = gr_read_u32(&r);
	memcpy(share->arrived_scales[index], scales, sizeof scales);
	share->has_arrived[index] = true;
	return GR_OK;
}

const struct gi_share_ops surfels_share_ops = {
	.set = set,
	.bytes_max = bytes_max,
	.take = take,
	.put = put,
};
