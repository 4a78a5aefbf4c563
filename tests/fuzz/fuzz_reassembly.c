/*
 * Fragments of messages, in any order and with any header that passes the gate,
 * against a plain model of what a reassembly may hold.
 */
#include "protocol/fragment.h"

#include "base/cursor.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Bytes that are there, and where each came from. */
struct model {
	uint64_t message;
	uint32_t len;
	uint16_t count;
	bool got[FDP_FRAGMENTS_MAX];
	uint8_t bytes[FDP_MESSAGE_MAX];
};

static uint8_t byte_of(const struct fdp_header *h, size_t i)
{
	return (uint8_t)(h->message * 7 + h->index * 13u + i);
}

static void check_missing(const struct fdp_reassembly *r, const struct model *m)
{
	uint8_t bitmap[FDP_BITMAP_BYTES];
	unsigned n = fdp_reassembly_missing(r, r->count, bitmap), expect = 0;

	for (unsigned i = 0; i < m->count; i++) {
		expect += !m->got[i];
		if (fdp_bit(bitmap, i) == m->got[i])
			abort();
	}
	if (n != expect || n + r->have != r->count || fdp_reassembly_open(r) != (n > 0))
		abort();
}

static void take(struct fdp_reassembly *r, struct model *m, const struct fdp_header *h)
{
	uint8_t *payload = malloc(h->payload_len ? h->payload_len : 1);
	const size_t chunk = fdp_fragment_chunk(h);
	uint8_t gap[FDP_BITMAP_BYTES];
	enum fdp_fragment_result result;

	if (!payload)
		abort();
	for (size_t i = 0; i < h->payload_len; i++)
		payload[i] = byte_of(h, i);
	result = fdp_reassembly_add(r, h, payload);
	if (result == FDP_FRAGMENT_PART || result == FDP_FRAGMENT_WHOLE) {
		if (!chunk || h->message < m->message)
			abort();
		if (h->message > m->message)
			*m = (struct model){ .message = h->message, .len = h->message_len, .count = h->count };
		if (m->got[h->index] || chunk * h->index + h->payload_len > m->len)
			abort();
		m->got[h->index] = true;
		memcpy(m->bytes + chunk * h->index, payload, h->payload_len);
		fdp_reassembly_gap(r, h->index, gap);
	} else if (result == FDP_FRAGMENT_AGAIN && h->message == m->message && !m->got[h->index]) {
		abort();
	}
	if (result == FDP_FRAGMENT_WHOLE && (r->message_len != m->len || memcmp(r->bytes, m->bytes, m->len)))
		abort();
	if (m->message && r->message == m->message)
		check_missing(r, m);
	free(payload);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct fdp_reassembly r;
	static struct model m;
	struct gr_reader in = gr_reader(data, size);

	fdp_reassembly_reset(&r);
	m = (struct model){ 0 };
	while (gr_reader_left(&in) >= 14) {
		const uint8_t what = gr_read_u8(&in);
		struct fdp_header h = {
			.kind = FDP_DELTA, .message = gr_read_u8(&in), .packed = what & 1,
			.index = gr_read_u16(&in), .count = gr_read_u16(&in),
			.payload_len = gr_read_u16(&in), .message_len = gr_read_u32(&in),
		};

		h.plain_len = h.message_len + (gr_read_u8(&in) & 1);
		gr_read_u8(&in);
		/* Half of them as an honest sender cuts: the rest of the header follows from three numbers. */
		if (what & 2) {
			const uint32_t len = h.message_len % FDP_MESSAGE_MAX + 1;
			const size_t datagram = FDP_DATAGRAM_MIN + h.payload_len % 2000;
			size_t part;

			h.message_len = h.plain_len = len;
			h.count = (uint16_t)fdp_fragment_count(len, datagram);
			if (!h.count)
				continue;
			h.index = (uint16_t)(h.index % h.count);
			fdp_fragment_at(len, datagram, h.index, &part);
			h.payload_len = (uint16_t)part;
			if (fdp_fragment_chunk(&h) != (h.count > 1 ? datagram - FDP_HEADER_BYTES : len))
				abort();
		}
		take(&r, &m, &h);
	}
	return 0;
}
