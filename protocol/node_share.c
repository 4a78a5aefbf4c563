/*
 * The light that the nodes share out, as one of them sees it. Slices are put
 * together as their pieces come, and used at the start of a frame; what is
 * missing then is late, and asked for beside the frame until it is whole or a
 * newer one has come.
 */
#include "protocol/node_private.h"

#include "base/result.h"

void fdp_node_share_reset(struct fdp_node *n)
{
	fdp_share_reset(&n->share);
	n->shared = n->shared_since = 0;
	n->slice_frame = n->slices_frame = n->sending.frame = 0;
}

void fdp_node_share_frame(struct fdp_node *n, const struct fdp_state_head *head)
{
	n->lack_budget = 4 * fdp_share_slice_max(&n->share);
	if (head->shared_since != n->shared_since)
		n->slice_frame = n->sending.frame = 0;
	n->shared = head->shared;
	n->shared_since = head->shared_since;
	if (n->shared && n->share.room)
		fdp_share_divide(&n->share, n->shared_since,
				 (unsigned)__builtin_popcountll(n->shared));
}

/* The present frame's division, when it is the one that slices come for, and has one for us. */
static bool sharing(const struct fdp_node *n, unsigned *out_index)
{
	*out_index = fdp_share_rank(n->shared, n->params.index);
	return n->share.room && n->shared_since && n->shared_since == n->share.since &&
	       fdp_node_in(n, n->shared);
}

bool fdp_node_division(const struct fdp_node *n, unsigned *out_index, unsigned *out_count)
{
	*out_index = fdp_share_rank(n->shared, n->params.index);
	*out_count = (unsigned)__builtin_popcountll(n->shared);
	return n->share.room && fdp_node_in(n, n->shared);
}

static void send_lack(struct fdp_node *n, const struct fdp_lack *lack)
{
	for (int i = 0; i < (n->twice ? 2 : 1); i++)
		fdp_outbox_send(&n->out, FDP_TO_ALL, FDP_LACK,
				fdp_lack_encode(lack, fdp_outbox_body(&n->out), FDP_BODY_MAX));
}

static void send_piece(struct fdp_node *n, unsigned index, const struct fdp_slice *slice,
		       unsigned piece)
{
	const size_t len = fdp_share_write(&n->share, index, slice, piece, fdp_outbox_body(&n->out),
					   n->out.datagram_max - FDP_HEADER_BYTES);

	if (len)
		fdp_outbox_send(&n->out, FDP_TO_ALL, FDP_SLICE, len);
}

/* As much of what leaves beside the frames as may. */
static void send_some(struct fdp_node *n, unsigned index, int64_t now_ns)
{
	const uint64_t count = n->share.count, burst = FDP_SLICES_BURST / count, least = n->out.datagram_max;
	const struct fdp_rate rate = { FDP_SLICES_BYTES_S / count, burst > least ? burst : least };
	struct fdp_node_sending *sending = &n->sending;
	const struct fdp_slice *slice = fdp_share_find(&n->share, index, sending->frame);

	fdp_bucket_fill(&sending->bucket, &rate, now_ns);
	while (slice && sending->next < slice->pieces && sending->bucket.left >= least) {
		send_piece(n, index, slice, sending->next++);
		sending->bucket.left -= least;
	}
	sending->at_ns = now_ns + FDP_SLICES_TICK_NS;
	if (!slice || sending->next >= slice->pieces)
		sending->frame = 0;
}

int fdp_node_slice(struct fdp_node *n, uint64_t frame, const uint8_t *bytes, size_t len,
		   int64_t now_ns)
{
	struct fdp_slice *slice;
	bool first;
	unsigned index;

	if (n->status != FDP_NODE_LIVE || !frame || frame != n->current.frame ||
	    !sharing(n, &index) || n->share.count < 2 || frame <= n->slice_frame)
		return GR_NOTHING;
	slice = fdp_share_own(&n->share, index, frame, bytes, len,
			      n->out.datagram_max - FDP_HEADER_BYTES - FDP_PIECE_HEAD);
	if (!slice)
		return GR_ERR_RANGE;
	first = !n->slice_frame;
	n->slice_frame = frame;
	n->share.counts.sent++;
	n->share.counts.bytes_sent += len;
	/* One that is on its way has been overtaken. */
	n->sending.frame = 0;
	if (first && len * n->share.count > FDP_SLICES_AT_ONCE) {
		n->sending.frame = frame;
		n->sending.next = 0;
		send_some(n, index, now_ns);
		return GR_OK;
	}
	for (unsigned i = 0; i < slice->pieces; i++)
		send_piece(n, index, slice, i);
	return GR_OK;
}

enum fdp_verdict fdp_node_on_slice(struct fdp_node *n, const uint8_t *body, size_t len,
				   int64_t now_ns)
{
	enum fdp_fragment_result result;
	struct fdp_slice *slice;
	struct fdp_piece piece;
	struct fdp_lack lack;
	unsigned own;

	if (fdp_piece_decode(body, len, &piece))
		return FDP_BAD_FORMAT;
	if (n->status != FDP_NODE_LIVE || !n->share.room || piece.since < n->share.since)
		return FDP_GOOD;
	/* The others may be a frame ahead of us, and so in the next division. */
	fdp_share_divide(&n->share, piece.since, piece.count);
	if (piece.count != n->share.count)
		return FDP_BAD_FORMAT;
	if (sharing(n, &own) && piece.index == own)
		return FDP_GOOD; /* ours, from the group */
	result = fdp_share_add(&n->share, &piece, body + FDP_PIECE_HEAD, now_ns, &slice);
	if (result == FDP_FRAGMENT_BAD)
		return FDP_BAD_FORMAT;
	if (result == FDP_FRAGMENT_WHOLE) {
		n->share.counts.received++;
		n->share.counts.bytes_received += slice->len;
	} else if (result == FDP_FRAGMENT_PART &&
		   fdp_share_ask(&n->share, piece.index, slice, fdp_piece_sure(&piece), false,
				 now_ns, &lack)) {
		send_lack(n, &lack);
	}
	return FDP_GOOD;
}

enum fdp_verdict fdp_node_on_lack(struct fdp_node *n, const uint8_t *body, size_t len)
{
	const struct fdp_slice *slice;
	struct fdp_lack lack;
	unsigned own;

	if (fdp_lack_decode(body, len, &lack))
		return FDP_BAD_FORMAT;
	if (n->status != FDP_NODE_LIVE || lack.since != n->share.since || !sharing(n, &own))
		return FDP_GOOD;
	if (lack.index != own)
		return FDP_BAD_FORMAT;
	slice = fdp_share_find(&n->share, own, lack.frame);
	for (unsigned i = 0; slice && fdp_slice_whole(slice) && i < slice->pieces; i++) {
		if (n->sending.frame == lack.frame && i >= n->sending.next)
			break; /* has yet to leave */
		if (!fdp_slice_answers(slice, &lack, i))
			continue;
		if (n->lack_budget < slice->chunk)
			break;
		n->lack_budget -= slice->chunk;
		n->share.counts.repairs++;
		send_piece(n, own, slice, i);
	}
	return FDP_GOOD;
}

void fdp_node_note_slices(struct fdp_node *n, const struct fdp_announce *a, int64_t now_ns)
{
	unsigned own;

	if (!a->slices || !sharing(n, &own) || a->since != n->share.since ||
	    a->slices != n->share.count)
		return;
	for (unsigned i = 0; i < a->slices; i++) {
		struct fdp_slice *slice;
		struct fdp_lack lack;
		uint64_t frame;

		if (i == own || a->age[i] == FDP_AGE_NONE || a->age[i] > a->frame - a->since)
			continue;
		frame = a->frame - a->age[i];
		if (fdp_share_newest(&n->share, i) >= frame)
			continue;
		slice = fdp_share_place(&n->share, i, frame);
		if (slice &&
		    fdp_share_ask(&n->share, i, slice, FDP_SLICE_PIECES_MAX, false, now_ns, &lack))
			send_lack(n, &lack);
	}
}

/* Late is what should be used in `frame` and is not whole, or came too late for the frame before.
 */
static void count_late(struct fdp_node *n, struct fdp_slice *slice, uint64_t frame)
{
	if (!slice->frame || slice->frame >= frame || slice->late || slice->given)
		return;
	if (fdp_slice_whole(slice) && slice->frame >= n->slices_frame)
		return;
	slice->late = true;
	n->share.counts.late++;
}

void fdp_node_slices(struct fdp_node *n, uint64_t frame, fdp_node_slice_fn *fn, void *ctx)
{
	unsigned own;

	if (!sharing(n, &own))
		return;
	for (unsigned i = 0; i < n->share.count; i++) {
		struct fdp_slice *lanes = n->share.slices[i], *best = NULL;

		if (i == own)
			continue;
		for (unsigned lane = 0; lane < FDP_SHARE_LANES; lane++) {
			struct fdp_slice *slice = &lanes[lane];

			count_late(n, slice, frame);
			if (fdp_slice_whole(slice) && slice->frame < frame &&
			    (!best || slice->frame > best->frame))
				best = slice;
		}
		if (best && !best->given)
			fn(ctx, fdp_share_bytes(&n->share, i, best), best->len);
		if (best)
			best->given = true;
	}
	n->slices_frame = frame;
}

void fdp_node_share_tick(struct fdp_node *n, int64_t now_ns)
{
	unsigned own;

	if (!sharing(n, &own))
		return;
	if (n->sending.frame && now_ns >= n->sending.at_ns)
		send_some(n, own, now_ns);
	if (!n->share.open)
		return;
	for (unsigned i = 0; i < n->share.count; i++)
		for (unsigned lane = 0; lane < FDP_SHARE_LANES; lane++) {
			struct fdp_slice *slice = &n->share.slices[i][lane];
			struct fdp_lack lack;

			if (i != own &&
			    now_ns >= fdp_share_ask_at(&n->share, i, slice, n->retry_ns) &&
			    fdp_share_ask(&n->share, i, slice, FDP_SLICE_PIECES_MAX, true, now_ns,
					  &lack))
				send_lack(n, &lack);
		}
}

int64_t fdp_node_share_next(const struct fdp_node *n)
{
	int64_t next = INT64_MAX;
	unsigned own;

	if (!sharing(n, &own))
		return next;
	if (n->sending.frame)
		next = n->sending.at_ns;
	if (!n->share.open)
		return next;
	for (unsigned i = 0; i < n->share.count; i++)
		for (unsigned lane = 0; lane < FDP_SHARE_LANES; lane++) {
			const int64_t at = fdp_share_ask_at(&n->share, i, &n->share.slices[i][lane],
							    n->retry_ns);

			next = i != own && at < next ? at : next;
		}
	return next;
}

void fdp_node_share(const struct fdp_node *n, struct fdp_share_counts *out)
{
	*out = n->share.counts;
}
