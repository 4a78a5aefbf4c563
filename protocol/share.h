/*
 * Inside protocol/: slices of the light on their way, the same for master and
 * node. A slice is what one node has computed for all in one frame. It travels
 * in pieces, one a datagram, so that a piece can be passed on before the next
 * has come, and asked for alone.
 *
 * A division says who computes what: it begins with a frame, and has a slice
 * for each node that counts in that frame. When who counts changes, or the
 * light starts anew, a new division begins and everything of the one before is
 * void.
 *
 * Of each slice the newest two frames are kept: a node that is slow still gets
 * the one before last while the next one is on its way. Memory is taken once;
 * what arrives is bounded by it.
 */
#ifndef GROTTO_PROTOCOL_SHARE_H
#define GROTTO_PROTOCOL_SHARE_H

#include "protocol/message.h"

#define FDP_SLICE_PIECES_MAX 12288
#define FDP_SHARE_LANES 2
/*
 * A piece is missing, and not merely overtaken, when the third one after it has
 * come; what is said of whole slices finds the rest. (As TCP counts: RFC 5681, section 3.2.)
 */
#define FDP_OVERTAKEN 3

/* One frame's slice of one node. */
struct fdp_slice {
	uint64_t frame;      /* 0: nothing here */
	uint32_t len;        /* 0: it is known that there is one, nothing of it has come */
	uint16_t chunk;      /* bytes of every piece but the last */
	uint16_t pieces, have;
	uint16_t asked;      /* what is missing below this piece has been asked for */
	bool given, late;    /* to who uses it; was not whole when that was due */
	unsigned asks;       /* how often it was asked for again */
	int64_t asked_ns;
	uint64_t got[FDP_SLICE_PIECES_MAX / 64];
};

struct fdp_share {
	uint64_t since; /* first frame of the division; 0: none yet */
	unsigned count; /* slices */
	unsigned open;  /* known of, and not whole */
	size_t room;    /* bytes of all slices of one frame together; 0: nothing is shared here */
	uint8_t *bytes; /* FDP_SHARE_LANES times room */
	struct fdp_slice slices[FDP_MAX_NODES][FDP_SHARE_LANES];
	struct fdp_share_counts counts;
};

/* GR_OK, GR_ERR_RANGE (room above FDP_SHARE_MAX), GR_ERR_NOMEM. */
int fdp_share_init(struct fdp_share *s, size_t room);
void fdp_share_finish(struct fdp_share *s);
/* A new division; does nothing when it is no newer than the present one. */
void fdp_share_divide(struct fdp_share *s, uint64_t since, unsigned count);
/* Out of every division. */
void fdp_share_reset(struct fdp_share *s);
/* Longest slice of the present division. */
size_t fdp_share_slice_max(const struct fdp_share *s);

/*
 * The place of a slice, made when there is none; NULL when two newer ones are
 * known. Index below count, frame in the division.
 */
struct fdp_slice *fdp_share_place(struct fdp_share *s, unsigned index, uint64_t frame);
uint8_t *fdp_share_bytes(const struct fdp_share *s, unsigned index, const struct fdp_slice *slice);
static inline bool fdp_slice_whole(const struct fdp_slice *slice)
{
	return slice->pieces && slice->have == slice->pieces;
}
/* NULL when it is not known. */
struct fdp_slice *fdp_share_find(struct fdp_share *s, unsigned index, uint64_t frame);
/* Frame of the newest whole slice; 0: none. */
uint64_t fdp_share_newest(const struct fdp_share *s, unsigned index);
/* A whole slice at once, which is to be sent; given and whole. NULL when it is too long or too old. */
struct fdp_slice *fdp_share_own(struct fdp_share *s, unsigned index, uint64_t frame,
				const uint8_t *bytes, size_t len, size_t chunk);

/* The piece is decoded, of the present division; bytes stand behind it. */
enum fdp_fragment_result fdp_share_add(struct fdp_share *s, const struct fdp_piece *piece,
				       const uint8_t *bytes, int64_t now_ns,
				       struct fdp_slice **out);
/*
 * What to ask for when all pieces below `below` should have come, and were not asked
 * for before; with `again` all that is missing. False: nothing.
 */
bool fdp_share_ask(struct fdp_share *s, unsigned index, struct fdp_slice *slice, unsigned below,
		   bool again, int64_t now_ns, struct fdp_lack *out);
/* Pieces below this number should have come when this one has. */
static inline unsigned fdp_piece_sure(const struct fdp_piece *piece)
{
	const unsigned number = piece->at / piece->chunk;

	return number < FDP_OVERTAKEN ? 0 : number - FDP_OVERTAKEN + 1;
}
/* When it is to be asked for again; INT64_MAX: no more, it is whole or a newer one is. */
int64_t fdp_share_ask_at(const struct fdp_share *s, unsigned index, const struct fdp_slice *slice,
			 int64_t interval_ns);
/* Whether we hold a piece of the slice that a LACK is about, and it asks for it. */
static inline bool fdp_slice_answers(const struct fdp_slice *slice, const struct fdp_lack *lack,
				     unsigned piece)
{
	if (!fdp_slice_whole(slice) && !(slice->got[piece / 64] >> piece % 64 & 1))
		return false;
	if (!lack->count)
		return true;
	return piece >= lack->first && piece - lack->first < lack->count &&
	       fdp_bit(lack->missing, piece - lack->first);
}
/* Node `node`'s slice in a division among `nodes`, of which it is one. */
static inline unsigned fdp_share_rank(uint64_t nodes, unsigned node)
{
	return (unsigned)__builtin_popcountll(nodes & ((UINT64_C(1) << node) - 1));
}
/* A piece as body of a SLICE; returns its length. */
size_t fdp_share_write(const struct fdp_share *s, unsigned index, const struct fdp_slice *slice,
		       unsigned piece, uint8_t *body, size_t size);

#endif
