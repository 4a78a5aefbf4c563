/*
 * Nodes that do not keep up: who is waited for in a frame and how long, who was
 * late in it, and what becomes of who is slow (pace.h).
 *
 * Frames come in pairs. A node at half the rate draws the first of a pair, which the
 * others do not wait for, and shows that with the second, in whose barrier it is
 * waited for. It applies and acknowledges the state of both, so that the base of a
 * delta is as near for it as for the others. It goes to half the rate, and back, with
 * the first of a pair; while there is none, every frame is such a one.
 */
#include "protocol/master_private.h"

#define BIT(node) (UINT64_C(1) << (node))

static uint64_t nodes_at_half(const struct fdp_master *m)
{
	uint64_t nodes = 0;

	for (size_t i = 0; i < m->params.node_count; i++)
		if (m->peers[i].pace.state == FDP_PACE_HALF)
			nodes |= BIT(i);
	return nodes;
}

void fdp_master_start_barrier(struct fdp_master *m, uint64_t live, int64_t now_ns)
{
	struct fdp_half *half = &m->half;

	half->shows = !half->shows && half->nodes;
	if (half->shows) {
		half->nodes &= live;
	} else {
		*half = (struct fdp_half){ .nodes = live & nodes_at_half(m),
					   .frame = m->frame,
					   .begun_ns = now_ns };
	}
	fdp_barrier_start(&m->barrier, m->frame, half->shows ? live : live & ~half->nodes, now_ns,
			  m->params.deadline_ns);
	m->barrier.draws = half->shows ? live & ~half->nodes : live;
	m->barrier.ready = half->shows ? half->ready & half->nodes : 0;
	m->waits_longer = false;
	m->judges = m->params.deadline_ns == m->usual_deadline_ns;
}

void fdp_master_count_out(struct fdp_master *m, unsigned node)
{
	fdp_barrier_drop(&m->barrier, node);
	m->half.nodes &= ~BIT(node);
}

uint64_t fdp_master_draws(const struct fdp_master *m)
{
	return fdp_master_mask(m, fdp_peer_counts) & ~(m->half.shows ? m->half.nodes : 0);
}

uint64_t fdp_master_every_frame(const struct fdp_master *m)
{
	return fdp_master_mask(m, fdp_peer_counts) & ~m->half.nodes;
}

bool fdp_master_half_ready(struct fdp_master *m, unsigned node, uint64_t frame)
{
	struct fdp_half *half = &m->half;

	if (!(half->nodes & BIT(node)))
		return frame == m->frame;
	if (frame != half->frame)
		return false;
	if (!(half->ready & BIT(node))) {
		half->ready |= BIT(node);
		m->peers[node].missed_row = 0;
		m->peers[node].status.ready_after_ns = m->now_ns - half->begun_ns;
	}
	return half->shows;
}

int64_t fdp_master_ready_after(const struct fdp_master *m, unsigned node)
{
	return m->half.nodes & BIT(node) ? m->peers[node].status.ready_after_ns
					 : m->now_ns - m->barrier.begun_ns;
}

/* Of who is not ready: some give signs of life. */
static bool some_draw_still(const struct fdp_master *m)
{
	const uint64_t unready = fdp_barrier_unready(&m->barrier);

	for (size_t i = 0; i < m->params.node_count; i++)
		if (unready & BIT(i) && m->peers[i].status.last_heard_ns >= m->barrier.begun_ns)
			return true;
	return false;
}

bool fdp_master_frame_over(struct fdp_master *m, int64_t now_ns)
{
	struct fdp_barrier *barrier = &m->barrier;

	if (!fdp_barrier_over(barrier, now_ns))
		return m->waits_longer && !some_draw_still(m);
	if (fdp_barrier_complete(barrier) || m->waits_longer || m->pace.policy != FDP_SLOW_WAIT ||
	    !some_draw_still(m))
		return true;
	m->waits_longer = true;
	if (barrier->begun_ns + m->pace.wait_most_ns > barrier->deadline_ns)
		barrier->deadline_ns = barrier->begun_ns + m->pace.wait_most_ns;
	return fdp_barrier_over(barrier, now_ns);
}

static void say_pace(struct fdp_master *m, unsigned node)
{
	const struct fdp_master_event event = {
		.kind = FDP_MASTER_PACE,
		.node = (int)node,
		.frame = m->frame,
		.pace = m->peers[node].pace.state,
	};

	fdp_master_say(m, &event);
}

static void evict(struct fdp_master *m, unsigned node)
{
	const struct fdp_master_event event = {
		.kind = FDP_MASTER_EVICTED,
		.node = (int)node,
		.frame = m->frame,
		.pace = m->peers[node].pace.state,
	};

	m->peers[node].state = fdp_peer_next(m->peers[node].state, FDP_PEER_EXPIRES);
	fdp_master_say(m, &event);
}

/* They keep counting until they have missed too many. */
static void note_missed(struct fdp_master *m, unsigned node, int64_t now_ns)
{
	struct fdp_peer *peer = &m->peers[node];
	const struct fdp_master_event late = { .kind = FDP_MASTER_LATE,
					       .node = (int)node,
					       .frame = m->frame };

	peer->status.missed++;
	if (!peer->missed_row++)
		peer->missed_ns = m->params.evict_frames > 1 ? now_ns : m->barrier.begun_ns;
	peer->state = fdp_peer_next(peer->state, FDP_PEER_MISSES);
	fdp_master_say(m, &late);
	if (peer->missed_row < m->params.evict_frames)
		return;
	/* Who was heard after the first that it missed lives, and is slow. */
	if (peer->status.last_heard_ns > peer->missed_ns) {
		const bool stays = fdp_pace_too_late(&peer->pace, &m->pace, now_ns);

		say_pace(m, node);
		peer->missed_row = 0;
		if (stays)
			return;
	}
	evict(m, node);
}

static void note_pace(struct fdp_master *m, unsigned node, bool ready, int64_t now_ns)
{
	struct fdp_peer *peer = &m->peers[node];
	const bool slow = !ready || peer->status.ready_after_ns > m->pace.limit_ns;

	if (!fdp_pace_frame(&peer->pace, &m->pace, slow, now_ns))
		return;
	say_pace(m, node);
	if (peer->pace.state == FDP_PACE_EVICTED)
		evict(m, node);
}

void fdp_master_judge(struct fdp_master *m, int64_t now_ns)
{
	const uint64_t late = fdp_barrier_unready(&m->barrier);

	for (unsigned i = 0; i < m->params.node_count; i++) {
		const struct fdp_peer *peer = &m->peers[i];

		if (!(m->barrier.live & BIT(i)))
			continue;
		if (late & BIT(i))
			note_missed(m, i, now_ns);
		/* A frame that may take longer says nothing, nor does silence. */
		if (m->judges && fdp_peer_counts(peer->state) &&
		    peer->status.last_heard_ns >= m->barrier.begun_ns)
			note_pace(m, i, !(late & BIT(i)), now_ns);
	}
}
