/*
 * The sockets and the protocol of an end of a cluster, in its process. What a bench
 * has in an end begins with one of these: its address is the ctx of the protocol's
 * events.
 */
#ifndef GROTTO_TOOLS_BENCH_CLUSTER_ENDS_H
#define GROTTO_TOOLS_BENCH_CLUSTER_ENDS_H

#include "daemon/socket.h"
#include "protocol/master.h"
#include "protocol/node.h"
#include "tools/bench/cluster.h"

struct cluster_master {
	struct bench_cluster *cluster;
	struct net *net;
	struct fdp_master *fdp;
	struct param_state *state;
};

struct cluster_node {
	struct bench_cluster *cluster;
	unsigned index;
	struct net *net;
	struct fdp_node *fdp;
};

/*
 * The cluster (and a node's index) are set, all else is zero. Of params the session,
 * the nodes, the datagrams' size, the way and the lead are the cluster's. False: what
 * was opened is to be closed all the same.
 */
bool cluster_master_open(struct cluster_master *master, struct fdp_master_params params,
			 void (*event)(void *ctx, const struct fdp_master_event *event));
void cluster_master_close(struct cluster_master *master);
bool cluster_node_open(struct cluster_node *node,
		       void (*event)(void *ctx, const struct fdp_node_event *event));
void cluster_node_close(struct cluster_node *node);

/* Until something can be read or the time has come; no longer than an end looks whether the run is over. */
void cluster_wait(struct net *net, int64_t until_ns);

#endif
