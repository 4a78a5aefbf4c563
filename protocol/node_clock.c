/* The node's part in time: where the master's clock stands, and what it says back. */
#include "protocol/node_private.h"

/* No master asks for more: a frame's part, at the lowest rate. */
#define AHEAD_MOST_NS INT64_C(1000000000)

void fdp_node_clock_reset(struct fdp_node *n)
{
	fdp_clock_reset(&n->clock);
	n->echo_ns = n->echo_arrived_ns = 0;
	n->swap_at_ns = 0;
	n->path_ns = n->swaps_late = 0;
}

void fdp_node_arrived(struct fdp_node *n, int64_t arrived_ns)
{
	n->arrived_ns = arrived_ns;
}

void fdp_node_say_time(const struct fdp_node *n, struct fdp_report *report, int64_t now_ns)
{
	const int64_t held_ns = now_ns - n->echo_arrived_ns;

	report->sent_ns = now_ns;
	report->path_ns = n->path_ns;
	report->swaps_late = n->swaps_late;
	if (!n->echo_ns || held_ns < 0 || held_ns > UINT32_MAX)
		return;
	report->echo_low = (uint32_t)n->echo_ns;
	report->held_ns = (uint32_t)held_ns;
}

void fdp_node_note_clock(struct fdp_node *n, const struct fdp_announce *a, int64_t arrived_ns)
{
	for (unsigned i = 0; i < a->echoes; i++) {
		const struct fdp_exchange exchange = {
			.left_ns = fdp_whole_time(a->echo[i].sent_low, arrived_ns),
			.peer_arrived_ns = (int64_t)((uint64_t)a->sent_ns - a->echo[i].held_ns),
			.peer_left_ns = a->sent_ns,
			.arrived_ns = arrived_ns,
		};

		if (a->echo[i].node == n->params.index)
			fdp_clock_take(&n->clock, &exchange);
	}
	if (a->sent_ns > n->echo_ns) {
		n->echo_ns = a->sent_ns;
		n->echo_arrived_ns = arrived_ns;
	}
}

static uint32_t path_of(const struct fdp_node *n, const struct fdp_announce *a, int64_t now_ns)
{
	const int64_t there_ns = fdp_clock_to_peer(&n->clock, now_ns);
	int64_t path_ns;

	/* Of no use: an offset that is off by more than the way is long. */
	if (__builtin_sub_overflow(there_ns, a->sent_ns, &path_ns))
		return 0;
	return path_ns < 1 ? 1 : path_ns > UINT32_MAX ? UINT32_MAX : (uint32_t)path_ns;
}

void fdp_node_note_swap(struct fdp_node *n, const struct fdp_announce *a, int64_t now_ns)
{
	struct fdp_clock_estimate estimate;
	int64_t at_ns, lead_ns;

	n->swap_at_ns = 0;
	fdp_clock_estimate(&n->clock, now_ns, &estimate);
	n->path_ns = estimate.known ? path_of(n, a, now_ns) : 0;
	if (!a->swap_ns || !estimate.known || estimate.error_ns > FDP_SWAP_ERROR_MOST_NS ||
	    __builtin_sub_overflow(a->swap_ns, a->sent_ns, &lead_ns) || lead_ns > AHEAD_MOST_NS)
		return;
	at_ns = fdp_clock_to_ours(&n->clock, a->swap_ns);
	/* It has been on its way: whatever the clocks are thought to be, the wait is no longer than the lead. */
	if (at_ns > n->arrived_ns + lead_ns)
		at_ns = n->arrived_ns + lead_ns;
	if (at_ns <= now_ns)
		n->swaps_late += n->current.ready && !n->current.swapped;
	else
		n->swap_at_ns = at_ns;
}

void fdp_node_clock(const struct fdp_node *n, int64_t now_ns, struct fdp_clock_estimate *out)
{
	fdp_clock_estimate(&n->clock, now_ns, out);
}
