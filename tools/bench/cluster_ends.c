#include <config.h> /* ppoll */

#include "tools/bench/cluster_ends.h"

#include "base/clock.h"
#include "base/result.h"

#include <poll.h>

#define LOOK_NS (20 * GR_NS_PER_MS)

static void master_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct cluster_master *m = ctx;

	net_send(m->net, to, bytes, len);
}

bool cluster_master_open(struct cluster_master *master, struct fdp_master_params params,
			 void (*event)(void *ctx, const struct fdp_master_event *event))
{
	const struct bench_cluster *c = master->cluster;
	const struct fdp_master_ops ops = { .send = master_send, .event = event, .ctx = master };
	const char *names[CLUSTER_NODES_MOST];

	for (unsigned i = 0; i < c->node_count; i++)
		names[i] = c->nodes[i].name;
	params.session = c->session;
	params.node_names = names;
	params.node_count = c->node_count;
	params.datagram_max = net_datagram_max(&c->layout.network);
	params.multicast = c->layout.network.cast == LAYOUT_MULTICAST;
	params.share_bytes = c->share_bytes;
	params.swap_lead_most_ns = c->period_ns / 4;
	return net_open_master(&master->net, &c->layout, 0) == GR_OK &&
	       fdp_master_create(&master->fdp, &params, &ops) == GR_OK &&
	       param_state_create(&master->state) == GR_OK;
}

void cluster_master_close(struct cluster_master *master)
{
	fdp_master_destroy(&master->fdp);
	param_state_destroy(&master->state);
	net_close(&master->net);
}

static void node_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct cluster_node *n = ctx;

	(void)to;
	net_send(n->net, 0, bytes, len);
}

bool cluster_node_open(struct cluster_node *node,
		       void (*event)(void *ctx, const struct fdp_node_event *event))
{
	const struct bench_cluster *c = node->cluster;
	const struct fdp_node_ops ops = { node_send, event, node };
	struct fdp_node_params params = {
		.index = (uint16_t)node->index, .name = c->nodes[node->index].name,
		.datagram_max = net_datagram_max(&c->layout.network),
		.share_bytes = c->share_bytes,
	};

	if (net_open_node(&node->net, &c->layout, node->index) != GR_OK)
		return false;
	params.receive_bytes = net_receive_bytes(node->net);
	return fdp_node_create(&node->fdp, &params, &ops) == GR_OK;
}

void cluster_node_close(struct cluster_node *node)
{
	fdp_node_destroy(&node->fdp);
	net_close(&node->net);
}

void cluster_wait(struct net *net, int64_t until_ns)
{
	struct pollfd fds[2];
	int raw[2];
	const int count = net_fds(net, raw);
	int64_t left_ns = until_ns - gr_clock_now(&gr_clock_monotonic);
	struct timespec ts;

	left_ns = left_ns < 0 ? 0 : left_ns > LOOK_NS ? LOOK_NS : left_ns;
	ts = (struct timespec){ .tv_nsec = (long)left_ns };
	for (int i = 0; i < count; i++)
		fds[i] = (struct pollfd){ .fd = raw[i], .events = POLLIN };
	ppoll(fds, (nfds_t)count, &ts, NULL);
}
