#include "protocol/state.h"

#include "base/cursor.h"
#include "base/result.h"

#include <math.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#define HASH_BYTES 16 /* of the table: libsodium's smallest; the first 8 are kept */
/* Values are encoded as they lie in memory: long parameters are then copied at its speed. */
#define AS_IN_MEMORY (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)

/* Names are made lower case once, at compile time there is no such operator. */
#define X(id, type, count, def, min, max, unit, help) \
	{ #id, type, count, (count) * PARAM_TYPE_SIZE(type), def, min, max, unit, help },
static const struct param_info upper_table[PARAM_COUNT] = {
#include "protocol/params.def"
};
#undef X

enum { NAME_MAX_BYTES = 32 };

struct table {
	struct param_info info[PARAM_COUNT];
	char names[PARAM_COUNT][NAME_MAX_BYTES];
	uint32_t offset[PARAM_COUNT]; /* into param_state.values, in 8-byte units */
};
static struct table table;

/* Before main, so that the table is read-only for every thread. */
static __attribute__((constructor)) void fill_table(void)
{
	uint32_t at = 0;

	for (int i = 0; i < PARAM_COUNT; i++) {
		const char *from = upper_table[i].name;
		size_t n;

		for (n = 0; n < NAME_MAX_BYTES - 1 && from[n]; n++)
			table.names[i][n] = (char)(from[n] >= 'A' && from[n] <= 'Z' ? from[n] + 32 : from[n]);
		table.info[i] = upper_table[i];
		table.info[i].name = table.names[i];
		table.offset[i] = at;
		at += (upper_table[i].size + 7u) / 8u;
	}
}

const struct param_info *param_info(enum param_id id)
{
	return &table.info[id];
}

void *param_values(struct param_state *state, enum param_id id)
{
	return state->values + table.offset[id];
}

void param_reset(struct param_state *state, enum param_id id)
{
	const struct param_info *info = param_info(id);
	void *values = param_values(state, id);

	for (unsigned i = 0; i < info->count; i++) {
		switch (info->type) {
		case PARAM_F32: ((float *)values)[i] = (float)info->def; break;
		case PARAM_I32: ((int32_t *)values)[i] = (int32_t)info->def; break;
		case PARAM_U32: ((uint32_t *)values)[i] = (uint32_t)info->def; break;
		case PARAM_U64: ((uint64_t *)values)[i] = (uint64_t)info->def; break;
		}
	}
	state->version[id] = 0;
}

int param_state_create(struct param_state **out)
{
	struct param_state *state = calloc(1, sizeof *state);

	*out = state;
	if (!state)
		return GR_ERR_NOMEM;
	for (int i = 0; i < PARAM_COUNT; i++)
		param_reset(state, (enum param_id)i);
	return GR_OK;
}

void param_state_destroy(struct param_state **state)
{
	free(*state);
	*state = NULL;
}

void param_state_copy(struct param_state *to, const struct param_state *from)
{
	*to = *from;
}

/*
 * All of them, without a branch for each: a long parameter is checked as fast as it is
 * read. Ranges are taken in the parameter's own precision, so that 0.2f passes as 0.2.
 */
static bool valid_f32(const struct param_info *info, const float *v)
{
	const float min = (float)info->min, max = (float)info->max;
	bool ok = true;

	for (unsigned i = 0; i < info->count; i++)
		ok &= isfinite(v[i]) && v[i] >= min && v[i] <= max;
	return ok;
}

static bool valid_i32(const struct param_info *info, const int32_t *v)
{
	const int64_t min = (int64_t)ceil(info->min), max = (int64_t)floor(info->max);
	bool ok = true;

	for (unsigned i = 0; i < info->count; i++)
		ok &= v[i] >= min && v[i] <= max;
	return ok;
}

static bool valid_u32(const struct param_info *info, const uint32_t *v)
{
	const int64_t min = (int64_t)ceil(info->min), max = (int64_t)floor(info->max);
	bool ok = true;

	for (unsigned i = 0; i < info->count; i++)
		ok &= v[i] >= min && v[i] <= max;
	return ok;
}

static bool valid_u64(const struct param_info *info, const uint64_t *v)
{
	bool ok = true;

	for (unsigned i = 0; i < info->count; i++)
		ok &= (double)v[i] >= info->min && (double)v[i] <= info->max;
	return ok;
}

bool param_valid(enum param_id id, const void *values)
{
	const struct param_info *info = param_info(id);

	switch (info->type) {
	case PARAM_F32: return valid_f32(info, values);
	case PARAM_I32: return valid_i32(info, values);
	case PARAM_U32: return valid_u32(info, values);
	case PARAM_U64: return valid_u64(info, values);
	}
	return false;
}

int param_set(struct param_state *state, enum param_id id, const void *values, uint64_t frame)
{
	if ((unsigned)id >= PARAM_COUNT || !frame || frame < state->version[id] ||
	    !param_valid(id, values))
		return GR_ERR_RANGE;
	if (!memcmp(param_values(state, id), values, param_info(id)->size))
		return GR_NOTHING;
	memcpy(param_values(state, id), values, param_info(id)->size);
	state->version[id] = frame;
	return GR_OK;
}

const void *param_get(const struct param_state *state, enum param_id id)
{
	return state->values + table.offset[id];
}

const float *param_f32(const struct param_state *state, enum param_id id)
{
	return param_get(state, id);
}

const uint32_t *param_u32(const struct param_state *state, enum param_id id)
{
	return param_get(state, id);
}

uint64_t param_version(const struct param_state *state, enum param_id id)
{
	return state->version[id];
}

uint64_t param_newest(const struct param_state *state)
{
	uint64_t newest = 0;

	for (int i = 0; i < PARAM_COUNT; i++)
		newest = state->version[i] > newest ? state->version[i] : newest;
	return newest;
}

void param_encode_values(enum param_id id, const void *values, uint8_t *bytes)
{
	const struct param_info *info = param_info(id);
	struct gr_writer w = gr_writer(bytes, info->size);

	if (AS_IN_MEMORY) {
		memcpy(bytes, values, info->size);
		return;
	}
	for (unsigned i = 0; i < info->count; i++) {
		if (info->type == PARAM_U64)
			gr_write_u64(&w, ((const uint64_t *)values)[i]);
		else
			gr_write_u32(&w, ((const uint32_t *)values)[i]);
	}
}

void param_decode_values(enum param_id id, const uint8_t *bytes, void *values)
{
	const struct param_info *info = param_info(id);
	struct gr_reader r = gr_reader(bytes, info->size);

	if (AS_IN_MEMORY) {
		memcpy(values, bytes, info->size);
		return;
	}
	for (unsigned i = 0; i < info->count; i++) {
		if (info->type == PARAM_U64)
			((uint64_t *)values)[i] = gr_read_u64(&r);
		else
			((uint32_t *)values)[i] = gr_read_u32(&r);
	}
}

uint64_t param_state_hash(const struct param_state *state, uint64_t previous)
{
	uint8_t bytes[8 + 8 * PARAM_COUNT + PARAM_VALUE_BYTES];
	struct gr_writer w = gr_writer(bytes, sizeof bytes);

	gr_write_u64(&w, previous);
	for (int i = 0; i < PARAM_COUNT; i++) {
		enum param_id id = (enum param_id)i;
		uint8_t *room;

		gr_write_u64(&w, state->version[i]);
		room = gr_write_room(&w, param_info(id)->size);
		if (room)
			param_encode_values(id, param_get(state, id), room);
	}
	return XXH64(bytes, w.len, 0);
}

uint64_t param_table_hash(void)
{
	uint8_t bytes[PARAM_COUNT * (NAME_MAX_BYTES + 3 + 3 * 8)];
	struct gr_writer w = gr_writer(bytes, sizeof bytes);
	uint8_t hash[HASH_BYTES];
	struct gr_reader r = gr_reader(hash, sizeof hash);

	for (int i = 0; i < PARAM_COUNT; i++) {
		const double numbers[3] = { table.info[i].def, table.info[i].min, table.info[i].max };

		gr_write_bytes(&w, table.names[i], sizeof table.names[i]);
		gr_write_u8(&w, (uint8_t)table.info[i].type);
		gr_write_u16(&w, table.info[i].count);
		for (int k = 0; k < 3; k++) {
			uint64_t bits;

			memcpy(&bits, &numbers[k], sizeof bits);
			gr_write_u64(&w, bits);
		}
	}
	crypto_generichash(hash, sizeof hash, bytes, w.len, NULL, 0);
	return gr_read_u64(&r);
}
