/*
 * Each end of a cluster in a network namespace with one veth, eth0, all on a bridge
 * in the caller's, by ip(8). Private to cluster.c.
 */
#ifndef GROTTO_TOOLS_BENCH_CLUSTER_NET_H
#define GROTTO_TOOLS_BENCH_CLUSTER_NET_H

#include <stdbool.h>
#include <sys/types.h>

/*
 * The bridge, in a new namespace: the caller's own is left. False, and a line on
 * stderr, when that is not allowed here; then addresses are to be loopback's.
 */
bool cluster_net_hub(void);
/* In an end's process: a namespace of its own. */
bool cluster_net_leave(void);
/* In the caller, for an end that has left: its way to the bridge. */
bool cluster_net_connect(unsigned end, pid_t pid);
/* In the end: its address. */
bool cluster_net_address(const char *address);

#endif
