/*
 * The fixed header of every FDP datagram, its keyed MAC, and the one gate
 * that all arriving bytes pass. docs/protocol.md gives every byte.
 *
 * A datagram is a header of FDP_HEADER_BYTES and a payload: a fragment of a
 * message, or a whole one. The MAC has 16 bytes and covers all but itself. The
 * cluster's key signs the kinds of FDP_HANDSHAKE (BLAKE2b, keyed, RFC 7693), keys
 * of the session (session_keys.h) all others: SipHash-2-4 of 128 bits (Aumasson and
 * Bernstein 2012; libsodium's siphashx24), a keyed function that needs no nonce and
 * takes a third to a fifth of BLAKE2b's time on what is signed hundreds of times a frame.
 *
 * The header, the first FDP_JOIN_FIXED bytes of a JOIN and all of a REFUSE keep
 * their form in every version of the protocol, so that a peer of another
 * version can be told why it is refused.
 */
#ifndef GROTTO_PROTOCOL_WIRE_H
#define GROTTO_PROTOCOL_WIRE_H

#include "protocol/master.h"

#define FDP_VERSION 4
#define FDP_HEADER_BYTES 64
#define FDP_KIND_AT 5
#define FDP_MAC_AT 48
#define FDP_MAC_BYTES 16
#define FDP_SENDER_MASTER 0xffff /* less the master's index in the layout */
#define FDP_DATAGRAM_MIN 448   /* least datagram_max: a JOIN, or a SWAP of 64 slices, in one piece */
#define FDP_DATAGRAM_MAX 65507 /* what UDP over IPv4 can hold */
#define FDP_MESSAGE_MAX 65536
#define FDP_FRAGMENTS_MAX 192 /* enough for the longest message in the smallest datagrams */
#define FDP_PARITY_MAX 32     /* parity fragments of one message, see parity.h */
/*
 * What is asked again within a frame is asked every probe interval, as often
 * as a deadline of the usual length has them; then ever more rarely, down to
 * 16 intervals, so that a room that waits for a slow wall is quiet.
 */
#define FDP_STEADY_ASKS 8
static inline int64_t fdp_backoff(int64_t interval_ns, unsigned times)
{
	const unsigned more = times > FDP_STEADY_ASKS ? times - FDP_STEADY_ASKS : 0;

	return interval_ns << (more < 4 ? more : 4);
}

enum fdp_kind {
	FDP_JOIN = 1, /* node: may I? and again with the challenge: I am here */
	FDP_WELCOME,  /* master: prove that you are here now */
	FDP_REFUSE,
	FDP_SNAPSHOT, /* master: the whole state, base 0 */
	FDP_DELTA,
	FDP_ACK,      /* node: applied */
	FDP_NACK,     /* node: these fragments are missing */
	FDP_PROBE,    /* master: where are you? this is the frame */
	FDP_READY,    /* node: the GPU has finished */
	FDP_SWAP,
	FDP_SWAPPED,
	FDP_LEAVE,
	FDP_SLICE,    /* both: a piece of a slice of the light */
	FDP_LACK,     /* both: these pieces of a slice are missing */
	FDP_BEACON,   /* master: this is the session, for those who are not in it */
	FDP_VITALS,   /* node: how much its socket holds, where its time goes */
	FDP_INPUT,    /* node: what is done at its window */
	FDP_GLANCE,   /* node: what the eye looks at of its wall */
	FDP_KINDS
};

/* The sender of master `index`, and the index of a master that is the sender. */
static inline uint16_t fdp_master_sender(unsigned index)
{
	return (uint16_t)(FDP_SENDER_MASTER - index);
}

static inline bool fdp_sender_is_master(uint16_t sender)
{
	return sender > FDP_SENDER_MASTER - FDP_MAX_MASTERS;
}

/* Signed with the cluster's key: what is said before there is a session. */
#define FDP_HANDSHAKE (1u << FDP_JOIN | 1u << FDP_WELCOME | 1u << FDP_REFUSE | 1u << FDP_BEACON)

struct fdp_header {
	uint8_t version;
	enum fdp_kind kind;
	bool packed;
	bool group;      /* from the master: sent to the group; from a node: it hears the group */
	bool again;      /* this fragment was sent before */
	uint8_t to;      /* one more than the node that it is for; 0: all, the master, or a handshake */
	uint16_t sender; /* node index, or fdp_master_sender */
	uint16_t payload_len;
	/* Fragment; from count on it is one of `parity` parity fragments of the message. */
	uint16_t index, count, parity;
	uint64_t session;      /* 0 only in the first JOIN */
	uint64_t sequence;     /* per sender and session, never twice */
	uint64_t message;      /* numbers the sender's messages, rising */
	uint32_t message_len;  /* as sent */
	uint32_t plain_len;    /* after unpacking; equal to message_len when not packed */
};

/* What the gate says; each but FDP_GOOD has its counter. */
enum fdp_verdict {
	FDP_GOOD,
	FDP_BAD_SHORT,
	FDP_BAD_VERSION,
	FDP_BAD_AUTH,
	FDP_BAD_SESSION,
	FDP_BAD_FORMAT,
	FDP_BAD_REPLAY,
};
void fdp_count_bad(struct fdp_counters *counters, enum fdp_verdict verdict);
/* As a negative result: GR_ERR_FORMAT, _VERSION, _AUTH, _MISMATCH or _REPLAY. */
int fdp_verdict_result(enum fdp_verdict verdict);

/* Who may come in. Bits of kinds are 1 << kind. */
struct fdp_gate {
	const uint8_t *cluster_key;           /* of FDP_HANDSHAKE, in any session */
	const uint8_t (*keys)[FDP_KEY_BYTES]; /* of all else, in `session`: that of first_sender + i */
	uint64_t keyed;                       /* bit i: there is such a key */
	uint64_t session;
	uint32_t kinds; /* that this side takes at all */
	uint32_t any_version_kinds;
	uint16_t first_sender, last_sender;
	uint8_t self; /* what `to` says when it is for this side alone; 0: the master's */
};

/*
 * Checks in this order: length, magic, version, whether sender and kind may be,
 * session, MAC (constant time), then the rest. The fields of *out are authentic
 * on FDP_GOOD and FDP_BAD_REPLAY (for another node) alone. The payload follows
 * the header in the caller's bytes. The window is the caller's to check
 * (replay.h), since it is kept per sender.
 */
enum fdp_verdict fdp_gate_open(const struct fdp_gate *gate, const uint8_t *bytes, size_t len,
			       struct fdp_header *out);
/* Writes header and MAC before a payload that stands at bytes + FDP_HEADER_BYTES. */
void fdp_wire_seal(const struct fdp_header *header, const uint8_t key[FDP_KEY_BYTES],
		   uint8_t *bytes);
/* Puts the MAC of what stands there, by its kind, into a datagram of at least FDP_HEADER_BYTES. */
void fdp_wire_sign(const uint8_t key[FDP_KEY_BYTES], uint8_t *bytes, size_t len);
/* Constant-time comparison of the MAC in a datagram of at least FDP_HEADER_BYTES. */
bool fdp_wire_authentic(const uint8_t key[FDP_KEY_BYTES], const uint8_t *bytes, size_t len);
/* The version that a datagram says it is of; 0 when it is none of FDP. */
unsigned fdp_wire_version(const uint8_t *bytes, size_t len);
const char *fdp_kind_name(enum fdp_kind kind);

#endif
