#include "record/format.h"

#include "base/result.h"

#include <math.h>
#include <sodium.h>
#include <string.h>

#define HEAD_SUMMED 56 /* bytes before the header's own checksum */
#define HEAD_SUM_BYTES 8

static const char magic[4] = { 'G', 'R', 'E', 'C' };

static void sum_of(const uint8_t *bytes, size_t len, uint8_t out[RECORD_SUM_BYTES])
{
	crypto_generichash(out, RECORD_SUM_BYTES, bytes, len, NULL, 0);
}

void record_head_sum(struct record_head *head, const uint8_t *payload)
{
	sum_of(payload, head->len, head->sum);
}

void record_head_encode(const struct record_head *head, uint8_t bytes[RECORD_HEAD_BYTES])
{
	struct gr_writer w = gr_writer(bytes, RECORD_HEAD_BYTES);
	uint8_t sum[RECORD_SUM_BYTES];

	gr_write_bytes(&w, magic, sizeof magic);
	gr_write_u8(&w, RECORD_VERSION);
	gr_write_u8(&w, head->kind);
	gr_write_u8(&w, head->flags);
	gr_write_u8(&w, 0);
	gr_write_u32(&w, head->len);
	gr_write_u32(&w, head->count);
	gr_write_u64(&w, head->recording);
	gr_write_u64(&w, head->sequence);
	gr_write_u64(&w, head->frame);
	gr_write_bytes(&w, head->sum, sizeof head->sum);
	sum_of(bytes, HEAD_SUMMED, sum);
	gr_write_bytes(&w, sum, HEAD_SUM_BYTES);
}

static bool head_plausible(const struct record_head *h)
{
	const unsigned flags = h->kind == RECORD_ENTRIES ? RECORD_WHOLE : 0;

	return h->kind >= RECORD_SESSION && h->kind <= RECORD_END && !(h->flags & ~flags) &&
	       h->len >= 1 && h->len <= RECORD_PAYLOAD_MAX && h->recording &&
	       (h->kind == RECORD_ENTRIES) == (h->count > 0) &&
	       h->count <= h->len / RECORD_ENTRY_HEAD;
}

int record_head_decode(const uint8_t bytes[RECORD_HEAD_BYTES], struct record_head *out)
{
	struct gr_reader r = gr_reader(bytes, RECORD_HEAD_BYTES);
	const uint8_t *found = gr_read_bytes(&r, sizeof magic), *sum;
	const uint8_t version = gr_read_u8(&r);
	uint8_t ours[RECORD_SUM_BYTES], reserved;

	if (memcmp(found, magic, sizeof magic) != 0)
		return GR_ERR_FORMAT;
	out->kind = gr_read_u8(&r);
	out->flags = gr_read_u8(&r);
	reserved = gr_read_u8(&r);
	out->len = gr_read_u32(&r);
	out->count = gr_read_u32(&r);
	out->recording = gr_read_u64(&r);
	out->sequence = gr_read_u64(&r);
	out->frame = gr_read_u64(&r);
	memcpy(out->sum, gr_read_bytes(&r, RECORD_SUM_BYTES), RECORD_SUM_BYTES);
	sum = gr_read_bytes(&r, HEAD_SUM_BYTES);
	sum_of(bytes, HEAD_SUMMED, ours);
	if (memcmp(sum, ours, HEAD_SUM_BYTES) != 0)
		return GR_ERR_FORMAT;
	if (version != RECORD_VERSION)
		return GR_ERR_VERSION;
	return reserved || !head_plausible(out) ? GR_ERR_FORMAT : GR_OK;
}

bool record_payload_sound(const struct record_head *head, const uint8_t *payload)
{
	uint8_t sum[RECORD_SUM_BYTES];

	sum_of(payload, head->len, sum);
	return memcmp(sum, head->sum, sizeof sum) == 0;
}

/* Texts: a length in two bytes, then that many printable ones (ASCII or UTF-8's upper half). */
static void write_text(struct gr_writer *w, const char *text, size_t room)
{
	size_t len = strnlen(text, room);

	if (len == room) {
		w->ok = false;
		return;
	}
	gr_write_u16(w, (uint16_t)len);
	gr_write_bytes(w, text, len);
}

static void read_text(struct gr_reader *r, char *out, size_t room)
{
	const size_t len = gr_read_u16(r);
	const uint8_t *bytes = len < room ? gr_read_bytes(r, len) : NULL;

	out[0] = '\0';
	if (!bytes) {
		r->ok = false;
		return;
	}
	for (size_t i = 0; i < len; i++)
		if (bytes[i] < 0x20 || bytes[i] == 0x7f)
			r->ok = false;
	if (!r->ok)
		return;
	memcpy(out, bytes, len);
	out[len] = '\0';
}

size_t record_session_encode(const struct record_session *s, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size < RECORD_SESSION_MAX ? size : RECORD_SESSION_MAX);

	if (s->node_count > RECORD_NODES || s->tracker_count > RECORD_TRACKERS)
		return 0;
	gr_write_u16(&w, s->protocol);
	gr_write_u16(&w, s->flags);
	gr_write_u16(&w, s->node_count);
	gr_write_u16(&w, s->tracker_count);
	gr_write_u64(&w, s->session);
	gr_write_u64(&w, s->table_hash);
	gr_write_bytes(&w, s->layout_hash, sizeof s->layout_hash);
	gr_write_bytes(&w, s->scene_hash, sizeof s->scene_hash);
	gr_write_u64(&w, (uint64_t)s->wall_ns);
	gr_write_u64(&w, (uint64_t)s->start_ns);
	gr_write_u64(&w, (uint64_t)s->zero_ns);
	gr_write_f32(&w, s->frame_hz);
	write_text(&w, s->grotto, sizeof s->grotto);
	write_text(&w, s->layout, sizeof s->layout);
	write_text(&w, s->scene, sizeof s->scene);
	write_text(&w, s->layout_path, sizeof s->layout_path);
	write_text(&w, s->scene_path, sizeof s->scene_path);
	for (unsigned i = 0; i < s->node_count; i++)
		write_text(&w, s->nodes[i], sizeof s->nodes[i]);
	for (unsigned i = 0; i < s->tracker_count; i++)
		write_text(&w, s->trackers[i], sizeof s->trackers[i]);
	return w.ok ? w.len : 0;
}

static int64_t read_time(struct gr_reader *r)
{
	const int64_t ns = (int64_t)gr_read_u64(r);

	if (ns < 0)
		r->ok = false;
	return ns;
}

int record_session_decode(const uint8_t *bytes, size_t len, struct record_session *out)
{
	struct gr_reader r = gr_reader(bytes, len);

	memset(out, 0, sizeof *out);
	out->protocol = gr_read_u16(&r);
	out->flags = gr_read_u16(&r);
	out->node_count = gr_read_u16(&r);
	out->tracker_count = gr_read_u16(&r);
	out->session = gr_read_u64(&r);
	out->table_hash = gr_read_u64(&r);
	for (int i = 0; i < 2; i++) {
		const uint8_t *hash = gr_read_bytes(&r, 32);
		if (hash)
			memcpy(i == 0 ? out->layout_hash : out->scene_hash, hash, 32);
	}
	out->wall_ns = read_time(&r);
	out->start_ns = read_time(&r);
	/* Before the machine started, where scene time goes on from another master's. */
	out->zero_ns = (int64_t)gr_read_u64(&r);
	out->frame_hz = gr_read_f32(&r);
	read_text(&r, out->grotto, sizeof out->grotto);
	read_text(&r, out->layout, sizeof out->layout);
	read_text(&r, out->scene, sizeof out->scene);
	read_text(&r, out->layout_path, sizeof out->layout_path);
	read_text(&r, out->scene_path, sizeof out->scene_path);
	if (out->node_count > RECORD_NODES || out->tracker_count > RECORD_TRACKERS)
		return GR_ERR_FORMAT;
	for (unsigned i = 0; i < out->node_count; i++)
		read_text(&r, out->nodes[i], sizeof out->nodes[i]);
	for (unsigned i = 0; i < out->tracker_count; i++)
		read_text(&r, out->trackers[i], sizeof out->trackers[i]);
	if (!gr_reader_done(&r) || len > RECORD_SESSION_MAX || !out->session || !out->node_count ||
	    out->flags & ~(RECORD_FRAME_CLOCK | RECORD_OF_REPLAY) ||
	    !(out->frame_hz > 0 && out->frame_hz <= 1e6f))
		return GR_ERR_FORMAT;
	return GR_OK;
}

void record_end_encode(const struct record_end *end, uint8_t bytes[RECORD_END_BYTES])
{
	struct gr_writer w = gr_writer(bytes, RECORD_END_BYTES);

	gr_write_u64(&w, (uint64_t)end->reason);
	gr_write_u64(&w, end->entries);
	gr_write_u64(&w, end->lost);
}

int record_end_decode(const uint8_t *bytes, size_t len, struct record_end *out)
{
	struct gr_reader r = gr_reader(bytes, len);
	const uint64_t reason = gr_read_u64(&r);

	out->entries = gr_read_u64(&r);
	out->lost = gr_read_u64(&r);
	if (!gr_reader_done(&r) || reason < RECORD_END_ASKED || reason > RECORD_END_SIZE)
		return GR_ERR_FORMAT;
	out->reason = (enum record_end_reason)reason;
	return GR_OK;
}

const char *record_end_name(enum record_end_reason reason)
{
	switch (reason) {
	case RECORD_END_ASKED: return "asked to";
	case RECORD_END_MASTER: return "the master ended";
	case RECORD_END_SIZE: return "the file had reached its largest size";
	}
	return "unknown";
}
