/*
 * How long an update takes from the master to the last node, beside bare
 * datagrams and beside others' ways of the same size in the same run. Private to
 * bench-delivery.
 */
#ifndef GROTTO_TOOLS_BENCH_DELIVERY_H
#define GROTTO_TOOLS_BENCH_DELIVERY_H

#include "daemon/socket.h"
#include "protocol/master.h"
#include "tools/bench/peer.h"

#define DELIVERY_UPDATES_MOST 200000

/* Bare: datagrams that nobody acknowledges; signed: with the protocol's MAC, checked. */
enum delivery_way { DELIVERY_BARE, DELIVERY_SIGNED, DELIVERY_FDP, DELIVERY_PEER };
#define DELIVERY_WAYS (DELIVERY_PEER + PEERS)

/* What is dropped where it arrives. */
struct delivery_loss {
	const char *name;  /* in the table */
	unsigned permille; /* of datagrams at random; or of those that begin a burst */
	unsigned burst_ms; /* nothing more comes from the same sender for so long; 0: no bursts */
	/* By the receivers themselves, datagrams in a row, so many on average: Gilbert's model; 0: no such runs. */
	unsigned run;
};
/* Of one receiver. */
struct delivery_runs {
	uint64_t random;
	bool bad;
};
/* Whether the datagram that has just come is lost to a run. */
bool delivery_lost(const struct delivery_loss *loss, struct delivery_runs *runs);

/* Shared by all processes of a bench. */
struct delivery_room {
	struct bench_cluster cluster;
	unsigned updates, warm; /* warm: sent before those that count */
	size_t update_bytes;
	struct delivery_loss loss;
	enum fdp_parity parity;
	/* Of this run: DELIVERY_FDP, and the two bare ways between its frames; or one of the peers. */
	unsigned way;
	/* Of update u, by way; of node n: [n * updates + u]. CLOCK_MONOTONIC, 0: never. */
	int64_t *sent_ns[DELIVERY_WAYS], *arrived_ns[DELIVERY_WAYS];
	uint64_t bytes_out;      /* of the protocol, for the updates that count, in this run */
	atomic_uint here;        /* nodes that a peer's update has reached, in this run */
	atomic_ulong arrivals;   /* of a peer's updates that count, of all nodes */
};

/* Update u has reached a node whole. */
void delivery_note(struct delivery_room *room, unsigned way, unsigned node, uint64_t update);

/* Bytes of the parameter that makes updates long (ballast/protocol/params.def); 0: there is none. */
size_t delivery_ballast(void);

/* One run of the protocol, in the process of that end. */
void delivery_master(struct delivery_room *room);
void delivery_node(struct delivery_room *room, unsigned node);

/* An update in bare datagrams, signed ones or not. */
void delivery_send_bare(const struct delivery_room *room, struct net *net, enum delivery_way way,
			uint32_t update);
/* What a node has of the update that is coming. */
struct delivery_bare {
	uint32_t update, have;
};
/* A datagram that may be one of these: false, it is not. Notes the update when it is whole. */
bool delivery_take_bare(struct delivery_room *room, unsigned node,
			struct delivery_bare bare[DELIVERY_FDP], const uint8_t *bytes, size_t len);

/* One run of the peer that room->way says, in the process of that end. */
void delivery_peer_sender(struct delivery_room *room);
void delivery_peer_receiver(struct delivery_room *room, unsigned node);

/*
 * In an end's own namespace: so much of what arrives there is dropped, by nftables'
 * random numbers. False when nft cannot be run.
 */
bool delivery_lose(const struct delivery_loss *loss);

#endif
