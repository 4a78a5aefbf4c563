/*
 * Fragments of messages, in any order and with any header that passes the gate,
 * against a plain model of what a reassembly may hold; parity fragments are right, or lies.
 */
#include "protocol/fragment.h"
#include "protocol/parity.h"

#include "base/cursor.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What is there, and whether all of it is of the message. */
struct model {
	uint64_t message;
	uint32_t len;
	size_t chunk;
	uint16_t count, data, parity;
	bool got[FDP_PARTS_MAX];
	bool whole, lied;
};

static uint8_t byte_of(uint64_t message, size_t at)
{
	return (uint8_t)(message * 7 + at * 13u + at / 251);
}

/* The whole message of which a header is, its last fragment padded. */
static const uint8_t *message_of(const struct fdp_header *h, size_t chunk)
{
	static uint8_t bytes[FDP_PADDED_MAX];

	for (size_t i = 0; i < chunk * h->count; i++)
		bytes[i] = i < h->message_len ? byte_of(h->message, i) : 0;
	return bytes;
}

/* What an honest sender puts behind this header; a lie: anything. */
static void fill(uint8_t *payload, const struct fdp_header *h, size_t chunk, bool lie)
{
	static uint8_t parity[FDP_MESSAGE_MAX];

	if (!chunk || (lie && h->index >= h->count)) {
		memset(payload, 0x5a, h->payload_len);
		return;
	}
	if (h->index < h->count) {
		for (size_t i = 0; i < h->payload_len; i++)
			payload[i] = byte_of(h->message, chunk * h->index + i);
		return;
	}
	fdp_parity_make(message_of(h, chunk), chunk, h->count, h->parity, parity);
	memcpy(payload, parity + chunk * (h->index - h->count), chunk);
}

static void check_missing(const struct fdp_reassembly *r, const struct model *m)
{
	uint8_t bitmap[FDP_BITMAP_BYTES];
	const unsigned n = fdp_reassembly_missing(r, r->count, bitmap);
	const unsigned expect = m->whole ? 0 : m->count - m->data - m->parity;

	for (unsigned i = 0; i < m->count; i++)
		if (fdp_bit(bitmap, i) && (m->got[i] || m->whole))
			abort();
	if (n != expect || fdp_reassembly_open(r) != (n > 0))
		abort();
}

static void take(struct fdp_reassembly *r, struct model *m, const struct fdp_header *h, bool lie)
{
	uint8_t *payload = malloc(h->payload_len ? h->payload_len : 1);
	const size_t chunk = fdp_fragment_chunk(h);
	uint8_t gap[FDP_BITMAP_BYTES];
	enum fdp_fragment_result result;

	if (!payload)
		abort();
	fill(payload, h, chunk, lie);
	result = fdp_reassembly_add(r, h, payload);
	free(payload);
	if (result == FDP_FRAGMENT_PART || result == FDP_FRAGMENT_WHOLE) {
		if (!chunk || h->message < m->message)
			abort();
		if (h->message > m->message)
			*m = (struct model){ .message = h->message, .len = h->message_len,
					     .chunk = chunk, .count = h->count };
		if (m->got[h->index] || m->whole ||
		    (h->index < h->count ? chunk * h->index + h->payload_len > m->len : h->payload_len != chunk))
			abort();
		m->got[h->index] = true;
		m->data = (uint16_t)(m->data + (h->index < h->count));
		m->parity = (uint16_t)(m->parity + (h->index >= h->count));
		m->lied = m->lied || (lie && h->index >= h->count);
		m->whole = m->data + m->parity == m->count;
		if (m->whole != (result == FDP_FRAGMENT_WHOLE))
			abort();
		if (fdp_reassembly_gap(r, h, gap) > (unsigned)m->count - m->data - m->parity)
			abort();
	} else if (result == FDP_FRAGMENT_AGAIN && h->message == m->message && !m->got[h->index] &&
		   !m->whole) {
		abort();
	}
	if (result == FDP_FRAGMENT_WHOLE && (r->message_len != m->len ||
	    (!m->lied && memcmp(r->bytes, message_of(h, chunk), m->len))))
		abort();
	if (m->message && r->message == m->message)
		check_missing(r, m);
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
		h.parity = gr_read_u8(&in);
		h.again = what & 8;
		/* Half of them as an honest sender cuts: the rest of the header follows from three numbers. */
		if (what & 2) {
			const uint32_t len = h.message_len % FDP_MESSAGE_MAX + 1;
			const size_t datagram = FDP_DATAGRAM_MIN + h.payload_len % 2000;
			size_t part;

			h.message_len = h.plain_len = len;
			h.count = (uint16_t)fdp_fragment_count(len, datagram);
			if (!h.count)
				continue;
			h.parity = (uint16_t)(h.parity % (fdp_parity_most(h.count) + 1));
			h.index = (uint16_t)(h.index % (h.count + h.parity));
			if (h.index < h.count)
				fdp_fragment_at(len, datagram, h.index, &part);
			else
				part = datagram - FDP_HEADER_BYTES;
			h.payload_len = (uint16_t)part;
			if (fdp_fragment_chunk(&h) != (h.count > 1 ? datagram - FDP_HEADER_BYTES : len))
				abort();
		}
		take(&r, &m, &h, what & 4);
	}
	return 0;
}
