/*
 * How long an update takes from the master to the last node, beside bare
 * datagrams of the same size in the same run. Private to bench-delivery.
 */
#ifndef GROTTO_TOOLS_BENCH_DELIVERY_H
#define GROTTO_TOOLS_BENCH_DELIVERY_H

#include "tools/bench/cluster.h"

#define DELIVERY_UPDATES_MOST 200000

enum delivery_way { DELIVERY_FDP, DELIVERY_BARE, DELIVERY_WAYS };

/* Shared by all processes of a bench. */
struct delivery_room {
	struct bench_cluster cluster;
	unsigned updates, warm; /* warm: sent before those that count */
	size_t update_bytes;
	unsigned loss_permille; /* of this run, at every ingress */
	/* Of update u, by way; of node n: [n * updates + u]. CLOCK_MONOTONIC, 0: never. */
	int64_t *sent_ns[DELIVERY_WAYS], *arrived_ns[DELIVERY_WAYS];
	uint64_t bytes_out; /* of the protocol, for the updates that count, in this run */
};

/* Bytes of the parameter that makes updates long (ballast/protocol/params.def); 0: there is none. */
size_t delivery_ballast(void);

/* One run, in the process of that end. */
void delivery_master(struct delivery_room *room);
void delivery_node(struct delivery_room *room, unsigned node);

/*
 * In an end's own namespace: so much of what arrives there by UDP is dropped,
 * by nftables' random numbers. False when nft cannot be run.
 */
bool delivery_lose(unsigned permille);

#endif
