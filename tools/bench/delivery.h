/*
 * How long an update takes from the master to the last node, beside bare
 * datagrams of the same size in the same run: protocol, sockets and processes
 * are the daemons' own. The state is made longer by a parameter of this program
 * alone (PARAM_BALLAST, in 4-byte words): today's is at most some 1100 bytes.
 * Private to bench-delivery.
 */
#ifndef GROTTO_TOOLS_BENCH_DELIVERY_H
#define GROTTO_TOOLS_BENCH_DELIVERY_H

#include "config/layout.h"
#include "protocol/params.h"

#include <pthread.h>
#include <stdatomic.h>

#define DELIVERY_NODES_MOST 16
#define DELIVERY_UPDATES_MOST 200000

enum delivery_way { DELIVERY_FDP, DELIVERY_BARE, DELIVERY_WAYS };

/* Shared by all processes of a bench. */
struct delivery_room {
	pthread_barrier_t step; /* all ends and the parent */
	struct layout layout;
	struct layout_node nodes[DELIVERY_NODES_MOST];
	char group[16], interface[8];
	char addresses[DELIVERY_NODES_MOST + 1][16]; /* the last is the master's */
	unsigned node_count, updates, warm; /* warm: sent before those that count */
	int64_t period_ns;
	unsigned loss_permille; /* of this run, at every ingress */
	uint64_t session;       /* of this run */
	atomic_int failed;
	atomic_bool over; /* this run */
	/* Of update u, by way; of node n: [n * updates + u]. CLOCK_MONOTONIC, 0: never. */
	int64_t *sent_ns[DELIVERY_WAYS], *arrived_ns[DELIVERY_WAYS];
	/* Of this run, from the master's counters. */
	uint64_t bytes_out, bare_bytes, repairs, update_bytes;
};

/* One run, in the process of that end. */
void delivery_master(struct delivery_room *room);
void delivery_node(struct delivery_room *room, unsigned node);

/*
 * In an end's own namespace: so much of what arrives there by UDP is dropped,
 * by nftables' random numbers. False when nft cannot be run.
 */
bool delivery_lose(unsigned permille);

#endif
