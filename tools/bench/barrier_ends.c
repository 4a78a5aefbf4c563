/* The two ends of the barrier, as the daemons do it, with nothing to draw. */
#include "tools/bench/barrier.h"

#include "base/clock.h"
#include "daemon/frame_stats.h"
#include "daemon/loop.h"
#include "daemon/swap_wait.h"
#include "tools/bench/cluster_ends.h"

#include <math.h>

#define RECEIVE_MOST 64
/* A picture takes so long: nodes are ready at different times, and asleep before SWAP comes. */
#define DRAW_LEAST_NS (500 * GR_NS_PER_US)
#define DRAW_MOST_NS (2500 * GR_NS_PER_US)

static int64_t now(void)
{
	return gr_clock_now(&gr_clock_monotonic);
}

struct master_end {
	struct cluster_master end; /* first: the protocol's ctx */
	struct barrier_room *room;
	struct loop *loop;
	struct frame_stats stats;
	uint64_t frame;
	int64_t next_ns;
	int frame_timer, tick_timer;
};

static void master_event(void *ctx, const struct fdp_master_event *event)
{
	struct master_end *m = ctx;

	if (event->kind == FDP_MASTER_SWAP) {
		frame_stats_swap_sent(&m->stats, event->frame, event->swap_ns != 0, now());
		m->room->scheduled += event->swap_ns != 0 && event->frame > m->room->warm;
	} else if (event->kind == FDP_MASTER_LATE) {
		m->room->late++;
	}
}

static void master_begin(struct master_end *m)
{
	const uint64_t all = (UINT64_C(1) << m->room->cluster.node_count) - 1, frame = m->frame + 1;
	const float head[3] = { (float)sin((double)frame), 1.7f, 0 };
	const uint64_t time = frame * (uint64_t)m->room->cluster.period_ns;

	if (frame == m->room->warm + 1)
		m->stats = (struct frame_stats){ .begun = 0 };
	param_set(m->end.state, PARAM_FRAME_TIME, &time, frame);
	param_set(m->end.state, PARAM_HEAD_POSITION, head, frame);
	m->frame = frame;
	frame_stats_begin(&m->stats, frame, all, now());
	fdp_master_begin(m->end.fdp, m->end.state, frame, now());
	m->next_ns += m->room->cluster.period_ns;
	if (m->next_ns < now())
		m->next_ns = now();
}

static void master_advance(struct master_end *m)
{
	const unsigned count = m->room->warm + m->room->frames;
	int64_t frame_ns = LOOP_NEVER;

	net_flush(m->end.net);
	if (fdp_master_idle(m->end.fdp) && fdp_master_present(m->end.fdp) == m->room->cluster.node_count) {
		if (m->frame >= count && frame_stats_settled(&m->stats, m->frame))
			loop_stop(m->loop);
		else if (m->frame < count && now() >= m->next_ns)
			master_begin(m);
		else
			frame_ns = m->next_ns;
		net_flush(m->end.net);
	}
	loop_timer_set(m->loop, m->frame_timer, frame_ns);
	loop_timer_set(m->loop, m->tick_timer, fdp_master_next(m->end.fdp));
}

static void master_datagram(void *ctx, const uint8_t *bytes, size_t len,
			    const struct net_address *from, int64_t arrived_ns)
{
	struct master_end *m = ctx;
	struct fdp_peer_status peer;
	int node;

	(void)from;
	fdp_master_arrived(m->end.fdp, arrived_ns);
	node = fdp_master_receive(m->end.fdp, bytes, len, now(), NULL);
	if (node < 0)
		return;
	fdp_master_peer(m->end.fdp, (size_t)node, &peer);
	if (peer.swapped_frame)
		frame_stats_swapped(&m->stats, (unsigned)node, peer.swapped_frame, peer.swap_ns, now());
}

static void master_readable(void *ctx, uint32_t events)
{
	struct master_end *m = ctx;
	int fds[2];

	(void)events;
	net_fds(m->end.net, fds);
	net_receive(m->end.net, fds[0], RECEIVE_MOST, master_datagram, m);
	master_advance(m);
}

static void master_timer(void *ctx, int64_t now_ns)
{
	struct master_end *m = ctx;

	fdp_master_tick(m->end.fdp, now_ns);
	master_advance(m);
}

static bool master_open(struct master_end *m)
{
	const struct fdp_master_params params = {
		.deadline_ns = GR_NS_PER_S, .evict_frames = 3, .swap = m->room->swap,
	};
	int fds[2];

	if (loop_create(&m->loop) < 0 || !cluster_master_open(&m->end, params, master_event))
		return false;
	net_fds(m->end.net, fds);
	m->frame_timer = loop_timer_create(m->loop, master_timer, m);
	m->tick_timer = loop_timer_create(m->loop, master_timer, m);
	return m->tick_timer >= 0 && loop_add(m->loop, fds[0], EPOLLIN, master_readable, m) >= 0;
}

void barrier_master(struct barrier_room *room)
{
	static struct master_end end; /* histograms: too large for a stack, one in the process */
	struct master_end *m = &end;
	struct fdp_clock_estimate clock;

	*m = (struct master_end){ .end.cluster = &room->cluster, .room = room, .next_ns = now() };
	if (!master_open(m)) {
		atomic_store(&room->cluster.failed, true);
	} else {
		master_timer(m, now());
		while (!loop_stopped(m->loop) && !atomic_load(&room->cluster.failed))
			if (loop_once(m->loop, 1000) < 0)
				atomic_store(&room->cluster.failed, true);
		room->seen_p50_us = histogram_percentile(&m->stats.skew, 0.5);
		room->seen_p99_us = histogram_percentile(&m->stats.skew, 0.99);
		for (unsigned i = 0; i < room->cluster.node_count; i++) {
			fdp_master_clock(m->end.fdp, i, now(), &clock);
			room->clock_off_us[i] = (double)clock.offset_ns * 1e-3;
		}
	}
	atomic_store(&room->cluster.over, true);
	cluster_master_close(&m->end);
	loop_destroy(&m->loop);
}

struct node_end {
	struct cluster_node end; /* first: the protocol's ctx */
	struct barrier_room *room;
	struct loop *loop;
	uint64_t drawing, told; /* frames; 0: none */
	int64_t at_ns;
	uint32_t random;
	int tick_timer, draw_timer;
};

static void node_note(const struct node_end *n, int64_t *times, uint64_t frame, int64_t at_ns)
{
	const struct barrier_room *room = n->room;

	if (frame > room->warm && frame <= (uint64_t)room->warm + room->frames)
		times[n->end.index * room->frames + (frame - room->warm - 1)] = at_ns;
}

static void node_event(void *ctx, const struct fdp_node_event *event)
{
	struct node_end *n = ctx;

	if (event->kind == FDP_NODE_FRAME) {
		n->random = n->random * 1664525u + 1013904223u;
		n->drawing = event->frame;
		loop_timer_set(n->loop, n->draw_timer, now() + DRAW_LEAST_NS +
			       (int64_t)(n->random >> 8) % (DRAW_MOST_NS - DRAW_LEAST_NS));
	} else if (event->kind == FDP_NODE_SWAP) {
		n->told = event->frame;
		n->at_ns = event->at_ns;
		/* What is shown when told is shown first of all. */
		if (!event->at_ns)
			n->at_ns = -now();
	}
}

static void node_serve(struct node_end *n)
{
	if (n->told) {
		/* Leaving the barrier is all there is to see. */
		const int64_t swap_ns = n->at_ns > 0 ?
			swap_wait(n->at_ns, n->room->cluster.layout.swap.busy_poll_ns) : -n->at_ns;

		node_note(n, n->room->swap_ns, n->told, swap_ns);
		swap_give_way();
		fdp_node_swapped(n->end.fdp, n->told, swap_ns, now());
		n->told = 0;
	}
	net_flush(n->end.net);
	loop_timer_set(n->loop, n->tick_timer, fdp_node_next(n->end.fdp));
}

static void node_datagram(void *ctx, const uint8_t *bytes, size_t len,
			  const struct net_address *from, int64_t arrived_ns)
{
	struct node_end *n = ctx;

	(void)from;
	fdp_node_arrived(n->end.fdp, arrived_ns);
	fdp_node_receive(n->end.fdp, bytes, len, now());
}

static void node_readable(void *ctx, uint32_t events)
{
	struct node_end *n = ctx;
	int fds[2], count = net_fds(n->end.net, fds);

	(void)events;
	for (int i = 0; i < count; i++)
		net_receive(n->end.net, fds[i], RECEIVE_MOST, node_datagram, n);
	node_serve(n);
}

static void node_tick(void *ctx, int64_t now_ns)
{
	struct node_end *n = ctx;

	fdp_node_tick(n->end.fdp, now_ns);
	node_serve(n);
}

static void node_drawn(void *ctx, int64_t now_ns)
{
	struct node_end *n = ctx;

	node_note(n, n->room->ready_ns, n->drawing, now_ns);
	fdp_node_ready(n->end.fdp, n->drawing, 1000, now());
	node_serve(n);
}

static bool node_open(struct node_end *n)
{
	int fds[2], count;

	if (loop_create(&n->loop) < 0 || !cluster_node_open(&n->end, node_event))
		return false;
	count = net_fds(n->end.net, fds);
	n->tick_timer = loop_timer_create(n->loop, node_tick, n);
	n->draw_timer = loop_timer_create(n->loop, node_drawn, n);
	return n->draw_timer >= 0 && loop_add(n->loop, fds[0], EPOLLIN, node_readable, n) >= 0 &&
	       (count < 2 || loop_add(n->loop, fds[1], EPOLLIN, node_readable, n) >= 0);
}

void barrier_node(struct barrier_room *room, unsigned node)
{
	struct node_end end = {
		.end = { .cluster = &room->cluster, .index = node }, .room = room, .random = node * 7919 + 1,
	};
	struct node_end *n = &end;

	if (!node_open(n)) {
		atomic_store(&room->cluster.failed, true);
	} else {
		node_tick(n, now());
		while (!atomic_load(&room->cluster.over) && !atomic_load(&room->cluster.failed))
			if (loop_once(n->loop, 100) < 0)
				atomic_store(&room->cluster.failed, true);
	}
	cluster_node_close(&n->end);
	loop_destroy(&n->loop);
}
