#include "protocol/share.h"

#include "base/cursor.h"
#include "base/result.h"

#include <stdlib.h>

/* A slice is at most half of the light. */
#define SLICE_MAX (FDP_SHARE_MAX / 2)

_Static_assert(SLICE_MAX <= (size_t)FDP_SLICE_PIECES_MAX *
				    (FDP_DATAGRAM_MIN - FDP_HEADER_BYTES - FDP_PIECE_HEAD),
	       "the longest slice must fit into the pieces of the smallest datagrams");
_Static_assert(FDP_SLICE_PIECES_MAX <= UINT16_MAX, "pieces are counted in 16 bits");

size_t fdp_piece_encode(const struct fdp_piece *m, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_u64(&w, m->since);
	gr_write_u64(&w, m->frame);
	gr_write_u16(&w, m->index);
	gr_write_u16(&w, m->count);
	gr_write_u16(&w, m->chunk);
	gr_write_u16(&w, 0);
	gr_write_u32(&w, m->len);
	gr_write_u32(&w, m->at);
	return w.ok ? w.len : 0;
}

static uint32_t piece_count(uint32_t len, uint32_t chunk)
{
	return (len + chunk - 1) / chunk;
}

int fdp_piece_decode(const uint8_t *bytes, size_t len, struct fdp_piece *out)
{
	struct gr_reader r = gr_reader(bytes, len);
	uint16_t reserved;
	size_t expected;

	out->since = gr_read_u64(&r);
	out->frame = gr_read_u64(&r);
	out->index = gr_read_u16(&r);
	out->count = gr_read_u16(&r);
	out->chunk = gr_read_u16(&r);
	reserved = gr_read_u16(&r);
	out->len = gr_read_u32(&r);
	out->at = gr_read_u32(&r);
	if (!r.ok || reserved || !out->since || out->frame < out->since || out->count < 2 ||
	    out->count > FDP_MAX_NODES || out->index >= out->count || !out->chunk || !out->len ||
	    out->len > SLICE_MAX || piece_count(out->len, out->chunk) > FDP_SLICE_PIECES_MAX ||
	    out->at >= out->len || out->at % out->chunk)
		return GR_ERR_FORMAT;
	expected = out->len - out->at < out->chunk ? out->len - out->at : out->chunk;
	return gr_reader_left(&r) == expected ? GR_OK : GR_ERR_FORMAT;
}

size_t fdp_lack_encode(const struct fdp_lack *m, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_u64(&w, m->since);
	gr_write_u64(&w, m->frame);
	gr_write_u16(&w, m->index);
	gr_write_u16(&w, m->count);
	gr_write_u32(&w, m->first);
	gr_write_bytes(&w, m->missing, (m->count + 7u) / 8u);
	return w.ok ? w.len : 0;
}

int fdp_lack_decode(const uint8_t *bytes, size_t len, struct fdp_lack *out)
{
	struct gr_reader r = gr_reader(bytes, len);
	const uint8_t *bits;

	memset(out->missing, 0, sizeof out->missing);
	out->since = gr_read_u64(&r);
	out->frame = gr_read_u64(&r);
	out->index = gr_read_u16(&r);
	out->count = gr_read_u16(&r);
	out->first = gr_read_u32(&r);
	if (!r.ok || !out->since || out->frame < out->since || out->index >= FDP_MAX_NODES ||
	    out->count > FDP_LACK_BITS || out->first >= FDP_SLICE_PIECES_MAX ||
	    (!out->count && out->first))
		return GR_ERR_FORMAT;
	bits = gr_read_bytes(&r, (out->count + 7u) / 8u);
	if (!bits || !gr_reader_done(&r))
		return GR_ERR_FORMAT;
	memcpy(out->missing, bits, (out->count + 7u) / 8u);
	/* No bits beyond the last piece. */
	return out->count % 8 && out->missing[out->count / 8] >> out->count % 8 ? GR_ERR_FORMAT
										: GR_OK;
}

int fdp_share_init(struct fdp_share *s, size_t room)
{
	memset(s, 0, sizeof *s);
	if (room > FDP_SHARE_MAX)
		return GR_ERR_RANGE;
	if (!room)
		return GR_OK;
	s->bytes = calloc(FDP_SHARE_LANES, room);
	if (!s->bytes)
		return GR_ERR_NOMEM;
	s->room = room;
	return GR_OK;
}

void fdp_share_finish(struct fdp_share *s)
{
	free(s->bytes);
	s->bytes = NULL;
	s->room = 0;
}

static void forget(struct fdp_share *s, struct fdp_slice *slice)
{
	const bool lost = slice->frame && !fdp_slice_whole(slice);

	s->counts.lost += lost;
	s->open -= lost;
	*slice = (struct fdp_slice){ 0 };
}

void fdp_share_reset(struct fdp_share *s)
{
	for (unsigned i = 0; i < s->count; i++)
		for (unsigned lane = 0; lane < FDP_SHARE_LANES; lane++)
			forget(s, &s->slices[i][lane]);
	s->since = 0;
	s->count = 0;
}

void fdp_share_divide(struct fdp_share *s, uint64_t since, unsigned count)
{
	if (since <= s->since)
		return;
	fdp_share_reset(s);
	s->since = since;
	s->count = count;
}

size_t fdp_share_slice_max(const struct fdp_share *s)
{
	return s->count ? s->room / s->count : 0;
}

struct fdp_slice *fdp_share_find(struct fdp_share *s, unsigned index, uint64_t frame)
{
	for (unsigned lane = 0; lane < FDP_SHARE_LANES; lane++)
		if (s->slices[index][lane].frame == frame)
			return &s->slices[index][lane];
	return NULL;
}

struct fdp_slice *fdp_share_place(struct fdp_share *s, unsigned index, uint64_t frame)
{
	struct fdp_slice *lanes = s->slices[index];
	struct fdp_slice *old = &lanes[lanes[1].frame < lanes[0].frame];
	struct fdp_slice *known = fdp_share_find(s, index, frame);

	if (known)
		return known;
	if (frame < old->frame)
		return NULL;
	forget(s, old);
	old->frame = frame;
	s->open++;
	return old;
}

uint8_t *fdp_share_bytes(const struct fdp_share *s, unsigned index, const struct fdp_slice *slice)
{
	const size_t lane = (size_t)(slice - s->slices[index]);

	return s->bytes + lane * s->room + index * fdp_share_slice_max(s);
}

uint64_t fdp_share_newest(const struct fdp_share *s, unsigned index)
{
	uint64_t newest = 0;

	for (unsigned lane = 0; lane < FDP_SHARE_LANES; lane++) {
		const struct fdp_slice *slice = &s->slices[index][lane];

		if (fdp_slice_whole(slice) && slice->frame > newest)
			newest = slice->frame;
	}
	return newest;
}

static void open_slice(struct fdp_slice *slice, uint32_t len, uint16_t chunk)
{
	slice->len = len;
	slice->chunk = chunk;
	slice->pieces = (uint16_t)piece_count(len, chunk);
	if (slice->asked)
		slice->asked =
			slice->pieces; /* for everything, when only its existence was known */
}

struct fdp_slice *fdp_share_own(struct fdp_share *s, unsigned index, uint64_t frame,
				const uint8_t *bytes, size_t len, size_t chunk)
{
	struct fdp_slice *slice;

	if (!len || len > fdp_share_slice_max(s) || !chunk || chunk > UINT16_MAX)
		return NULL;
	slice = fdp_share_place(s, index, frame);
	if (!slice || slice->pieces)
		return NULL;
	open_slice(slice, (uint32_t)len, (uint16_t)chunk);
	memcpy(fdp_share_bytes(s, index, slice), bytes, len);
	slice->have = slice->pieces;
	s->open--;
	slice->given = true;
	return slice;
}

enum fdp_fragment_result fdp_share_add(struct fdp_share *s, const struct fdp_piece *piece,
				       const uint8_t *bytes, int64_t now_ns, struct fdp_slice **out)
{
	const unsigned number = piece->at / piece->chunk;
	const size_t len =
		piece->len - piece->at < piece->chunk ? piece->len - piece->at : piece->chunk;
	struct fdp_slice *slice;

	*out = NULL;
	if (piece->len > fdp_share_slice_max(s))
		return FDP_FRAGMENT_BAD;
	slice = *out = fdp_share_place(s, piece->index, piece->frame);
	if (!slice)
		return FDP_FRAGMENT_AGAIN;
	if (!slice->pieces) {
		open_slice(slice, piece->len, piece->chunk);
		slice->asked_ns = now_ns; /* the rest may be on its way */
	}
	if (slice->len != piece->len || slice->chunk != piece->chunk)
		return FDP_FRAGMENT_BAD;
	if (slice->got[number / 64] >> number % 64 & 1 || fdp_slice_whole(slice))
		return FDP_FRAGMENT_AGAIN;
	memcpy(fdp_share_bytes(s, piece->index, slice) + piece->at, bytes, len);
	slice->got[number / 64] |= UINT64_C(1) << number % 64;
	slice->have++;
	slice->asks = 0; /* it comes: asking is worth while, once no more does */
	slice->asked_ns = now_ns;
	if (!fdp_slice_whole(slice))
		return FDP_FRAGMENT_PART;
	s->open--;
	return FDP_FRAGMENT_WHOLE;
}

/*
 * The missing pieces from `first` on and below `below`, as far as one LACK can
 * say them. Returns the piece up to which it does.
 */
static unsigned lacks(const struct fdp_slice *slice, unsigned first, unsigned below,
		      struct fdp_lack *out)
{
	for (unsigned i = first; i < below; i++) {
		if (slice->got[i / 64] >> i % 64 & 1)
			continue;
		if (!out->count)
			out->first = i;
		if (i - out->first >= FDP_LACK_BITS)
			return i;
		out->missing[(i - out->first) / 8] |= (uint8_t)(1u << (i - out->first) % 8);
		out->count = (uint16_t)(i - out->first + 1);
	}
	return below;
}

bool fdp_share_ask(struct fdp_share *s, unsigned index, struct fdp_slice *slice, unsigned below,
		   bool again, int64_t now_ns, struct fdp_lack *out)
{
	unsigned upto;

	*out = (struct fdp_lack){ .since = s->since,
				  .frame = slice->frame,
				  .index = (uint16_t)index };
	if (fdp_slice_whole(slice))
		return false;
	if (!slice->pieces) {
		if (slice->asked && !again)
			return false;
		slice->asked = 1;
	} else {
		below = below < slice->pieces ? below : slice->pieces;
		upto = lacks(slice, again ? 0 : slice->asked, below, out);
		slice->asked = upto > slice->asked ? (uint16_t)upto : slice->asked;
		if (!out->count)
			return false;
	}
	slice->asks += again;
	slice->asked_ns = now_ns;
	s->counts.asked++;
	return true;
}

int64_t fdp_share_ask_at(const struct fdp_share *s, unsigned index, const struct fdp_slice *slice,
			 int64_t interval_ns)
{
	if (!slice->frame || fdp_slice_whole(slice) || fdp_share_newest(s, index) > slice->frame)
		return INT64_MAX;
	return slice->asked_ns + fdp_backoff(interval_ns, slice->asks);
}

size_t fdp_share_write(const struct fdp_share *s, unsigned index, const struct fdp_slice *slice,
		       unsigned piece, uint8_t *body, size_t size)
{
	const struct fdp_piece head = {
		.since = s->since,
		.frame = slice->frame,
		.index = (uint16_t)index,
		.count = (uint16_t)s->count,
		.chunk = slice->chunk,
		.len = slice->len,
		.at = piece * slice->chunk,
	};
	const size_t len = head.len - head.at < head.chunk ? head.len - head.at : head.chunk;

	if (FDP_PIECE_HEAD + len > size)
		return 0;
	fdp_piece_encode(&head, body, size);
	memcpy(body + FDP_PIECE_HEAD, fdp_share_bytes(s, index, slice) + head.at, len);
	return FDP_PIECE_HEAD + len;
}
