/*
 * What else could bring an update from one machine to all others: each peer in a
 * file of its own, behind this interface. Built where configure found its library.
 * Private to bench-delivery.
 */
#ifndef GROTTO_TOOLS_BENCH_PEER_H
#define GROTTO_TOOLS_BENCH_PEER_H

#include "tools/bench/cluster.h"

#define PEER_WAITS_MOST_NS INT64_C(20000000) /* serve returns after this at the latest */

/* Where an end of a peer stands. */
struct peer_place {
	const struct bench_cluster *cluster;
	bool sender;
	unsigned node; /* which of the receivers; the sender: how many there are */
	uint16_t port; /* the sender's; those above it are free, too */
	size_t update_bytes;
};

/* An update came whole; the bytes are valid during the call. */
typedef void peer_take_fn(void *ctx, const uint8_t *bytes, size_t len);

/* Each end in one thread of its process. */
struct peer {
	const char *name; /* with the settings that matter */
	/* NULL: configure found no library of it. Gives NULL, and a line on stderr, when it cannot be. */
	void *(*open)(const struct peer_place *place);
	void (*close)(void *end);
	/* Sender: to all who are there. False: it has no room for it now. */
	bool (*send)(void *end, const uint8_t *bytes, size_t len);
	/*
	 * Does what is due until then (CLOCK_MONOTONIC), or PEER_WAITS_MOST_NS if that is
	 * less; returns when something came. A receiver's take gets each update.
	 */
	void (*serve)(void *end, int64_t until_ns, peer_take_fn *take, void *ctx);
};

#define PEERS 5
extern const struct peer peer_tcp, peer_enet, peer_norm, peer_norm_parity, peer_pgm;
/* All, built or not, in the order of the table. */
extern const struct peer *const peers[PEERS];

/* Waits for POLLIN of any of them until then, or PEER_WAITS_MOST_NS. */
void peer_wait(const int *fds, unsigned count, int64_t until_ns);

#endif
