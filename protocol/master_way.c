/*
 * How datagrams for all go: once to the group, or to each node by itself. Where
 * the group is only to be used if it works, every node says whether it hears it.
 * The room goes one way: what is one datagram for some and many for others would
 * be two protocols, and to few nodes the group saves little (docs/protocol.md).
 */
#include "protocol/master_private.h"

#define BIT(node) (UINT64_C(1) << (node))

/* The first of the nodes that has not heard the group, though it has been in for so long; -1: none. */
static int find_deaf(const struct fdp_master *m, uint64_t nodes, int64_t now_ns, int64_t for_ns)
{
	for (size_t i = 0; i < m->params.node_count; i++)
		if (nodes & BIT(i) && !m->peers[i].status.hears_group &&
		    now_ns - m->peers[i].joined_ns >= for_ns)
			return (int)i;
	return -1;
}

void fdp_master_choose_way(struct fdp_master *m, uint64_t live, int64_t now_ns)
{
	struct fdp_master_event event = { .kind = FDP_MASTER_WAY, .node = -1, .frame = m->frame };
	enum fdp_way told = m->told_way;

	if (!m->params.probe_group)
		return;
	m->group = live && find_deaf(m, live, now_ns, 0) < 0;
	if (m->group) {
		told = FDP_WAY_GROUP;
	} else if (live) {
		/* Who has just come has had no time to hear it. */
		event.node = find_deaf(m, live, now_ns, FDP_GROUP_PATIENCE_NS);
		told = event.node >= 0 ? FDP_WAY_EACH : told;
	}
	if (told == m->told_way)
		return;
	m->told_way = told;
	event.way = told;
	fdp_master_say(m, &event);
}

void fdp_master_probe_group(struct fdp_master *m)
{
	if (m->params.probe_group && !m->group)
		fdp_master_announce(m, FDP_TO_GROUP, FDP_PROBE);
}

/* As long as somebody is missing: how nodes that wait, or sit in an older session, find us. */
void fdp_master_send_beacon(struct fdp_master *m)
{
	const uint64_t present = fdp_master_mask(m, fdp_peer_present);
	/* Who is not in has not said whether it hears a group that is not sure to work. */
	const bool group = m->group && !m->params.probe_group;

	for (size_t i = 0; i < m->params.node_count; i++) {
		if (present & BIT(i))
			continue;
		fdp_outbox_send(&m->out, group ? FDP_TO_GROUP : (int)i, FDP_BEACON,
				fdp_beacon_encode(fdp_outbox_body(&m->out), FDP_BODY_MAX));
		if (group)
			return;
	}
}

enum fdp_way fdp_master_way(const struct fdp_master *m)
{
	return m->group ? FDP_WAY_GROUP : FDP_WAY_EACH;
}
