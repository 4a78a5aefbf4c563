/*
 * What is sent again. On a multicast wire a repair goes to all, and answers
 * everybody who asks within a short window; who asks again, or where the wire
 * is not multicast, gets it alone. Either way a frame has a budget, so that no amount of asking can
 * fill the wire: what is left out is healed by the next frame's delta.
 */
#include "protocol/master_private.h"

#include <string.h>

void fdp_master_saw_loss(struct fdp_master *m)
{
	m->loss = FDP_LOSS_FRAMES;
}

int64_t fdp_master_wait(const struct fdp_master *m, uint64_t nodes)
{
	int64_t wait_ns = 0;

	for (size_t i = 0; i < m->params.node_count; i++) {
		const int64_t ns = fdp_trip_wait(&m->peers[i].trip, m->params.probe_ns);

		if (nodes >> i & 1 && ns > wait_ns)
			wait_ns = ns;
	}
	return wait_ns;
}

void fdp_master_begin_repairs(struct fdp_master *m)
{
	const size_t message = FDP_STATE_HEAD_MAX + param_delta_max();
	const size_t count = fdp_fragment_count(message, m->out.datagram_max);
	const uint64_t readers = m->group ? 4 : m->params.node_count * 4;

	m->repair_budget = (8 + readers) * (message + count * FDP_HEADER_BYTES);
	for (size_t i = 0; i < count; i++)
		m->repaired_ns[i] = INT64_MIN;
}

void fdp_master_want_snapshot(struct fdp_master *m, unsigned node)
{
	struct fdp_peer *peer = &m->peers[node];

	peer->status.acked = 0;
	peer->synced = false;
	peer->wants_snapshot = true;
	peer->snapshot_from = m->frame;
}

bool fdp_master_bulk(struct fdp_master *m, unsigned node, size_t bytes)
{
	struct fdp_bucket *one = &m->peers[node].bulk;

	fdp_bucket_fill(one, &m->bulk_node, m->now_ns);
	fdp_bucket_fill(&m->bulk, &m->bulk_all, m->now_ns);
	if (one->left < bytes || m->bulk.left < bytes || !fdp_master_has_room(m, node, bytes, false))
		return false;
	one->left -= bytes;
	m->bulk.left -= bytes;
	return true;
}

bool fdp_master_bulk_to_all(struct fdp_master *m, size_t bytes)
{
	fdp_bucket_fill(&m->bulk, &m->bulk_all, m->now_ns);
	if (m->bulk.left < bytes)
		return false;
	m->bulk.left -= bytes;
	return true;
}

void fdp_master_send_snapshot(struct fdp_master *m, unsigned node, int64_t now_ns)
{
	const uint64_t present = fdp_master_mask(m, fdp_peer_present);

	/* One for all who want it in this frame; made anew when the room has changed. */
	if (!m->snapshot.number || m->snapshot.frame != m->frame ||
	    m->snapshot_present != present)
		fdp_master_write_state(m, &m->snapshot, FDP_SNAPSHOT, 0);
	m->snapshot_present = present;
	m->peers[node].snapshot_ns = now_ns;
	/* If not now, then when it is due again. */
	if (!fdp_master_bulk(m, node, m->snapshot.len))
		return;
	fdp_outbox_post(&m->out, (int)node, &m->snapshot);
	fdp_master_mark_frame(m, UINT64_C(1) << node);
}

static bool spend(struct fdp_master *m, const struct fdp_letter *letter, unsigned index)
{
	size_t len;

	fdp_fragment_at(letter->len, m->out.datagram_max, index, &len);
	len += FDP_HEADER_BYTES;
	if (m->repair_budget < len)
		return false;
	m->repair_budget -= len;
	return true;
}

static void repair(struct fdp_master *m, unsigned node, const struct fdp_letter *letter,
		   unsigned index, int64_t now_ns)
{
	bool all = letter == &m->delta && m->group;

	if (all && m->repaired_ns[index] != INT64_MIN) {
		/* No node asks a second time before: this is another one. */
		if (now_ns - m->repaired_ns[index] < FDP_WAIT_LEAST_NS)
			return;
		all = false; /* perhaps this node does not hear the group at all */
	}
	if (!spend(m, letter, index))
		return;
	if (all)
		m->repaired_ns[index] = now_ns;
	m->counters.repairs++;
	fdp_outbox_again(&m->out, all ? FDP_TO_GROUP : (int)node, letter, index);
	/* To one node the NACK's own second copy brings it twice. */
	if (all && fdp_master_twice(m) && spend(m, letter, index))
		fdp_outbox_again(&m->out, FDP_TO_GROUP, letter, index);
}

/*
 * A node that has nothing of it, or all but its end, need not be asked first.
 * The others it costs no more than the PROBE that follows.
 */
void fdp_master_send_end_again(struct fdp_master *m, uint64_t nodes)
{
	const unsigned end = m->delta.count - 1u;
	/* Who does not answer to the group may not hear it. */
	const bool all = m->group && nodes & (nodes - 1) && m->probes == 1;

	if (!m->delta.number || m->delta.frame != m->frame)
		return;
	for (unsigned i = 0; i < m->params.node_count; i++) {
		if (!(nodes >> i & 1) || !fdp_master_has_room(m, i, 0, true))
			continue;
		if (!spend(m, &m->delta, end))
			return;
		m->counters.repairs++;
		fdp_outbox_again(&m->out, all ? FDP_TO_GROUP : (int)i, &m->delta, end);
		if (all)
			return;
	}
}

void fdp_master_on_nack(struct fdp_master *m, unsigned node, const struct fdp_nack *nack,
			int64_t now_ns)
{
	struct fdp_peer *peer = &m->peers[node];
	const struct fdp_letter *letter;

	if (nack->flags & FDP_NACK_SNAPSHOT) {
		fdp_master_want_snapshot(m, node);
		if (now_ns - peer->snapshot_ns >= m->params.probe_ns)
			fdp_master_send_snapshot(m, node, now_ns);
		return;
	}
	letter = nack->message == m->delta.number	   ? &m->delta
		 : nack->message == m->snapshot.number ? &m->snapshot
						       : NULL;
	/* Something older: the next delta carries it too. */
	if (!letter || letter->frame != m->frame || nack->count != letter->count)
		return;
	for (unsigned i = 0; i < letter->count; i++)
		if (fdp_bit(nack->missing, i))
			repair(m, node, letter, i, now_ns);
}
