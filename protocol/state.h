/*
 * Inside protocol/: what a parameter state is made of. Others use
 * protocol/params.h.
 */
#ifndef GROTTO_PROTOCOL_STATE_H
#define GROTTO_PROTOCOL_STATE_H

#include "protocol/params.h"

#include "base/cursor.h"

#define PARAM_TYPE_SIZE(type) ((type) == PARAM_U64 ? 8 : 4)

/* Bytes of all values in their encoded form, known when compiling. */
enum {
	PARAM_VALUE_BYTES = 0
#define X(id, type, count, def, min, max, unit, help) +(count) * PARAM_TYPE_SIZE(type)
#include "protocol/params.def"
#undef X
};

/*
 * A delta: base, number of entries, and per entry how many ids are left out
 * before it, its version less the base, values. All but these are varints.
 */
#define PARAM_DELTA_HEAD_MAX (GR_VARINT_MOST + 2)
#define PARAM_ENTRY_HEAD_MAX (2 + GR_VARINT_MOST)
#define PARAM_DELTA_MAX (PARAM_DELTA_HEAD_MAX + PARAM_ENTRY_HEAD_MAX * PARAM_COUNT + PARAM_VALUE_BYTES)

struct param_state {
	uint64_t version[PARAM_COUNT];
	/* 8-byte units keep every parameter aligned for its type. */
	uint64_t values[PARAM_VALUE_BYTES / 8 + PARAM_COUNT];
};

void *param_values(struct param_state *state, enum param_id id);
/* The default of every element, at version 0. */
void param_reset(struct param_state *state, enum param_id id);
/* Finite and inside the range, every element. */
bool param_valid(enum param_id id, const void *values);
/* Little endian, param_info(id)->size bytes. */
void param_encode_values(enum param_id id, const void *values, uint8_t *bytes);
void param_decode_values(enum param_id id, const uint8_t *bytes, void *values);
uint64_t param_newest(const struct param_state *state);

#endif
