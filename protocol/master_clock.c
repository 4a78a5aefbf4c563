/*
 * The master's part in time: where each node's clock stands, what it says back
 * so that the nodes know where the master's does, and the time at which to swap.
 */
#include "protocol/master_private.h"

#include <string.h>

#define LEAD_LEAST_NS 50000 /* a wake-up of the slowest node, beyond what was seen of it */

void fdp_master_clock_forget(struct fdp_peer *peer)
{
	fdp_clock_reset(&peer->clock);
	peer->echo_due = false;
	peer->path_count = 0;
	peer->echoes = 0;
}

void fdp_master_note_clock(struct fdp_master *m, unsigned node, const struct fdp_report *report,
			   int64_t arrived_ns)
{
	struct fdp_peer *peer = &m->peers[node];
	const struct fdp_exchange exchange = {
		.left_ns = fdp_whole_time(report->echo_low, arrived_ns),
		.peer_arrived_ns = (int64_t)((uint64_t)report->sent_ns - report->held_ns),
		.peer_left_ns = report->sent_ns,
		.arrived_ns = arrived_ns,
	};

	if (report->echo_low)
		fdp_clock_take(&peer->clock, &exchange);
	peer->echo_due = true;
	peer->echo_sent_ns = report->sent_ns;
	peer->echo_arrived_ns = arrived_ns;
	peer->status.swaps_late = report->swaps_late;
}

/* How long the way of a SWAP took: once a frame. */
void fdp_master_note_path(struct fdp_peer *peer, uint32_t path_ns)
{
	if (!path_ns)
		return;
	peer->path_ns[peer->path_count++ % FDP_PATHS] = path_ns;
	peer->status.path_ns = path_ns;
}

static void say_back(struct fdp_master *m, unsigned node, struct fdp_announce *a)
{
	struct fdp_peer *peer = &m->peers[node];
	const int64_t held_ns = m->now_ns - peer->echo_arrived_ns;

	if (!peer->echo_due || held_ns < 0 || held_ns > UINT32_MAX || a->echoes == FDP_ECHOES_MOST)
		return;
	peer->echo_due = false;
	peer->echoes++;
	a->echo[a->echoes++] = (struct fdp_echo){
		.node = (uint16_t)node, .held_ns = (uint32_t)held_ns, .sent_low = (uint32_t)peer->echo_sent_ns
	};
}

/* In a datagram to all: two a SWAP keep a few clocks; until all have theirs, what there is room for. */
static unsigned echoes_to_say(const struct fdp_master *m)
{
	for (size_t i = 0; i < m->params.node_count; i++)
		if (m->peers[i].echo_due && m->peers[i].echoes < FDP_ECHOES_FIRST)
			return FDP_ECHOES_MOST;
	return m->params.node_count <= FDP_ECHOES_FEW ? 2 : FDP_ECHOES_MOST;
}

void fdp_master_say_time(struct fdp_master *m, int to, struct fdp_announce *a)
{
	const unsigned count = (unsigned)m->params.node_count, from = m->echo_next;

	a->sent_ns = m->now_ns;
	a->swap_ns = m->swap_ns;
	if (to >= 0) {
		say_back(m, (unsigned)to, a);
		return;
	}
	/* One datagram for all has room for a few: they take turns. */
	for (unsigned i = 0; i < count && a->echoes < echoes_to_say(m); i++) {
		const unsigned node = (from + i) % count;

		say_back(m, node, a);
		m->echo_next = (node + 1) % count;
	}
}

/*
 * The longest of the last FDP_PATHS ways but one: who was held up once need
 * not make all wait from then on.
 */
static uint32_t path_of(const struct fdp_peer *peer)
{
	const unsigned count = peer->path_count < FDP_PATHS ? (unsigned)peer->path_count : FDP_PATHS;
	uint32_t most = 0, second = 0;

	for (unsigned i = 0; i < count; i++) {
		const uint32_t path = peer->path_ns[i];

		if (path >= most) {
			second = most;
			most = path;
		} else if (path > second) {
			second = path;
		}
	}
	return count < FDP_PATHS / 2 ? most : second;
}

static bool clock_is_good(const struct fdp_peer *peer, int64_t now_ns)
{
	struct fdp_clock_estimate estimate;

	fdp_clock_estimate(&peer->clock, now_ns, &estimate);
	return estimate.known && estimate.error_ns <= FDP_SWAP_ERROR_MOST_NS && peer->path_count;
}

int64_t fdp_master_swap_time(const struct fdp_master *m, uint64_t live, int64_t now_ns)
{
	uint32_t path = 0;
	unsigned good = 0, all = 0;
	int64_t lead_ns;

	if (m->params.swap == FDP_SWAP_MESSAGE)
		return 0;
	for (unsigned i = 0; i < m->params.node_count; i++) {
		const struct fdp_peer *peer = &m->peers[i];

		if (!(live >> i & 1))
			continue;
		all++;
		if (!clock_is_good(peer, now_ns))
			continue;
		good++;
		if (path_of(peer) > path)
			path = path_of(peer);
	}
	/* Who does not know the time swaps when told: by itself, or all with it. */
	if (!good || (m->params.swap == FDP_SWAP_AUTO && good < all))
		return 0;
	lead_ns = path + (path / 4 > LEAD_LEAST_NS ? path / 4 : LEAD_LEAST_NS);
	return now_ns + (lead_ns < m->params.swap_lead_most_ns ? lead_ns : m->params.swap_lead_most_ns);
}

void fdp_master_arrived(struct fdp_master *m, int64_t arrived_ns)
{
	m->arrived_ns = arrived_ns;
}
