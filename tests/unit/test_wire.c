/* protocol/wire.h, message.h, replay.h: the gate, the bodies, the window. */
#include "unit.h"

#include "protocol/message.h"
#include "protocol/replay.h"

#include "base/result.h"

#include <sodium.h>

static const uint8_t key[FDP_KEY_BYTES] = { 9, 8, 7 }; /* the cluster's */
static const uint8_t keys[4][FDP_KEY_BYTES] = { { 1 }, { 2 }, { 3 }, { 4 } };

static struct fdp_gate master_gate(void)
{
	return (struct fdp_gate){
		.cluster_key = key, .keys = keys, .keyed = 0xd, .session = 77,
		.kinds = 1u << FDP_JOIN | 1u << FDP_ACK | 1u << FDP_DELTA,
		.any_version_kinds = 1u << FDP_JOIN,
		.first_sender = 0, .last_sender = 3,
	};
}

static struct fdp_header ack_header(void)
{
	return (struct fdp_header){
		.version = FDP_VERSION, .kind = FDP_ACK, .sender = 2, .payload_len = 10,
		.count = 1, .session = 77, .sequence = 5, .message = 6,
		.message_len = 10, .plain_len = 10,
	};
}

/* What an honest sender would sign it with. */
static const uint8_t *key_for(const struct fdp_header *h)
{
	return (unsigned)h->kind < FDP_KINDS && 1u << h->kind & FDP_HANDSHAKE ? key
	       : h->sender < 4						    ? keys[h->sender]
										    : keys[0];
}

static enum fdp_verdict open_copy(const struct fdp_gate *gate, const uint8_t *bytes, size_t len)
{
	uint8_t *exact = unit_copy(bytes, len);
	struct fdp_header h;
	const enum fdp_verdict v = fdp_gate_open(gate, exact, len, &h);

	free(exact);
	return v;
}

/* What docs/protocol.md says, by the primitives alone. */
static void macs(void **state)
{
	const uint8_t *with = keys[2];
	uint8_t bytes[FDP_HEADER_BYTES + 10] = { 'G', 'F', 'D', 'P', FDP_VERSION }, text[FDP_HEADER_BYTES];
	uint8_t mac[FDP_MAC_BYTES];
	crypto_generichash_state hash;

	(void)state;
	for (unsigned kind = FDP_JOIN; kind < FDP_KINDS; kind++) {
		bytes[5] = (uint8_t)kind;
		bytes[FDP_HEADER_BYTES + 3] = 7;
		if (1u << kind & FDP_HANDSHAKE) {
			crypto_generichash_init(&hash, with, FDP_KEY_BYTES, sizeof mac);
			crypto_generichash_update(&hash, bytes, FDP_MAC_AT);
			crypto_generichash_update(&hash, bytes + FDP_HEADER_BYTES, 10);
			crypto_generichash_final(&hash, mac, sizeof mac);
		} else {
			memcpy(text, bytes, FDP_MAC_AT);
			crypto_shorthash_siphashx24(text + FDP_MAC_AT, bytes + FDP_HEADER_BYTES, 10, with);
			crypto_shorthash_siphashx24(mac, text, sizeof text, with + 16);
		}
		fdp_wire_sign(with, bytes, sizeof bytes);
		assert_memory_equal(bytes + FDP_MAC_AT, mac, sizeof mac);
		assert_true(fdp_wire_authentic(with, bytes, sizeof bytes));
	}
}

static void good(void **state)
{
	const struct fdp_gate gate = master_gate();
	const struct fdp_header in = ack_header();
	uint8_t bytes[FDP_HEADER_BYTES + 10] = { 0 };
	struct fdp_header out;

	(void)state;
	fdp_wire_seal(&in, keys[2], bytes);
	assert_int_equal(fdp_gate_open(&gate, bytes, sizeof bytes, &out), FDP_GOOD);
	assert_int_equal(out.kind, FDP_ACK);
	assert_int_equal(out.sender, 2);
	assert_int_equal(out.session, 77);
	assert_int_equal(out.sequence, 5);
	assert_int_equal(out.message, 6);
	assert_int_equal(out.payload_len, 10);
	assert_int_equal(out.count, 1);
	assert_false(out.packed);
	/* Every byte where docs/protocol.md says it is. */
	assert_memory_equal(bytes, "GFDP\4\6\0\0\2\0\12\0\0\0\1\0", 16);
	assert_memory_equal(bytes + 16, "\115\0\0\0\0\0\0\0\5\0\0\0\0\0\0\0\6\0\0\0\0\0\0\0\12\0\0\0\12\0\0\0", 32);
}

static void short_ones(void **state)
{
	const struct fdp_gate gate = master_gate();
	const struct fdp_header h = ack_header();
	uint8_t bytes[FDP_HEADER_BYTES + 10] = { 0 };

	(void)state;
	fdp_wire_seal(&h, keys[2], bytes);
	for (size_t n = 0; n < sizeof bytes; n++)
		assert_int_equal(open_copy(&gate, bytes, n),
				 n < FDP_HEADER_BYTES ? FDP_BAD_SHORT : FDP_BAD_AUTH);
}

static void every_bit(void **state)
{
	const struct fdp_gate gate = master_gate();
	const struct fdp_header h = ack_header();
	uint8_t bytes[FDP_HEADER_BYTES + 10] = { 0 };

	(void)state;
	fdp_wire_seal(&h, keys[2], bytes);
	for (size_t bit = 0; bit < sizeof bytes * 8; bit++) {
		struct fdp_gate open = gate;
		enum fdp_verdict v;

		/* Whatever kind, sender or session it claims to be of: the MAC covers it. */
		open.kinds = UINT32_MAX;
		open.last_sender = 0xffff;

		bytes[bit / 8] = (uint8_t)(bytes[bit / 8] ^ 1u << bit % 8);
		v = open_copy(&open, bytes, sizeof bytes);
		if (bit / 8 == 5)
			assert_true(v == FDP_BAD_AUTH || v == FDP_BAD_FORMAT);
		else if (bit / 8 == 8 || bit / 8 == 9)
			assert_true(v == FDP_BAD_AUTH || v == FDP_BAD_SESSION);
		else
			assert_int_equal(v, bit / 8 < 4 ? FDP_BAD_FORMAT : bit / 8 == 4 ? FDP_BAD_VERSION
					    : bit / 8 >= 16 && bit / 8 < 24 ? FDP_BAD_SESSION : FDP_BAD_AUTH);
		bytes[bit / 8] = (uint8_t)(bytes[bit / 8] ^ 1u << bit % 8);
	}
	assert_int_equal(open_copy(&gate, bytes, sizeof bytes), FDP_GOOD);
}

static enum fdp_verdict sealed(struct fdp_header h, const uint8_t *with, size_t payload)
{
	struct fdp_gate gate = master_gate();
	uint8_t bytes[FDP_HEADER_BYTES + 64] = { 0 };
	/* Seal covers payload_len bytes; a lying length must be sealed as it arrives. */
	const uint16_t said = h.payload_len;

	h.payload_len = (uint16_t)payload;
	fdp_wire_seal(&h, with, bytes);
	if (said != payload) {
		bytes[10] = (uint8_t)said;
		bytes[11] = (uint8_t)(said >> 8);
		fdp_wire_sign(with, bytes, FDP_HEADER_BYTES + payload);
	}
	return open_copy(&gate, bytes, FDP_HEADER_BYTES + payload);
}

/* Signed by a key holder, and still wrong: each field. */
static void each_field(void **state)
{
	const uint8_t other_key[FDP_KEY_BYTES] = { 9, 8, 6 };
	struct fdp_header h;

	(void)state;
#define SAYS(verdict, ...) do { h = ack_header(); __VA_ARGS__; \
		assert_int_equal(sealed(h, key_for(&h), 10), verdict); } while (0)
	SAYS(FDP_GOOD, (void)0);
	assert_int_equal(sealed(ack_header(), key, 10), FDP_BAD_AUTH);     /* the cluster's is not the node's */
	assert_int_equal(sealed(ack_header(), keys[1], 10), FDP_BAD_AUTH); /* nor another node's */
	h = ack_header();
	h.kind = FDP_JOIN;
	assert_int_equal(sealed(h, keys[2], 10), FDP_BAD_AUTH);
	SAYS(FDP_BAD_SESSION, h.sender = 1); /* has not joined */
	SAYS(FDP_BAD_REPLAY, h.to = 3);	     /* was for a node */
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_JOIN; h.to = 3);
	SAYS(FDP_BAD_FORMAT, h.group = true; h.to = 3); /* to all and to one */
	assert_int_equal(sealed(ack_header(), other_key, 10), FDP_BAD_AUTH);
	SAYS(FDP_BAD_VERSION, h.version = 2);
	SAYS(FDP_BAD_VERSION, h.version = FDP_VERSION - 1);
	SAYS(FDP_BAD_VERSION, h.version = FDP_VERSION + 1);
	SAYS(FDP_BAD_VERSION, h.version = 0);
	SAYS(FDP_GOOD, h.version = 1; h.kind = FDP_JOIN); /* the form of JOIN never changes */
	SAYS(FDP_BAD_SESSION, h.session = 78);
	SAYS(FDP_BAD_SESSION, h.session = 0);
	SAYS(FDP_GOOD, h.session = 0; h.kind = FDP_JOIN);
	SAYS(FDP_BAD_FORMAT, h.sender = 4);
	SAYS(FDP_BAD_FORMAT, h.sender = FDP_SENDER_MASTER);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_SWAP); /* not to a master */
	SAYS(FDP_BAD_FORMAT, h.kind = (enum fdp_kind)0);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_KINDS);
	SAYS(FDP_BAD_FORMAT, h.kind = (enum fdp_kind)255);
	SAYS(FDP_BAD_FORMAT, h.kind = (enum fdp_kind)38); /* 32 + ACK */
	SAYS(FDP_BAD_FORMAT, h.sequence = 0);
	SAYS(FDP_BAD_FORMAT, h.payload_len = 9);
	SAYS(FDP_BAD_FORMAT, h.payload_len = 11);
	SAYS(FDP_BAD_FORMAT, h.message_len = 11; h.plain_len = 11);
	SAYS(FDP_BAD_FORMAT, h.message_len = 0; h.plain_len = 0);
	SAYS(FDP_BAD_FORMAT, h.plain_len = 11);
	SAYS(FDP_BAD_FORMAT, h.packed = true);
	SAYS(FDP_BAD_FORMAT, h.packed = true; h.plain_len = 100);  /* an ACK is never packed */
	SAYS(FDP_BAD_FORMAT, h.count = 2; h.message_len = h.plain_len = 20); /* nor cut */
	SAYS(FDP_BAD_FORMAT, h.count = 0);
	SAYS(FDP_BAD_FORMAT, h.index = 1);
	SAYS(FDP_GOOD, h.kind = FDP_DELTA; h.packed = true; h.plain_len = 100);
	SAYS(FDP_GOOD, h.kind = FDP_DELTA; h.count = 2; h.message_len = h.plain_len = 20);
	/* Parity: of deltas that are cut alone, as long as their fragments, half as many at most. */
	SAYS(FDP_GOOD, h.kind = FDP_DELTA; h.count = 2; h.message_len = h.plain_len = 20; h.parity = 1);
	SAYS(FDP_GOOD, h.kind = FDP_DELTA; h.count = 2; h.message_len = h.plain_len = 20; h.parity = 1; h.index = 2);
	SAYS(FDP_GOOD, h.kind = FDP_DELTA; h.count = 2; h.message_len = h.plain_len = 11; h.parity = 1; h.index = 2);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_DELTA; h.count = 2; h.message_len = h.plain_len = 10; h.parity = 1; h.index = 2);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_DELTA; h.count = 2; h.message_len = h.plain_len = 21; h.parity = 1; h.index = 2);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_DELTA; h.count = 2; h.message_len = h.plain_len = 20; h.parity = 1; h.index = 3);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_DELTA; h.count = 2; h.message_len = h.plain_len = 20; h.parity = 2);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_DELTA; h.count = 2; h.message_len = h.plain_len = 20; h.index = 2);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_DELTA; h.parity = 1);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_DELTA; h.count = 193; h.message_len = h.plain_len = 1930);
	SAYS(FDP_BAD_FORMAT, h.parity = 1);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_DELTA; h.packed = true; h.plain_len = FDP_MESSAGE_MAX + 1);
	SAYS(FDP_BAD_FORMAT, h.kind = FDP_DELTA; h.packed = true); /* packed, and no smaller */
#undef SAYS
}

static void reserved_bits(void **state)
{
	const struct fdp_gate gate = master_gate();
	const struct fdp_header h = ack_header();
	uint8_t bytes[FDP_HEADER_BYTES + 10] = { 0 };

	(void)state;
	for (unsigned bit = 3; bit < 8; bit++) {
		fdp_wire_seal(&h, keys[2], bytes);
		bytes[6] = (uint8_t)(bytes[6] | 1u << bit);
		fdp_wire_sign(keys[2], bytes, sizeof bytes);
		assert_int_equal(open_copy(&gate, bytes, sizeof bytes), FDP_BAD_FORMAT);
	}
}

static void counting(void **state)
{
	struct fdp_counters c = { 0 };

	(void)state;
	for (int v = FDP_GOOD; v <= FDP_BAD_REPLAY; v++) {
		fdp_count_bad(&c, (enum fdp_verdict)v);
		assert_true(v == FDP_GOOD ? !fdp_verdict_result((enum fdp_verdict)v)
					  : fdp_verdict_result((enum fdp_verdict)v) < 0);
	}
	assert_int_equal(c.bad_short, 1);
	assert_int_equal(c.bad_version, 1);
	assert_int_equal(c.bad_auth, 1);
	assert_int_equal(c.bad_session, 1);
	assert_int_equal(c.bad_format, 1);
	assert_int_equal(c.bad_replay, 1);
	for (int k = FDP_JOIN; k < FDP_KINDS; k++)
		assert_string_not_equal(fdp_kind_name((enum fdp_kind)k), "unknown");
	assert_string_equal(fdp_kind_name((enum fdp_kind)99), "unknown");
}

/* A decoder seen through one face, and the structs compared as bytes. */
union body {
	struct fdp_join join;
	struct fdp_welcome welcome;
	struct fdp_refuse refuse;
	struct fdp_report report;
	struct fdp_nack nack;
	struct fdp_announce announce;
	struct fdp_state_head head;
	uint64_t leave;
};

#define FACE(name, field) \
	static size_t enc_##name(const union body *b, uint8_t *p, size_t n) \
	{ return fdp_##name##_encode(&b->field, p, n); } \
	static int dec_##name(const uint8_t *p, size_t n, union body *b) \
	{ return fdp_##name##_decode(p, n, &b->field); }
FACE(join, join)
FACE(welcome, welcome)
FACE(refuse, refuse)
FACE(report, report)
FACE(nack, nack)
FACE(announce, announce)
static size_t enc_state_head(const union body *b, uint8_t *p, size_t n)
{
	return fdp_state_head_encode(&b->head, p, n);
}
static int dec_state_head(const uint8_t *p, size_t n, union body *b)
{
	size_t used;

	return fdp_state_head_decode(p, n, &b->head, &used);
}
static size_t enc_leave(const union body *b, uint8_t *p, size_t n)
{
	return fdp_leave_encode(b->leave, p, n);
}
static int dec_leave(const uint8_t *p, size_t n, union body *b)
{
	return fdp_leave_decode(p, n, &b->leave);
}

struct sample {
	const char *name;
	size_t len;
	bool open_ended; /* more bytes may follow */
	union body body;
	size_t (*encode)(const union body *b, uint8_t *p, size_t n);
	int (*decode)(const uint8_t *p, size_t n, union body *b);
};

/* A REFUSE that ends with its reason, which is whole whether or not a plan follows. */
#define REFUSE_PLAIN (18 + 11)

static const struct sample samples[] = {
	{ "join", FDP_JOIN_BYTES, false,
	  { .join = { FDP_VERSION, 3, { 1, 2 }, { 3 }, { 4 }, { 5 }, 6, "left", 7, 2180, 510, 99, 77, 20, 13, { 1, 2, 3 } } },
	  enc_join, dec_join },
	{ "welcome", 64, false, { .welcome = { { 1 }, { 2 }, { 3 }, UINT64_C(1) << 40, 33000, 4125 } },
	  enc_welcome, dec_welcome },
	{ "refuse", REFUSE_PLAIN, false, { .refuse = { { 1 }, "another one" } }, enc_refuse, dec_refuse },
	{ "refuse with the room's plan", REFUSE_PLAIN + 8, false,
	  { .refuse = { { 1 }, "another one", UINT64_C(0x1234567890) } }, enc_refuse, dec_refuse },
	{ "report", 32, false,
	  { .report = { 9, UINT64_C(0x1122334455667788), 8, 7, -5, 1234, 9, 77, 66, 55, 44, 3, 2 } },
	  enc_report, dec_report },
	{ "nack", 20 + 2, false, { .nack = { 9, 8, 0, 11, { 0xff, 0x07 } } }, enc_nack, dec_nack },
	{ "nack for a snapshot", 20, false, { .nack = { 9, 8, FDP_NACK_SNAPSHOT, 0, { 0 } } },
	  enc_nack, dec_nack },
	{ "announce", 22, false,
	  { .announce = { 9, 8, 7, 0x0f, 0xff, 3, FDP_TWICE, 571, 0, 0, { 0 }, 1234, 0, 0, { { 0 } } } },
	  enc_announce, dec_announce },
	{ "announce with slices and echoes", 43, false,
	  { .announce = { 9, 8, 7, 0x07, 0xff, 3, 0, 0, 5, 3, { 0, 4, FDP_AGE_NONE }, 1234, 2345, 2,
			  { { 63, 17, UINT32_MAX - 4 }, { 0, UINT32_MAX, 99 } } } },
	  enc_announce, dec_announce },
	{ "state head", 25, true,
	  { .head = { 9, 8, UINT64_C(0xdeadbeefcafebabe), 6, 0x0f, 0xff, FDP_TWICE, 0x0f, 5 } },
	  enc_state_head, dec_state_head },
	{ "chained state head", 17, true,
	  { .head = { 9, 8, UINT64_C(0xdeadbeefcafebabe), 0, 0x0f, 0xff, FDP_CHAINED, 0x0f, 5 } },
	  enc_state_head, dec_state_head },
	{ "state head, two at half the rate", 26, true,
	  { .head = { 9, 8, UINT64_C(0xdeadbeefcafebabe), 6, 0x0f, 0xff, FDP_TWICE, 0x0f, 5, 0x05 } },
	  enc_state_head, dec_state_head },
	{ "leave", 8, false, { .leave = 99 }, enc_leave, dec_leave },
};

static void bodies(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof samples / sizeof *samples; i++) {
		const struct sample *s = &samples[i];
		uint8_t bytes[FDP_BODY_MAX + 1] = { 0 }, again[FDP_BODY_MAX];
		union body out = { .leave = 0 };

		assert_int_equal(s->encode(&s->body, bytes, sizeof bytes), s->len);
		for (size_t n = 0; n < s->len; n++) {
			const bool whole = s->decode == dec_refuse && n == REFUSE_PLAIN;
			uint8_t *exact = unit_copy(bytes, n);

			assert_int_equal(s->encode(&s->body, again, n), 0);
			assert_int_equal(s->decode(exact, n, &out), whole ? GR_OK : GR_ERR_FORMAT);
			free(exact);
		}
		assert_int_equal(s->decode(bytes, s->len, &out), GR_OK);
		assert_int_equal(s->encode(&out, again, sizeof again), s->len);
		assert_memory_equal(bytes, again, s->len);
		assert_int_equal(s->decode(bytes, s->len + 1, &out), s->open_ended ? GR_OK : GR_ERR_FORMAT);
	}
}

/* Whatever a decoder takes, its encoder writes again: no byte without a meaning. */
static void canonical(void **state)
{
	struct unit_random r = unit_random_start("canonical");

	(void)state;
	for (size_t i = 0; i < sizeof samples / sizeof *samples; i++) {
		const struct sample *s = &samples[i];
		uint8_t bytes[FDP_BODY_MAX], again[FDP_BODY_MAX];

		for (int round = 0; round < 20000; round++) {
			union body out = { .leave = 0 };
			size_t len;

			s->encode(&s->body, bytes, sizeof bytes);
			for (unsigned n = 1 + unit_random_u32(&r) % 3; n; n--)
				bytes[unit_random_u32(&r) % s->len] = (uint8_t)unit_random_u32(&r);
			if (s->decode(bytes, s->len, &out))
				continue;
			len = s->encode(&out, again, sizeof again);
			assert_true(s->open_ended ? len && len <= s->len : len == s->len);
			/* Of a JOIN of another version no more is looked at than all have alike. */
			assert_memory_equal(bytes, again,
					    s->encode == enc_join && out.join.version != FDP_VERSION ?
						    FDP_JOIN_FIXED : len);
		}
	}
}

/* What answers a JOIN or a BEACON is never longer than it. */
static void no_amplification(void **state)
{
	struct fdp_refuse refuse = { .reason = "", .plan = 1 };
	uint8_t bytes[FDP_BODY_MAX];

	(void)state;
	memset(refuse.reason, 'x', sizeof refuse.reason - 1);
	assert_true(fdp_refuse_encode(&refuse, bytes, sizeof bytes) <= FDP_JOIN_BYTES);
	assert_int_equal(fdp_beacon_encode(bytes, sizeof bytes), FDP_JOIN_BYTES);
	assert_int_equal(fdp_beacon_decode(bytes, FDP_JOIN_BYTES), GR_OK);
	assert_int_equal(fdp_beacon_decode(bytes, FDP_JOIN_BYTES - 1), GR_ERR_FORMAT);
	bytes[FDP_JOIN_BYTES - 1] = 1;
	assert_int_equal(fdp_beacon_decode(bytes, FDP_JOIN_BYTES), GR_ERR_FORMAT);
	assert_true(fdp_welcome_encode(&samples[1].body.welcome, bytes, sizeof bytes) <= FDP_JOIN_BYTES);
}

/* The longest that there can be fits into the smallest datagram. */
static void longest_announce(void **state)
{
	struct fdp_announce a = {
		.frame = UINT64_MAX, .message = UINT64_MAX, .live = 1, .present = UINT64_MAX,
		.count = FDP_FRAGMENTS_MAX, .flags = FDP_TWICE, .wait_us = UINT32_MAX, .since = 1,
		.slices = FDP_MAX_NODES, .sent_ns = INT64_MAX, .swap_ns = INT64_MIN / 2,
		.echoes = FDP_ECHOES_MOST,
	};
	uint8_t bytes[FDP_BODY_MAX];
	struct fdp_announce out;
	size_t len;

	(void)state;
	for (int i = 0; i < FDP_MAX_NODES; i++)
		a.age[i] = FDP_AGE_NONE;
	for (int i = 0; i < FDP_ECHOES_MOST; i++)
		a.echo[i] = (struct fdp_echo){ 63, UINT32_MAX, UINT32_MAX };
	len = fdp_announce_encode(&a, bytes, sizeof bytes);
	printf("# longest PROBE or SWAP: %zu of %d bytes\n", len, FDP_BODY_MAX);
	assert_true(len > 0);
	assert_int_equal(fdp_announce_decode(bytes, len, &out), GR_OK);
}

static void text_for_logs(void **state)
{
	struct fdp_join join = samples[0].body.join, out;
	struct fdp_refuse refuse = { .reason = "two\nlines" }, refuse_out;
	uint8_t bytes[FDP_BODY_MAX];
	size_t len;

	(void)state;
	strcpy(join.name, "a\x1b[2J");
	len = fdp_join_encode(&join, bytes, sizeof bytes);
	assert_int_equal(fdp_join_decode(bytes, len, &out), GR_ERR_FORMAT);
	memset(join.name, 'n', sizeof join.name); /* no NUL */
	len = fdp_join_encode(&join, bytes, sizeof bytes);
	assert_int_equal(fdp_join_decode(bytes, len, &out), GR_ERR_FORMAT);
	len = fdp_refuse_encode(&refuse, bytes, sizeof bytes);
	assert_int_equal(fdp_refuse_decode(bytes, len, &refuse_out), GR_ERR_FORMAT);
}

/* Against a plain list of what was taken. */
static void replay_window(void **state)
{
	struct unit_random r = unit_random_start("replay_window");
	static bool taken[60000];
	struct fdp_replay window;
	uint64_t top = 100;

	(void)state;
	memset(taken, 0, sizeof taken);
	fdp_replay_start(&window, 100);
	for (int i = 0; i < 200000; i++) {
		const uint64_t span = unit_random_u32(&r) % 50 ? 40 : 3000;
		const uint64_t back = unit_random_u32(&r) % (span * 2);
		uint64_t s = top + span / 8 > back ? top + span / 8 - back : 0;
		bool expect;

		if (s >= sizeof taken)
			break;
		expect = s > 100 && !taken[s] && (s > top || top - s < FDP_REPLAY_WINDOW);
		assert_int_equal(fdp_replay_take(&window, s), expect);
		taken[s] |= expect;
		top = expect && s > top ? s : top;
	}
	fdp_replay_start(&window, UINT64_MAX - 3);
	assert_true(fdp_replay_take(&window, UINT64_MAX));
	assert_false(fdp_replay_take(&window, UINT64_MAX));
	assert_false(fdp_replay_take(&window, 5));
	assert_true(fdp_replay_take(&window, UINT64_MAX - 1));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(macs),
		cmocka_unit_test(good), cmocka_unit_test(short_ones), cmocka_unit_test(every_bit),
		cmocka_unit_test(each_field), cmocka_unit_test(reserved_bits),
		cmocka_unit_test(counting), cmocka_unit_test(bodies), cmocka_unit_test(canonical),
		cmocka_unit_test(no_amplification), cmocka_unit_test(text_for_logs),
		cmocka_unit_test(longest_announce),
		cmocka_unit_test(replay_window),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
