#include "daemon/master_pace.h"

#include "base/clock.h"
#include "daemon/master.h"

#include <math.h>
#include <stdio.h>

#define WHY_MAX 256

_Static_assert((int)LAYOUT_SLOW_EVICT == (int)FDP_SLOW_EVICT &&
		       (int)LAYOUT_SLOW_WAIT == (int)FDP_SLOW_WAIT &&
		       (int)LAYOUT_SLOW_HALF == (int)FDP_SLOW_HALF,
	       "what the layout says goes to the protocol as it is");

struct fdp_pace_params master_pace_params(const struct layout *layout)
{
	const struct layout_slow *slow = &layout->slow;
	struct fdp_pace_params params = {
		.policy = (enum fdp_slow)slow->policy,
		.limit_ns = slow->limit_ns,
		.frames = (unsigned)slow->frames,
		.wait_most_ns = slow->wait_most_ns,
		.rejoin_most_ns = slow->rejoin_most_ns,
	};
	const int64_t half_ns = llrint(1.5e9 / (double)layout->rates.frame_hz);

	/* At half the rate a node has two frames' time, and the others must have one. */
	if (params.policy == FDP_SLOW_HALF && !params.limit_ns &&
	    half_ns < layout->rates.barrier_deadline_ns)
		params.limit_ns = half_ns;
	return params;
}

/* What is known of where its time goes. */
static void say_why(const struct master *m, const struct fdp_peer_status *peer, char why[WHY_MAX])
{
	const struct fdp_pace_params params = master_pace_params(m->params.layout);
	const int64_t limit_ns =
		params.limit_ns ? params.limit_ns : m->params.layout->rates.barrier_deadline_ns;
	const double ready_ms = (double)peer->ready_after_ns * 1e-6,
		     draws_ms = (double)peer->render_us * 1e-3;
	const struct fdp_vitals_stage *longest = fdp_vitals_longest(&peer->vitals);
	char stage[FDP_VITALS_NAME + 40] = "";

	if (longest)
		snprintf(stage, sizeof stage, ", of which %s takes %.1f", longest->name,
			 longest->us * 1e-3);
	snprintf(why, WHY_MAX,
		 "last ready %.1f ms after its frame began, %.1f are allowed; it draws for "
		 "%.1f ms%s%s",
		 ready_ms, (double)limit_ns * 1e-6, draws_ms, stage,
		 draws_ms < ready_ms / 2 ? ", so most of it goes by on the way or before it draws"
					 : "");
}

void master_note_pace(struct master *m, const struct fdp_master_event *event, int64_t now_ns)
{
	const char *name = m->params.layout->nodes[event->node].name;
	struct fdp_peer_status peer;
	char why[WHY_MAX], back[32] = "at once";

	fdp_master_peer(m->fdp, (size_t)event->node, &peer);
	say_why(m, &peer, why);
	switch (event->pace) {
	case FDP_PACE_IN_STEP: gr_notice("node %s keeps up again", name); break;
	case FDP_PACE_SLOW:
		gr_warning("node %s does not keep up: %s. All wait for it (slow.policy)", name,
			   why);
		break;
	case FDP_PACE_HALF:
		/* Its light does fewer steps than the others' until it is back. */
		m->behind |= UINT64_C(1) << event->node;
		gr_warning("node %s does not keep up: %s. It shows every second frame from now on, "
			   "the others all (slow.policy)",
			   name, why);
		break;
	case FDP_PACE_EVICTED:
		if (peer.out_until_ns > now_ns)
			snprintf(back, sizeof back, "in %.0f s",
				 ceil((double)(peer.out_until_ns - now_ns) * 1e-9));
		gr_error("node %s does not keep up: %s. It is left out and may join again %s "
			 "(slow.policy)",
			 name, why, back);
		break;
	}
}

void master_note_evicted(struct master *m, const struct fdp_master_event *event)
{
	if (event->pace != FDP_PACE_EVICTED)
		gr_error("node %s is gone: it missed %d frames in a row; the room goes on without "
			 "it (if it lives, rates.barrier_deadline_ms is too short for it)",
			 m->params.layout->nodes[event->node].name,
			 m->params.layout->rates.evict_frames);
}

void master_write_pace(struct json *json, const struct fdp_peer_status *peer, int64_t now_ns)
{
	json_string(json, "pace", fdp_pace_state_name(peer->pace));
	if (peer->pace != FDP_PACE_IN_STEP)
		json_f64(json, "pace_for_s", (double)(now_ns - peer->pace_since_ns) * 1e-9);
	if (peer->pace == FDP_PACE_EVICTED && peer->out_until_ns > now_ns)
		json_f64(json, "out_for_s", (double)(peer->out_until_ns - now_ns) * 1e-9);
}

void master_write_stages(struct json *json, const struct fdp_peer_status *peer)
{
	json_open(json, "stages", '[');
	for (unsigned i = 0; i < peer->vitals.count; i++) {
		json_open(json, NULL, '{');
		json_string(json, "name", peer->vitals.stages[i].name);
		json_f64(json, "ms", peer->vitals.stages[i].us * 1e-3);
		json_close(json, '}');
	}
	json_close(json, ']');
}
