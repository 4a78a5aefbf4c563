/*
 * Inside the master's half of FDP: master.c has the frame, master_receive.c
 * what arrives, master_clock.c time, master_pace.c who does not keep up, master_join.c
 * who may take part and master_refuse.c why not, master_repair.c what is sent again,
 * master_parity.c what is sent ahead of losses, master_bulk.c what can wait, master_way.c
 * the way to all, master_window.c what is on its way to each, master_follow.c the other
 * masters, master_share.c the light that the nodes share out.
 */
#ifndef GROTTO_PROTOCOL_MASTER_PRIVATE_H
#define GROTTO_PROTOCOL_MASTER_PRIVATE_H

#include "protocol/barrier.h"
#include "protocol/bucket.h"
#include "protocol/loss.h"
#include "protocol/master.h"
#include "protocol/message.h"
#include "protocol/outbox.h"
#include "protocol/pace.h"
#include "protocol/peer.h"
#include "protocol/replay.h"
#include "protocol/session_keys.h"
#include "protocol/share.h"
#include "protocol/state.h"
#include "protocol/trip.h"
#include "protocol/window.h"

#define FDP_HASH_RING 64 /* frames whose hash an ACK may still name */
#define FDP_PROBE_MOST_NS INT64_C(5000000) /* a long deadline is no reason to repair slowly */
#define FDP_KEEPALIVE_NS INT64_C(250000000)
#define FDP_JOIN_SILENCE_NS INT64_C(2000000000)
#define FDP_REFUSED_AGAIN_NS INT64_C(60000000000) /* a repeated reason is told once in this time */
/* Sequences of a node's n-th incarnation start at n << this: older ones never pass. */
#define FDP_INCARNATION_SHIFT 40
/* So many frames after the last sign of loss, small messages go twice. */
#define FDP_LOSS_FRAMES 512
#define FDP_GROUP_PATIENCE_NS INT64_C(1000000000) /* for a node to hear the group before it is named */
#define FDP_SAID_FRAMES 64 /* SWAP says which slices there are until so long after the last change */

#define FDP_SWAPPED_MOST_NS INT64_C(10000000000) /* a swap is told of within this */
#define FDP_ECHOES_FIRST 64 /* to a node that has just joined, as fast as there is room */
#define FDP_ECHOES_FEW 4 /* up to so many nodes two echoes a SWAP are enough */
/*
 * Snapshots and what is sent again of the light: so fast to one node, and to all
 * together. With a frame's longest delta (64 KiB) a node's burst fits the receive
 * buffer that Linux gives unasked (208 KiB, which counts each datagram's room), and a delta
 * waits for the burst to all at most: a millisecond at 1 Gbit/s.
 */
#define FDP_BULK_NODE_BYTES_S 40000000
#define FDP_BULK_NODE_BURST 65536
#define FDP_BULK_ALL_BYTES_S 60000000
#define FDP_BULK_ALL_BURST 131072
_Static_assert(FDP_BULK_NODE_BURST >= FDP_DATAGRAM_MAX, "a bucket must hold what is sent at once");

/*
 * What waits leaves so much at a time, so often: at 1 Gbit/s half of the link, and a delta
 * finds no more before it than takes an eighth of a millisecond; and none when it comes
 * on time, for shortly before nothing leaves.
 */
#define FDP_BULK_TICK_NS INT64_C(250000)
#define FDP_BULK_TICK_BYTES 16384
#define FDP_BULK_REST_NS INT64_C(300000)
/*
 * What is passed on as it comes: of a light that moves, what goes over 1 Gbit/s beside the
 * frames. When a division begins all nodes send all of the light: where that is more than the
 * burst it waits, until each has sent its part.
 */
#define FDP_PASS_BYTES_S 110000000
#define FDP_PASS_BURST 2097152

#define FDP_PATHS 64 /* ways of a SWAP that its lead is measured by */

struct fdp_peer {
	enum fdp_peer_state state;
	struct fdp_peer_status status;
	struct fdp_replay window;
	uint64_t joins; /* incarnations taken in this session */
	uint8_t challenge[FDP_NONCE_BYTES]; /* of the incarnation that is in */
	bool synced;         /* has acknowledged a snapshot, waits for the next frame */
	bool wants_snapshot; /* holds a wrong state, or cannot use the deltas */
	uint64_t snapshot_from;  /* frame in which it was found to: what it held before is no base */
	uint64_t mismatch_frame; /* counted once a frame */
	unsigned missed_row;
	int64_t missed_ns;    /* deadline of the first of these */
	struct fdp_pace pace; /* of all its incarnations */
	int64_t joined_ns;
	struct fdp_bucket bulk;
	struct fdp_window window_out; /* what is on its way to it */
	uint32_t lost;        /* as its last report said, see fdp_report */
	uint32_t lost_now;    /* said since the last frame began */
	struct fdp_loss loss;
	struct fdp_trip trip; /* from a DELTA to its ACK */
	int64_t snapshot_ns; /* last sent */
	int64_t told_ns;     /* a dead one was told so */
	int64_t refused_ns;
	struct fdp_clock clock;     /* the node's beside ours */
	bool echo_due;              /* a report came that was not said back yet */
	int64_t echo_sent_ns, echo_arrived_ns; /* its clock, ours */
	uint64_t echoes;            /* said to it */
	uint32_t path_ns[FDP_PATHS]; /* of its last SWAPs */
	uint64_t path_count;
	uint64_t input_sequence;    /* of the newest INPUT's datagram */
	uint64_t glance_sequence;   /* of the newest GLANCE's */
	char refused[FDP_REASON_MAX];
};

/* Nodes at half the rate; see master_pace.c. */
struct fdp_half {
	bool shows;       /* this frame is the second of its pair */
	uint64_t nodes;   /* of the pair */
	uint64_t frame;   /* first of the pair, which they draw */
	uint64_t ready;   /* for that */
	int64_t begun_ns; /* when it did */
};

struct fdp_want;

struct fdp_master {
	struct fdp_master_params params;
	char names[FDP_MAX_NODES][FDP_NAME_BYTES];
	struct fdp_master_ops ops;
	struct fdp_counters counters;
	struct fdp_gate gate;
	struct fdp_outbox out;
	uint8_t nonce[FDP_NONCE_BYTES]; /* of the session */
	uint8_t key_to_nodes[FDP_KEY_BYTES];
	uint8_t node_keys[FDP_MAX_NODES][FDP_KEY_BYTES]; /* of the incarnation that came in last */
	struct fdp_peer peers[FDP_MAX_NODES];
	int answers; /* node whose datagram is being handled, or -1 */

	struct param_state *state;
	uint64_t frame, previous_frame, hash, previous_hash;
	uint64_t hashes[FDP_HASH_RING], hash_frames[FDP_HASH_RING];
	bool underway;
	uint64_t swapped;
	int64_t swapped_ns;
	int64_t swap_ns;    /* when `swapped` is to be shown; 0: at once */
	int64_t now_ns;     /* of the call that is being served: what is sent bears it */
	int64_t arrived_ns; /* of the next datagram, by the kernel; 0: not told */
	unsigned echo_next; /* node whose turn it is to be answered in a datagram to all */
	struct fdp_barrier barrier;
	struct fdp_half half;
	struct fdp_pace_params pace; /* complete */
	int64_t usual_deadline_ns;
	bool judges;       /* the frame has the usual deadline: who keeps pace shows */
	bool waits_longer; /* the deadline was put off for who is slow and lives */

	struct fdp_letter delta, snapshot;
	uint64_t snapshot_present; /* whom the snapshot names as present */
	int64_t repaired_ns[FDP_FRAGMENTS_MAX]; /* of delta, when sent to all again */
	uint64_t repair_budget;                 /* bytes left in this frame */
	struct fdp_rate bulk_node, bulk_all;
	struct fdp_bucket bulk; /* to all together */
	struct fdp_bucket passed; /* of slices, as they came */
	bool fresh;             /* the division has begun, and its first slices have not all come */
	size_t bulk_tick_bytes; /* FDP_BULK_TICK_BYTES */
	struct fdp_want *wants; /* pieces that wait: see master_bulk.c; NULL: nothing is shared */
	size_t wanted, want_next; /* how many; whose turn it is */
	int64_t bulk_at_ns;     /* when some of these leave */
	int64_t due_ns;         /* when the next frame is to begin, as far as can be foreseen */
	uint64_t sent_to_all;   /* of datagrams to all, for the windows */
	unsigned loss; /* frames for which small messages still go twice */
	int64_t asked_ns; /* who has not acknowledged the frame was last asked, or the frame began */
	int64_t keepalive_at;
	int64_t spoke_ns;    /* to all who are live or follow */
	uint64_t floor;      /* see fdp_master_floor */
	bool calls;          /* see fdp_master_call */
	int64_t listens_ns;  /* see fdp_master_listen; 0: does not */
	int64_t all_told_ns; /* SWAP last went to all nodes that the layout has */
	unsigned probes; /* in this frame */

	bool group;            /* what is for all goes to the group */
	enum fdp_way told_way; /* the last FDP_MASTER_WAY */

	struct fdp_share share;
	uint64_t shared;         /* nodes among whom it is divided */
	uint64_t share_changed;  /* frame in which a slice last became whole */
	/* Bytes that may be passed on of each node, and sent to it again, in this frame. */
	uint64_t pass_budget[FDP_MAX_NODES], lack_budget[FDP_MAX_NODES];
};

/* Bit sets over the peers. */
uint64_t fdp_master_mask(const struct fdp_master *m, bool (*test)(enum fdp_peer_state));
void fdp_master_say(struct fdp_master *m, const struct fdp_master_event *event);
/* PROBE or SWAP with where we are. */
void fdp_master_announce(struct fdp_master *m, int to, enum fdp_kind kind);
/* To every node of the set, as one send where the wire can. */
void fdp_master_announce_to(struct fdp_master *m, uint64_t nodes, enum fdp_kind kind);
void fdp_master_finish_if_over(struct fdp_master *m, int64_t now_ns);
/* The frame under way waits for these, less who is at half the rate and not done. */
void fdp_master_start_barrier(struct fdp_master *m, uint64_t live, int64_t now_ns);
/* A node that left, or joined anew, is waited for no more. */
void fdp_master_count_out(struct fdp_master *m, unsigned node);
/* Who counts and begins to draw the frame. */
uint64_t fdp_master_draws(const struct fdp_master *m);
/* READY for `frame` of a node that counts; true when it is the one that the barrier waits for. */
bool fdp_master_half_ready(struct fdp_master *m, unsigned node, uint64_t frame);
/* From the beginning of what it drew until now, when it is ready first. */
int64_t fdp_master_ready_after(const struct fdp_master *m, unsigned node);
/* All are ready, or nobody is waited for any longer. May put the deadline off. */
bool fdp_master_frame_over(struct fdp_master *m, int64_t now_ns);
/* The frame is over: who was late, who is slow, who must go. */
void fdp_master_judge(struct fdp_master *m, int64_t now_ns);
/* Writes head and delta since base as the plain bytes of a letter. */
void fdp_master_write_state(struct fdp_master *m, struct fdp_letter *letter, enum fdp_kind kind,
			    uint64_t base);

/* True, with the reason and the plan that would be right, when a node may not take part. */
bool fdp_master_refuses(const struct fdp_master *m, unsigned version, const struct fdp_join *join,
			char reason[FDP_REASON_MAX], uint64_t *out_plan);
/* True when the JOIN is no recording. */
bool fdp_master_on_join(struct fdp_master *m, const struct fdp_header *header,
			const struct fdp_join *join, int64_t now_ns);
void fdp_master_on_leave(struct fdp_master *m, unsigned node, int64_t now_ns);

/* A datagram leaves. */
void fdp_master_count_sent(struct fdp_master *m, int to, const uint8_t *bytes, size_t len);
/* Whether so many bytes more may be on their way to it. What does not hurry leaves a quarter free. */
bool fdp_master_has_room(const struct fdp_master *m, unsigned node, size_t bytes, bool hurries);
/* Those of the nodes to which a message that hurries may go. */
uint64_t fdp_master_with_room(const struct fdp_master *m, uint64_t nodes, size_t bytes);
/* The frame's state, something with this time in it, has been sent to them. */
void fdp_master_mark_frame(struct fdp_master *m, uint64_t nodes);
void fdp_master_mark_time(struct fdp_master *m, int to, int64_t sent_ns);
/* What the node speaks of was taken out of its socket, and what was sent before it. */
void fdp_master_note_taken(struct fdp_master *m, unsigned node, const struct fdp_report *report);
void fdp_master_note_vitals(struct fdp_master *m, unsigned node, const struct fdp_vitals *vitals);

/* Whether so much may be sent to the node now besides the frame; counts it if so. */
bool fdp_master_bulk(struct fdp_master *m, unsigned node, size_t bytes);
bool fdp_master_bulk_to_all(struct fdp_master *m, size_t bytes);
/* GR_OK, GR_ERR_NOMEM. */
int fdp_master_bulk_init(struct fdp_master *m);
void fdp_master_bulk_finish(struct fdp_master *m);
/* All that waits is void. */
void fdp_master_bulk_forget(struct fdp_master *m);
/* The piece of a slice waits to leave for the node, or for the group that it is in. */
bool fdp_master_waits(const struct fdp_master *m, unsigned node, unsigned index, uint64_t frame, unsigned piece);
/* From now on it does so, for the node or FDP_TO_GROUP. */
void fdp_master_want_piece(struct fdp_master *m, int to, unsigned index, uint64_t frame, unsigned piece);
void fdp_master_bulk_tick(struct fdp_master *m, int64_t now_ns);
int64_t fdp_master_bulk_next(const struct fdp_master *m);
/* The node has a part in the present division. */
bool fdp_master_takes_slices(const struct fdp_master *m, unsigned node);
void fdp_master_send_snapshot(struct fdp_master *m, unsigned node, int64_t now_ns);
/* What the node holds is wrong or useless: nothing that it acknowledged is a base. */
void fdp_master_want_snapshot(struct fdp_master *m, unsigned node);
void fdp_master_on_nack(struct fdp_master *m, unsigned node, const struct fdp_nack *nack,
			int64_t now_ns);
void fdp_master_begin_repairs(struct fdp_master *m);
/* A frame begins, its DELTA is not written yet: what was lost of the one before. */
void fdp_master_measure_loss(struct fdp_master *m);
/* How many parity fragments a DELTA of so many fragments is to have. */
unsigned fdp_master_parity(const struct fdp_master *m, unsigned count);
void fdp_master_saw_loss(struct fdp_master *m);
/* How long to wait for an answer of all of these nodes before asking again. */
int64_t fdp_master_wait(const struct fdp_master *m, uint64_t nodes);
/* The end of the frame's DELTA once more, to who has not acknowledged it. */
void fdp_master_send_end_again(struct fdp_master *m, uint64_t nodes);

/* A frame begins with these nodes: is the division another one? */
void fdp_master_share_begin(struct fdp_master *m, uint64_t live);
enum fdp_verdict fdp_master_on_slice(struct fdp_master *m, unsigned node, const uint8_t *body,
				     size_t len, int64_t now_ns);
enum fdp_verdict fdp_master_on_lack(struct fdp_master *m, unsigned node, const uint8_t *body,
				    size_t len);
/* A node says that it has made a slice of that frame. */
void fdp_master_note_slice(struct fdp_master *m, unsigned node, uint64_t frame, int64_t now_ns);
/* Which slices are whole, into a PROBE or SWAP. */
void fdp_master_say_slices(const struct fdp_master *m, enum fdp_kind kind, struct fdp_announce *a);

/* Its clock and ways are another's from now on. */
void fdp_master_clock_forget(struct fdp_peer *peer);
void fdp_master_note_clock(struct fdp_master *m, unsigned node, const struct fdp_report *report,
			   int64_t arrived_ns);
void fdp_master_note_path(struct fdp_peer *peer, uint32_t path_ns);
/* Time stamps, into a PROBE or SWAP to a node or to all. */
void fdp_master_say_time(struct fdp_master *m, int to, struct fdp_announce *a);
/* When these nodes are to swap, if they are told now; 0: at once. */
int64_t fdp_master_swap_time(const struct fdp_master *m, uint64_t live, int64_t now_ns);
/* A frame begins with these nodes: to the group or to each. */
void fdp_master_choose_way(struct fdp_master *m, uint64_t live, int64_t now_ns);
/* So that nodes can say whether they hear a group that is not in use. */
void fdp_master_probe_group(struct fdp_master *m);
void fdp_master_send_beacon(struct fdp_master *m);

/* Nodes and, from node_count on, masters. */
static inline size_t fdp_master_peers(const struct fdp_master *m)
{
	return m->params.node_count + (m->params.masters > 1 ? m->params.masters : 0);
}

static inline bool fdp_master_is_follower(const struct fdp_master *m, unsigned peer)
{
	return peer >= m->params.node_count;
}

/* The frame's delta to all masters that follow. */
void fdp_master_tell_followers(struct fdp_master *m);
/* Word to who would otherwise think that we are gone; when it is due. */
void fdp_master_heartbeat(struct fdp_master *m, int64_t now_ns);
int64_t fdp_master_heartbeat_at(const struct fdp_master *m);
/* The frame's delta to one, signed for it. */
void fdp_master_send_delta(struct fdp_master *m, int to);
/* The hash of m->state as that of m->frame, after previous_hash. */
void fdp_master_remember_hash(struct fdp_master *m);

static inline int fdp_master_all(const struct fdp_master *m)
{
	return m->group ? FDP_TO_GROUP : FDP_TO_ALL;
}

static inline bool fdp_master_twice(const struct fdp_master *m)
{
	return m->loss > 0;
}

#endif
