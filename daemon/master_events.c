/* What the protocol tells the master: who comes and goes, who is late, who may not. */
#include "daemon/master_pace.h"
#include "daemon/master_private.h"

#include "base/clock.h"

#include <inttypes.h>

const char *master_node_name(const struct master *m, int node)
{
	return node >= 0 && (size_t)node < m->params.layout->node_count ?
		       m->params.layout->nodes[node].name : "?";
}

size_t master_members(const struct master *m)
{
	return (size_t)__builtin_popcountll(m->members);
}

void master_node_gone(struct master *m, int node)
{
	m->members &= ~(UINT64_C(1) << node);
	m->behind &= ~(UINT64_C(1) << node);
	frame_stats_gone(&m->stats, (unsigned)node);
	if (m->params.live)
		live_source_node_gone(m->params.live, (unsigned)node);
}

/* Recordings of two JOINs in turns can have a node refused without end: into the log and the record goes one a minute. */
static void node_refused(struct master *m, const struct fdp_master_event *event, int64_t now_ns)
{
	struct gr_log_limit *limit = &m->refused_limit[event->node < 0 ? 0 : event->node % FDP_MAX_NODES];
	uint64_t times;

	m->refused++;
	if (!gr_log_limit(limit, now_ns, &times))
		return;
	recorder_event(m->recorder, now_ns, event);
	gr_error("node %s may not join: %s", master_node_name(m, event->node),
		 event->reason ? event->reason : "no reason given");
}

static void node_mismatch(struct master *m, const struct fdp_master_event *event, int64_t now_ns)
{
	uint64_t times;

	if (gr_log_limit(&m->mismatch_limit, now_ns, &times))
		gr_error("node %s holds another state at frame %" PRIu64 ": ours %016" PRIx64
			 ", its %016" PRIx64 "; it gets a snapshot (%" PRIu64 " since the last line)",
			 master_node_name(m, event->node), event->frame, event->ours, event->theirs, times);
}

static void note_way(struct master *m, const struct fdp_master_event *event, int64_t now_ns)
{
	const struct layout_network *network = &m->params.layout->network;
	uint64_t times;

	m->deaf = event->way == FDP_WAY_GROUP ? -1 : event->node;
	if (!gr_log_limit(&m->way_limit, now_ns, &times))
		return;
	if (event->way == FDP_WAY_GROUP)
		gr_notice("all nodes hear %s: frames go by multicast", network->group);
	else
		gr_warning("node %s does not hear %s: frames go to each node by itself (a switch that "
			   "snoops IGMP needs a querier; \"ip maddr\" on the node shows whether it has joined; "
			   "%" PRIu64 " changes since the last line)", master_node_name(m, event->node),
			   network->group, times);
}

void master_on_event(void *ctx, const struct fdp_master_event *event)
{
	struct master *m = ctx;
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
	uint64_t times;

	if (event->node >= (int)m->params.layout->node_count) {
		master_role_event(m, event);
		return;
	}
	if (event->kind != FDP_MASTER_REFUSED)
		recorder_event(m->recorder, now_ns, event);
	switch (event->kind) {
	case FDP_MASTER_JOINED:
		/* Counts from the next frame on. */
		m->joined++;
		m->members |= UINT64_C(1) << event->node;
		m->restart_light = true;
		gr_notice("node %s joined: %zu of %zu", master_node_name(m, event->node), master_members(m),
			  m->params.layout->node_count);
		break;
	case FDP_MASTER_LEFT:
		master_node_gone(m, event->node);
		gr_notice("node %s left: %s", master_node_name(m, event->node),
			  event->reason ? event->reason : "no reason given");
		break;
	case FDP_MASTER_REFUSED: node_refused(m, event, now_ns); break;
	case FDP_MASTER_LATE:
		m->late++;
		m->behind |= UINT64_C(1) << event->node;
		if (gr_log_limit(&m->late_limit, now_ns, &times))
			gr_warning("node %s was late for frame %" PRIu64 " (%" PRIu64 " since the last line)",
				   master_node_name(m, event->node), event->frame, times);
		break;
	case FDP_MASTER_EVICTED:
		m->evicted++;
		master_node_gone(m, event->node);
		master_note_evicted(m, event);
		break;
	case FDP_MASTER_PACE: master_note_pace(m, event, now_ns); break;
	case FDP_MASTER_MISMATCH: node_mismatch(m, event, now_ns); break;
	case FDP_MASTER_FOLLOWED: break;
	case FDP_MASTER_OUTRANKED: master_role_event(m, event); break;
	case FDP_MASTER_WAY: note_way(m, event, now_ns); break;
	case FDP_MASTER_SWAP:
		m->swap_ns = now_ns;
		recorder_swap(m->recorder, now_ns, event->frame, event->swap_ns);
		frame_stats_swap_sent(&m->stats, event->frame, event->swap_ns != 0, now_ns);
		notify_feed(&m->notify, now_ns);
		break;
	}
}

