#include "protocol/fragment.h"

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
	size_t chunk, last;

	if (!total || total > FDP_MESSAGE_MAX || !len || len > total || !h->count ||
	    h->count > FDP_FRAGMENTS_MAX || h->index >= h->count)
		return 0;
	if (h->count == 1)
		return len == total ? len : 0;
	if (h->index + 1 < h->count) {
		chunk = len;
	} else {
		if ((total - len) % (h->count - 1u))
			return 0;
		chunk = (total - len) / (h->count - 1u);
	}
	/* The last fragment holds at least one byte and no more than the others. */
	if (!chunk || chunk * (h->count - 1u) >= total)
		return 0;
	last = total - chunk * (h->count - 1u);
	return last <= chunk ? chunk : 0;
}

void fdp_reassembly_reset(struct fdp_reassembly *r)
{
	memset(r, 0, offsetof(struct fdp_reassembly, bytes));
}

static void start(struct fdp_reassembly *r, const struct fdp_header *h, size_t chunk)
{
	fdp_reassembly_reset(r);
	r->message = h->message;
	r->message_len = h->message_len;
	r->plain_len = h->plain_len;
	r->packed = h->packed;
	r->count = h->count;
	r->chunk = (uint32_t)chunk;
}

enum fdp_fragment_result fdp_reassembly_add(struct fdp_reassembly *r,
					    const struct fdp_header *h, const uint8_t *payload)
{
	const size_t chunk = fdp_fragment_chunk(h);
	uint64_t bit;

	if (!chunk || !h->message)
		return FDP_FRAGMENT_BAD;
	if (h->message < r->message)
		return FDP_FRAGMENT_AGAIN;
	if (h->message > r->message)
		start(r, h, chunk);
	if (h->message_len != r->message_len || h->plain_len != r->plain_len ||
	    h->packed != r->packed || h->count != r->count || chunk != r->chunk)
		return FDP_FRAGMENT_BAD;
	bit = UINT64_C(1) << h->index % 64;
	if (!h->again && !(r->first[h->index / 64] & bit)) {
		r->first[h->index / 64] |= bit;
		r->firsts++;
	}
	if (r->got[h->index / 64] & bit)
		return FDP_FRAGMENT_AGAIN;
	memcpy(r->bytes + (size_t)r->chunk * h->index, payload, h->payload_len);
	r->got[h->index / 64] |= bit;
	r->have++;
	return r->have == r->count ? FDP_FRAGMENT_WHOLE : FDP_FRAGMENT_PART;
}

static unsigned missing(const struct fdp_reassembly *r, unsigned from, unsigned below,
			uint8_t bitmap[FDP_BITMAP_BYTES])
{
	unsigned n = 0;

	memset(bitmap, 0, FDP_BITMAP_BYTES);
	for (unsigned i = from; i < below && i < r->count; i++) {
		if (r->got[i / 64] >> i % 64 & 1)
			continue;
		bitmap[i / 8] = (uint8_t)(bitmap[i / 8] | 1u << i % 8);
		n++;
	}
	return n;
}

unsigned fdp_reassembly_missing(const struct fdp_reassembly *r, unsigned below,
				uint8_t bitmap[FDP_BITMAP_BYTES])
{
	return missing(r, 0, below, bitmap);
}

unsigned fdp_reassembly_gap(struct fdp_reassembly *r, unsigned index,
			    uint8_t bitmap[FDP_BITMAP_BYTES])
{
	const unsigned n = missing(r, r->reported, index, bitmap);

	if (index > r->reported)
		r->reported = (uint16_t)index;
	return n;
}
