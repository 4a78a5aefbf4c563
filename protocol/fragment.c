#include "protocol/fragment.h"

#include "protocol/parity.h"

#include <string.h>

unsigned fdp_fragment_count(size_t message_len, size_t datagram_max)
{
	const size_t chunk = datagram_max - FDP_HEADER_BYTES;
	const size_t count = (message_len + chunk - 1) / chunk;

	return count <= FDP_FRAGMENTS_MAX ? (unsigned)count : 0;
}

size_t fdp_fragment_at(size_t message_len, size_t datagram_max, unsigned index, size_t *out_len)
{
	const size_t chunk = datagram_max - FDP_HEADER_BYTES;
	const size_t at = chunk * index;

	*out_len = message_len - at < chunk ? message_len - at : chunk;
	return at;
}

size_t fdp_fragment_chunk(const struct fdp_header *h)
{
	const size_t total = h->message_len, len = h->payload_len;
	size_t chunk;

	if (!total || total > FDP_MESSAGE_MAX || !len || len > FDP_MESSAGE_MAX || !h->count ||
	    h->count > FDP_FRAGMENTS_MAX || h->parity > fdp_parity_most(h->count) ||
	    h->index >= h->count + h->parity)
		return 0;
	if (h->count == 1)
		return len == total ? len : 0;
	if (h->index + 1 != h->count) {
		chunk = len;
	} else {
		if (len > total || (total - len) % (h->count - 1u))
			return 0;
		chunk = (total - len) / (h->count - 1u);
	}
	/* The last fragment holds at least one byte and no more than the others. */
	return chunk * (h->count - 1u) < total && total <= chunk * h->count ? chunk : 0;
}

void fdp_reassembly_reset(struct fdp_reassembly *r)
{
	memset(r, 0, offsetof(struct fdp_reassembly, bytes));
}

static bool has(const uint64_t bits[FDP_PARTS_MAX / 64], unsigned i)
{
	return bits[i / 64] >> i % 64 & 1;
}

static void set(uint64_t bits[FDP_PARTS_MAX / 64], unsigned i)
{
	bits[i / 64] |= UINT64_C(1) << i % 64;
}

static void start(struct fdp_reassembly *r, const struct fdp_header *h, size_t chunk)
{
	fdp_reassembly_reset(r);
	r->message = h->message;
	r->message_len = h->message_len;
	r->plain_len = h->plain_len;
	r->packed = h->packed;
	r->count = h->count;
	r->parity = h->parity;
	r->chunk = (uint32_t)chunk;
}

/* Of the fragments that the message needs, and no parity fragment stands in for. */
static unsigned lacks(const struct fdp_reassembly *r)
{
	const unsigned there = (unsigned)r->have + r->have_parity;

	return there < r->count ? r->count - there : 0;
}

static void heal(struct fdp_reassembly *r)
{
	const unsigned n = (unsigned)r->count - r->have;
	uint8_t lost[FDP_PARITY_MAX] = { 0 }, rows[FDP_PARITY_MAX] = { 0 };
	unsigned i = 0, row = 0;

	for (unsigned j = 0; j < r->count; j++)
		if (!has(r->got, j))
			lost[i++] = (uint8_t)j;
	for (i = 0; i < n; row++)
		if (has(r->got, r->count + row))
			rows[i++] = (uint8_t)row;
	memset(r->bytes + r->message_len, 0, (size_t)r->chunk * r->count - r->message_len);
	fdp_parity_heal(r->bytes, r->chunk, r->count, r->parity_bytes, lost, rows, n);
	for (i = 0; i < n; i++)
		set(r->got, lost[i]);
	r->have = r->count;
	r->healed = (uint16_t)n;
}

enum fdp_fragment_result fdp_reassembly_add(struct fdp_reassembly *r,
					    const struct fdp_header *h, const uint8_t *payload)
{
	const size_t chunk = fdp_fragment_chunk(h);

	if (!chunk || !h->message)
		return FDP_FRAGMENT_BAD;
	if (h->message < r->message)
		return FDP_FRAGMENT_AGAIN;
	if (h->message > r->message)
		start(r, h, chunk);
	if (h->message_len != r->message_len || h->plain_len != r->plain_len ||
	    h->packed != r->packed || h->count != r->count || h->parity != r->parity ||
	    chunk != r->chunk)
		return FDP_FRAGMENT_BAD;
	if (!h->again && h->index < r->count && !has(r->first, h->index)) {
		set(r->first, h->index);
		r->firsts++;
	}
	if (has(r->got, h->index) || r->have == r->count)
		return FDP_FRAGMENT_AGAIN;
	set(r->got, h->index);
	if (h->index < r->count) {
		memcpy(r->bytes + chunk * h->index, payload, h->payload_len);
		r->have++;
	} else {
		memcpy(r->parity_bytes + chunk * (h->index - r->count), payload, h->payload_len);
		r->have_parity++;
	}
	if (lacks(r))
		return FDP_FRAGMENT_PART;
	if (r->have < r->count)
		heal(r);
	return FDP_FRAGMENT_WHOLE;
}

/* The first `most` missing fragments of from..below-1; *end is then past the last of them. */
static unsigned missing(const struct fdp_reassembly *r, unsigned from, unsigned below,
			unsigned most, uint8_t bitmap[FDP_BITMAP_BYTES], unsigned *end)
{
	unsigned n = 0;

	memset(bitmap, 0, FDP_BITMAP_BYTES);
	*end = from;
	for (unsigned i = from; i < below && i < r->count && n < most; i++) {
		if (has(r->got, i))
			continue;
		bitmap[i / 8] = (uint8_t)(bitmap[i / 8] | 1u << i % 8);
		*end = i + 1;
		n++;
	}
	return n;
}

unsigned fdp_reassembly_missing(const struct fdp_reassembly *r, unsigned below,
				uint8_t bitmap[FDP_BITMAP_BYTES])
{
	unsigned end;

	return missing(r, 0, below, lacks(r), bitmap, &end);
}

unsigned fdp_reassembly_gap(struct fdp_reassembly *r, const struct fdp_header *h,
			    uint8_t bitmap[FDP_BITMAP_BYTES])
{
	/* What is sent again is sent after all of the message, its parity too. */
	const unsigned parts = (unsigned)r->count + r->parity;
	const unsigned seen = h->again && r->parity ? parts : h->index;
	unsigned lost = 0, asked = 0, end, n;

	for (unsigned i = 0; i < seen; i++) {
		lost += !has(r->got, i);
		asked += i < r->reported && i < r->count && !has(r->got, i);
	}
	n = lost > r->parity + asked ? lost - r->parity - asked : 0;
	n = missing(r, r->reported, seen, n, bitmap, &end);
	if (end > r->reported)
		r->reported = (uint16_t)end;
	return n;
}
