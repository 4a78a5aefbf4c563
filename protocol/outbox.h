/*
 * The sending half of a peer, the same for master and node: numbers messages
 * and datagrams, cuts, packs, seals and counts. No allocation after create.
 */
#ifndef GROTTO_PROTOCOL_OUTBOX_H
#define GROTTO_PROTOCOL_OUTBOX_H

#include "protocol/message.h"
#include "protocol/pack.h"

/* A message that may have to be sent again, whole or by the fragment. */
struct fdp_letter {
	enum fdp_kind kind;
	uint64_t number; /* of the message; 0: nothing here */
	uint64_t frame;
	bool packed;
	uint16_t count, parity;
	uint32_t len, plain_len;
	uint8_t bytes[FDP_PADDED_MAX];
	uint8_t parity_bytes[FDP_MESSAGE_MAX]; /* of `parity` parity fragments */
};

struct fdp_outbox {
	const uint8_t *cluster_key; /* signs FDP_HANDSHAKE */
	const uint8_t *key;         /* signs all else */
	uint16_t sender;
	uint64_t session;
	uint64_t sequence; /* of the last datagram */
	uint64_t message;  /* last number given */
	size_t datagram_max;
	bool hears_group; /* a node's to say */
	size_t fan_out; /* datagrams on the wire for one to FDP_TO_ALL */
	struct fdp_counters *counters;
	void (*send)(void *ctx, int to, const uint8_t *bytes, size_t len);
	void *ctx;
	uint8_t *datagram; /* datagram_max bytes */
	struct fdp_packer *packer;
};

int fdp_outbox_init(struct fdp_outbox *out);
void fdp_outbox_finish(struct fdp_outbox *out);
/* A message that fits one datagram: its body stands at fdp_outbox_body(). */
uint8_t *fdp_outbox_body(struct fdp_outbox *out);
void fdp_outbox_send(struct fdp_outbox *out, int to, enum fdp_kind kind, size_t body_len);
/*
 * Makes a letter of the plain bytes that stand in letter->bytes: gives it a
 * number and packs it where that saves datagrams. It has no parity.
 */
void fdp_outbox_letter(struct fdp_outbox *out, struct fdp_letter *letter, enum fdp_kind kind,
		       uint64_t frame, size_t plain_len);
/* Gives a letter that was not sent yet so many parity fragments, at most fdp_parity_most(). */
void fdp_outbox_protect(const struct fdp_outbox *out, struct fdp_letter *letter, unsigned parity);
/* From letter->count on: parity fragments. */
void fdp_outbox_fragment(struct fdp_outbox *out, int to, const struct fdp_letter *letter,
			 unsigned index);
/* The same once more, marked so: who has it from this one has lost the first. */
void fdp_outbox_again(struct fdp_outbox *out, int to, const struct fdp_letter *letter,
		      unsigned index);
/* All of it, its parity last. */
void fdp_outbox_post(struct fdp_outbox *out, int to, const struct fdp_letter *letter);

#endif
