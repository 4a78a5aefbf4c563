/* What arrives at the master: reports of the nodes, and who may not speak. */
#include "protocol/master_private.h"

#define BIT(node) (UINT64_C(1) << (node))

/* True when the node holds what we hold for a frame that we still know. */
static bool state_agrees(struct fdp_master *m, unsigned node, const struct fdp_report *report,
			 int64_t now_ns)
{
	struct fdp_peer *peer = &m->peers[node];
	const unsigned slot = report->frame % FDP_HASH_RING;
	struct fdp_master_event event = {
		.kind = FDP_MASTER_MISMATCH, .node = (int)node, .frame = report->frame,
		.ours = m->hashes[slot], .theirs = report->hash,
	};

	if (m->hash_frames[slot] != report->frame)
		return false;
	if (report->hash == m->hashes[slot])
		return true;
	fdp_master_want_snapshot(m, node);
	if (report->frame == m->barrier.frame) {
		m->barrier.acked &= ~BIT(node);
		m->barrier.ready &= ~BIT(node);
	}
	if (report->frame == m->half.frame)
		m->half.ready &= ~BIT(node);
	if (report->frame != peer->mismatch_frame || !peer->status.mismatches) {
		peer->mismatch_frame = report->frame;
		peer->status.mismatches++;
		fdp_master_say(m, &event);
		fdp_master_send_snapshot(m, node, now_ns);
	}
	return false;
}

static void note_acked(struct fdp_master *m, unsigned node, const struct fdp_report *report)
{
	struct fdp_peer *peer = &m->peers[node];
	const struct fdp_master_event joined = {
		.kind = FDP_MASTER_JOINED, .node = (int)node, .frame = m->frame
	};

	if (peer->wants_snapshot && report->frame < peer->snapshot_from)
		return; /* from before its state went wrong */
	peer->wants_snapshot = false;
	if (report->frame > peer->status.acked)
		peer->status.acked = report->frame;
	if (report->frame == m->barrier.frame && !(m->barrier.acked & BIT(node))) {
		m->barrier.acked |= BIT(node);
		if (m->barrier.draws & BIT(node) && m->underway)
			fdp_trip_take(&peer->trip, m->now_ns - m->barrier.begun_ns);
	}
	if (peer->state == FDP_PEER_JOINING && fdp_master_is_follower(m, node)) {
		peer->state = fdp_peer_next(peer->state, FDP_PEER_FOLLOWED);
		fdp_master_say(m, &(struct fdp_master_event){
			.kind = FDP_MASTER_FOLLOWED, .node = (int)node, .frame = m->frame });
	} else if (peer->state == FDP_PEER_JOINING && !peer->synced) {
		peer->synced = true;
		fdp_trip_take(&peer->trip, m->now_ns - peer->snapshot_ns);
		fdp_master_say(m, &joined);
	}
}

static void on_ready(struct fdp_master *m, unsigned node, const struct fdp_report *report,
		     int64_t now_ns)
{
	struct fdp_peer *peer = &m->peers[node];

	if (report->frame > peer->status.ready)
		peer->status.ready = report->frame;
	peer->status.render_us = report->render_us;
	if (!fdp_peer_counts(peer->state) || !fdp_master_half_ready(m, node, report->frame))
		return;
	if (!m->underway) {
		/* It has not seen the SWAP: lost, unless the two have just crossed. */
		if (m->barrier.ready & BIT(node) && now_ns - m->swapped_ns > m->params.probe_ns / 4)
			fdp_master_saw_loss(m);
		fdp_master_announce(m, (int)node, FDP_SWAP);
		return;
	}
	if (m->barrier.ready & BIT(node))
		return;
	peer->status.ready_after_ns = fdp_master_ready_after(m, node);
	peer->missed_row = 0;
	peer->state = fdp_peer_next(peer->state, FDP_PEER_READIES);
	m->barrier.ready |= BIT(node);
	fdp_master_finish_if_over(m, now_ns);
}

/* By our clock; 0: its clock is not known, or what it says is no time of late. */
static int64_t swap_time(const struct fdp_peer *peer, int64_t swap_ns, int64_t now_ns)
{
	struct fdp_clock_estimate estimate;
	int64_t ours_ns, ago_ns;

	fdp_clock_estimate(&peer->clock, now_ns, &estimate);
	ours_ns = fdp_clock_to_ours(&peer->clock, swap_ns);
	if (!estimate.known || __builtin_sub_overflow(now_ns, ours_ns, &ago_ns) ||
	    ago_ns < -FDP_SWAPPED_MOST_NS || ago_ns > FDP_SWAPPED_MOST_NS)
		return 0;
	return ours_ns;
}

static void note_swap(struct fdp_peer *peer, const struct fdp_report *report, int64_t now_ns)
{
	if (report->swapped_count <= peer->status.swapped)
		return;
	peer->status.swapped = report->swapped_count;
	peer->status.swapped_frame = report->swapped_frame;
	peer->status.swap_local_ns = report->swap_ns;
	peer->status.swap_ns = swap_time(peer, report->swap_ns, now_ns);
	fdp_master_note_path(peer, report->path_ns);
}

/* What the node lost, cumulative: any report tells. */
static void note_losses(struct fdp_master *m, unsigned node, const struct fdp_report *report)
{
	struct fdp_peer *peer = &m->peers[node];
	const uint32_t more = report->lost - peer->lost;

	/* Reports overtake each other: one that says less is older. */
	if (!more || more > UINT32_MAX / 2)
		return;
	peer->lost = report->lost;
	peer->status.lost += more;
	peer->lost_now += more;
	fdp_master_saw_loss(m);
}

static void on_report(struct fdp_master *m, unsigned node, enum fdp_kind kind,
		      const struct fdp_report *report, int64_t now_ns)
{
	fdp_master_note_taken(m, node, report);
	if (fdp_master_is_follower(m, node)) {
		/* It draws nothing, and nobody waits for it. */
		if (kind == FDP_ACK && state_agrees(m, node, report, now_ns))
			note_acked(m, node, report);
		return;
	}
	fdp_master_note_clock(m, node, report, m->arrived_ns);
	note_losses(m, node, report);
	note_swap(&m->peers[node], report, now_ns);
	fdp_master_note_slice(m, node, report->slice, now_ns);
	if (kind == FDP_SWAPPED || !state_agrees(m, node, report, now_ns))
		return;
	note_acked(m, node, report);
	if (kind == FDP_READY)
		on_ready(m, node, report, now_ns);
}

/* A state, of which the newest counts: datagrams overtake each other. */
static enum fdp_verdict on_input(struct fdp_master *m, const struct fdp_header *h, const uint8_t *body)
{
	struct fdp_peer *peer = &m->peers[h->sender];
	struct fdp_input input;

	if (fdp_master_is_follower(m, h->sender) || fdp_input_decode(body, h->payload_len, &input))
		return FDP_BAD_FORMAT;
	if (h->sequence < peer->input_sequence)
		return FDP_GOOD;
	peer->input_sequence = h->sequence;
	if (m->ops.input)
		m->ops.input(m->ops.ctx, h->sender, &input);
	return FDP_GOOD;
}

static enum fdp_verdict on_glance(struct fdp_master *m, const struct fdp_header *h, const uint8_t *body)
{
	struct fdp_peer *peer = &m->peers[h->sender];
	struct fdp_glance glance;

	if (fdp_master_is_follower(m, h->sender) || fdp_glance_decode(body, h->payload_len, &glance))
		return FDP_BAD_FORMAT;
	if (h->sequence < peer->glance_sequence)
		return FDP_GOOD;
	peer->glance_sequence = h->sequence;
	if (m->ops.glance)
		m->ops.glance(m->ops.ctx, h->sender, &glance);
	return FDP_GOOD;
}

/* An authentic, new datagram of a present peer. */
static enum fdp_verdict dispatch(struct fdp_master *m, const struct fdp_header *h,
				 const uint8_t *body, int64_t now_ns)
{
	struct fdp_report report;
	struct fdp_vitals vitals;
	struct fdp_nack nack;
	uint64_t frame;

	switch (h->kind) {
	case FDP_ACK:
	case FDP_READY:
	case FDP_SWAPPED:
		if (fdp_report_decode(body, h->payload_len, &report) || report.frame > m->frame)
			return FDP_BAD_FORMAT;
		if (m->ops.report)
			m->ops.report(m->ops.ctx, h->sender, h->kind, &report);
		on_report(m, h->sender, h->kind, &report, now_ns);
		return FDP_GOOD;
	case FDP_VITALS:
		if (fdp_vitals_decode(body, h->payload_len, &vitals))
			return FDP_BAD_FORMAT;
		fdp_master_note_vitals(m, h->sender, &vitals);
		return FDP_GOOD;
	case FDP_INPUT:
		return on_input(m, h, body);
	case FDP_GLANCE:
		return on_glance(m, h, body);
	case FDP_NACK:
		if (fdp_nack_decode(body, h->payload_len, &nack))
			return FDP_BAD_FORMAT;
		fdp_master_on_nack(m, h->sender, &nack, now_ns);
		return FDP_GOOD;
	case FDP_LEAVE:
		if (fdp_leave_decode(body, h->payload_len, &frame))
			return FDP_BAD_FORMAT;
		fdp_master_on_leave(m, h->sender, now_ns);
		return FDP_GOOD;
	case FDP_SLICE:
		return fdp_master_on_slice(m, h->sender, body, h->payload_len, now_ns);
	case FDP_LACK:
		return fdp_master_on_lack(m, h->sender, body, h->payload_len);
	default:
		return FDP_BAD_FORMAT;
	}
}

/* A node that is not in the room but thinks so is told, rarely and briefly. */
static void tell_stranger(struct fdp_master *m, unsigned node, int64_t now_ns)
{
	struct fdp_peer *peer = &m->peers[node];

	if (peer->told_ns && now_ns - peer->told_ns < m->params.probe_ns)
		return;
	peer->told_ns = now_ns;
	fdp_master_announce(m, (int)node, FDP_PROBE);
}

static enum fdp_verdict take(struct fdp_master *m, const struct fdp_header *h, const uint8_t *body,
			     int64_t now_ns, bool *fresh)
{
	struct fdp_peer *peer = &m->peers[h->sender];

	if (h->kind == FDP_JOIN) {
		struct fdp_join join;

		if (h->session && h->session != m->params.session)
			return FDP_BAD_SESSION;
		if (fdp_join_decode(body, h->payload_len, &join) || join.index != h->sender)
			return FDP_BAD_FORMAT;
		*fresh = fdp_master_on_join(m, h, &join, now_ns);
		return FDP_GOOD;
	}
	if (peer->state == FDP_PEER_ABSENT && !peer->joins)
		return FDP_BAD_SESSION;
	if (!fdp_replay_take(&peer->window, h->sequence))
		return FDP_BAD_REPLAY;
	peer->status.last_heard_ns = now_ns;
	peer->status.hears_group = h->group;
	if (!fdp_peer_present(peer->state)) {
		if (h->kind != FDP_LEAVE)
			tell_stranger(m, h->sender, now_ns);
		return FDP_GOOD;
	}
	return dispatch(m, h, body, now_ns);
}

int fdp_master_answers(const struct fdp_master *m)
{
	return m->answers;
}

int fdp_master_receive(struct fdp_master *m, const uint8_t *bytes, size_t len, int64_t now_ns,
		       bool *out_fresh)
{
	bool fresh = false;
	struct fdp_header h;
	enum fdp_verdict verdict = fdp_gate_open(&m->gate, bytes, len, &h);

	m->now_ns = now_ns;
	/* A time to come, or long gone, is no receive time of this datagram. */
	if (m->arrived_ns > now_ns || m->arrived_ns < now_ns - FDP_ARRIVED_MOST_NS)
		m->arrived_ns = now_ns;
	m->counters.datagrams_in++;
	m->counters.bytes_in += len;
	if (verdict == FDP_GOOD) {
		m->answers = h.sender;
		verdict = take(m, &h, bytes + FDP_HEADER_BYTES, now_ns, &fresh);
		m->answers = -1;
	}
	if (out_fresh)
		*out_fresh = verdict == FDP_GOOD && fresh;
	m->arrived_ns = 0;
	fdp_count_bad(&m->counters, verdict);
	return verdict == FDP_GOOD ? h.sender : fdp_verdict_result(verdict);
}
