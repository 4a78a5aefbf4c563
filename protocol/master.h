/*
 * The master's side of FDP: a state machine without sockets and clocks. The
 * caller hands in datagrams and the time, and gets datagrams to send and
 * events to act on. docs/protocol.md gives every byte.
 *
 * One frame:
 *   fdp_master_begin(m, state, frame, now)   delta goes out to all live nodes
 *   fdp_master_receive(...)                  ACK, NACK (repaired), READY
 *   event FDP_MASTER_SWAP                    SWAP(frame) went out: all live nodes were
 *                                            ready, or the deadline passed
 * and then the next. Not thread safe; no allocation after create.
 */
#ifndef GROTTO_PROTOCOL_MASTER_H
#define GROTTO_PROTOCOL_MASTER_H

#include "protocol/clock_offset.h"
#include "protocol/glance.h"
#include "protocol/input.h"
#include "protocol/key.h"
#include "protocol/pace.h"
#include "protocol/params.h"
#include "protocol/vitals.h"

#include "base/item.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FDP_MAX_NODES 64 /* and masters, where a room has more than one */
#define FDP_MAX_MASTERS 8
#define FDP_TO_ALL (-1)   /* each node by itself */
#define FDP_TO_GROUP (-2) /* once, to the group that all are in */
#define FDP_REASON_MAX 224
#define FDP_ITEMS_MAX 166 /* parts of layout and scene together, see fdp_join */
#define FDP_SHARE_MAX (8u << 20) /* bytes of the light that nodes share out, all slices together */

enum fdp_peer_state {
	FDP_PEER_ABSENT,  /* never heard of, or left */
	FDP_PEER_JOINING, /* its snapshot is on the way */
	FDP_PEER_LIVE,    /* counts in the barrier */
	FDP_PEER_LATE,    /* missed the last barrier, still counts */
	FDP_PEER_DEAD,    /* evicted; may join again */
	FDP_PEER_FOLLOWS, /* another master, that has the state and no part in the barrier */
};
const char *fdp_peer_state_name(enum fdp_peer_state state);

enum fdp_master_event_kind {
	FDP_MASTER_JOINED,   /* node: live from the frame after this one */
	FDP_MASTER_LEFT,
	FDP_MASTER_REFUSED,  /* node asked to join and may not: reason */
	FDP_MASTER_LATE,     /* node missed the barrier of `frame` */
	FDP_MASTER_EVICTED,  /* node missed evict_frames in a row, or (pace) is too slow */
	FDP_MASTER_PACE,     /* node is slow, at half the rate, out for slowness, or in step again: pace */
	FDP_MASTER_MISMATCH, /* node's state hash differs: ours, theirs; it gets a snapshot */
	FDP_MASTER_SWAP,     /* SWAP(frame) was sent */
	FDP_MASTER_FOLLOWED, /* master node - node_count follows from now on */
	FDP_MASTER_OUTRANKED, /* node has been in session `theirs`, above ours, and is in none now */
	FDP_MASTER_WAY,      /* what is for all goes `way`; node: the first that does not hear the group */
};

/* How what is for all goes. */
enum fdp_way { FDP_WAY_NONE, FDP_WAY_EACH, FDP_WAY_GROUP };

struct fdp_master_event {
	enum fdp_master_event_kind kind;
	int node; /* -1 when about all */
	uint64_t frame;
	int64_t swap_ns; /* FDP_MASTER_SWAP: when it is to be shown; 0: when told */
	uint64_t ours, theirs;
	const char *reason; /* valid during the call */
	enum fdp_way way;
	enum fdp_pace_state pace;
};

/*
 * What all must have alike, as hashes, and the parts of each in the order of
 * the file: at most FDP_ITEMS_MAX together, borrowed; without them a
 * difference is told and not named.
 */
struct fdp_contents {
	uint8_t layout_hash[32], scene_hash[32];
	const struct gr_item *layout, *scene;
	size_t layout_count, scene_count;
};

/* When a node shows a frame. */
enum fdp_swap {
	FDP_SWAP_AUTO,      /* at a time, when all live nodes know it well; else when told */
	FDP_SWAP_MESSAGE,   /* when told */
	FDP_SWAP_SCHEDULED, /* at a time, but for nodes that do not know it */
};
/* A clock that may be off by more than this is no good for a time to swap at. */
#define FDP_SWAP_ERROR_MOST_NS INT64_C(1000000)

/* Whether a DELTA of several fragments has parity fragments (parity.h, loss.h). */
enum fdp_parity {
	FDP_PARITY_AUTO, /* while datagrams get lost: as many as what is lost asks for */
	FDP_PARITY_OFF,
	FDP_PARITY_ON,   /* also before the first loss */
};

struct fdp_master_params {
	uint64_t session; /* new at every start, not 0; the upper half is the epoch, see fdp_session_after */
	uint8_t key[FDP_KEY_BYTES];
	struct fdp_contents contents;
	const char *const *node_names;
	size_t node_count;
	size_t datagram_max; /* UDP payload bytes: MTU less IP and UDP headers */
	int64_t deadline_ns; /* of the barrier, from fdp_master_begin */
	/*
	 * Who has not acknowledged is asked after this at the latest, sooner once it
	 * is known how long its answers take; 0: deadline/8, 5 ms at most.
	 */
	int64_t probe_ns;
	unsigned evict_frames;
	struct fdp_pace_params pace; /* what becomes of a node that lives and is slow */
	/*
	 * Masters of the layout, 0 or 1: this one alone, and which of them this is. The
	 * others may follow: as peers from node_count on, in the layout's order.
	 */
	unsigned masters, index;
	int64_t heartbeat_ns; /* with more than one: it says at least so often that it lives */
	bool multicast;   /* there is a group: one send on the wire for all */
	bool probe_group; /* but it is used only while every live node hears it */
	enum fdp_parity parity;
	enum fdp_swap swap;
	int64_t swap_lead_most_ns; /* a swap's time is at most so far ahead of its SWAP */
	/* Room for the light that nodes share out, all slices together; 0: none is, slices are bad. At most FDP_SHARE_MAX. */
	size_t share_bytes;
};

struct fdp_report;
struct fdp_master_ops {
	/*
	 * Neither may call back into the master.
	 * One datagram to node `to` (from node_count on: to a master), or for FDP_TO_ALL to each of them, or to the group
	 * (FDP_TO_GROUP, with params.multicast alone). Where the
	 * node's address is not the layout's, the caller has the last source
	 * address it heard a fresh datagram from (fdp_master_receive). What is sent
	 * to node fdp_master_answers() goes to where the datagram came from.
	 */
	void (*send)(void *ctx, int to, const uint8_t *bytes, size_t len);
	void (*event)(void *ctx, const struct fdp_master_event *event);
	/*
	 * An authentic ACK, READY or SWAPPED of a node that is in (protocol/message.h),
	 * repeated ones too, before anything is made of it. May be NULL.
	 */
	void (*report)(void *ctx, unsigned node, unsigned kind, const struct fdp_report *report);
	/* What is done at the window of a node that is in; never older than the last. May be NULL. */
	void (*input)(void *ctx, unsigned node, const struct fdp_input *input);
	/* What the eye looks at of the wall of a node that is in; likewise. May be NULL. */
	void (*glance)(void *ctx, unsigned node, const struct fdp_glance *glance);
	void *ctx;
};

struct fdp_counters {
	uint64_t datagrams_out, bytes_out, datagrams_in, bytes_in;
	uint64_t repairs;      /* fragments sent again */
	/* Parity fragments sent, their datagrams' bytes, and fragments that they gave (on a node). */
	uint64_t parity, parity_bytes, healed;
	uint64_t packed;       /* messages sent in LZO form */
	uint64_t bad_short, bad_version, bad_auth, bad_session, bad_format, bad_replay;
};

/*
 * Slices of the light. On a node `sent` are its own, `received` those of the
 * others that came whole. On the master `received` came whole and were passed
 * on, `sent` times: once for each node that they went to. bytes_sent are those of
 * slices on the wire, repairs left out.
 */
struct fdp_share_counts {
	uint64_t sent, bytes_sent;
	uint64_t received, bytes_received;
	uint64_t late;   /* node: not whole at the start of the frame that should use it; master: whole after SWAP */
	uint64_t lost;   /* known of, but never whole: a newer one, or another division, came first */
	uint64_t asked;  /* LACKs sent */
	uint64_t repairs; /* pieces sent again */
};

/* What the status page shows of a node. */
struct fdp_peer_status {
	enum fdp_peer_state state;
	enum fdp_pace_state pace;
	int64_t pace_since_ns; /* 0: in step from the first */
	int64_t out_until_ns;  /* FDP_PACE_EVICTED: may not join before */
	uint64_t acked;   /* last frame whose state it has applied */
	uint64_t ready;   /* last frame it was ready for */
	uint64_t swapped; /* frames it reported as swapped */
	uint64_t missed;  /* barriers missed since it joined */
	uint64_t mismatches;
	uint64_t lost;      /* fragments of DELTAs of which it says that the first copy was lost */
	double loss;        /* that share of them, of late; 0 while nothing is lost */
	int64_t answer_ns;  /* from a DELTA to its ACK, mean; 0: not known */
	int64_t last_heard_ns;
	int64_t ready_after_ns;    /* last READY, from fdp_master_begin of the frame that it drew */
	int64_t swap_local_ns;     /* node's own CLOCK_MONOTONIC when it swapped `swapped_frame` */
	int64_t swap_ns;           /* the same by the master's clock, as estimated then; 0: not known */
	uint32_t path_ns;          /* the last SWAP's way, until the node had it in hand; 0: not known */
	uint32_t swaps_late;       /* SWAPs that it had in hand after their time */
	uint64_t swapped_frame;
	bool hears_group;          /* as it says, of late */
	uint32_t render_us;        /* GPU and CPU time the node says it took */
	uint64_t slices, slices_late, slice_bytes; /* of the light, from it, whole; after SWAP */
	struct fdp_vitals vitals;                  /* as it told last, within a second; all 0: not yet */
	uint64_t under_way;                        /* bytes sent that it has not taken out of its socket, as the kernel counts */
	uint64_t plan;                             /* of its light, see struct fdp_join */
	uint16_t plan_cost, plan_error;            /* as there */
};

struct fdp_master;
int fdp_master_create(struct fdp_master **out, const struct fdp_master_params *params,
		      const struct fdp_master_ops *ops);
void fdp_master_destroy(struct fdp_master **master);

/*
 * Sends the state of `frame` (greater than the last). State must carry
 * versions up to `frame`. GR_ERR_STATE while the previous frame has not
 * swapped.
 */
int fdp_master_begin(struct fdp_master *master, const struct param_state *state, uint64_t frame,
		     int64_t now_ns);
/*
 * Directly before begin: the next frame's hash is chained to this one (not
 * below the last begun), as where frames of a recording are missing.
 * GR_ERR_STATE, GR_ERR_RANGE.
 */
int fdp_master_chain(struct fdp_master *master, uint64_t previous_frame, uint64_t previous_hash);
/*
 * A datagram that arrived. Returns the node it is authentically from (>= 0),
 * or a negative result; everything bad is counted and dropped.
 *
 * *out_fresh (may be NULL): it is a JOIN that echoes our challenge and came the first
 * time: its source address says where the node is. Of anything else that may be a copy
 * by who listens, of what was lost on its way.
 */
int fdp_master_receive(struct fdp_master *master, const uint8_t *bytes, size_t len, int64_t now_ns,
		       bool *out_fresh);
/*
 * The kernel's receive time of the datagram that the next fdp_master_receive
 * is given, where it has one: waking up is then no part of the way.
 */
void fdp_master_arrived(struct fdp_master *master, int64_t arrived_ns);
/*
 * Another session, above ours, of which `state` is the last that was shown, as
 * `frame` (0: none was). Whoever was in must join anew. state may be NULL with
 * frame 0; it is copied. No allocation.
 */
void fdp_master_renew(struct fdp_master *master, uint64_t session, const struct param_state *state,
		      uint64_t frame);
/* The upper half of a session. */
#define FDP_EPOCH_SHIFT 32
/* A session of the next epoch after that of `highest`; the rest is random. */
uint64_t fdp_session_after(uint64_t highest);
/*
 * From now on until a node comes in, no master may follow: this one only asks
 * whether there are nodes without a master.
 */
void fdp_master_call(struct fdp_master *master);
/* Until then nobody comes in who has been in a session before; fdp_master_renew ends it. */
void fdp_master_listen(struct fdp_master *master, int64_t until_ns);
bool fdp_master_calls(const struct fdp_master *master);
/*
 * The highest frame that a node which came in has shown, whoever was its master: one
 * that begins its next frame above it shows no wall a frame that is not above the last.
 */
uint64_t fdp_master_floor(const struct fdp_master *master);
/* BEACON to every node and master that is not in, at once. */
void fdp_master_beacon(struct fdp_master *master, int64_t now_ns);
uint64_t fdp_master_session(const struct fdp_master *master);
/* In ops.send: the node whose datagram is answered; -1 outside of fdp_master_receive. */
int fdp_master_answers(const struct fdp_master *master);
/* Does what time asks for: probes, deadline, evictions. */
void fdp_master_tick(struct fdp_master *master, int64_t now_ns);
/* When tick wants to be called next; INT64_MAX when nothing is pending. */
int64_t fdp_master_next(const struct fdp_master *master);
/*
 * From the next frame on the barrier waits this long (> 0) instead of
 * params.deadline_ns: for a frame that is known to cost more than others.
 */
void fdp_master_set_deadline(struct fdp_master *master, int64_t deadline_ns);
/* No frame is under way: begin may be called. */
bool fdp_master_idle(const struct fdp_master *master);
size_t fdp_master_live(const struct fdp_master *master);
/* Bit per node: those that count and draw every frame, none of those at half the rate. */
uint64_t fdp_master_every_frame(const struct fdp_master *master);
/* Nodes that wait for their snapshot or are live. */
size_t fdp_master_present(const struct fdp_master *master);
/* Tells all nodes that the master goes. */
void fdp_master_leave(struct fdp_master *master, int64_t now_ns);
uint64_t fdp_master_hash(const struct fdp_master *master);
void fdp_master_peer(const struct fdp_master *master, size_t node, struct fdp_peer_status *out);
/* Where a node's clock stands beside ours. */
void fdp_master_clock(const struct fdp_master *master, size_t node, int64_t now_ns,
		      struct fdp_clock_estimate *out);
void fdp_master_counters(const struct fdp_master *master, struct fdp_counters *out);
enum fdp_way fdp_master_way(const struct fdp_master *master);
/* Fragments and parity fragments of the last DELTA. */
void fdp_master_fragments(const struct fdp_master *master, unsigned *out_count, unsigned *out_parity);
/* Also among how many nodes the light is divided in this frame, 0: it is not. */
unsigned fdp_master_share(const struct fdp_master *master, struct fdp_share_counts *out);

#endif
