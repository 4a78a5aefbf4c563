#include "protocol/message.h"

#include "base/cursor.h"
#include "base/result.h"

static size_t written(const struct gr_writer *w)
{
	return w->ok ? w->len : 0;
}

static int finished(const struct gr_reader *r)
{
	return gr_reader_done(r) ? GR_OK : GR_ERR_FORMAT;
}

static void read_into(struct gr_reader *r, void *to, size_t n)
{
	const uint8_t *p = gr_read_bytes(r, n);

	if (p)
		memcpy(to, p, n);
	else
		memset(to, 0, n);
}

/* Text from outside ends up in logs: printable ASCII only. */
static bool printable(const char *text, size_t len)
{
	for (size_t i = 0; i < len; i++)
		if (text[i] < 0x20 || text[i] > 0x7e)
			return false;
	return true;
}

size_t fdp_join_encode(const struct fdp_join *m, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_u16(&w, m->version);
	gr_write_u16(&w, m->index);
	gr_write_u16(&w, m->plan_cost);
	gr_write_u16(&w, m->plan_error);
	gr_write_bytes(&w, m->nonce, sizeof m->nonce);
	gr_write_bytes(&w, m->challenge, sizeof m->challenge);
	gr_write_bytes(&w, m->layout_hash, sizeof m->layout_hash);
	gr_write_bytes(&w, m->scene_hash, sizeof m->scene_hash);
	gr_write_u64(&w, m->table_hash);
	gr_write_bytes(&w, m->name, sizeof m->name);
	gr_write_u64(&w, m->plan);
	gr_write_u64(&w, m->highest);
	gr_write_u64(&w, m->shown);
	gr_write_u8(&w, m->layout_items);
	gr_write_u8(&w, m->scene_items);
	gr_write_bytes(&w, m->items, sizeof m->items);
	return written(&w);
}

/* The rest, of which the form is this version's. What no part's digest stands in is zero. */
static int read_rest(struct gr_reader *r, struct fdp_join *out)
{
	unsigned count, used;

	out->highest = gr_read_u64(r);
	out->shown = gr_read_u64(r);
	out->layout_items = gr_read_u8(r);
	out->scene_items = gr_read_u8(r);
	read_into(r, out->items, sizeof out->items);
	count = (unsigned)out->layout_items + out->scene_items;
	used = count * fdp_items_width(count);
	if (count && !used)
		return GR_ERR_FORMAT;
	for (size_t i = used; i < sizeof out->items; i++)
		if (out->items[i])
			return GR_ERR_FORMAT;
	return finished(r);
}

int fdp_join_decode(const uint8_t *bytes, size_t len, struct fdp_join *out)
{
	struct gr_reader r = gr_reader(bytes, len);
	uint8_t any = 0;
	size_t name_len;

	out->version = gr_read_u16(&r);
	out->index = gr_read_u16(&r);
	out->plan_cost = gr_read_u16(&r);
	out->plan_error = gr_read_u16(&r);
	read_into(&r, out->nonce, sizeof out->nonce);
	read_into(&r, out->challenge, sizeof out->challenge);
	read_into(&r, out->layout_hash, sizeof out->layout_hash);
	read_into(&r, out->scene_hash, sizeof out->scene_hash);
	out->table_hash = gr_read_u64(&r);
	read_into(&r, out->name, sizeof out->name);
	out->plan = gr_read_u64(&r);
	name_len = strnlen(out->name, sizeof out->name);
	for (size_t i = name_len; i < sizeof out->name; i++)
		any |= (uint8_t)out->name[i];
	if (any || !name_len || name_len == sizeof out->name ||
	    !printable(out->name, name_len))
		return GR_ERR_FORMAT;
	if (out->version == FDP_VERSION)
		return read_rest(&r, out);
	out->highest = out->shown = 0;
	out->layout_items = out->scene_items = 0;
	memset(out->items, 0, sizeof out->items);
	return r.ok ? GR_OK : GR_ERR_FORMAT;
}

size_t fdp_welcome_encode(const struct fdp_welcome *m, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_bytes(&w, m->nonce, sizeof m->nonce);
	gr_write_bytes(&w, m->challenge, sizeof m->challenge);
	gr_write_bytes(&w, m->master_nonce, sizeof m->master_nonce);
	gr_write_u64(&w, m->first_sequence);
	gr_write_u32(&w, m->deadline_us);
	gr_write_u32(&w, m->probe_us);
	return written(&w);
}

int fdp_welcome_decode(const uint8_t *bytes, size_t len, struct fdp_welcome *out)
{
	struct gr_reader r = gr_reader(bytes, len);

	read_into(&r, out->nonce, sizeof out->nonce);
	read_into(&r, out->challenge, sizeof out->challenge);
	read_into(&r, out->master_nonce, sizeof out->master_nonce);
	out->first_sequence = gr_read_u64(&r);
	out->deadline_us = gr_read_u32(&r);
	out->probe_us = gr_read_u32(&r);
	if (!out->first_sequence || !out->deadline_us || !out->probe_us)
		return GR_ERR_FORMAT;
	return finished(&r);
}

size_t fdp_refuse_encode(const struct fdp_refuse *m, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);
	const size_t len = strnlen(m->reason, sizeof m->reason - 1);

	gr_write_bytes(&w, m->nonce, sizeof m->nonce);
	gr_write_u16(&w, (uint16_t)len);
	gr_write_bytes(&w, m->reason, len);
	/* only to a node of this version: for others the form ends here */
	if (m->plan)
		gr_write_u64(&w, m->plan);
	return written(&w);
}

int fdp_refuse_decode(const uint8_t *bytes, size_t len, struct fdp_refuse *out)
{
	struct gr_reader r = gr_reader(bytes, len);
	size_t n;

	memset(out->reason, 0, sizeof out->reason);
	read_into(&r, out->nonce, sizeof out->nonce);
	n = gr_read_u16(&r);
	if (n >= sizeof out->reason)
		return GR_ERR_FORMAT;
	read_into(&r, out->reason, n);
	out->plan = 0;
	if (gr_reader_left(&r) > 0) {
		out->plan = gr_read_u64(&r);
		if (!out->plan)
			return GR_ERR_FORMAT;
	}
	return printable(out->reason, n) ? finished(&r) : GR_ERR_FORMAT;
}

size_t fdp_beacon_encode(uint8_t *bytes, size_t size)
{
	static const uint8_t zero[FDP_JOIN_BYTES];
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_bytes(&w, zero, sizeof zero);
	return written(&w);
}

int fdp_beacon_decode(const uint8_t *bytes, size_t len)
{
	uint8_t any = 0;

	if (len != FDP_JOIN_BYTES)
		return GR_ERR_FORMAT;
	for (size_t i = 0; i < len; i++)
		any |= bytes[i];
	return any ? GR_ERR_FORMAT : GR_OK;
}

/* A time near another one, whatever either says: differences wrap. */
static void write_near(struct gr_writer *w, int64_t ns, int64_t near_ns)
{
	gr_write_varint(w, gr_zigzag((int64_t)((uint64_t)ns - (uint64_t)near_ns)));
}

static int64_t read_near(struct gr_reader *r, int64_t near_ns)
{
	return (int64_t)((uint64_t)near_ns + (uint64_t)gr_unzigzag(gr_read_varint(r)));
}

/* A number that must be under 2^bits. */
static uint64_t read_bits(struct gr_reader *r, unsigned bits)
{
	const uint64_t value = gr_read_varint(r);

	if (value >> bits)
		r->ok = false;
	return value;
}

size_t fdp_report_encode(const struct fdp_report *m, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_u64(&w, m->hash);
	gr_write_varint(&w, m->frame);
	gr_write_varint(&w, m->frame - m->swapped_frame);
	gr_write_varint(&w, m->swapped_count);
	gr_write_u64(&w, (uint64_t)m->sent_ns);
	write_near(&w, m->swap_ns, m->sent_ns);
	gr_write_u32(&w, m->echo_low);
	gr_write_varint(&w, m->held_ns);
	gr_write_varint(&w, m->slice);
	gr_write_varint(&w, m->render_us);
	gr_write_varint(&w, m->path_ns);
	gr_write_varint(&w, m->swaps_late);
	gr_write_varint(&w, m->lost);
	return written(&w);
}

int fdp_report_decode(const uint8_t *bytes, size_t len, struct fdp_report *out)
{
	struct gr_reader r = gr_reader(bytes, len);

	out->hash = gr_read_u64(&r);
	out->frame = gr_read_varint(&r);
	out->swapped_frame = out->frame - gr_read_varint(&r);
	out->swapped_count = gr_read_varint(&r);
	out->sent_ns = (int64_t)gr_read_u64(&r);
	out->swap_ns = read_near(&r, out->sent_ns);
	out->echo_low = gr_read_u32(&r);
	out->held_ns = (uint32_t)read_bits(&r, 32);
	out->slice = gr_read_varint(&r);
	out->render_us = (uint32_t)read_bits(&r, 32);
	out->path_ns = (uint32_t)read_bits(&r, 32);
	out->swaps_late = (uint32_t)read_bits(&r, 32);
	out->lost = (uint32_t)read_bits(&r, 32);
	if (out->swapped_frame > out->frame || (!out->echo_low && out->held_ns))
		return GR_ERR_FORMAT;
	return finished(&r);
}

size_t fdp_nack_encode(const struct fdp_nack *m, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_u64(&w, m->frame);
	gr_write_u64(&w, m->message);
	gr_write_u16(&w, m->flags);
	gr_write_u16(&w, m->count);
	gr_write_bytes(&w, m->missing, (m->count + 7u) / 8u);
	return written(&w);
}

int fdp_nack_decode(const uint8_t *bytes, size_t len, struct fdp_nack *out)
{
	struct gr_reader r = gr_reader(bytes, len);

	memset(out->missing, 0, sizeof out->missing);
	out->frame = gr_read_u64(&r);
	out->message = gr_read_u64(&r);
	out->flags = gr_read_u16(&r);
	out->count = gr_read_u16(&r);
	if (out->count > FDP_FRAGMENTS_MAX || out->flags & ~FDP_NACK_SNAPSHOT ||
	    !out->count != !!(out->flags & FDP_NACK_SNAPSHOT))
		return GR_ERR_FORMAT;
	read_into(&r, out->missing, (out->count + 7u) / 8u);
	/* No bits beyond the last fragment. */
	if (out->count % 8 && out->missing[out->count / 8] >> out->count % 8)
		return GR_ERR_FORMAT;
	return finished(&r);
}

/* Frames of a division, from 1: 0 is none. */
static void write_since(struct gr_writer *w, uint64_t since, uint64_t frame)
{
	gr_write_varint(w, since ? frame - since + 1 : 0);
}

static uint64_t read_since(struct gr_reader *r, uint64_t frame)
{
	const uint64_t frames = gr_read_varint(r);

	if (frames > frame)
		r->ok = false; /* no division begins before frame 1 */
	return frames ? frame - frames + 1 : 0;
}

/* A flag of the wire alone: there is a time to swap at. */
#define ANNOUNCE_TIMED 2u

size_t fdp_announce_encode(const struct fdp_announce *m, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_u8(&w, (uint8_t)(m->flags | (m->swap_ns ? ANNOUNCE_TIMED : 0)));
	gr_write_varint(&w, m->frame);
	gr_write_varint(&w, m->frame - m->swapped);
	gr_write_varint(&w, m->present);
	gr_write_varint(&w, m->present ^ m->live);
	gr_write_varint(&w, m->count);
	if (m->count)
		gr_write_varint(&w, m->message);
	if (m->flags & FDP_TWICE)
		gr_write_varint(&w, m->wait_us);
	write_since(&w, m->since, m->frame);
	gr_write_varint(&w, m->slices);
	for (unsigned i = 0; i < m->slices; i++)
		gr_write_varint(&w, m->age[i]);
	gr_write_u64(&w, (uint64_t)m->sent_ns);
	if (m->swap_ns)
		write_near(&w, m->swap_ns, m->sent_ns);
	gr_write_varint(&w, m->echoes);
	for (unsigned i = 0; i < m->echoes; i++) {
		gr_write_varint(&w, m->echo[i].node);
		gr_write_varint(&w, m->echo[i].held_ns);
		gr_write_u32(&w, m->echo[i].sent_low);
	}
	return written(&w);
}

static bool read_echoes(struct gr_reader *r, struct fdp_announce *out)
{
	const uint64_t echoes = gr_read_varint(r);

	memset(out->echo, 0, sizeof out->echo);
	if (echoes > FDP_ECHOES_MOST)
		return false;
	out->echoes = (uint16_t)echoes;
	for (unsigned i = 0; i < out->echoes; i++) {
		const uint64_t node = gr_read_varint(r);

		if (node >= FDP_MAX_NODES)
			return false;
		out->echo[i].node = (uint16_t)node;
		out->echo[i].held_ns = (uint32_t)read_bits(r, 32);
		out->echo[i].sent_low = gr_read_u32(r);
	}
	return true;
}

static bool read_slices(struct gr_reader *r, struct fdp_announce *out)
{
	uint64_t slices;

	out->since = read_since(r, out->frame);
	slices = gr_read_varint(r);
	if (slices > FDP_MAX_NODES || (slices && !out->since))
		return false;
	out->slices = (uint16_t)slices;
	for (unsigned i = 0; i < FDP_MAX_NODES; i++) {
		const uint64_t age = i < slices ? gr_read_varint(r) : FDP_AGE_NONE;

		if (age > FDP_AGE_NONE)
			return false;
		out->age[i] = (uint32_t)age;
	}
	return true;
}

int fdp_announce_decode(const uint8_t *bytes, size_t len, struct fdp_announce *out)
{
	struct gr_reader r = gr_reader(bytes, len);
	const uint8_t flags = gr_read_u8(&r);

	out->frame = gr_read_varint(&r);
	out->swapped = out->frame - gr_read_varint(&r);
	out->present = gr_read_varint(&r);
	out->live = out->present ^ gr_read_varint(&r);
	out->count = (uint16_t)read_bits(&r, 16);
	out->message = out->count ? gr_read_varint(&r) : 0;
	out->flags = flags & (uint8_t)~ANNOUNCE_TIMED;
	out->wait_us = out->flags & FDP_TWICE ? (uint32_t)read_bits(&r, 32) : 0;
	if (!read_slices(&r, out))
		return GR_ERR_FORMAT;
	out->sent_ns = (int64_t)gr_read_u64(&r);
	out->swap_ns = flags & ANNOUNCE_TIMED ? read_near(&r, out->sent_ns) : 0;
	if (!read_echoes(&r, out))
		return GR_ERR_FORMAT;
	if (out->count > FDP_FRAGMENTS_MAX || !out->message != !out->count ||
	    !(flags & ANNOUNCE_TIMED) != !out->swap_ns || out->swapped > out->frame ||
	    out->live & ~out->present || out->flags & ~FDP_TWICE)
		return GR_ERR_FORMAT;
	return finished(&r);
}

size_t fdp_leave_encode(uint64_t frame, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_u64(&w, frame);
	return written(&w);
}

int fdp_leave_decode(const uint8_t *bytes, size_t len, uint64_t *out_frame)
{
	struct gr_reader r = gr_reader(bytes, len);

	*out_frame = gr_read_u64(&r);
	return finished(&r);
}

size_t fdp_state_head_encode(const struct fdp_state_head *m, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_u64(&w, m->hash);
	gr_write_u8(&w, (uint8_t)(m->flags | (m->half ? FDP_HALF : 0)));
	gr_write_varint(&w, m->frame);
	gr_write_varint(&w, m->frame - m->previous_frame);
	if (!(m->flags & FDP_CHAINED))
		gr_write_u64(&w, m->previous_hash);
	gr_write_varint(&w, m->present);
	gr_write_varint(&w, m->present ^ m->live);
	if (m->half)
		gr_write_varint(&w, m->half);
	write_since(&w, m->shared_since, m->frame);
	if (m->shared_since)
		gr_write_varint(&w, m->shared ^ m->live);
	return written(&w);
}

int fdp_state_head_decode(const uint8_t *bytes, size_t len, struct fdp_state_head *out,
			  size_t *out_len)
{
	struct gr_reader r = gr_reader(bytes, len);

	out->hash = gr_read_u64(&r);
	out->flags = gr_read_u8(&r);
	out->frame = gr_read_varint(&r);
	out->previous_frame = out->frame - gr_read_varint(&r);
	out->previous_hash = out->flags & FDP_CHAINED ? 0 : gr_read_u64(&r);
	out->present = gr_read_varint(&r);
	out->live = out->present ^ gr_read_varint(&r);
	out->half = out->flags & FDP_HALF ? gr_read_varint(&r) : 0;
	out->shared_since = read_since(&r, out->frame);
	out->shared = out->shared_since ? gr_read_varint(&r) ^ out->live : 0;
	*out_len = r.at;
	if (!out->shared != !out->shared_since)
		return GR_ERR_FORMAT;
	if (!out->half != !(out->flags & FDP_HALF) || out->half & ~out->live)
		return GR_ERR_FORMAT;
	if (!r.ok || out->flags & ~(FDP_TWICE | FDP_CHAINED | FDP_HALF) || out->live & ~out->present ||
	    (out->frame ? out->previous_frame >= out->frame : out->previous_frame))
		return GR_ERR_FORMAT;
	return GR_OK;
}
