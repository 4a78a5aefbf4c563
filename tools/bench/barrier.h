/*
 * The barrier by itself: a master and nodes that draw nothing, in processes
 * and, where that is allowed, network namespaces of their own; the protocol,
 * sockets, event loop and waiting are the daemons'. Private to bench-barrier.
 */
#ifndef GROTTO_TOOLS_BENCH_BARRIER_H
#define GROTTO_TOOLS_BENCH_BARRIER_H

#include "config/layout.h"
#include "protocol/master.h"

#include <pthread.h>
#include <stdatomic.h>
#include <sys/types.h>

#define BARRIER_NODES_MOST 16
#define BARRIER_FRAMES_MOST 100000

/* Shared by all processes of a bench. */
struct barrier_room {
	pthread_barrier_t step; /* all ends and the parent */
	struct layout layout;
	struct layout_node nodes[BARRIER_NODES_MOST];
	char group[16], interface[8];
	char addresses[BARRIER_NODES_MOST + 1][16]; /* the last is the master's */
	unsigned node_count, frames, warm; /* warm: begun before those that count */
	int64_t period_ns;
	enum fdp_swap swap; /* of this run */
	uint64_t session;   /* of this run */
	atomic_int failed;
	atomic_bool over;   /* this run */
	/* Of node n in frame f: [n * frames + f], the one CLOCK_MONOTONIC of this machine. */
	int64_t *swap_ns, *ready_ns;
	/* By the master's estimates: from the first swap to the last, us. */
	double seen_p50_us, seen_p99_us;
	uint64_t scheduled, late;
	double clock_off_us[BARRIER_NODES_MOST]; /* the master's estimate less the truth, 0 */
};

/* One run, in the process of that end. */
void barrier_master(struct barrier_room *room);
void barrier_node(struct barrier_room *room, unsigned node);

/*
 * Each end in a network namespace with one veth, all on a bridge in the
 * caller's, which is a new one: its own is left. False, and a line on stderr,
 * when that is not allowed here; then the addresses are to be loopback's.
 */
bool barrier_net_hub(void);
/* In an end's process: a namespace of its own. */
bool barrier_net_leave(void);
/* In the caller, for an end that has left: its way to the bridge. */
bool barrier_net_connect(unsigned end, pid_t pid);
/* In the end: its address. */
bool barrier_net_address(const char *address);

#endif
