#include "protocol/outbox.h"

#include "protocol/parity.h"

#include "base/result.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

int fdp_outbox_init(struct fdp_outbox *out)
{
	int result;

	if (sodium_init() < 0)
		return GR_ERR_UNSUPPORTED;
	result = fdp_packer_create(&out->packer);
	if (result)
		return result;
	out->datagram = malloc(out->datagram_max);
	return out->datagram ? GR_OK : GR_ERR_NOMEM;
}

void fdp_outbox_finish(struct fdp_outbox *out)
{
	free(out->datagram);
	out->datagram = NULL;
	fdp_packer_destroy(&out->packer);
}

static void send_sealed(struct fdp_outbox *out, int to, struct fdp_header *header)
{
	const size_t len = (size_t)FDP_HEADER_BYTES + header->payload_len;
	const uint64_t copies = to == FDP_TO_ALL ? out->fan_out : 1;
	const bool handshake = 1u << header->kind & FDP_HANDSHAKE;

	header->version = FDP_VERSION;
	header->sender = out->sender;
	header->session = out->session;
	header->sequence = ++out->sequence;
	header->group = !handshake && (to == FDP_TO_GROUP || out->hears_group);
	if (fdp_sender_is_master(out->sender) && to >= 0 && !handshake)
		header->to = (uint8_t)(to + 1);
	fdp_wire_seal(header, handshake ? out->cluster_key : out->key, out->datagram);
	out->counters->datagrams_out += copies;
	out->counters->bytes_out += copies * len;
	out->send(out->ctx, to, out->datagram, len);
}

uint8_t *fdp_outbox_body(struct fdp_outbox *out)
{
	return out->datagram + FDP_HEADER_BYTES;
}

void fdp_outbox_send(struct fdp_outbox *out, int to, enum fdp_kind kind, size_t body_len)
{
	struct fdp_header header = {
		.kind = kind,
		.payload_len = (uint16_t)body_len,
		.count = 1,
		.message = ++out->message,
		.message_len = (uint32_t)body_len,
		.plain_len = (uint32_t)body_len,
	};

	send_sealed(out, to, &header);
}

void fdp_outbox_letter(struct fdp_outbox *out, struct fdp_letter *letter, enum fdp_kind kind,
		       uint64_t frame, size_t plain_len)
{
	const unsigned plain_count = fdp_fragment_count(plain_len, out->datagram_max);
	const uint8_t *packed;
	size_t packed_len;

	letter->kind = kind;
	letter->frame = frame;
	letter->number = ++out->message;
	letter->plain_len = letter->len = (uint32_t)plain_len;
	letter->count = (uint16_t)plain_count;
	letter->parity = 0;
	letter->packed = false;
	if (plain_count == 1 || fdp_pack(out->packer, letter->bytes, plain_len, &packed, &packed_len))
		return;
	if (fdp_fragment_count(packed_len, out->datagram_max) >= plain_count)
		return;
	memcpy(letter->bytes, packed, packed_len);
	letter->packed = true;
	letter->len = (uint32_t)packed_len;
	letter->count = (uint16_t)fdp_fragment_count(packed_len, out->datagram_max);
	out->counters->packed++;
}

void fdp_outbox_protect(const struct fdp_outbox *out, struct fdp_letter *letter, unsigned parity)
{
	const size_t chunk = out->datagram_max - FDP_HEADER_BYTES;

	letter->parity = (uint16_t)parity;
	if (!parity)
		return;
	memset(letter->bytes + letter->len, 0, chunk * letter->count - letter->len);
	fdp_parity_make(letter->bytes, chunk, letter->count, parity, letter->parity_bytes);
}

/* Where fragment or parity fragment `index` stands, and its length. */
static const uint8_t *part(const struct fdp_outbox *out, const struct fdp_letter *letter,
			   unsigned index, size_t *len)
{
	if (index < letter->count)
		return letter->bytes + fdp_fragment_at(letter->len, out->datagram_max, index, len);
	*len = out->datagram_max - FDP_HEADER_BYTES;
	return letter->parity_bytes + *len * (index - letter->count);
}

static void send_fragment(struct fdp_outbox *out, int to, const struct fdp_letter *letter,
			  unsigned index, bool again)
{
	size_t len;
	const uint8_t *bytes = part(out, letter, index, &len);
	const uint64_t copies = to == FDP_TO_ALL ? out->fan_out : 1;
	struct fdp_header header = {
		.kind = letter->kind,
		.packed = letter->packed,
		.again = again,
		.payload_len = (uint16_t)len,
		.index = (uint16_t)index,
		.count = letter->count,
		.parity = letter->parity,
		.message = letter->number,
		.message_len = letter->len,
		.plain_len = letter->plain_len,
	};

	if (index >= letter->count) {
		out->counters->parity += copies;
		out->counters->parity_bytes += copies * (FDP_HEADER_BYTES + len);
	}
	memcpy(fdp_outbox_body(out), bytes, len);
	send_sealed(out, to, &header);
}

void fdp_outbox_fragment(struct fdp_outbox *out, int to, const struct fdp_letter *letter,
			 unsigned index)
{
	send_fragment(out, to, letter, index, false);
}

void fdp_outbox_again(struct fdp_outbox *out, int to, const struct fdp_letter *letter,
		      unsigned index)
{
	send_fragment(out, to, letter, index, true);
}

void fdp_outbox_post(struct fdp_outbox *out, int to, const struct fdp_letter *letter)
{
	for (unsigned i = 0; i < (unsigned)letter->count + letter->parity; i++)
		fdp_outbox_fragment(out, to, letter, i);
}
