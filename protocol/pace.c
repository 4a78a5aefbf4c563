#include "protocol/pace.h"

static const char *const names[] = {
	[FDP_PACE_IN_STEP] = "in step",
	[FDP_PACE_SLOW] = "slow",
	[FDP_PACE_HALF] = "half rate",
	[FDP_PACE_EVICTED] = "evicted for slowness",
};

const char *fdp_pace_state_name(enum fdp_pace_state state)
{
	return (unsigned)state < sizeof names / sizeof *names ? names[state] : "unknown";
}

struct fdp_pace_params fdp_pace_complete(const struct fdp_pace_params *params, int64_t deadline_ns)
{
	struct fdp_pace_params p = *params;

	p.limit_ns = p.limit_ns ? p.limit_ns : deadline_ns;
	p.frames = p.frames ? p.frames : FDP_PACE_FRAMES;
	p.wait_most_ns = p.wait_most_ns ? p.wait_most_ns : FDP_PACE_WAIT_NS;
	p.rejoin_most_ns = p.rejoin_most_ns ? p.rejoin_most_ns : FDP_PACE_REJOIN_NS;
	return p;
}

static unsigned factor(const struct fdp_pace *pace)
{
	return 1u << (pace->relapses < FDP_PACE_RELAPSES ? pace->relapses : FDP_PACE_RELAPSES);
}

static void enter(struct fdp_pace *pace, enum fdp_pace_state state, int64_t now_ns)
{
	pace->state = state;
	pace->since_ns = now_ns;
	pace->steady = 0;
	pace->score = 0;
}

/* Out of step, in the way that the policy has for it. */
static void fall_back(struct fdp_pace *pace, const struct fdp_pace_params *p, int64_t now_ns)
{
	const bool again = pace->since_ns && pace->steady < 8 * (uint64_t)p->frames * factor(pace);
	unsigned doublings;
	int64_t out_ns;

	pace->relapses = again ? pace->relapses + 1 : 0;
	enter(pace,
	      p->policy == FDP_SLOW_WAIT   ? FDP_PACE_SLOW
	      : p->policy == FDP_SLOW_HALF ? FDP_PACE_HALF
					   : FDP_PACE_EVICTED,
	      now_ns);
	pace->score = p->frames * factor(pace);
	if (pace->state != FDP_PACE_EVICTED)
		return;
	doublings = pace->relapses < 16 ? pace->relapses : 16;
	out_ns = doublings ? FDP_PACE_OUT_NS << (doublings - 1) : 0;
	pace->out_until_ns = now_ns + (out_ns < p->rejoin_most_ns ? out_ns : p->rejoin_most_ns);
}

bool fdp_pace_frame(struct fdp_pace *pace, const struct fdp_pace_params *p, bool slow,
		    int64_t now_ns)
{
	if (pace->state == FDP_PACE_IN_STEP) {
		pace->steady += !slow;
		if (slow)
			pace->score++;
		else if (pace->score)
			pace->score--;
		if (pace->score < p->frames)
			return false;
		fall_back(pace, p, now_ns);
		return true;
	}
	if (pace->state == FDP_PACE_EVICTED)
		return false;
	if (slow) {
		if (pace->score < p->frames * factor(pace))
			pace->score++;
		return false;
	}
	if (--pace->score)
		return false;
	enter(pace, FDP_PACE_IN_STEP, now_ns);
	return true;
}

bool fdp_pace_too_late(struct fdp_pace *pace, const struct fdp_pace_params *p, int64_t now_ns)
{
	struct fdp_pace_params out = *p;

	if (p->policy == FDP_SLOW_HALF && pace->state == FDP_PACE_IN_STEP) {
		fall_back(pace, p, now_ns);
		return true;
	}
	/* At half the rate, or waited for, and still too late: nothing else is left. */
	out.policy = FDP_SLOW_EVICT;
	fall_back(pace, &out, now_ns);
	return false;
}

void fdp_pace_join(struct fdp_pace *pace, int64_t now_ns)
{
	pace->score = 0;
	if (pace->state == FDP_PACE_IN_STEP)
		return;
	enter(pace, FDP_PACE_IN_STEP, now_ns);
}
