/* What the daemons of a simulated cluster do around the state machines, and must see of them. */
#include "cluster_sim_private.h"

#include "base/result.h"

#include <math.h>

int64_t sim_node_time(const struct sim_node *n)
{
	const int64_t now_ns = n->sim->now_ns;

	return now_ns + n->clock_ns + llrint(n->clock_ppm * 1e-6 * (double)(now_ns - SIM_EPOCH_NS));
}

/* The first time at which a node's clock has come so far. */
int64_t sim_true_time(const struct sim_node *n, int64_t local_ns)
{
	if (local_ns == INT64_MAX || (!n->clock_ns && n->clock_ppm == 0))
		return local_ns;
	local_ns -= n->clock_ns + SIM_EPOCH_NS;
	return SIM_EPOCH_NS + 2 + (int64_t)ceil((double)local_ns / (1 + n->clock_ppm * 1e-6));
}

void sim_master_event(void *ctx, const struct fdp_master_event *e)
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
	case FDP_MASTER_PACE: s->paced[e->pace]++; break;
	case FDP_MASTER_MISMATCH: s->mismatches++; break;
	case FDP_MASTER_FOLLOWED: break;
	case FDP_MASTER_OUTRANKED: s->outranked = e->theirs; break;
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

static void note_shown(struct sim *s, uint64_t frame)
{
	if (frame != s->shown_frame) {
		s->shown_frame = frame;
		s->shown = 0;
		s->shown_first_ns = s->now_ns;
	}
	s->shown_last_ns = s->now_ns;
	if (++s->shown < s->node_count || s->untimed)
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
	if (s->untimed)
		return;
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

	/* cmocka's own comparison is byte by byte. */
	assert_int_equal(memcmp(fdp_node_params_state(n->node), &s->states[frame % SIM_STATES],
				sizeof(struct param_state)), 0);
	if (frame == s->frame) {
		assert_int_equal(fdp_node_hash(n->node), fdp_master_hash(s->master));
		note_delivery(s);
	}
}

void sim_node_event(void *ctx, const struct fdp_node_event *e)
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
				 : 2 * SIM_MS + (int64_t)(6 * SIM_MS * sim_uniform(s)));
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
		n->offered = e->plan;
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

void sim_begin_frame(struct sim *s)
{
	const uint64_t frame = s->frame + 1, time = frame * 16666667;
	const float head[3] = { (float)sim_uniform(s), 1.6f, (float)sim_uniform(s) };
	float lamps[48];

	assert_true(param_set(s->state, PARAM_FRAME_TIME, &time, frame) >= 0);
	if (!s->still)
		assert_true(param_set(s->state, PARAM_HEAD_POSITION, head, frame) >= 0);
	if (s->wand) {
		const float turned[4] = { 0, (float)sim_uniform(s), 0, (float)sim_uniform(s) };

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
			lamps[i] = (float)sim_uniform(s);
		assert_true(param_set(s->state, k ? PARAM_LAMP_POSITION : PARAM_LAMP_INTENSITY,
				      lamps, frame) >= 0);
	}
	if (s->more_state)
		s->more_state(s, frame);
	s->frame = frame;
	s->begun_ns = s->now_ns;
	s->begin_at_ns = INT64_MAX;
	param_state_copy(&s->states[frame % SIM_STATES], s->state);
	assert_int_equal(fdp_master_begin(s->master, s->state, frame, s->now_ns), GR_OK);
}

int64_t sim_node_wake(const struct sim_node *n)
{
	int64_t next, at;

	if (!n->node || n->asleep)
		return INT64_MAX;
	next = sim_true_time(n, fdp_node_next(n->node));
	at = n->swap ? sim_true_time(n, n->swap_at_ns) : INT64_MAX;
	next = at < next ? at : next;
	return n->drawing && n->drawn_at_ns < next ? n->drawn_at_ns : next;
}

/* The node's daemon, after each call into the state machine. */
void sim_tend_node(struct sim *s, struct sim_node *n)
{
	const uint64_t start = n->start;

	n->start = 0;
	if (n->node && start && s->begin_light)
		s->begin_light(n, start);
	while (n->node && n->swap && (!n->swap_at_ns || sim_node_time(n) >= n->swap_at_ns))
		show(n);
}

void sim_step_node(struct sim *s, struct sim_node *n)
{
	if (!n->node || n->asleep)
		return;
	if (n->drawing && s->now_ns >= n->drawn_at_ns) {
		const uint64_t frame = n->drawing;

		n->drawing = 0;
		if (s->light_done)
			s->light_done(n, frame);
		fdp_node_ready(n->node, frame, 1000, sim_node_time(n));
		sim_tend_node(s, n);
	}
	sim_tend_node(s, n);
	if (sim_node_time(n) >= fdp_node_next(n->node)) {
		fdp_node_tick(n->node, sim_node_time(n));
		sim_tend_node(s, n);
		/* Or an event loop would spin. */
		assert_true(fdp_node_next(n->node) > sim_node_time(n));
	}
}
