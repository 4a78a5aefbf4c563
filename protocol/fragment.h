/*
 * Messages cut into fragments and put together again. All fragments of a
 * message but the last have the same length, so that one header says where
 * its payload belongs.
 *
 * A reassembly holds one message: a fragment of a newer one (higher number)
 * takes its place, one of an older one is dropped. So its memory is bounded
 * whatever arrives.
 *
 * A message may have parity fragments (parity.h), which follow its own: as soon as
 * any `count` of them all are there it is whole, and none is asked for that these
 * can still stand in for.
 */
#ifndef GROTTO_PROTOCOL_FRAGMENT_H
#define GROTTO_PROTOCOL_FRAGMENT_H

#include "protocol/wire.h"

#define FDP_BITMAP_BYTES (FDP_FRAGMENTS_MAX / 8)
#define FDP_PARTS_MAX 256 /* fragments and parity fragments: what a header can number */
/* Room for a message in fragments of one length, its last one padded. */
#define FDP_PADDED_MAX (2 * FDP_MESSAGE_MAX)

/* How many fragments a message needs; 0 when it does not fit into FDP_FRAGMENTS_MAX. */
unsigned fdp_fragment_count(size_t message_len, size_t datagram_max);
/*
 * Bytes of every fragment but the last, and of every parity fragment, found from any
 * one's header; 0 when index, counts and lengths do not go together.
 */
size_t fdp_fragment_chunk(const struct fdp_header *header);
/* Where fragment `index` of a message begins, and its length. */
size_t fdp_fragment_at(size_t message_len, size_t datagram_max, unsigned index, size_t *out_len);

struct fdp_reassembly {
	uint64_t message; /* 0: none yet */
	uint32_t message_len, plain_len;
	uint32_t chunk;
	uint16_t count, have;
	uint16_t parity, have_parity;
	uint16_t firsts;   /* of count, those whose first copy came */
	uint16_t reported; /* missing ones below this index were told by _gap */
	uint16_t healed;   /* of count, those that parity gave */
	bool packed;
	uint64_t got[FDP_PARTS_MAX / 64];   /* parity fragments from bit `count` on */
	uint64_t first[FDP_PARTS_MAX / 64]; /* first copies that came */
	uint8_t bytes[FDP_PADDED_MAX];
	uint8_t parity_bytes[FDP_MESSAGE_MAX]; /* at most fdp_parity_most(count) * chunk of them */
};

enum fdp_fragment_result {
	FDP_FRAGMENT_PART,  /* taken, others are missing */
	FDP_FRAGMENT_WHOLE, /* taken, and the message is whole: said once */
	FDP_FRAGMENT_AGAIN, /* we have it, or the message is older than the one held */
	FDP_FRAGMENT_BAD,   /* does not go with the others of its message */
};

/* The header has passed the gate; payload has header->payload_len bytes. */
enum fdp_fragment_result fdp_reassembly_add(struct fdp_reassembly *r,
					    const struct fdp_header *header,
					    const uint8_t *payload);
/* Fragments of the message held of which no first copy has come so far. */
static inline unsigned fdp_reassembly_lost(const struct fdp_reassembly *r)
{
	return r->message ? (unsigned)r->count - r->firsts : 0;
}
void fdp_reassembly_reset(struct fdp_reassembly *r);
static inline bool fdp_reassembly_open(const struct fdp_reassembly *r)
{
	return r->message && r->have < r->count;
}
/*
 * Sets the bits of missing fragments with index < below, the first ones, and no more
 * of them than the message lacks; returns how many.
 */
unsigned fdp_reassembly_missing(const struct fdp_reassembly *r, unsigned below,
				uint8_t bitmap[FDP_BITMAP_BYTES]);
/*
 * The fragment of this header has come (taken by _add): all that were sent before it
 * are there or lost. Missing fragments that parity cannot stand in for, even if all of it
 * that is to come does, and that no earlier call gave; returns how many.
 */
unsigned fdp_reassembly_gap(struct fdp_reassembly *r, const struct fdp_header *header,
			    uint8_t bitmap[FDP_BITMAP_BYTES]);

static inline bool fdp_bit(const uint8_t *bitmap, unsigned i)
{
	return bitmap[i / 8] >> (i % 8) & 1;
}

#endif
