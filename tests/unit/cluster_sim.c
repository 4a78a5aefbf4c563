#include "cluster_sim.h"

#include "base/result.h"

#include <math.h>

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

static double uniform(struct sim *s)
{
	return unit_random_range(&s->random, 0, 1);
}

int64_t sim_node_time(const struct sim_node *n)
{
	const int64_t now_ns = n->sim->now_ns;

	return now_ns + n->clock_ns + llrint(n->clock_ppm * 1e-6 * (double)(now_ns - SIM_EPOCH_NS));
}

/* The first time at which a node's clock has come so far. */
static int64_t true_time(const struct sim_node *n, int64_t local_ns)
{
	if (local_ns == INT64_MAX || (!n->clock_ns && n->clock_ppm == 0))
		return local_ns;
	local_ns -= n->clock_ns + SIM_EPOCH_NS;
	return SIM_EPOCH_NS + 2 + (int64_t)ceil((double)local_ns / (1 + n->clock_ppm * 1e-6));
}

static bool before(const struct sim_packet *a, const struct sim_packet *b)
{
	return a->at_ns != b->at_ns ? a->at_ns < b->at_ns : a->order < b->order;
}

static void heap_push(struct sim *s, struct sim_packet packet)
{
	size_t i = s->packet_count++;

	if (s->packet_count > s->packet_room) {
		s->packet_room = s->packet_room ? s->packet_room * 2 : 256;
		s->packets = realloc(s->packets, s->packet_room * sizeof *s->packets);
		assert_non_null(s->packets);
	}
	for (; i && before(&packet, &s->packets[(i - 1) / 2]); i = (i - 1) / 2)
		s->packets[i] = s->packets[(i - 1) / 2];
	s->packets[i] = packet;
}

static struct sim_packet heap_pop(struct sim *s)
{
	const struct sim_packet top = s->packets[0], last = s->packets[--s->packet_count];
	size_t i = 0;

	for (;;) {
		size_t child = 2 * i + 1;

		if (child >= s->packet_count)
			break;
		if (child + 1 < s->packet_count && before(&s->packets[child + 1], &s->packets[child]))
			child++;
		if (!before(&s->packets[child], &last))
			break;
		s->packets[i] = s->packets[child];
		i = child;
	}
	s->packets[i] = last;
	return top;
}

void sim_inject(struct sim *s, int to, const uint8_t *bytes, size_t len, int64_t delay_ns)
{
	heap_push(s, (struct sim_packet){ s->now_ns + delay_ns, s->order++, to, len,
					  unit_copy(bytes, len) });
}

/* One receiver's copy of a datagram: lost, late, twice, as the dice fall. */
static void carry(struct sim *s, int to, int about, const uint8_t *bytes, size_t len,
		  int64_t queued_ns)
{
	const int copies = 1 + (s->duplicate > 0 && uniform(s) < s->duplicate);

	if (s->nodes[about].cut)
		return;
	for (int i = 0; i < copies; i++) {
		uint8_t *copy;

		if (s->loss > 0 && uniform(s) < s->loss)
			continue;
		copy = unit_copy(bytes, len);
		if (s->tamper && !s->tamper(s, to, copy, len)) {
			free(copy);
			continue;
		}
		heap_push(s, (struct sim_packet){
			s->now_ns + queued_ns + s->delay_ns + (to < 0 ? 0 : s->slow_ns) +
				(int64_t)((double)s->jitter_ns * uniform(s)),
			s->order++, to, len, copy });
	}
}

/* Datagrams leave the master one after the other, each with its frame's 66 bytes. */
static void queue_on_link(struct sim *s, size_t len)
{
	if (s->link_free_ns < s->now_ns)
		s->link_free_ns = s->now_ns;
	s->link_free_ns += (int64_t)(len + 66) * s->byte_ns;
}

static void master_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct sim *s = ctx;

	assert_true(len <= s->datagram_max);
	assert_true(to != FDP_TO_GROUP || s->multicast);
	s->to_group += to == FDP_TO_GROUP;
	if (to == FDP_TO_GROUP)
		queue_on_link(s, len);
	for (int i = 0; i < (int)s->node_count; i++) {
		if (to != FDP_TO_ALL && to != i && (to != FDP_TO_GROUP || s->nodes[i].deaf))
			continue;
		if (to != FDP_TO_GROUP)
			queue_on_link(s, len);
		carry(s, i, i, bytes, len, s->byte_ns ? s->link_free_ns - s->now_ns : 0);
	}
}

static void master_event(void *ctx, const struct fdp_master_event *e)
{
	struct sim *s = ctx;

	switch (e->kind) {
	case FDP_MASTER_JOINED:
		s->joined++;
		s->join_pending = true;
		break;
	case FDP_MASTER_LEFT: s->left++; break;
	case FDP_MASTER_REFUSED:
		s->refused++;
		snprintf(s->reason, sizeof s->reason, "%s", e->reason);
		break;
	case FDP_MASTER_LATE: s->late++; break;
	case FDP_MASTER_EVICTED: s->evicted++; break;
	case FDP_MASTER_MISMATCH: s->mismatches++; break;
	case FDP_MASTER_WAY:
		s->ways++;
		s->way = e->way;
		s->deaf = e->node;
		break;
	case FDP_MASTER_SWAP:
		assert_int_equal(e->frame, s->frame);
		s->swapped++;
		s->scheduled += e->swap_ns != 0;
		if (e->swap_ns)
			assert_true(e->swap_ns > s->now_ns && e->swap_ns <= s->now_ns + SIM_LEAD_MOST_NS);
		s->begin_at_ns = s->begun_ns + SIM_PERIOD_NS > s->now_ns ? s->begun_ns + SIM_PERIOD_NS
									  : s->now_ns;
		break;
	}
}

static void node_send(void *ctx, const uint8_t *bytes, size_t len)
{
	struct sim_node *n = ctx;

	assert_true(len <= n->sim->datagram_max);
	carry(n->sim, -1, n->index, bytes, len, 0);
}

static void note_shown(struct sim *s, uint64_t frame)
{
	if (frame != s->shown_frame) {
		s->shown_frame = frame;
		s->shown = 0;
		s->shown_first_ns = s->now_ns;
	}
	s->shown_last_ns = s->now_ns;
	if (++s->shown < s->node_count)
		return;
	if (s->spread_count == s->spread_room) {
		s->spread_room = s->spread_room ? s->spread_room * 2 : 1024;
		s->spread_ns = realloc(s->spread_ns, s->spread_room * sizeof *s->spread_ns);
		assert_non_null(s->spread_ns);
	}
	s->spread_ns[s->spread_count++] = s->shown_last_ns - s->shown_first_ns;
}

/* What the daemon does when the time has come. */
static void show(struct sim_node *n)
{
	const uint64_t frame = n->swap;

	n->swap = 0;
	note_shown(n->sim, frame);
	fdp_node_swapped(n->node, frame, sim_node_time(n), sim_node_time(n));
}

static void note_delivery(struct sim *s)
{
	if (s->delivery_count == s->delivery_room) {
		s->delivery_room = s->delivery_room ? s->delivery_room * 2 : 1024;
		s->delivery_ns = realloc(s->delivery_ns, s->delivery_room * sizeof *s->delivery_ns);
		assert_non_null(s->delivery_ns);
	}
	s->delivery_ns[s->delivery_count++] = s->now_ns - s->begun_ns;
}

/* A node may only be told of a frame whose state it holds to the bit. */
static void check_frame(struct sim_node *n, uint64_t frame)
{
	struct sim *s = n->sim;

	assert_int_equal(param_state_hash(fdp_node_params_state(n->node), 0),
			 s->state_hash[frame % SIM_STATES]);
	if (frame == s->frame) {
		assert_int_equal(fdp_node_hash(n->node), fdp_master_hash(s->master));
		note_delivery(s);
	}
}

static void node_event(void *ctx, const struct fdp_node_event *e)
{
	struct sim_node *n = ctx;
	struct sim *s = n->sim;

	switch (e->kind) {
	case FDP_NODE_JOINED:
		n->joined++;
		n->last_frame = n->last_swap = n->drawing = n->swap = n->start = 0;
		break;
	case FDP_NODE_FRAME:
		assert_true(e->frame >= n->last_frame); /* equal: the state was put right */
		check_frame(n, e->frame);
		n->frames += e->frame > n->last_frame;
		n->last_frame = n->drawing = n->start = e->frame;
		n->drawn_at_ns = s->now_ns + (n->render_ns ? n->render_ns
				 : 2 * SIM_MS + (int64_t)(6 * SIM_MS * uniform(s)));
		break;
	case FDP_NODE_SWAP:
		assert_true(e->frame > n->last_swap);
		assert_int_equal(e->frame, n->last_frame);
		assert_int_equal(n->drawing, 0); /* drawn, or it may not be shown */
		/* All live ones are ready for it, or its deadline has passed. */
		if (s->master && n->node->gate.session == s->session)
			assert_true(e->frame <= s->master->swapped);
		assert_int_equal(n->swap, 0);
		n->last_swap = n->swap = e->frame;
		n->swap_at_ns = e->at_ns;
		n->swaps++;
		break;
	case FDP_NODE_REFUSED:
		n->refused++;
		snprintf(n->reason, sizeof n->reason, "%s", e->reason);
		break;
	case FDP_NODE_LOST: n->lost++; break;
	case FDP_NODE_MASTER_LEFT: n->left++; break;
	case FDP_NODE_MISMATCH:
		assert_int_not_equal(e->ours, e->theirs);
		n->mismatches++;
		break;
	}
}

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
	const struct fdp_master_ops ops = { .send = master_send, .event = master_event, .ctx = s };
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
		.multicast = s->multicast,
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
	const struct fdp_node_ops ops = { node_send, node_event, n };
	const struct fdp_node_params p = {
		.index = (uint16_t)node,
		.name = s->names[node],
		.key = { 1, 2, 3 },
		.contents = sim_contents,
		.datagram_max = s->datagram_max,
		.share_bytes = s->share_bytes,
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

static void begin_frame(struct sim *s)
{
	const uint64_t frame = s->frame + 1, time = frame * 16666667;
	const float head[3] = { (float)uniform(s), 1.6f, (float)uniform(s) };
	float lamps[48];

	assert_true(param_set(s->state, PARAM_FRAME_TIME, &time, frame) >= 0);
	if (!s->still)
		assert_true(param_set(s->state, PARAM_HEAD_POSITION, head, frame) >= 0);
	if (s->wand) {
		const float turned[4] = { 0, (float)uniform(s), 0, (float)uniform(s) };

		assert_true(param_set(s->state, PARAM_HEAD_ROTATION, turned, frame) >= 0);
		assert_true(param_set(s->state, PARAM_WAND_POSITION, head, frame) >= 0);
		assert_true(param_set(s->state, PARAM_WAND_ROTATION, turned, frame) >= 0);
	}
	if (s->join_pending) { /* what the daemon does, so that the light starts equal */
		assert_true(param_set(s->state, PARAM_GI_EPOCH, &frame, frame) >= 0);
		s->join_pending = false;
	}
	for (int k = 0; s->lamps && k < 2; k++) {
		for (int i = 0; i < 48; i++)
			lamps[i] = (float)uniform(s);
		assert_true(param_set(s->state, k ? PARAM_LAMP_POSITION : PARAM_LAMP_INTENSITY,
				      lamps, frame) >= 0);
	}
	s->frame = frame;
	s->begun_ns = s->now_ns;
	s->begin_at_ns = INT64_MAX;
	s->state_hash[frame % SIM_STATES] = param_state_hash(s->state, 0);
	assert_int_equal(fdp_master_begin(s->master, s->state, frame, s->now_ns), GR_OK);
}

static bool may_begin(const struct sim *s)
{
	return s->running && fdp_master_idle(s->master) && s->swapped < s->stop_at;
}

static int64_t earliest(const struct sim *s)
{
	int64_t next = s->packet_count ? s->packets[0].at_ns : INT64_MAX, at;

	if (s->master) {
		at = fdp_master_next(s->master);
		next = at < next ? at : next;
		if (may_begin(s) && s->begin_at_ns < next)
			next = s->begin_at_ns;
	}
	for (size_t i = 0; i < s->node_count; i++) {
		const struct sim_node *n = &s->nodes[i];

		if (!n->node || n->asleep)
			continue;
		at = true_time(n, fdp_node_next(n->node));
		next = at < next ? at : next;
		at = n->swap ? true_time(n, n->swap_at_ns) : INT64_MAX;
		next = at < next ? at : next;
		if (n->drawing && n->drawn_at_ns < next)
			next = n->drawn_at_ns;
	}
	return next;
}

/* The node's daemon, after each call into the state machine. */
static void tend_node(struct sim *s, struct sim_node *n)
{
	const uint64_t start = n->start;

	n->start = 0;
	if (n->node && start && s->begin_light)
		s->begin_light(n, start);
	while (n->node && n->swap && (!n->swap_at_ns || sim_node_time(n) >= n->swap_at_ns))
		show(n);
}

static void deliver(struct sim *s, const struct sim_packet *p)
{
	if (p->to < 0) {
		bool fresh = false;

		if (s->master)
			fdp_master_receive(s->master, p->bytes, p->len, s->now_ns, &fresh);
		s->fresh += fresh;
	} else if (s->nodes[p->to].node && !s->nodes[p->to].asleep) {
		fdp_node_receive(s->nodes[p->to].node, p->bytes, p->len, sim_node_time(&s->nodes[p->to]));
		tend_node(s, &s->nodes[p->to]);
	}
	free(p->bytes);
}

static void step_node(struct sim *s, struct sim_node *n)
{
	if (!n->node || n->asleep)
		return;
	if (n->drawing && s->now_ns >= n->drawn_at_ns) {
		const uint64_t frame = n->drawing;

		n->drawing = 0;
		if (s->light_done)
			s->light_done(n, frame);
		fdp_node_ready(n->node, frame, 1000, sim_node_time(n));
		tend_node(s, n);
	}
	tend_node(s, n);
	if (sim_node_time(n) >= fdp_node_next(n->node)) {
		fdp_node_tick(n->node, sim_node_time(n));
		tend_node(s, n);
		/* Or an event loop would spin. */
		assert_true(fdp_node_next(n->node) > sim_node_time(n));
	}
}

static void step(struct sim *s)
{
	while (s->packet_count && s->packets[0].at_ns <= s->now_ns) {
		const struct sim_packet p = heap_pop(s);

		deliver(s, &p);
	}
	for (size_t i = 0; i < s->node_count; i++)
		step_node(s, &s->nodes[i]);
	if (!s->master)
		return;
	if (s->now_ns >= fdp_master_next(s->master)) {
		fdp_master_tick(s->master, s->now_ns);
		assert_true(fdp_master_next(s->master) > s->now_ns);
	}
	if (may_begin(s) && s->now_ns >= s->begin_at_ns)
		begin_frame(s);
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

	while (s->now_ns < until)
		advance(s, until);
}

void sim_run_frames(struct sim *s, uint64_t frames)
{
	const uint64_t until = s->swapped + frames;
	const int64_t give_up = s->now_ns + (int64_t)(frames + 100) * 4 * SIM_DEADLINE_NS;

	s->running = true;
	s->stop_at = until;
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

struct fdp_peer_status sim_peer(const struct sim *s, int node)
{
	struct fdp_peer_status status;

	fdp_master_peer(s->master, (size_t)node, &status);
	return status;
}

static int compare_ns(const void *a, const void *b)
{
	const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;

	return (x > y) - (x < y);
}

int64_t sim_delivery_quantile(struct sim *s, double q)
{
	if (!s->delivery_count)
		return 0;
	qsort(s->delivery_ns, s->delivery_count, sizeof *s->delivery_ns, compare_ns);
	return s->delivery_ns[(size_t)(q * (double)(s->delivery_count - 1))];
}

int64_t sim_spread_quantile(struct sim *s, double q)
{
	if (!s->spread_count)
		return 0;
	qsort(s->spread_ns, s->spread_count, sizeof *s->spread_ns, compare_ns);
	return s->spread_ns[(size_t)(q * (double)(s->spread_count - 1))];
}

void sim_finish(struct sim *s)
{
	for (size_t i = 0; i < s->node_count; i++)
		fdp_node_destroy(&s->nodes[i].node);
	fdp_master_destroy(&s->master);
	while (s->packet_count)
		free(heap_pop(s).bytes);
	free(s->packets);
	free(s->delivery_ns);
	free(s->spread_ns);
	param_state_destroy(&s->state);
}

uint64_t sim_seed_of(const char *name)
{
	struct unit_random r = unit_random_start(name);

	return unit_random_u32(&r);
}

void sim_assert_in_step(struct sim *s)
{
	for (size_t i = 0; i < s->node_count; i++) {
		assert_non_null(s->nodes[i].node);
		assert_int_equal(sim_peer(s, (int)i).state, FDP_PEER_LIVE);
		assert_int_equal(fdp_node_hash(s->nodes[i].node), fdp_master_hash(s->master));
		assert_int_equal(s->nodes[i].mismatches, 0);
	}
	assert_int_equal(s->mismatches, 0);
}

void sim_assert_all_swapped(struct sim *s, uint64_t frames)
{
	for (size_t i = 0; i < s->node_count; i++) {
		assert_int_equal(s->nodes[i].frames, frames);
		assert_int_equal(s->nodes[i].swaps, frames);
		assert_int_equal(sim_peer(s, (int)i).swapped, frames);
	}
	sim_assert_in_step(s);
}

void sim_start_running(struct sim *s, size_t nodes)
{
	sim_init(s, nodes, 11);
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 20);
	sim_assert_all_swapped(s, 20);
}
