/*
 * A render node's side of FDP: a state machine without sockets and clocks,
 * the counterpart of protocol/master.h.
 *
 *   event FDP_NODE_JOINED          the master took us; a snapshot follows
 *   event FDP_NODE_FRAME           state of `frame` is applied: render it
 *   fdp_node_ready(n, frame, ...)  the GPU has finished
 *   event FDP_NODE_SWAP            show `frame`, at the time that it says
 *   fdp_node_swapped(n, frame, ...)
 *
 * Without a master it asks to join every join_ns, for ever. A frame whose
 * successor arrives first is dropped (FDP_NODE_FRAME comes only for the
 * newest). A master that restarts (new session) is joined anew, and another master
 * where the layout has several: only when its own is silent, and never one whose
 * session is below one that it has been in.
 * Not thread safe; no allocation after create.
 */
#ifndef GROTTO_PROTOCOL_NODE_H
#define GROTTO_PROTOCOL_NODE_H

#include "protocol/glance.h"
#include "protocol/input.h"
#include "protocol/master.h"

enum fdp_node_state { FDP_NODE_ALONE, FDP_NODE_ASKING, FDP_NODE_WAITING_SNAPSHOT, FDP_NODE_LIVE };
const char *fdp_node_state_name(enum fdp_node_state state);

enum fdp_node_event_kind {
	FDP_NODE_JOINED,
	FDP_NODE_FRAME,
	FDP_NODE_SWAP,
	FDP_NODE_REFUSED,  /* reason from the master: other layout, other scene, other version */
	FDP_NODE_LOST,     /* nothing from the master for silence_ns: asking again */
	FDP_NODE_MASTER_LEFT,
	FDP_NODE_MISMATCH, /* our state hash is not the master's: ours, theirs; asked for a snapshot */
};

struct fdp_node_event {
	enum fdp_node_event_kind kind;
	uint64_t frame;
	int64_t at_ns; /* FDP_NODE_SWAP: when to show it, our clock; 0: now */
	uint64_t ours, theirs;
	const char *reason;
	uint64_t plan; /* FDP_NODE_REFUSED: the room's, for which this node's was refused; from outside; 0: not */
};

struct fdp_node_params {
	uint16_t index; /* of this node in the layout; from the number of nodes on: of a master that follows */
	const char *name;
	uint8_t key[FDP_KEY_BYTES];
	struct fdp_contents contents;
	uint64_t plan; /* as struct fdp_join's; nodes of one room must have one */
	uint16_t plan_cost, plan_error; /* as there */
	size_t datagram_max;
	uint32_t receive_bytes; /* of its socket's buffer, SO_RCVBUF; the master keeps what is under way below. 0: not told */
	int64_t join_ns;    /* between two requests to join; 0: 200 ms */
	int64_t silence_ns; /* master counts as lost after this; 0: 2 s */
	unsigned masters;   /* of the layout, 0 or 1: one */
	int64_t call_ns;    /* one that is silent for so long may be replaced by one that calls */
	/*
	 * All nodes' slices of the light together, bytes: at each count of nodes as
	 * many times the longest slice. 0: nothing is shared. At most FDP_SHARE_MAX.
	 */
	size_t share_bytes;
};

struct fdp_node_ops { /* neither may call back into the node */
	/* To a master of the layout, by its index, or FDP_TO_ALL of them. */
	void (*send)(void *ctx, int to, const uint8_t *bytes, size_t len);
	void (*event)(void *ctx, const struct fdp_node_event *event);
	void *ctx;
};

struct fdp_node;
int fdp_node_create(struct fdp_node **out, const struct fdp_node_params *params,
		    const struct fdp_node_ops *ops);
void fdp_node_destroy(struct fdp_node **node);
int fdp_node_receive(struct fdp_node *node, const uint8_t *bytes, size_t len, int64_t now_ns);
/* As fdp_master_arrived. */
void fdp_node_arrived(struct fdp_node *node, int64_t arrived_ns);
void fdp_node_tick(struct fdp_node *node, int64_t now_ns);
int64_t fdp_node_next(const struct fdp_node *node);
/* The state of the frame of the last FDP_NODE_FRAME; valid until the next call of receive. */
const struct param_state *fdp_node_params_state(const struct fdp_node *node);
void fdp_node_ready(struct fdp_node *node, uint64_t frame, uint32_t render_us, int64_t now_ns);
void fdp_node_swapped(struct fdp_node *node, uint64_t frame, int64_t swap_ns, int64_t now_ns);

/*
 * The light that nodes share out. In each frame:
 *   on FDP_NODE_FRAME     fdp_node_division: which slice is ours
 *   before it is drawn    fdp_node_slices: what the others made of the frames before
 *   the GPU has finished  fdp_node_slice, if it changed; then fdp_node_ready
 */
/* False when the light of the present frame is not shared. *out_count 1: ours is all of it. */
bool fdp_node_division(const struct fdp_node *node, unsigned *out_index, unsigned *out_count);
typedef void fdp_node_slice_fn(void *ctx, const uint8_t *bytes, size_t len);
/*
 * Gives the newest whole slice of each other node that was made before `frame`
 * in this division, once, and counts those that are late. fn may not call back into the node.
 */
void fdp_node_slices(struct fdp_node *node, uint64_t frame, fdp_node_slice_fn *fn, void *ctx);
/*
 * Sends our slice of `frame` to all. GR_OK; GR_NOTHING when nobody is to have it
 * (alone, overtaken by a newer frame, a session gone by); GR_ERR_RANGE when it
 * is longer than share_bytes by the number of nodes.
 */
int fdp_node_slice(struct fdp_node *node, uint64_t frame, const uint8_t *bytes, size_t len,
		   int64_t now_ns);
void fdp_node_share(const struct fdp_node *node, struct fdp_share_counts *out);

/*
 * This node's plan, and what follows from it, is another from now on. GR_OK,
 * GR_ERR_STATE while it takes part in a session; GR_ERR_RANGE, GR_ERR_NOMEM:
 * nothing is shared any more.
 */
int fdp_node_replan(struct fdp_node *node, uint64_t plan, uint16_t plan_cost, uint16_t plan_error,
		    size_t share_bytes);
/* Where its time goes, told to the master once a second: the first FDP_VITALS_STAGES of them. */
void fdp_node_stages(struct fdp_node *node, const struct fdp_vitals_stage *stages, unsigned count);

/* What is done at its window, as it is now; told soon if it has changed (protocol/input.h). */
void fdp_node_input(struct fdp_node *node, const struct fdp_input *input);
/* What the eye looks at of its wall; told soon if it has changed (protocol/glance.h). */
void fdp_node_glance(struct fdp_node *node, const struct fdp_glance *glance);

void fdp_node_leave(struct fdp_node *node, int64_t now_ns);
enum fdp_node_state fdp_node_status(const struct fdp_node *node);
/* Where the master's clock stands beside ours. */
void fdp_node_clock(const struct fdp_node *node, int64_t now_ns, struct fdp_clock_estimate *out);
/*
 * For masters that follow. From now on it asks for no master by itself: it only
 * looks whether one rules in a session above `session`, and joins it if so.
 */
void fdp_node_guard(struct fdp_node *node, uint64_t session);
/* When the master that it is with was last heard; 0: it is with none. */
int64_t fdp_node_heard(const struct fdp_node *node);
/* The highest session that it has been in; 0: none. */
uint64_t fdp_node_highest(const struct fdp_node *node);
/* The frame whose state it holds; 0: none. And who counted in it. */
uint64_t fdp_node_applied(const struct fdp_node *node, uint64_t *out_live);
/* Index of the master that it is with. */
unsigned fdp_node_master(const struct fdp_node *node);
/* Of the master that it is with; 0: none. */
uint64_t fdp_node_session(const struct fdp_node *node);
uint64_t fdp_node_hash(const struct fdp_node *node);
void fdp_node_counters(const struct fdp_node *node, struct fdp_counters *out);

#endif
