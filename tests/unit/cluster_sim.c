/* The simulated cluster: its start and end, and the clock that all runs by. */
#include "cluster_sim_private.h"

#include "base/result.h"

static const struct gr_item layout_items[] = {
	{ "number of walls", { 4 } },
	{ "walls[0] (front)", { 1, 2, 3, 4, 5, 6, 7, 8 } },
	{ "rates.frame_hz", { 60 } },
};
static const struct gr_item scene_items[] = {
	{ "lamps", { 9, 9 } },
	{ "model", { 8, 8 } },
};
static const struct fdp_contents sim_contents = {
	.layout_hash = { 4 }, .scene_hash = { 5 },
	.layout = layout_items, .layout_count = 3, .scene = scene_items, .scene_count = 2,
};

void sim_init(struct sim *s, size_t nodes, uint64_t seed)
{
	memset(s, 0, sizeof *s);
	s->random.state = seed * 2 + 1;
	unit_random_u32(&s->random);
	s->now_ns = SIM_EPOCH_NS;
	s->delay_ns = 50000;
	s->jitter_ns = 20000;
	s->datagram_max = 1472;
	s->multicast = true;
	s->evict_frames = 3;
	s->node_count = nodes;
	s->session = seed * 1000 + 1;
	for (size_t i = 0; i < nodes; i++)
		snprintf(s->names[i], sizeof s->names[i], "wall%zu", i);
}

void sim_start_master(struct sim *s)
{
	const struct fdp_master_ops ops = { .send = sim_master_send, .event = sim_master_event, .ctx = s };
	const char *names[FDP_MAX_NODES];
	struct fdp_master_params p = {
		.session = ++s->session,
		.key = { 1, 2, 3 },
		.contents = sim_contents,
		.node_names = names,
		.node_count = s->node_count,
		.datagram_max = s->datagram_max,
		.deadline_ns = SIM_DEADLINE_NS,
		.evict_frames = s->evict_frames,
		.pace = s->pace,
		.multicast = s->multicast,
		.parity = s->parity,
		.swap = s->swap,
		.swap_lead_most_ns = SIM_LEAD_MOST_NS,
		.probe_group = s->probe_group,
		.share_bytes = s->share_bytes,
	};

	for (size_t i = 0; i < s->node_count; i++)
		names[i] = s->names[i];
	assert_int_equal(fdp_master_create(&s->master, &p, &ops), GR_OK);
	param_state_destroy(&s->state);
	assert_int_equal(param_state_create(&s->state), GR_OK);
	s->frame = 0;
	s->begin_at_ns = s->now_ns;
	s->stop_at = UINT64_MAX;
}

void sim_kill_master(struct sim *s)
{
	fdp_master_destroy(&s->master);
}

void sim_start_node(struct sim *s, int node)
{
	struct sim_node *n = &s->nodes[node];
	const struct fdp_node_ops ops = { sim_node_send, sim_node_event, n };
	const struct fdp_node_params p = {
		.index = (uint16_t)node,
		.name = s->names[node],
		.key = { 1, 2, 3 },
		.contents = sim_contents,
		.datagram_max = s->datagram_max,
		.share_bytes = s->share_bytes,
		.receive_bytes = s->receive_bytes,
	};

	n->sim = s;
	n->index = node;
	n->drawing = n->swap = n->start = 0;
	assert_int_equal(fdp_node_create(&n->node, &p, &ops), GR_OK);
}

void sim_kill_node(struct sim *s, int node)
{
	fdp_node_destroy(&s->nodes[node].node);
	s->nodes[node].drawing = s->nodes[node].start = 0;
}

void sim_start_all(struct sim *s)
{
	sim_start_master(s);
	for (size_t i = 0; i < s->node_count; i++)
		sim_start_node(s, (int)i);
}

static bool may_begin(const struct sim *s)
{
	return s->running && fdp_master_idle(s->master) && s->swapped < s->stop_at;
}

/*
 * When each is next due is kept, since a frame has hundreds of events and each
 * concerns one node; whoever calls sim_run_* may have changed anything before.
 */
static void refresh(struct sim *s)
{
	s->master_wake_ns = s->master ? fdp_master_next(s->master) : INT64_MAX;
	for (size_t i = 0; i < s->node_count; i++)
		s->nodes[i].wake_ns = sim_node_wake(&s->nodes[i]);
}

static int64_t earliest(const struct sim *s)
{
	int64_t next = s->packet_count ? s->packets[0].at_ns : INT64_MAX;

	next = s->master_wake_ns < next ? s->master_wake_ns : next;
	if (s->master && may_begin(s) && s->begin_at_ns < next)
		next = s->begin_at_ns;
	for (size_t i = 0; i < s->node_count; i++)
		next = s->nodes[i].wake_ns < next ? s->nodes[i].wake_ns : next;
	return next;
}

static void deliver(struct sim *s, const struct sim_packet *p)
{
	if (p->to < 0) {
		bool fresh = false;

		if (s->master) {
			fdp_master_receive(s->master, p->bytes, p->len, s->now_ns, &fresh);
			s->master_wake_ns = fdp_master_next(s->master);
		}
		s->fresh += fresh;
	} else if (s->nodes[p->to].node && !s->nodes[p->to].asleep) {
		struct sim_node *n = &s->nodes[p->to];

		fdp_node_receive(n->node, p->bytes, p->len, sim_node_time(n));
		sim_tend_node(s, n);
		n->wake_ns = sim_node_wake(n);
	}
	free(p->bytes);
}

static void step(struct sim *s)
{
	while (s->packet_count && s->packets[0].at_ns <= s->now_ns) {
		const struct sim_packet p = sim_packet_pop(s);

		deliver(s, &p);
	}
	for (size_t i = 0; i < s->node_count; i++) {
		if (s->nodes[i].wake_ns > s->now_ns)
			continue;
		sim_step_node(s, &s->nodes[i]);
		s->nodes[i].wake_ns = sim_node_wake(&s->nodes[i]);
	}
	if (!s->master)
		return;
	if (s->outranked) { /* a session above is the daemon's to choose */
		s->session = s->outranked + 1;
		s->outranked = 0;
		fdp_master_renew(s->master, s->session, s->state, s->frame);
	}
	if (s->now_ns >= s->master_wake_ns) {
		fdp_master_tick(s->master, s->now_ns);
		assert_true(fdp_master_next(s->master) > s->now_ns);
	}
	if (may_begin(s) && s->now_ns >= s->begin_at_ns)
		sim_begin_frame(s);
	s->master_wake_ns = fdp_master_next(s->master);
}

static void advance(struct sim *s, int64_t until_ns)
{
	const int64_t next = earliest(s);

	if (next > s->now_ns)
		s->now_ns = next < until_ns ? next : until_ns;
	step(s);
}

void sim_run_ns(struct sim *s, int64_t ns)
{
	const int64_t until = s->now_ns + ns;

	refresh(s);
	while (s->now_ns < until)
		advance(s, until);
}

void sim_run_frames(struct sim *s, uint64_t frames)
{
	const uint64_t until = s->swapped + frames;
	const int64_t give_up = s->now_ns + (int64_t)(frames + 100) * 4 * SIM_DEADLINE_NS;

	s->running = true;
	s->stop_at = until;
	refresh(s);
	while (s->swapped < until) {
		advance(s, give_up);
		assert_true(s->now_ns < give_up); /* the room never stops */
	}
	s->running = false;
	s->stop_at = UINT64_MAX;
	sim_run_ns(s, 2 * SIM_MS); /* let the last SWAP arrive */
}

void sim_assemble(struct sim *s)
{
	const int64_t give_up = s->now_ns + 5000 * SIM_MS;

	refresh(s);
	for (;;) {
		size_t in = 0;

		for (size_t i = 0; i < s->node_count; i++)
			in += s->nodes[i].node && fdp_node_status(s->nodes[i].node) == FDP_NODE_LIVE &&
			      (s->master && (s->master->peers[i].synced ||
					     fdp_peer_counts(s->master->peers[i].state)));
		if (in == s->node_count)
			return;
		advance(s, give_up);
		assert_true(s->now_ns < give_up);
	}
}

void sim_finish(struct sim *s)
{
	for (size_t i = 0; i < s->node_count; i++)
		fdp_node_destroy(&s->nodes[i].node);
	fdp_master_destroy(&s->master);
	while (s->packet_count)
		free(sim_packet_pop(s).bytes);
	free(s->packets);
	free(s->delivery_ns);
	free(s->spread_ns);
	param_state_destroy(&s->state);
}

void sim_start_running(struct sim *s, size_t nodes)
{
	sim_init(s, nodes, 11);
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 20);
	sim_assert_all_swapped(s, 20);
}
