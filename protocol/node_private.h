/*
 * Inside the node's half of FDP: node.c has membership, node_call.c which of several
 * masters it is with, node_frame.c the frame, node_clock.c time, node_vitals.c what it
 * tells of itself, node_input.c what is done at its window, node_glance.c what is looked at of its wall,
 * node_share.c the light that the nodes share out.
 */
#ifndef GROTTO_PROTOCOL_NODE_PRIVATE_H
#define GROTTO_PROTOCOL_NODE_PRIVATE_H

#include "protocol/bucket.h"
#include "protocol/message.h"
#include "protocol/node.h"
#include "protocol/outbox.h"
#include "protocol/replay.h"
#include "protocol/session_keys.h"
#include "protocol/share.h"
#include "protocol/state.h"
#include "protocol/trip.h"

#define FDP_JOIN_DEFAULT_NS INT64_C(200000000)
#define FDP_SILENCE_DEFAULT_NS INT64_C(2000000000)
#define FDP_GROUP_FRESH_NS INT64_C(1000000000) /* four of the master's PROBEs */
/*
 * When a division begins all nodes send all of the light to the master. What is longer than
 * this, of all, leaves beside the frames, all nodes together at half a gigabit: READY does not
 * wait for a slice of megabytes, nor do the others' behind it.
 */
#define FDP_SLICES_AT_ONCE 2097152
#define FDP_SLICES_BYTES_S 60000000
#define FDP_SLICES_BURST 131072
#define FDP_SLICES_TICK_NS INT64_C(250000)

/* The frame that the daemon is told of. */
struct fdp_node_frame {
	uint64_t frame; /* of the last FDP_NODE_FRAME; 0: none yet */
	uint64_t show;  /* with the swap of which it is shown: its own, at half the rate the next */
	uint64_t hash;
	bool ready;        /* fdp_node_ready was called for it */
	bool swapped;      /* FDP_NODE_SWAP was said for it */
	uint32_t render_us;
	int64_t asked_ns;  /* READY last sent */
	unsigned asks;     /* repeats of it */
};

struct fdp_node {
	struct fdp_node_params params;
	char name[FDP_NAME_BYTES];
	struct fdp_node_ops ops;
	struct fdp_counters counters;
	struct fdp_gate gate;
	struct fdp_outbox out;
	/* Of the session we are in, zero in none. */
	uint8_t key_to_nodes[FDP_MAX_MASTERS][FDP_KEY_BYTES], key_to_master[FDP_KEY_BYTES];
	uint8_t items[FDP_ITEMS_BYTES]; /* as JOIN says them */

	enum fdp_node_state status;
	uint8_t nonce[FDP_NONCE_BYTES];     /* of the next WELCOME that we take */
	/* Of the session we are in: what its second JOIN says again. */
	uint8_t joined_nonce[FDP_NONCE_BYTES], challenge[FDP_NONCE_BYTES];
	struct fdp_replay window;
	unsigned master;  /* that we are with, by the layout */
	uint64_t highest; /* session that we have been in */
	uint64_t shown;   /* frame that we were told to show, in any session */
	bool guards;      /* see fdp_node_guard */
	int to;           /* where what is sent goes: a master, or FDP_TO_ALL */
	/*
	 * Of each master that a BEACON spoke for: the highest session, 0: none that is of use, when
	 * it did, and when a JOIN was last sent for it. One may be a recording: none hides another's.
	 */
	struct fdp_node_call {
		uint64_t session;
		int64_t heard_ns, hinted_ns;
	} calls[FDP_MAX_MASTERS];
	int64_t proved_ns; /* JOIN last sent to show a master what we have been in */
	int64_t asked_ns; /* JOIN last sent */
	bool asked;
	int64_t heard_ns; /* master, in this session */
	int64_t group_heard_ns; /* by the group; 0: not in this session */
	int64_t retry_ns; /* the master's probe interval */
	int64_t wait_ns;  /* after which the master asks again at present */
	uint32_t lost;    /* as in fdp_report */
	char refused[FDP_REASON_MAX];
	int64_t refused_ns;
	uint64_t joined_sequence; /* the master's, of our first snapshot */

	struct param_state *state, *scratch;
	uint64_t applied, hash, applied_live; /* live: who counted in it */
	uint64_t swap_seen; /* highest frame whose swap was announced */
	bool twice;
	struct fdp_node_frame current;
	uint64_t swapped_frame, swapped_count;
	int64_t swap_ns;
	struct {
		struct fdp_input state;
		bool given, changed; /* since the start; since it was last sent */
		unsigned times;      /* that it is to be said, whatever is held */
		int64_t sent_ns;
	} input;
	struct {
		struct fdp_glance state;
		bool given;
		int64_t sent_ns; /* 0: it has changed since */
	} glance;
	struct fdp_vitals vitals;
	int64_t vitals_ns; /* last told in this session; 0: not yet */

	struct fdp_clock clock;           /* the master's beside ours */
	int64_t arrived_ns;               /* of the next datagram, by the kernel; 0: not told */
	int64_t echo_ns, echo_arrived_ns; /* the newest PROBE or SWAP: its sent_ns, our clock */
	int64_t swap_at_ns;               /* when swap_seen is to be shown, our clock; 0: at once */
	uint32_t path_ns, swaps_late;     /* as in fdp_report */

	/* One each for DELTA and SNAPSHOT. */
	struct fdp_reassembly delta, snapshot;
	int64_t nacked_ns;      /* last asked for fragments, or one came */
	int64_t gap_ns;         /* first asked for those of the present DELTA; 0: not, or one came */
	struct fdp_trip repair; /* from asking for a fragment to having it */
	uint8_t plain[FDP_MESSAGE_MAX];

	struct fdp_share share;
	/* Division of the present frame, as in the state's head; what came may be of a later one. */
	uint64_t shared, shared_since;
	uint64_t slice_frame;  /* of the newest slice that we made in it; 0: none */
	uint64_t slices_frame; /* that the others' were last given for */
	uint64_t lack_budget;  /* bytes of ours that may be sent again in this frame */
	/* Of ours: leaves beside the frames, so far up to this piece; frame 0: nothing does. */
	struct fdp_node_sending {
		uint64_t frame;
		unsigned next;
		int64_t at_ns;
		struct fdp_bucket bucket;
	} sending;
};

void fdp_node_say(struct fdp_node *n, enum fdp_node_event_kind kind, uint64_t frame);
/* Back to asking; `kind` and reason say why. */
void fdp_node_ask_again(struct fdp_node *n, enum fdp_node_event_kind kind, const char *reason);
/* Has joined, and is welcome at least. */
static inline bool fdp_node_in_session(const struct fdp_node *n)
{
	return n->status >= FDP_NODE_WAITING_SNAPSHOT;
}
/* A master's index, or FDP_TO_ALL. */
int fdp_node_whom_to_ask(const struct fdp_node *n);
/* Nothing binds us to the master that we are with, if any: another may take its place. */
bool fdp_node_is_free(const struct fdp_node *n, int64_t now_ns);
/* Belongs to no session: nothing but a handshake is taken, and the keys are gone. */
void fdp_node_forget_session(struct fdp_node *n);
/* session 0 asks; the session of a WELCOME, with its challenge, confirms. challenge may be NULL. */
void fdp_node_send_join(struct fdp_node *n, int to, uint64_t session,
			const uint8_t nonce[FDP_NONCE_BYTES], const uint8_t *challenge);
void fdp_node_prove_highest(struct fdp_node *n, const struct fdp_header *h,
			    const struct fdp_welcome *w, int64_t now_ns);
enum fdp_verdict fdp_node_on_beacon(struct fdp_node *n, const struct fdp_header *h,
				    const uint8_t *body, int64_t now_ns);
/* When a call that was heard may be answered, INT64_MAX: there is none; and answers it then. */
int64_t fdp_node_call_at(const struct fdp_node *n);
/* No call that was heard is of use any more. */
void fdp_node_forget_calls(struct fdp_node *n);
void fdp_node_serve_call(struct fdp_node *n, int64_t now_ns);
/* Our bit in a set of nodes. */
static inline bool fdp_node_in(const struct fdp_node *n, uint64_t set)
{
	return set >> n->params.index & 1;
}

void fdp_node_frame_reset(struct fdp_node *n);
enum fdp_verdict fdp_node_on_state(struct fdp_node *n, const struct fdp_header *h,
				   const uint8_t *payload, int64_t now_ns);
enum fdp_verdict fdp_node_on_announce(struct fdp_node *n, const struct fdp_header *h,
				      const uint8_t *body, int64_t now_ns);
void fdp_node_share_reset(struct fdp_node *n);
/* A frame is applied: its division. */
void fdp_node_share_frame(struct fdp_node *n, const struct fdp_state_head *head);
enum fdp_verdict fdp_node_on_slice(struct fdp_node *n, const uint8_t *body, size_t len,
				   int64_t now_ns);
enum fdp_verdict fdp_node_on_lack(struct fdp_node *n, const uint8_t *body, size_t len);
/* The master says which slices there are. */
void fdp_node_note_slices(struct fdp_node *n, const struct fdp_announce *a, int64_t now_ns);
/* Frame of the newest slice that has left whole; 0: none. */
static inline uint64_t fdp_node_slice_sent(const struct fdp_node *n)
{
	return n->sending.frame ? 0 : n->slice_frame;
}
void fdp_node_share_tick(struct fdp_node *n, int64_t now_ns);
int64_t fdp_node_share_next(const struct fdp_node *n);

void fdp_node_clock_reset(struct fdp_node *n);
/* Time stamps, into a report that leaves now. */
void fdp_node_say_time(const struct fdp_node *n, struct fdp_report *report, int64_t now_ns);
void fdp_node_note_clock(struct fdp_node *n, const struct fdp_announce *a, int64_t arrived_ns);
/* The swap that it announces is news: when it is due. */
void fdp_node_note_swap(struct fdp_node *n, const struct fdp_announce *a, int64_t now_ns);

void fdp_node_glance_tick(struct fdp_node *n, int64_t now_ns);
int64_t fdp_node_glance_next(const struct fdp_node *n);
void fdp_node_input_tick(struct fdp_node *n, int64_t now_ns);
int64_t fdp_node_input_next(const struct fdp_node *n);
void fdp_node_vitals_tick(struct fdp_node *n, int64_t now_ns);
int64_t fdp_node_vitals_next(const struct fdp_node *n);
void fdp_node_frame_tick(struct fdp_node *n, int64_t now_ns);
int64_t fdp_node_frame_next(const struct fdp_node *n);

#endif
