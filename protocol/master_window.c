/* What is on its way to each node, and whether more may be: window.h. */
#include "protocol/master_private.h"

#define BIT(node) (UINT64_C(1) << (node))

void fdp_master_count_sent(struct fdp_master *m, int to, const uint8_t *bytes, size_t len)
{
	const uint64_t cost = fdp_window_cost(len);

	/* A recorded JOIN brings answers, and may close no window. */
	if (1u << bytes[FDP_KIND_AT] & FDP_HANDSHAKE)
		return;
	if (to >= 0)
		m->peers[to].window_out.own += cost;
	else
		m->sent_to_all += cost;
}

/* Of a message in fragments. */
static uint64_t cost_of(const struct fdp_master *m, size_t bytes)
{
	const uint64_t count = fdp_fragment_count(bytes, m->out.datagram_max);

	return 2 * (bytes + count * FDP_HEADER_BYTES) + count * fdp_window_cost(0);
}

bool fdp_master_has_room(const struct fdp_master *m, unsigned node, size_t bytes, bool hurries)
{
	return fdp_window_fits(&m->peers[node].window_out, m->sent_to_all, cost_of(m, bytes),
			       hurries);
}

uint64_t fdp_master_with_room(const struct fdp_master *m, uint64_t nodes, size_t bytes)
{
	uint64_t with = 0;

	for (unsigned i = 0; i < m->params.node_count; i++)
		if (nodes & BIT(i) && fdp_master_has_room(m, i, bytes, true))
			with |= BIT(i);
	return with;
}

void fdp_master_mark_frame(struct fdp_master *m, uint64_t nodes)
{
	for (size_t i = 0; i < fdp_master_peers(m); i++)
		if (nodes & BIT(i))
			fdp_window_mark_frame(&m->peers[i].window_out, m->sent_to_all, m->frame);
}

void fdp_master_mark_time(struct fdp_master *m, int to, int64_t sent_ns)
{
	const size_t first = to < 0 ? 0 : (size_t)to,
		     end = to < 0 ? m->params.node_count : first + 1;

	for (size_t i = first; i < end; i++)
		fdp_window_mark_time(&m->peers[i].window_out, m->sent_to_all, (uint32_t)sent_ns);
}

void fdp_master_note_taken(struct fdp_master *m, unsigned node, const struct fdp_report *report)
{
	fdp_window_heard(&m->peers[node].window_out, report->frame, report->echo_low);
}

void fdp_master_note_vitals(struct fdp_master *m, unsigned node, const struct fdp_vitals *vitals)
{
	struct fdp_peer *peer = &m->peers[node];

	peer->status.vitals = *vitals;
	peer->window_out.room = vitals->receive_bytes;
}
