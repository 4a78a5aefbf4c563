/*
 * The light that the nodes share out. Each node's slice is passed on piece by
 * piece as it comes, to all others, before SWAP as the wire keeps the order.
 * Nobody waits for it: what is missing is asked for beside the frame.
 *
 * What a node that holds the key can make the master send is bounded: in a
 * frame so much is passed on of each, and so much sent again to each.
 */
#include "protocol/master_private.h"

#define BIT(node) (UINT64_C(1) << (node))

/* What a node needs that holds nothing; and something for slices that grow. */
static uint64_t held_bytes(const struct fdp_master *m)
{
	uint64_t bytes = 65536;

	for (unsigned i = 0; i < m->share.count; i++) {
		const struct fdp_slice *lanes = m->share.slices[i];

		bytes += lanes[0].len > lanes[1].len ? lanes[0].len : lanes[1].len;
	}
	return bytes;
}

/* Of each slice of the division one came whole. */
static bool all_came(const struct fdp_master *m)
{
	for (unsigned i = 0; i < m->share.count; i++)
		if (!fdp_share_newest(&m->share, i))
			return false;
	return true;
}

void fdp_master_share_begin(struct fdp_master *m, uint64_t live)
{
	uint64_t again;

	if (!m->share.room)
		return;
	/* A light that starts anew makes what is under way of the old one void. */
	if (live != m->shared || param_version(m->state, PARAM_GI_EPOCH) == m->frame) {
		m->shared = live;
		m->share_changed = 0;
		if (live)
			fdp_share_divide(&m->share, m->frame, (unsigned)__builtin_popcountll(live));
		else
			fdp_share_reset(&m->share);
		fdp_master_bulk_forget(m);
		m->fresh = live != 0;
	}
	m->fresh = m->fresh && !all_came(m);
	again = 4 * held_bytes(m);
	for (size_t i = 0; i < m->params.node_count; i++) {
		m->pass_budget[i] = 4 * fdp_share_slice_max(&m->share);
		m->lack_budget[i] = again;
	}
}

/* Where a node stands in the division; false when it has no part in it. */
static bool has_slice(const struct fdp_master *m, unsigned node, unsigned *out_index)
{
	*out_index = fdp_share_rank(m->shared, node);
	return m->share.count >= 2 && m->shared & BIT(node) &&
	       fdp_peer_counts(m->peers[node].state);
}

bool fdp_master_takes_slices(const struct fdp_master *m, unsigned node)
{
	unsigned index;

	return has_slice(m, node, &index);
}

static void send_lack(struct fdp_master *m, unsigned node, const struct fdp_lack *lack)
{
	for (int i = 0; i < (fdp_master_twice(m) ? 2 : 1); i++)
		fdp_outbox_send(&m->out, (int)node, FDP_LACK,
				fdp_lack_encode(lack, fdp_outbox_body(&m->out), FDP_BODY_MAX));
}

/* Whether so much, of this slice, may be passed on as it comes. */
static bool may_pass(struct fdp_master *m, const struct fdp_piece *piece, size_t len)
{
	static const struct fdp_rate rate = { FDP_PASS_BYTES_S, FDP_PASS_BURST };
	const uint64_t light = (uint64_t)piece->len * piece->count * (m->group ? 1 : piece->count - 1u);

	if (m->fresh && light > FDP_PASS_BURST)
		return false;
	fdp_bucket_fill(&m->passed, &rate, m->now_ns);
	if (m->passed.left < len)
		return false;
	m->passed.left -= len;
	return true;
}

/* To all that count but the one that it is from: at once, or when there is room. */
static void pass_on(struct fdp_master *m, unsigned from, const struct fdp_piece *piece, const uint8_t *body,
		    size_t len)
{
	const uint64_t to = m->shared & fdp_master_mask(m, fdp_peer_counts) & ~BIT(from);

	for (size_t i = 0; i < m->params.node_count; i++) {
		if (!(to & BIT(i)))
			continue;
		const int wire = m->group ? FDP_TO_GROUP : (int)i;

		m->share.counts.bytes_sent += len - FDP_PIECE_HEAD;
		if ((!m->group && !fdp_master_has_room(m, (unsigned)i, len, false)) || !may_pass(m, piece, len)) {
			fdp_master_want_piece(m, wire, piece->index, piece->frame, piece->at / piece->chunk);
		} else {
			memcpy(fdp_outbox_body(&m->out), body, len);
			fdp_outbox_send(&m->out, wire, FDP_SLICE, len);
		}
		if (m->group)
			break;
	}
}

static void count_whole(struct fdp_master *m, unsigned node, const struct fdp_slice *slice)
{
	const uint64_t others = m->shared & fdp_master_mask(m, fdp_peer_counts) & ~BIT(node);
	struct fdp_peer_status *status = &m->peers[node].status;
	const bool late = slice->frame < m->frame || !m->underway;

	m->share_changed = m->frame;
	m->share.counts.received++;
	m->share.counts.bytes_received += slice->len;
	m->share.counts.sent += (unsigned)__builtin_popcountll(others);
	m->share.counts.late += late;
	status->slices++;
	status->slice_bytes += slice->len;
	status->slices_late += late;
}

enum fdp_verdict fdp_master_on_slice(struct fdp_master *m, unsigned node, const uint8_t *body,
				     size_t len, int64_t now_ns)
{
	enum fdp_fragment_result result;
	struct fdp_slice *slice;
	struct fdp_piece piece;
	struct fdp_lack lack;
	unsigned index;

	if (fdp_piece_decode(body, len, &piece) || piece.frame > m->frame)
		return FDP_BAD_FORMAT;
	if (piece.since < m->share.since || !m->share.since)
		return FDP_GOOD; /* of a division gone by */
	if (!has_slice(m, node, &index) || piece.since != m->share.since || piece.index != index ||
	    piece.count != m->share.count)
		return FDP_BAD_FORMAT;
	if (m->pass_budget[node] < len)
		return FDP_GOOD;
	result = fdp_share_add(&m->share, &piece, body + FDP_PIECE_HEAD, now_ns, &slice);
	if (result == FDP_FRAGMENT_BAD)
		return FDP_BAD_FORMAT;
	if (result == FDP_FRAGMENT_AGAIN)
		return FDP_GOOD;
	m->pass_budget[node] -= len;
	pass_on(m, node, &piece, body, len);
	if (result == FDP_FRAGMENT_WHOLE)
		count_whole(m, node, slice);
	else if (fdp_share_ask(&m->share, index, slice, fdp_piece_sure(&piece), false, now_ns,
			       &lack))
		send_lack(m, node, &lack);
	return FDP_GOOD;
}

void fdp_master_note_slice(struct fdp_master *m, unsigned node, uint64_t frame, int64_t now_ns)
{
	struct fdp_slice *slice;
	struct fdp_lack lack;
	unsigned index;

	if (!frame || frame < m->share.since || frame > m->frame || !has_slice(m, node, &index))
		return;
	slice = fdp_share_place(&m->share, index, frame);
	if (!slice)
		return;
	if (fdp_share_ask(&m->share, index, slice, FDP_SLICE_PIECES_MAX, false, now_ns, &lack) ||
	    (now_ns >= fdp_share_ask_at(&m->share, index, slice, m->params.probe_ns) &&
	     fdp_share_ask(&m->share, index, slice, FDP_SLICE_PIECES_MAX, true, now_ns, &lack)))
		send_lack(m, node, &lack);
}

/*
 * Of a light that moves now or never: what is left out is asked for again, if it is
 * still of use. Of one that rests when there is time. False: no more now.
 */
static bool send_again(struct fdp_master *m, unsigned node, unsigned index, const struct fdp_slice *slice,
		       unsigned piece)
{
	size_t len;

	if (slice->frame + 1 < m->frame) {
		fdp_master_want_piece(m, (int)node, index, slice->frame, piece);
		return true;
	}
	len = fdp_share_write(&m->share, index, slice, piece, fdp_outbox_body(&m->out),
			      m->out.datagram_max - FDP_HEADER_BYTES);
	if (!len || !fdp_master_bulk(m, node, len))
		return false;
	fdp_outbox_send(&m->out, (int)node, FDP_SLICE, len);
	return true;
}

enum fdp_verdict fdp_master_on_lack(struct fdp_master *m, unsigned node, const uint8_t *body,
				    size_t len)
{
	const struct fdp_slice *slice;
	struct fdp_lack lack;

	if (fdp_lack_decode(body, len, &lack))
		return FDP_BAD_FORMAT;
	if (lack.since != m->share.since)
		return FDP_GOOD;
	if (lack.index >= m->share.count)
		return FDP_BAD_FORMAT;
	slice = fdp_share_find(&m->share, lack.index, lack.frame);
	if (!slice || !fdp_master_takes_slices(m, node))
		return FDP_GOOD;
	for (unsigned i = 0; i < slice->pieces; i++) {
		if (!fdp_slice_answers(slice, &lack, i) ||
		    fdp_master_waits(m, node, lack.index, lack.frame, i))
			continue;
		if (m->lack_budget[node] < slice->chunk || !send_again(m, node, lack.index, slice, i))
			break;
		m->lack_budget[node] -= slice->chunk;
		m->share.counts.repairs++;
	}
	fdp_master_bulk_tick(m, m->now_ns);
	return FDP_GOOD;
}

void fdp_master_say_slices(const struct fdp_master *m, enum fdp_kind kind, struct fdp_announce *a)
{
	const bool recent = m->share_changed && m->frame - m->share_changed < FDP_SAID_FRAMES;

	/* In a room where nothing changes SWAP need not repeat it, PROBE comes often enough. */
	if (m->share.count < 2 || (kind == FDP_SWAP && !recent))
		return;
	a->since = m->share.since;
	a->slices = (uint16_t)m->share.count;
	for (unsigned i = 0; i < m->share.count; i++) {
		const uint64_t newest = fdp_share_newest(&m->share, i);
		const uint64_t age = newest ? m->frame - newest : FDP_AGE_NONE;

		a->age[i] = age < FDP_AGE_NONE ? (uint32_t)age : FDP_AGE_NONE;
	}
}

unsigned fdp_master_share(const struct fdp_master *m, struct fdp_share_counts *out)
{
	*out = m->share.counts;
	return m->share.since ? m->share.count : 0;
}
