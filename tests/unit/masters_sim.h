/*
 * A room with several masters on a fake clock: the real state machines of
 * masters, standbys and nodes, and a network that can be cut between any two.
 */
#ifndef GROTTO_TESTS_MASTERS_SIM_H
#define GROTTO_TESTS_MASTERS_SIM_H

#include "protocol/master_private.h"
#include "protocol/node_private.h"
#include "protocol/standby.h"

#include "unit.h"

#define ROOM_NODES 4
#define ROOM_MASTERS 3
#define ROOM_ENDS (ROOM_NODES + ROOM_MASTERS) /* master k is end ROOM_NODES + k */
#define ROOM_MS INT64_C(1000000)
#define ROOM_PERIOD_NS INT64_C(16666667)
#define ROOM_TAKEOVER 10 /* frames, as the layout's default */
#define ROOM_EPOCH_NS INT64_C(1000000000000)

struct room_packet {
	int64_t at_ns;
	uint64_t order;
	int to, from; /* ends */
	size_t len;
	uint8_t *bytes;
};

struct room_master {
	struct room *room;
	unsigned index;
	struct fdp_master *fdp; /* NULL: dead */
	struct fdp_standby *standby;
	struct param_state *state;
	uint64_t frame;
	int64_t begin_at_ns, begun_ns;
	bool hangs; /* its process is stopped: datagrams wait */
	unsigned taken, yielded, called, returned, renewed;
};

struct room_node {
	struct room *room;
	int index;
	struct fdp_node *fdp; /* NULL: dead */
	uint64_t drawing, wants_swap;
	int64_t drawn_at_ns;
	uint64_t session, highest; /* of the last picture; the highest of any */
	uint64_t frame;            /* of the last picture, in whatever session */
	int64_t shown_ns;
	uint64_t swaps, joined, left, lost;
};

struct room {
	struct unit_random random;
	int64_t now_ns;
	double loss;
	int64_t render_ns;
	bool cut[ROOM_ENDS][ROOM_ENDS]; /* from, to */
	struct room_master masters[ROOM_MASTERS];
	struct room_node nodes[ROOM_NODES];
	struct room_packet *packets;
	size_t packet_count, packet_room;
	uint64_t order;
	/* The first picture of a session above this one: when, by any node; 0: none yet. */
	uint64_t watched_session;
	int64_t first_swap_ns;
};

void room_init(struct room *r, uint64_t seed);
/* follows: as grotto-master --standby. */
void room_start_master(struct room *r, unsigned index, bool follows);
void room_kill_master(struct room *r, unsigned index);
void room_start_node(struct room *r, int index);
void room_kill_node(struct room *r, int index);
void room_run(struct room *r, int64_t ns);
/* Neither hears the other; ends may be masters: ROOM_NODES + k. */
void room_cut(struct room *r, int a, int b, bool cut);
void room_finish(struct room *r);
/* Masters that rule, and which does; -1: none, or more. */
int room_rulers(const struct room *r);
int room_ruler(const struct room *r);
/* Nodes whose session is that master's. */
int room_driven(const struct room *r, unsigned master);
/* A room in operation, master 0 ruling, the others following, and so many frames shown. */
void room_start(struct room *r, uint64_t seed, uint64_t frames);
/* From any peer's mouth into a datagram's. */
void room_inject(struct room *r, int to, const uint8_t *bytes, size_t len);

#endif
