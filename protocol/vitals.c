#include "protocol/vitals.h"

#include "base/cursor.h"
#include "base/result.h"

#include <stdbool.h>
#include <string.h>

/* Printable, ended by a NUL, and after that nothing but NULs. */
static bool is_name(const char name[FDP_VITALS_NAME])
{
	size_t len = strnlen(name, FDP_VITALS_NAME);

	if (!len || len == FDP_VITALS_NAME)
		return false;
	for (size_t i = 0; i < FDP_VITALS_NAME; i++)
		if (i < len ? name[i] < 0x20 || name[i] > 0x7e : name[i] != 0)
			return false;
	return true;
}

size_t fdp_vitals_encode(const struct fdp_vitals *v, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	if (v->count > FDP_VITALS_STAGES)
		return 0;
	gr_write_u32(&w, v->receive_bytes);
	gr_write_u8(&w, (uint8_t)v->count);
	for (unsigned i = 0; i < v->count; i++) {
		if (!is_name(v->stages[i].name))
			return 0;
		gr_write_bytes(&w, v->stages[i].name, FDP_VITALS_NAME);
		gr_write_u32(&w, v->stages[i].us);
	}
	return w.ok ? w.len : 0;
}

int fdp_vitals_decode(const uint8_t *bytes, size_t len, struct fdp_vitals *out)
{
	struct gr_reader r = gr_reader(bytes, len);

	memset(out, 0, sizeof *out);
	out->receive_bytes = gr_read_u32(&r);
	out->count = gr_read_u8(&r);
	if (!r.ok || out->count > FDP_VITALS_STAGES)
		return GR_ERR_FORMAT;
	for (unsigned i = 0; i < out->count; i++) {
		const uint8_t *name = gr_read_bytes(&r, FDP_VITALS_NAME);

		if (!name)
			return GR_ERR_FORMAT;
		memcpy(out->stages[i].name, name, FDP_VITALS_NAME);
		out->stages[i].us = gr_read_u32(&r);
		if (!is_name(out->stages[i].name))
			return GR_ERR_FORMAT;
	}
	return r.ok && !gr_reader_left(&r) ? GR_OK : GR_ERR_FORMAT;
}

const struct fdp_vitals_stage *fdp_vitals_longest(const struct fdp_vitals *v)
{
	const struct fdp_vitals_stage *longest = NULL;

	for (unsigned i = 0; i < v->count; i++)
		if (!longest || v->stages[i].us > longest->us)
			longest = &v->stages[i];
	return longest;
}
