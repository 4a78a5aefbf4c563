#include "protocol/node_private.h"

#include "base/result.h"

#include <string.h>

void fdp_node_frame_reset(struct fdp_node *n)
{
	n->applied = n->hash = n->applied_live = 0;
	n->swap_seen = 0;
	n->twice = false;
	n->joined_sequence = 0;
	n->current = (struct fdp_node_frame){ 0 };
	n->swapped_frame = n->swapped_count = 0;
	n->swap_ns = n->vitals_ns = 0;
	n->nacked_ns = n->gap_ns = 0;
	n->repair = (struct fdp_trip){ 0, 0 };
	n->wait_ns = n->retry_ns;
	n->lost = 0;
	fdp_node_clock_reset(n);
	fdp_reassembly_reset(&n->delta);
	fdp_reassembly_reset(&n->snapshot);
	fdp_node_share_reset(n);
}

static void send_report(struct fdp_node *n, enum fdp_kind kind, uint64_t frame, uint64_t hash,
			int64_t now_ns)
{
	struct fdp_report report = {
		.frame = frame,
		.hash = hash,
		.swapped_frame = n->swapped_frame,
		.swapped_count = n->swapped_count,
		.swap_ns = n->swap_ns,
		.render_us = n->current.render_us,
		.slice = fdp_node_slice_sent(n),
		.lost = n->lost,
	};

	fdp_node_say_time(n, &report, now_ns);
	fdp_outbox_send(&n->out, FDP_TO_ALL, kind,
			fdp_report_encode(&report, fdp_outbox_body(&n->out), FDP_BODY_MAX));
}

static void send_ready(struct fdp_node *n, int64_t now_ns)
{
	n->current.asked_ns = now_ns;
	send_report(n, FDP_READY, n->current.frame, n->current.hash, now_ns);
}

static void send_nack(struct fdp_node *n, const struct fdp_nack *nack, int64_t now_ns)
{
	n->nacked_ns = now_ns;
	if (nack->count && nack->message == n->delta.message && !n->gap_ns)
		n->gap_ns = now_ns;
	for (int i = 0; i < (n->twice ? 2 : 1); i++)
		fdp_outbox_send(&n->out, FDP_TO_ALL, FDP_NACK,
				fdp_nack_encode(nack, fdp_outbox_body(&n->out), FDP_BODY_MAX));
}

static void ask_for_snapshot(struct fdp_node *n, uint64_t frame, int64_t now_ns)
{
	const struct fdp_nack nack = { .frame = frame, .flags = FDP_NACK_SNAPSHOT };

	send_nack(n, &nack, now_ns);
}

/* Says SWAP once for a frame that is drawn and that the room has swapped. */
static void swap_if_due(struct fdp_node *n)
{
	struct fdp_node_event event = { .kind = FDP_NODE_SWAP };

	if (!n->current.ready || n->current.swapped || n->swap_seen < n->current.show)
		return;
	n->current.swapped = true;
	event.frame = n->current.frame;
	if (event.frame > n->shown)
		n->shown = event.frame;
	event.at_ns = n->swap_seen == n->current.show ? n->swap_at_ns : 0;
	n->ops.event(n->ops.ctx, &event);
}

static void start_frame(struct fdp_node *n, uint64_t frame, bool half)
{
	/* A new frame means that the one before was swapped, even if we missed the word. */
	if (n->current.frame && frame > n->current.show) {
		if (n->swap_seen < n->current.show) {
			n->swap_seen = n->current.show;
			n->swap_at_ns = 0;
		}
		swap_if_due(n);
	}
	n->current = (struct fdp_node_frame){
		.frame = frame, .show = frame + half, .hash = n->hash, .render_us = n->current.render_us
	};
	fdp_node_say(n, FDP_NODE_FRAME, frame);
}

static void say_mismatch(struct fdp_node *n, uint64_t frame, uint64_t ours, uint64_t theirs)
{
	const struct fdp_node_event event = {
		.kind = FDP_NODE_MISMATCH, .frame = frame, .ours = ours, .theirs = theirs
	};

	n->ops.event(n->ops.ctx, &event);
}

/* Takes the next state beside the present one, and makes it the present one if it is right. */
static enum fdp_verdict apply(struct fdp_node *n, const struct fdp_state_head *head,
			      uint64_t sequence, const uint8_t *delta, size_t len, uint64_t base,
			      int64_t now_ns)
{
	const bool chained = base && head->previous_frame == n->applied;
	struct param_state *next = n->scratch;
	uint64_t hash;

	param_state_copy(next, n->state);
	if (param_delta_apply(next, delta, len) || param_newest(next) > head->frame) {
		ask_for_snapshot(n, head->frame, now_ns);
		return FDP_BAD_FORMAT;
	}
	/* Whoever skipped a frame takes the chain's last link from the master. */
	hash = param_state_hash(next, chained ? n->hash : head->previous_hash);
	if (hash != head->hash) {
		say_mismatch(n, head->frame, hash, head->hash);
		/* The master compares too, and answers with a snapshot. */
		send_report(n, FDP_ACK, head->frame, hash, now_ns);
		return FDP_GOOD;
	}
	n->scratch = n->state;
	n->state = next;
	n->applied = head->frame;
	n->applied_live = head->live;
	n->hash = hash;
	if (n->status == FDP_NODE_WAITING_SNAPSHOT) {
		n->status = FDP_NODE_LIVE;
		n->joined_sequence = sequence;
	}
	fdp_node_share_frame(n, head);
	send_report(n, FDP_ACK, n->applied, n->hash, now_ns);
	if (fdp_node_in(n, head->live))
		start_frame(n, head->frame, fdp_node_in(n, head->half));
	return FDP_GOOD;
}

static bool left_out(struct fdp_node *n, uint64_t present, uint64_t sequence)
{
	if (n->status != FDP_NODE_LIVE || sequence <= n->joined_sequence || fdp_node_in(n, present))
		return false;
	fdp_node_ask_again(n, FDP_NODE_LOST, "the master has left this node out");
	return true;
}

static enum fdp_verdict take_state(struct fdp_node *n, const struct fdp_header *h,
				   const uint8_t *bytes, size_t len, int64_t now_ns)
{
	struct fdp_state_head head;
	const uint8_t *delta;
	uint64_t base;
	size_t at;
	const bool snapshot = h->kind == FDP_SNAPSHOT;

	if (fdp_state_head_decode(bytes, len, &head, &at))
		return FDP_BAD_FORMAT;
	delta = bytes + at;
	len -= at;
	if (param_delta_base(delta, len, &base) || (snapshot && base) || base > head.frame ||
	    (head.flags & FDP_CHAINED && (!base || base != head.previous_frame)))
		return FDP_BAD_FORMAT;
	if (left_out(n, head.present, h->sequence))
		return FDP_GOOD;
	n->twice = head.flags & FDP_TWICE;
	if (n->status == FDP_NODE_WAITING_SNAPSHOT) {
		if (!snapshot)
			return FDP_GOOD; /* nothing to put it on yet */
	} else if (head.frame < n->applied ||
		   (head.frame == n->applied && (!snapshot || head.hash == n->hash))) {
		/* Old news; but who sends a snapshot has not heard what we hold. */
		if (snapshot)
			send_report(n, FDP_ACK, n->applied, n->hash, now_ns);
		return FDP_GOOD;
	}
	if (base > n->applied) {
		if (fdp_node_in(n, head.live))
			ask_for_snapshot(n, head.frame, now_ns);
		return FDP_GOOD;
	}
	return apply(n, &head, h->sequence, delta, len, base, now_ns);
}

static void nack_gap(struct fdp_node *n, struct fdp_reassembly *r, const struct fdp_header *h,
		     int64_t now_ns)
{
	struct fdp_nack nack = { .message = r->message, .count = r->count };

	if (fdp_reassembly_gap(r, h, nack.missing))
		send_nack(n, &nack, now_ns);
}

/* Fragments under `below`, as many as it lacks. */
static void nack_missing(struct fdp_node *n, const struct fdp_reassembly *r, unsigned below,
			 int64_t now_ns)
{
	struct fdp_nack nack = { .message = r->message, .count = r->count };

	if (fdp_reassembly_missing(r, below, nack.missing))
		send_nack(n, &nack, now_ns);
}

/*
 * The part of the DELTA that is known to be missing, and how long after the last
 * that was heard of it is asked for again: gaps when repairs usually have come, the
 * end, which may be on its way, only when the whole usually has.
 */
static unsigned missing_below(const struct fdp_node *n, int64_t *out_wait_ns)
{
	uint8_t missing[FDP_BITMAP_BYTES];
	const struct fdp_reassembly *r = &n->delta;
	const bool gaps = fdp_reassembly_missing(r, r->reported, missing) > 0;

	*out_wait_ns = gaps ? fdp_trip_wait(&n->repair, n->wait_ns) : n->wait_ns;
	return gaps && *out_wait_ns < n->wait_ns ? r->reported : r->count;
}

/* The same snapshot again: our ACK was lost, or we could not use it the first time. */
static void snapshot_again(struct fdp_node *n, const struct fdp_header *h, int64_t now_ns)
{
	if (h->kind != FDP_SNAPSHOT || h->message != n->snapshot.message ||
	    fdp_reassembly_open(&n->snapshot) || h->index + 1 != h->count)
		return;
	if (n->status == FDP_NODE_LIVE)
		send_report(n, FDP_ACK, n->applied, n->hash, now_ns);
	else
		fdp_reassembly_reset(&n->snapshot); /* take it when it comes once more */
}

/* A fragment of a DELTA that was asked for has come: how long that took. */
static void note_repair(struct fdp_node *n, const struct fdp_header *h,
			enum fdp_fragment_result result, int64_t now_ns)
{
	if (h->kind != FDP_DELTA || !h->again || !n->gap_ns ||
	    (result != FDP_FRAGMENT_PART && result != FDP_FRAGMENT_WHOLE))
		return;
	fdp_trip_take(&n->repair, now_ns - n->gap_ns);
	n->gap_ns = 0;
}

enum fdp_verdict fdp_node_on_state(struct fdp_node *n, const struct fdp_header *h,
				   const uint8_t *payload, int64_t now_ns)
{
	struct fdp_reassembly *r = h->kind == FDP_SNAPSHOT ? &n->snapshot : &n->delta;
	enum fdp_fragment_result result;

	/* A delta is of no use before the snapshot, and asking for its rest even less. */
	if (n->status == FDP_NODE_WAITING_SNAPSHOT && h->kind == FDP_DELTA)
		return FDP_GOOD;
	/* What is still to come of the message before will not come now. */
	if (h->kind == FDP_DELTA && h->message > r->message)
		n->lost += fdp_reassembly_lost(r);
	if (h->message > r->message)
		n->gap_ns = 0;
	result = fdp_reassembly_add(r, h, payload);
	note_repair(n, h, result, now_ns);
	switch (result) {
	case FDP_FRAGMENT_BAD:
		return FDP_BAD_FORMAT;
	case FDP_FRAGMENT_AGAIN:
		snapshot_again(n, h, now_ns);
		return FDP_GOOD;
	case FDP_FRAGMENT_PART:
		n->nacked_ns = now_ns; /* the rest may be on its way */
		nack_gap(n, r, h, now_ns);
		return FDP_GOOD;
	case FDP_FRAGMENT_WHOLE:
		n->counters.healed += r->healed;
		break;
	}
	if (!r->packed)
		return take_state(n, h, r->bytes, r->message_len, now_ns);
	if (fdp_unpack(r->bytes, r->message_len, n->plain, r->plain_len))
		return FDP_BAD_FORMAT;
	return take_state(n, h, n->plain, r->plain_len, now_ns);
}

/* A frame is announced that we do not hold: ask for what is missing of it. */
static void ask_for_announced(struct fdp_node *n, const struct fdp_announce *a, int64_t now_ns)
{
	struct fdp_nack nack = { .frame = a->frame, .message = a->message, .count = a->count };

	if (!a->message || (n->nacked_ns && now_ns - n->nacked_ns < n->wait_ns / 2))
		return;
	if (a->message == n->delta.message) {
		if (fdp_reassembly_open(&n->delta))
			nack_missing(n, &n->delta, n->delta.count, now_ns);
		else
			ask_for_snapshot(n, a->frame, now_ns); /* came whole, was of no use */
		return;
	}
	if (a->message < n->delta.message)
		return;
	for (unsigned i = 0; i < a->count; i++)
		nack.missing[i / 8] = (uint8_t)(nack.missing[i / 8] | 1u << i % 8);
	send_nack(n, &nack, now_ns);
}

enum fdp_verdict fdp_node_on_announce(struct fdp_node *n, const struct fdp_header *h,
				      const uint8_t *body, int64_t now_ns)
{
	struct fdp_announce a;

	if (fdp_announce_decode(body, h->payload_len, &a))
		return FDP_BAD_FORMAT;
	if (n->status != FDP_NODE_LIVE || left_out(n, a.present, h->sequence))
		return FDP_GOOD;
	n->twice = a.flags & FDP_TWICE;
	n->wait_ns = a.wait_us && (int64_t)a.wait_us * 1000 < n->retry_ns ? (int64_t)a.wait_us * 1000
									  : n->retry_ns;
	fdp_node_note_clock(n, &a, n->arrived_ns);
	if (a.swapped > n->swap_seen) {
		n->swap_seen = a.swapped;
		fdp_node_note_swap(n, &a, now_ns);
	}
	swap_if_due(n);
	fdp_node_note_slices(n, &a, now_ns);
	if (a.frame > n->applied && fdp_node_in(n, a.live))
		ask_for_announced(n, &a, now_ns);
	if (h->kind != FDP_PROBE)
		return FDP_GOOD;
	if (n->current.ready && !n->current.swapped && n->current.frame == n->applied)
		send_ready(n, now_ns);
	else
		send_report(n, FDP_ACK, n->applied, n->hash, now_ns);
	return FDP_GOOD;
}

/*
 * When READY is said again. It waits for the slowest of all nodes, so no answer is
 * no sign of loss: only where datagrams do get lost is it repeated soon, and then
 * after ever twice the time.
 */
static int64_t ready_at(const struct fdp_node *n)
{
	const unsigned asks = n->current.asks;
	const int64_t steady_ns = fdp_backoff(n->retry_ns, asks);
	const int64_t soon_ns = n->wait_ns << (asks < 8 ? asks : 8);

	return n->current.asked_ns + (n->twice && soon_ns < steady_ns ? soon_ns : steady_ns);
}

void fdp_node_frame_tick(struct fdp_node *n, int64_t now_ns)
{
	/* READY or SWAP may be lost: either way, saying READY again brings the SWAP. */
	if (n->current.ready && !n->current.swapped && now_ns >= ready_at(n)) {
		n->current.asks++;
		send_ready(n, now_ns);
	}
	if (fdp_reassembly_open(&n->delta)) {
		int64_t wait_ns;
		const unsigned below = missing_below(n, &wait_ns);

		if (now_ns - n->nacked_ns >= wait_ns)
			nack_missing(n, &n->delta, below, now_ns);
	}
	fdp_node_share_tick(n, now_ns);
}

int64_t fdp_node_frame_next(const struct fdp_node *n)
{
	int64_t next = INT64_MAX, share_next;

	if (n->current.ready && !n->current.swapped)
		next = ready_at(n);
	if (fdp_reassembly_open(&n->delta)) {
		int64_t wait_ns;

		missing_below(n, &wait_ns);
		if (n->nacked_ns + wait_ns < next)
			next = n->nacked_ns + wait_ns;
	}
	share_next = fdp_node_share_next(n);
	return share_next < next ? share_next : next;
}

void fdp_node_ready(struct fdp_node *n, uint64_t frame, uint32_t render_us, int64_t now_ns)
{
	if (n->status != FDP_NODE_LIVE || !frame || frame != n->current.frame || n->current.ready)
		return; /* overtaken by a newer frame, or a session gone by */
	n->current.ready = true;
	n->current.render_us = render_us;
	send_ready(n, now_ns);
	if (n->twice)
		send_ready(n, now_ns);
	swap_if_due(n);
}

void fdp_node_swapped(struct fdp_node *n, uint64_t frame, int64_t swap_ns, int64_t now_ns)
{
	if (n->status != FDP_NODE_LIVE || frame <= n->swapped_frame)
		return;
	n->swapped_frame = frame;
	n->swapped_count++;
	n->swap_ns = swap_ns;
	send_report(n, FDP_SWAPPED, frame, 0, now_ns);
}
