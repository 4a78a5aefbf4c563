/*
 * The table of typed parameters: the whole truth of a frame. It is declared
 * once, in protocol/params.def, which gives for each its name, type, number
 * of elements, default, range and unit. A parameter carries the frame number
 * of its last change; a delta names its base frame and carries what changed
 * since.
 *
 * Not thread safe: one thread owns a state.
 */
#ifndef GROTTO_PROTOCOL_PARAMS_H
#define GROTTO_PROTOCOL_PARAMS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PARAM_MAX_LAMPS 16

enum param_type { PARAM_F32, PARAM_I32, PARAM_U32, PARAM_U64 };

/*
 * X(ID, type, count, default, min, max, unit, help). Every element has the
 * same default and range; ranges bound what a receiver accepts (NaN never).
 */
enum param_id {
#define X(id, type, count, def, min, max, unit, help) PARAM_##id,
#include "protocol/params.def"
#undef X
	PARAM_COUNT
};

struct param_info {
	const char *name; /* lower case, as in the docs and in recordings */
	enum param_type type;
	uint16_t count;
	uint16_t size; /* bytes of the whole parameter */
	double def, min, max;
	const char *unit, *help;
};
const struct param_info *param_info(enum param_id id);

/* All values with their versions. Opaque so that none is set without a version. */
struct param_state;

/* All defaults at version 0. */
int param_state_create(struct param_state **out);
void param_state_destroy(struct param_state **state);
void param_state_copy(struct param_state *to, const struct param_state *from);

/*
 * Sets a whole parameter; `values` holds info->count elements of its type.
 * A value equal bit by bit changes nothing and keeps the old version. frame is
 * at least 1 (0 is the defaults' own) and not below the parameter's version.
 * GR_OK, GR_NOTHING (equal), GR_ERR_RANGE (NaN, outside, or such a frame;
 * nothing changed).
 */
int param_set(struct param_state *state, enum param_id id, const void *values, uint64_t frame);
/* In place, valid until the next change; cast by type: const float *, ... */
const void *param_get(const struct param_state *state, enum param_id id);
const float *param_f32(const struct param_state *state, enum param_id id);
const uint32_t *param_u32(const struct param_state *state, enum param_id id);
uint64_t param_version(const struct param_state *state, enum param_id id);

/* Largest number of bytes that param_delta_encode can write. */
size_t param_delta_max(void);
/* What changed after frame `base`; returns bytes written, or a negative result. */
long param_delta_encode(const struct param_state *state, uint64_t base, uint8_t *bytes, size_t size);
/*
 * Checks the whole delta first (ids, order, lengths, ranges, versions), then
 * applies it; a bad one changes nothing. Base 0 is a snapshot: what it does not
 * name goes back to its default. The caller sees to it that the state has the
 * base. GR_OK or GR_ERR_FORMAT.
 */
int param_delta_apply(struct param_state *state, const uint8_t *bytes, size_t len);
/* The base that a delta names, without a look at the rest. GR_OK or GR_ERR_FORMAT. */
int param_delta_base(const uint8_t *bytes, size_t len, uint64_t *out_base);

/*
 * Hash of all values and versions, order dependent, chained with the previous
 * frame's hash by the caller: h(N) = param_state_hash(state, h(N-1)).
 */
uint64_t param_state_hash(const struct param_state *state, uint64_t previous);
/* Hash of the table itself (names, types, counts, ranges): nodes compare it at join. */
uint64_t param_table_hash(void);

#endif
