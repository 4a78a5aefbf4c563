/*
 * Who may take part. A JOIN without a challenge is only answered, never
 * acted on: it may be a recording. What acts is the second JOIN, which
 * echoes a challenge that is bound to this session, both nonces and the number
 * of the node's incarnations so far, so that none is good twice.
 */
#include "protocol/master_private.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

/* No room comes so far; what a node says beyond it is nonsense. */
#define FLOOR_MOST (UINT64_C(1) << 56)

static void make_challenge(const struct fdp_master *m, unsigned node,
			   const uint8_t nonce[FDP_NONCE_BYTES],
			   uint8_t challenge[FDP_NONCE_BYTES])
{
	fdp_challenge(m->params.key, m->params.session, node, m->peers[node].joins, m->nonce, nonce,
		      challenge);
}

static void refuse(struct fdp_master *m, unsigned node, const struct fdp_join *join,
		   const char *reason, uint64_t plan, int64_t now_ns)
{
	struct fdp_peer *peer = &m->peers[node];
	struct fdp_refuse answer = { .plan = plan };
	const struct fdp_master_event event = {
		.kind = FDP_MASTER_REFUSED, .node = (int)node, .frame = m->frame, .reason = reason
	};

	memcpy(answer.nonce, join->nonce, sizeof answer.nonce);
	snprintf(answer.reason, sizeof answer.reason, "%s", reason);
	fdp_outbox_send(&m->out, (int)node, FDP_REFUSE,
			fdp_refuse_encode(&answer, fdp_outbox_body(&m->out), FDP_BODY_MAX));
	/* A refused node asks for ever; the log need not say so each time. */
	if (!strcmp(peer->refused, reason) && now_ns - peer->refused_ns < FDP_REFUSED_AGAIN_NS)
		return;
	snprintf(peer->refused, sizeof peer->refused, "%s", reason);
	peer->refused_ns = now_ns;
	fdp_master_say(m, &event);
}

static uint32_t clamp_us(int64_t ns)
{
	const int64_t us = ns / 1000;

	return us < 1 ? 1 : us > UINT32_MAX ? UINT32_MAX : (uint32_t)us;
}

static void welcome(struct fdp_master *m, unsigned node, const struct fdp_join *join)
{
	struct fdp_welcome answer = {
		.first_sequence = (m->peers[node].joins + 1) << FDP_INCARNATION_SHIFT,
		.deadline_us = clamp_us(m->params.deadline_ns),
		.probe_us = clamp_us(m->params.probe_ns),
	};

	memcpy(answer.nonce, join->nonce, sizeof answer.nonce);
	memcpy(answer.master_nonce, m->nonce, sizeof answer.master_nonce);
	make_challenge(m, node, join->nonce, answer.challenge);
	fdp_outbox_send(&m->out, (int)node, FDP_WELCOME,
			fdp_welcome_encode(&answer, fdp_outbox_body(&m->out), FDP_BODY_MAX));
}

static void count_out(struct fdp_master *m, unsigned node, const char *reason, int64_t now_ns)
{
	struct fdp_peer *peer = &m->peers[node];
	const bool counted = fdp_peer_present(peer->state);
	const struct fdp_master_event left = {
		.kind = FDP_MASTER_LEFT, .node = (int)node, .frame = m->frame, .reason = reason
	};

	peer->state = fdp_peer_next(peer->state, FDP_PEER_LEAVES);
	if (!counted)
		return;
	fdp_master_count_out(m, node);
	fdp_master_say(m, &left);
	fdp_master_finish_if_over(m, now_ns);
}

static void admit(struct fdp_master *m, unsigned node, const struct fdp_header *header,
		  const struct fdp_join *join, int64_t now_ns)
{
	struct fdp_peer *peer = &m->peers[node];
	const uint64_t first = (peer->joins + 1) << FDP_INCARNATION_SHIFT;

	count_out(m, node, "joins anew", now_ns);
	peer->joins++;
	memcpy(peer->challenge, join->challenge, sizeof peer->challenge);
	fdp_key_to_master(m->params.key, m->params.session, node, m->nonce, join->nonce,
			  join->challenge, m->node_keys[node]);
	m->gate.keyed |= UINT64_C(1) << node;
	fdp_replay_start(&peer->window, first - 1);
	fdp_replay_take(&peer->window, header->sequence);
	peer->status = (struct fdp_peer_status){
		.last_heard_ns = now_ns, .plan = join->plan,
		.plan_cost = join->plan_cost, .plan_error = join->plan_error,
	};
	fdp_master_clock_forget(peer);
	peer->trip = (struct fdp_trip){ 0, 0 };
	peer->lost = peer->lost_now = 0;
	peer->loss = (struct fdp_loss){ 0 };
	peer->synced = peer->wants_snapshot = false;
	peer->missed_row = 0;
	fdp_pace_join(&peer->pace, now_ns);
	fdp_window_start(&peer->window_out, m->sent_to_all);
	peer->joined_ns = now_ns;
	peer->mismatch_frame = 0;
	peer->input_sequence = peer->glance_sequence = 0;
	peer->refused[0] = 0;
	peer->state = fdp_peer_next(peer->state, FDP_PEER_JOINS);
	if (!fdp_master_is_follower(m, node)) {
		if (join->shown > m->floor && join->shown <= FLOOR_MOST)
			m->floor = join->shown;
		m->calls = false;
		fdp_master_probe_group(m);
	}
	fdp_master_send_snapshot(m, node, now_ns);
}

/*
 * It has been in a session above ours, so it will not enter this one; and it
 * has lost that one, or it would not ask. Proven, for it has echoed our challenge.
 */
static bool outranked(struct fdp_master *m, unsigned node, const struct fdp_join *join)
{
	const struct fdp_master_event event = {
		.kind = FDP_MASTER_OUTRANKED, .node = (int)node, .frame = m->frame,
		.ours = m->params.session, .theirs = join->highest,
	};

	if (join->highest <= m->params.session)
		return false;
	fdp_master_say(m, &event);
	return true;
}

bool fdp_master_on_join(struct fdp_master *m, const struct fdp_header *header,
			const struct fdp_join *join, int64_t now_ns)
{
	const unsigned node = header->sender;
	struct fdp_peer *peer = &m->peers[node];
	uint8_t expected[FDP_NONCE_BYTES];
	char reason[FDP_REASON_MAX];
	uint64_t plan;

	/* Who has been in a room may find that it goes on: one that begins does not take it away. */
	if (join->highest && join->highest != m->params.session && now_ns < m->listens_ns)
		return false;
	/* Whoever only calls has nothing to follow yet. */
	if (fdp_master_is_follower(m, node) && m->calls)
		return false;
	if (fdp_master_refuses(m, header->version, join, reason, &plan)) {
		refuse(m, node, join, reason, plan, now_ns);
		return false;
	}
	/* Not refused: it may come back soon. */
	if (!fdp_pace_may_join(&peer->pace, now_ns))
		return false;
	if (!header->session) {
		welcome(m, node, join);
		return false;
	}
	/* Our snapshot was lost, or its acknowledgement. */
	if (peer->state == FDP_PEER_JOINING &&
	    !sodium_memcmp(join->challenge, peer->challenge, sizeof expected)) {
		if (!fdp_replay_take(&peer->window, header->sequence))
			return false;
		peer->status.last_heard_ns = now_ns;
		/* It reads, but of the snapshot it has nothing. */
		fdp_window_start(&peer->window_out, m->sent_to_all);
		if (now_ns - peer->snapshot_ns >= m->params.probe_ns)
			fdp_master_send_snapshot(m, node, now_ns);
		return true;
	}
	make_challenge(m, node, join->nonce, expected);
	if (sodium_memcmp(join->challenge, expected, sizeof expected)) {
		m->counters.bad_replay++;
		return false;
	}
	if (outranked(m, node, join))
		return false;
	admit(m, node, header, join, now_ns);
	return true;
}

void fdp_master_on_leave(struct fdp_master *m, unsigned node, int64_t now_ns)
{
	count_out(m, node, "said so", now_ns);
}
