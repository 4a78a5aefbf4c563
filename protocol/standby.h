/*
 * Which of a room's masters rules. One does; the others follow it: an ear, which
 * is a node's half of FDP without a wall, keeps them at its state. One that has
 * heard nothing for silence_ns calls, in a session of the next epoch; nodes
 * answer only when they too have lost their master, and with the first that
 * comes in it rules. Who rules and hears of a session above its own joins that,
 * and rules no more. So
 *
 *   - a standby that is cut off calls in vain: it takes nothing over;
 *   - a node enters no session below one that it has been in, so a master that
 *     comes back drives nobody that another has;
 *   - of two that rule after a partition, the one with the higher session stays;
 *   - one that begins and knows of no room listens for a second: it takes nothing
 *     from a room that goes on, even where chance gave it the higher session.
 *
 *   follows ──silence, or LEAVE──► calls ──a node comes in──► rules
 *      ▲                             │ the old one speaks       │ a higher session
 *      └─────────────────────────────┴──────────────────────────┘
 *
 * A state machine without sockets and clocks, as master.h and node.h. Not thread
 * safe; no allocation after create.
 */
#ifndef GROTTO_PROTOCOL_STANDBY_H
#define GROTTO_PROTOCOL_STANDBY_H

#include "protocol/node.h"

enum fdp_role { FDP_ROLE_FOLLOWS, FDP_ROLE_CALLS, FDP_ROLE_RULES };
const char *fdp_role_name(enum fdp_role role);

struct fdp_standby_params {
	unsigned index, masters; /* this one's place in the layout, of so many; one alone always rules */
	size_t node_count;
	uint8_t key[FDP_KEY_BYTES];
	struct fdp_contents contents;
	size_t datagram_max;
	int64_t silence_ns; /* who rules is taken for dead after this; not 0 with several masters */
	int64_t period_ns;  /* of a frame */
	bool follows;       /* at the start; else it rules */
};

struct fdp_standby_ops { /* neither may call back into the standby */
	void (*send)(void *ctx, int to, const uint8_t *bytes, size_t len); /* to a master, or FDP_TO_ALL of them */
	/* Why the ear may not follow. */
	void (*refused)(void *ctx, const char *reason);
	void *ctx;
};

/* What a tick has changed. */
enum fdp_standby_change {
	FDP_STANDBY_SAME,
	FDP_STANDBY_FOLLOWS, /* has found who rules */
	FDP_STANDBY_CALLS,   /* has lost who rules, and looks for nodes that have too */
	FDP_STANDBY_RETURNS, /* who rules was heard again before any node came */
	FDP_STANDBY_TAKES,   /* rules from now on: a node has come in */
	FDP_STANDBY_YIELDS,  /* rules no more: there is a higher session. LEAVE was sent */
	FDP_STANDBY_RENEWED, /* rules, in a higher session of its own: all join anew */
};

struct fdp_standby;
/* The master is borrowed; it has the same index and number of masters. */
int fdp_standby_create(struct fdp_standby **out, const struct fdp_standby_params *params,
		       const struct fdp_standby_ops *ops, struct fdp_master *master, int64_t now_ns);
void fdp_standby_destroy(struct fdp_standby **standby);

/*
 * Whether a datagram says that it is from a master, of whom there are several:
 * then it is fdp_standby_receive's.
 */
bool fdp_standby_is_its(const struct fdp_standby *standby, const uint8_t *bytes, size_t len);
/* Of the ear; words of a master that it does not follow are nothing bad. All 0 with one master. */
void fdp_standby_counters(const struct fdp_standby *standby, struct fdp_counters *out);
/* As fdp_node_receive. arrived_ns: the kernel's time, or now_ns. */
int fdp_standby_receive(struct fdp_standby *standby, const uint8_t *bytes, size_t len,
			int64_t arrived_ns, int64_t now_ns);
/* A node has been in that session (FDP_MASTER_OUTRANKED): the next tick sees to it. */
void fdp_standby_outranked(struct fdp_standby *standby, uint64_t session);
/* After every receive of this and the master, and when the time has come. */
enum fdp_standby_change fdp_standby_tick(struct fdp_standby *standby, int64_t now_ns);
int64_t fdp_standby_next(const struct fdp_standby *standby);

enum fdp_role fdp_standby_role(const struct fdp_standby *standby);
/*
 * What it follows, or followed until it ruled: the state, its frame (0: none was
 * heard) and when that came. Valid until the next call of receive.
 */
const struct param_state *fdp_standby_state(const struct fdp_standby *standby, uint64_t *out_frame,
					    int64_t *out_frame_ns);
/* Index of the master that it follows; -1: none is found. */
int fdp_standby_follows(const struct fdp_standby *standby);
/*
 * After FDP_STANDBY_TAKES: the first frame's number, above all that the master
 * before can have shown by now.
 */
uint64_t fdp_standby_first_frame(const struct fdp_standby *standby, int64_t now_ns);
/*
 * When the first frame may begin: once all nodes are in that counted before, at
 * the latest a frame after the first came. 0: now.
 */
int64_t fdp_standby_begin_at(const struct fdp_standby *standby);

#endif
