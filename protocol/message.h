/*
 * The bodies of FDP messages. Encoders return the number of bytes written (0
 * when the room is too small), decoders GR_OK or GR_ERR_FORMAT: they take a
 * body only whole, with nothing left over and reserved bytes zero.
 */
#ifndef GROTTO_PROTOCOL_MESSAGE_H
#define GROTTO_PROTOCOL_MESSAGE_H

#include "protocol/fragment.h"

#include "base/cursor.h"

#define FDP_NONCE_BYTES 16
#define FDP_NAME_BYTES 32 /* with the final NUL */
/* Padded: what answers a JOIN, or a BEACON, is never longer than it. */
#define FDP_JOIN_BYTES 336
#define FDP_JOIN_FIXED 152 /* of these the form is the same in all versions */
#define FDP_ITEMS_BYTES (FDP_JOIN_BYTES - FDP_JOIN_FIXED - 18)
#define FDP_BODY_MAX (FDP_DATAGRAM_MIN - FDP_HEADER_BYTES) /* of all but states and slices */

struct fdp_join {
	uint16_t version, index;
	uint8_t nonce[FDP_NONCE_BYTES];     /* the node's, new for each time it joins */
	uint8_t challenge[FDP_NONCE_BYTES]; /* the master's, zero in the first JOIN */
	uint8_t layout_hash[32], scene_hash[32];
	uint64_t table_hash; /* of the parameter table */
	char name[FDP_NAME_BYTES];
	uint64_t plan; /* of how this node computes the light, where that is not the scene file's to say; 0: it is */
	/* What it expects of that, hundredths: of a millisecond a frame, of a percent. UINT16_MAX: that or more. */
	uint16_t plan_cost, plan_error;
	uint64_t highest; /* session that it has been in: it enters none below; 0: none yet */
	uint64_t shown;   /* the highest frame that it was told to show, in any session; 0: none yet */
	/*
	 * The parts of layout and scene, the beginnings of their digests in this
	 * order: fdp_items_width bytes each. All 0 in a JOIN of another version.
	 */
	uint8_t layout_items, scene_items;
	uint8_t items[FDP_ITEMS_BYTES];
};
/* Bytes of a digest that fit; 0 when not even one does. */
static inline unsigned fdp_items_width(unsigned count)
{
	const unsigned width = count ? FDP_ITEMS_BYTES / count : 0;

	return width < GR_ITEM_DIGEST ? width : GR_ITEM_DIGEST;
}

struct fdp_welcome {
	uint8_t nonce[FDP_NONCE_BYTES]; /* the JOIN's */
	uint8_t challenge[FDP_NONCE_BYTES];
	uint8_t master_nonce[FDP_NONCE_BYTES]; /* of the session */
	uint64_t first_sequence; /* the node's sequence numbers start here */
	uint32_t deadline_us, probe_us;
};

struct fdp_refuse {
	uint8_t nonce[FDP_NONCE_BYTES];
	char reason[FDP_REASON_MAX]; /* printable ASCII, NUL-terminated here */
	uint64_t plan; /* of the room, where the node's is why: with it it may come; 0: not said */
};

/* ACK, READY, SWAPPED. */
struct fdp_report {
	uint64_t frame, hash; /* hash of the state of `frame`; 0 in SWAPPED */
	uint64_t swapped_frame, swapped_count;
	int64_t swap_ns; /* node's CLOCK_MONOTONIC at swapped_frame */
	uint32_t render_us;
	uint64_t slice; /* frame of the newest slice that the node has made; 0: none in this division */
	/*
	 * For the clocks (clock_offset.h): when this left, by the node's; of sent_ns of
	 * the newest PROBE or SWAP that it has, 0: none, and how long ago that came.
	 */
	int64_t sent_ns;
	uint32_t echo_low; /* see fdp_whole_time */
	uint32_t held_ns;
	uint32_t path_ns;    /* from the last SWAP's leaving until the node had it in hand; 0: not known */
	uint32_t swaps_late; /* SWAPs since the join that were in hand after their time */
	/* Fragments of DELTAs since the join of which no first copy came; wraps. */
	uint32_t lost;
};

#define FDP_NACK_SNAPSHOT 1u /* cannot use what came: send the whole state */
struct fdp_nack {
	uint64_t frame, message;
	uint16_t flags;
	uint16_t count; /* fragments of the message; 0 with FDP_NACK_SNAPSHOT */
	uint8_t missing[FDP_BITMAP_BYTES];
};

/*
 * In a state's head: the hash of the frame before is left out, since nobody
 * needs it who has that frame, and that frame is the delta's base.
 */
#define FDP_CHAINED 2u
/* In a state's head: some of those that draw it do so at half the rate. */
#define FDP_HALF 4u
#define FDP_TWICE 1u /* the way is lossy: READY and NACK are worth sending twice */
/* How old a slice is that nobody has made yet, or that is older than can be said. */
#define FDP_AGE_NONE ((1u << 21) - 1) /* three bytes on the wire */
/* A node's report, said back: when it left (node's clock), and how long ago it came. */
struct fdp_echo {
	uint16_t node;
	uint32_t held_ns;
	uint32_t sent_low; /* see fdp_whole_time */
};
#define FDP_ECHOES_MOST 4
/* One's own time, said back by its low half: the last one before now_ns that has it, within 4.3 s. */
static inline int64_t fdp_whole_time(uint32_t low, int64_t now_ns)
{
	return now_ns - (int64_t)(uint32_t)((uint32_t)now_ns - low);
}
/* A datagram may wait so long in its socket for a busy receiver. */
#define FDP_ARRIVED_MOST_NS INT64_C(1000000000)

/* PROBE and SWAP. */
struct fdp_announce {
	uint64_t frame, swapped; /* under way (or last), last swapped */
	uint64_t message;        /* that carries frame's delta; 0: none */
	uint64_t live, present;  /* bit i: node i counts in the barrier; is known */
	uint16_t count;          /* fragments of that message */
	uint16_t flags;
	uint32_t wait_us; /* after which the master asks again who has not acknowledged; 0 without FDP_TWICE */
	/* The newest whole slices, by rank; slices 0: not said. Division: as in the state's head. */
	uint64_t since;
	uint16_t slices;
	uint32_t age[FDP_MAX_NODES]; /* frame less the slice's, or FDP_AGE_NONE */
	int64_t sent_ns; /* when this left, master's clock */
	int64_t swap_ns; /* when `swapped` is to be shown, master's clock; 0: at once */
	uint16_t echoes;
	struct fdp_echo echo[FDP_ECHOES_MOST];
};

/*
 * A piece of a slice: all but a slice's last have `chunk` bytes. The division
 * that it is of: the one that began with frame `since`.
 */
struct fdp_piece {
	uint64_t since, frame;
	uint16_t index, count; /* slice index of count; 2..FDP_MAX_NODES */
	uint16_t chunk;
	uint32_t len;          /* of the slice */
	uint32_t at;           /* where in it the piece begins */
};
#define FDP_PIECE_HEAD 32

#define FDP_LACK_BITS 1024
struct fdp_lack {
	uint64_t since, frame; /* which slice */
	uint16_t index;
	uint16_t count; /* bits; 0: every piece */
	uint32_t first; /* piece of bit 0 */
	uint8_t missing[FDP_LACK_BITS / 8];
};

/* What precedes the delta in DELTA and SNAPSHOT. */
struct fdp_state_head {
	uint64_t frame, previous_frame;
	uint64_t hash, previous_hash; /* previous_hash 0 with FDP_CHAINED */
	uint64_t live, present; /* draw the frame; are known */
	uint32_t flags; /* FDP_HALF is put there by the encoder */
	/*
	 * Division of the light: slice i is the i-th node's in `shared`, from the
	 * lowest bit up. Slices of frames before `shared_since` are void. Both 0
	 * when nothing is shared.
	 */
	uint64_t shared, shared_since;
	uint64_t half; /* of those that draw it, who shows it with the frame after; 0: none */
};
#define FDP_STATE_HEAD_MAX (1 + 2 * 8 + 7 * GR_VARINT_MOST)

/* What a master calls itself when it follows: by its place in the layout, 0 the first. */
void fdp_master_name(unsigned index, char name[FDP_NAME_BYTES]);

size_t fdp_join_encode(const struct fdp_join *m, uint8_t *bytes, size_t size);
int fdp_join_decode(const uint8_t *bytes, size_t len, struct fdp_join *out);
size_t fdp_welcome_encode(const struct fdp_welcome *m, uint8_t *bytes, size_t size);
int fdp_welcome_decode(const uint8_t *bytes, size_t len, struct fdp_welcome *out);
size_t fdp_refuse_encode(const struct fdp_refuse *m, uint8_t *bytes, size_t size);
int fdp_refuse_decode(const uint8_t *bytes, size_t len, struct fdp_refuse *out);
/* Says nothing: who it is from and of which session stands in the header. */
size_t fdp_beacon_encode(uint8_t *bytes, size_t size);
int fdp_beacon_decode(const uint8_t *bytes, size_t len);
size_t fdp_report_encode(const struct fdp_report *m, uint8_t *bytes, size_t size);
int fdp_report_decode(const uint8_t *bytes, size_t len, struct fdp_report *out);
size_t fdp_nack_encode(const struct fdp_nack *m, uint8_t *bytes, size_t size);
int fdp_nack_decode(const uint8_t *bytes, size_t len, struct fdp_nack *out);
size_t fdp_announce_encode(const struct fdp_announce *m, uint8_t *bytes, size_t size);
int fdp_announce_decode(const uint8_t *bytes, size_t len, struct fdp_announce *out);
size_t fdp_leave_encode(uint64_t frame, uint8_t *bytes, size_t size);
int fdp_leave_decode(const uint8_t *bytes, size_t len, uint64_t *out_frame);
size_t fdp_state_head_encode(const struct fdp_state_head *m, uint8_t *bytes, size_t size);
size_t fdp_piece_encode(const struct fdp_piece *m, uint8_t *bytes, size_t size);
/* The piece's bytes are what follows: bytes + FDP_PIECE_HEAD, len - FDP_PIECE_HEAD of them. */
int fdp_piece_decode(const uint8_t *bytes, size_t len, struct fdp_piece *out);
size_t fdp_lack_encode(const struct fdp_lack *m, uint8_t *bytes, size_t size);
int fdp_lack_decode(const uint8_t *bytes, size_t len, struct fdp_lack *out);
/* The delta is what follows the head's *out_len bytes. */
int fdp_state_head_decode(const uint8_t *bytes, size_t len, struct fdp_state_head *out,
			  size_t *out_len);

#endif
