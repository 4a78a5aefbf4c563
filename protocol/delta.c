#include "protocol/state.h"

#include "base/cursor.h"
#include "base/result.h"

size_t param_delta_max(void)
{
	return PARAM_DELTA_MAX;
}

long param_delta_encode(const struct param_state *state, uint64_t base, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);
	uint16_t count = 0;
	int last_id = -1;

	for (int i = 0; i < PARAM_COUNT; i++)
		count = (uint16_t)(count + (state->version[i] > base));
	gr_write_varint(&w, base);
	gr_write_varint(&w, count);
	for (int i = 0; i < PARAM_COUNT; i++) {
		enum param_id id = (enum param_id)i;
		uint8_t *room;

		if (state->version[i] <= base)
			continue;
		gr_write_varint(&w, (uint64_t)(i - last_id - 1));
		gr_write_varint(&w, state->version[i] - base);
		last_id = i;
		room = gr_write_room(&w, param_info(id)->size);
		if (room)
			param_encode_values(id, param_get(state, id), room);
	}
	return w.ok ? (long)w.len : GR_ERR_RANGE;
}

int param_delta_base(const uint8_t *bytes, size_t len, uint64_t *out_base)
{
	struct gr_reader r = gr_reader(bytes, len);

	*out_base = gr_read_varint(&r);
	gr_read_varint(&r);
	return r.ok ? GR_OK : GR_ERR_FORMAT;
}

/* One entry of a delta, checked against what the state holds. Its values stay encoded. */
struct entry {
	enum param_id id;
	uint64_t version;
	const uint8_t *bytes;
};

/* What it says of itself; not whether the values may be. */
static bool read_entry(struct gr_reader *r, const struct param_state *state, uint64_t base,
		       int last_id, struct entry *out)
{
	const uint64_t step = gr_read_varint(r), since = gr_read_varint(r), version = base + since;
	const uint64_t id = (uint64_t)(last_id + 1) + step;

	if (!r->ok || step >= PARAM_COUNT || id >= PARAM_COUNT || !since || version < base)
		return false;
	/* Base 0 starts from the defaults; any other goes forward from what is held. */
	if (base && version < state->version[id])
		return false;
	out->id = (enum param_id)id;
	out->version = version;
	out->bytes = gr_read_bytes(r, param_info(out->id)->size);
	return out->bytes;
}

static bool entry_valid(const struct entry *e)
{
	uint64_t values[(PARAM_VALUE_BYTES + 7) / 8];

	param_decode_values(e->id, e->bytes, values);
	return param_valid(e->id, values);
}

int param_delta_apply(struct param_state *state, const uint8_t *bytes, size_t len)
{
	struct gr_reader r = gr_reader(bytes, len);
	const uint64_t base = gr_read_varint(&r), count = gr_read_varint(&r);
	struct gr_reader first;
	struct entry e;
	int last_id = -1;

	if (!r.ok || count > PARAM_COUNT)
		return GR_ERR_FORMAT;
	first = r;
	for (uint64_t i = 0; i < count; i++) {
		if (!read_entry(&r, state, base, last_id, &e) || !entry_valid(&e))
			return GR_ERR_FORMAT;
		last_id = (int)e.id;
	}
	if (!gr_reader_done(&r))
		return GR_ERR_FORMAT;
	if (!base) {
		for (int i = 0; i < PARAM_COUNT; i++)
			param_reset(state, (enum param_id)i);
	}
	r = first;
	last_id = -1;
	for (uint64_t i = 0; i < count && read_entry(&r, state, base, last_id, &e); i++) {
		last_id = (int)e.id;
		param_decode_values(e.id, e.bytes, param_values(state, e.id));
		state->version[e.id] = e.version;
	}
	return GR_OK;
}
