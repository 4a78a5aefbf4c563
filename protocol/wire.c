#include "protocol/wire.h"

#include "protocol/fragment.h"

#include "base/cursor.h"
#include "base/result.h"

#include <sodium.h>

#define VERSION_AT 4
#define KIND_AT 5

static const uint8_t magic[4] = { 'G', 'F', 'D', 'P' };

#define FLAG_PACKED 1u
#define FLAG_GROUP 2u
#define FLAG_AGAIN 4u
#define FLAGS (FLAG_PACKED | FLAG_GROUP | FLAG_AGAIN)
/* Only states are long enough to be cut or packed. */
#define LONG_KINDS (1u << FDP_SNAPSHOT | 1u << FDP_DELTA)

static const char *const kind_names[FDP_KINDS] = {
	[FDP_JOIN] = "join",   [FDP_WELCOME] = "welcome", [FDP_REFUSE] = "refuse",
	[FDP_SNAPSHOT] = "snapshot", [FDP_DELTA] = "delta", [FDP_ACK] = "ack",
	[FDP_NACK] = "nack",   [FDP_PROBE] = "probe",     [FDP_READY] = "ready",
	[FDP_SWAP] = "swap",   [FDP_SWAPPED] = "swapped", [FDP_LEAVE] = "leave",
	[FDP_SLICE] = "slice", [FDP_LACK] = "lack",       [FDP_BEACON] = "beacon",
	[FDP_VITALS] = "vitals", [FDP_INPUT] = "input",     [FDP_GLANCE] = "glance",
};

const char *fdp_kind_name(enum fdp_kind kind)
{
	return (unsigned)kind < FDP_KINDS && kind_names[kind] ? kind_names[kind] : "unknown";
}

void fdp_count_bad(struct fdp_counters *counters, enum fdp_verdict verdict)
{
	switch (verdict) {
	case FDP_GOOD: break;
	case FDP_BAD_SHORT: counters->bad_short++; break;
	case FDP_BAD_VERSION: counters->bad_version++; break;
	case FDP_BAD_AUTH: counters->bad_auth++; break;
	case FDP_BAD_SESSION: counters->bad_session++; break;
	case FDP_BAD_FORMAT: counters->bad_format++; break;
	case FDP_BAD_REPLAY: counters->bad_replay++; break;
	}
}

int fdp_verdict_result(enum fdp_verdict verdict)
{
	switch (verdict) {
	case FDP_GOOD: return GR_OK;
	case FDP_BAD_VERSION: return GR_ERR_VERSION;
	case FDP_BAD_AUTH: return GR_ERR_AUTH;
	case FDP_BAD_REPLAY: return GR_ERR_REPLAY;
	case FDP_BAD_SESSION: return GR_ERR_MISMATCH;
	case FDP_BAD_SHORT:
	case FDP_BAD_FORMAT: break;
	}
	return GR_ERR_FORMAT;
}

unsigned fdp_wire_version(const uint8_t *bytes, size_t len)
{
	return len > VERSION_AT && !memcmp(bytes, magic, sizeof magic) ? bytes[VERSION_AT] : 0;
}

_Static_assert(crypto_shorthash_siphashx24_BYTES == FDP_MAC_BYTES &&
		       2 * crypto_shorthash_siphashx24_KEYBYTES == FDP_KEY_BYTES,
	       "a key is one for the payload and one for the header");

/* Over header (less the MAC) and payload, which do not touch: two updates. */
static void handshake_mac(const uint8_t key[FDP_KEY_BYTES], const uint8_t *bytes, size_t len,
			  uint8_t mac[FDP_MAC_BYTES])
{
	crypto_generichash_state hash;

	crypto_generichash_init(&hash, key, FDP_KEY_BYTES, FDP_MAC_BYTES);
	crypto_generichash_update(&hash, bytes, FDP_MAC_AT);
	crypto_generichash_update(&hash, bytes + FDP_HEADER_BYTES, len - FDP_HEADER_BYTES);
	crypto_generichash_final(&hash, mac, FDP_MAC_BYTES);
}

/* The payload's hash under one half of the key stands behind the header under the other. */
static void session_mac(const uint8_t key[FDP_KEY_BYTES], const uint8_t *bytes, size_t len,
			uint8_t mac[FDP_MAC_BYTES])
{
	uint8_t text[FDP_MAC_AT + FDP_MAC_BYTES];

	memcpy(text, bytes, FDP_MAC_AT);
	crypto_shorthash_siphashx24(text + FDP_MAC_AT, bytes + FDP_HEADER_BYTES, len - FDP_HEADER_BYTES, key);
	crypto_shorthash_siphashx24(mac, text, sizeof text, key + crypto_shorthash_siphashx24_KEYBYTES);
}

static void compute_mac(const uint8_t key[FDP_KEY_BYTES], const uint8_t *bytes, size_t len,
			uint8_t mac[FDP_MAC_BYTES])
{
	const unsigned kind = bytes[KIND_AT];

	if (kind < FDP_KINDS && 1u << kind & FDP_HANDSHAKE)
		handshake_mac(key, bytes, len, mac);
	else
		session_mac(key, bytes, len, mac);
}

bool fdp_wire_authentic(const uint8_t key[FDP_KEY_BYTES], const uint8_t *bytes, size_t len)
{
	uint8_t mac[FDP_MAC_BYTES];

	compute_mac(key, bytes, len, mac);
	return !sodium_memcmp(mac, bytes + FDP_MAC_AT, FDP_MAC_BYTES);
}

void fdp_wire_sign(const uint8_t key[FDP_KEY_BYTES], uint8_t *bytes, size_t len)
{
	compute_mac(key, bytes, len, bytes + FDP_MAC_AT);
}

void fdp_wire_seal(const struct fdp_header *header, const uint8_t key[FDP_KEY_BYTES],
		   uint8_t *bytes)
{
	struct gr_writer w = gr_writer(bytes, FDP_MAC_AT);

	gr_write_bytes(&w, magic, sizeof magic);
	gr_write_u8(&w, header->version);
	gr_write_u8(&w, (uint8_t)header->kind);
	gr_write_u8(&w, (uint8_t)((header->packed ? FLAG_PACKED : 0) | (header->group ? FLAG_GROUP : 0) |
				  (header->again ? FLAG_AGAIN : 0)));
	gr_write_u8(&w, header->to);
	gr_write_u16(&w, header->sender);
	gr_write_u16(&w, header->payload_len);
	gr_write_u16(&w, header->index);
	gr_write_u8(&w, (uint8_t)header->count);
	gr_write_u8(&w, (uint8_t)header->parity);
	gr_write_u64(&w, header->session);
	gr_write_u64(&w, header->sequence);
	gr_write_u64(&w, header->message);
	gr_write_u32(&w, header->message_len);
	gr_write_u32(&w, header->plain_len);
	fdp_wire_sign(key, bytes, (size_t)FDP_HEADER_BYTES + header->payload_len);
}

/* Everything after magic and version; false when a reserved bit is set. */
static bool read_fields(struct gr_reader *r, struct fdp_header *out)
{
	uint8_t flags;

	out->kind = (enum fdp_kind)gr_read_u8(r);
	flags = gr_read_u8(r);
	out->to = gr_read_u8(r);
	out->packed = flags & FLAG_PACKED;
	out->group = flags & FLAG_GROUP;
	out->again = flags & FLAG_AGAIN;
	out->sender = gr_read_u16(r);
	out->payload_len = gr_read_u16(r);
	out->index = gr_read_u16(r);
	out->count = gr_read_u8(r);
	out->parity = gr_read_u8(r);
	out->session = gr_read_u64(r);
	out->sequence = gr_read_u64(r);
	out->message = gr_read_u64(r);
	out->message_len = gr_read_u32(r);
	out->plain_len = gr_read_u32(r);
	return r->ok && !(flags & ~FLAGS);
}

static bool lengths_right(const struct fdp_header *h, size_t len)
{
	if (h->payload_len != len - FDP_HEADER_BYTES || !h->sequence)
		return false;
	if (h->plain_len > FDP_MESSAGE_MAX || !fdp_fragment_chunk(h))
		return false;
	if (h->packed ? h->plain_len <= h->message_len : h->plain_len != h->message_len)
		return false;
	if (h->parity && h->kind != FDP_DELTA)
		return false;
	return (1u << h->kind & LONG_KINDS) || (h->count == 1 && !h->packed);
}

/* Who may have signed it; NULL when nobody can have, as far as this side knows. */
static const uint8_t *key_of(const struct fdp_gate *gate, const struct fdp_header *h)
{
	const unsigned i = (unsigned)h->sender - gate->first_sender;

	if (1u << h->kind & FDP_HANDSHAKE)
		return gate->cluster_key;
	return h->session == gate->session && i < 64 && gate->keyed >> i & 1 ? gate->keys[i] : NULL;
}

enum fdp_verdict fdp_gate_open(const struct fdp_gate *gate, const uint8_t *bytes, size_t len,
			       struct fdp_header *out)
{
	struct gr_reader r = gr_reader(bytes, len);
	const uint8_t *got, *key;
	uint32_t bit;
	bool fields;

	*out = (struct fdp_header){ 0 };
	if (len < FDP_HEADER_BYTES)
		return FDP_BAD_SHORT;
	got = gr_read_bytes(&r, sizeof magic);
	if (!got || memcmp(got, magic, sizeof magic) || len > FDP_DATAGRAM_MAX)
		return FDP_BAD_FORMAT;
	out->version = gr_read_u8(&r);
	fields = read_fields(&r, out);
	bit = (unsigned)out->kind < FDP_KINDS ? 1u << out->kind : 0;
	if (out->version != FDP_VERSION && !(bit & gate->any_version_kinds))
		return FDP_BAD_VERSION;
	if (out->sender < gate->first_sender || out->sender > gate->last_sender ||
	    !(bit & gate->kinds))
		return FDP_BAD_FORMAT;
	key = key_of(gate, out);
	if (!key)
		return FDP_BAD_SESSION;
	if (!fdp_wire_authentic(key, bytes, len))
		return FDP_BAD_AUTH;
	if (!fields || !lengths_right(out, len) || (out->to && (out->group || bit & FDP_HANDSHAKE)))
		return FDP_BAD_FORMAT;
	/* What was for one node is not good at another: each has numbers that only it has seen. */
	return !out->to || out->to == gate->self ? FDP_GOOD : FDP_BAD_REPLAY;
}
