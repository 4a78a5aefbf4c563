#include "protocol/peer.h"

static const char *const names[] = {
	[FDP_PEER_ABSENT] = "absent", [FDP_PEER_JOINING] = "joining", [FDP_PEER_LIVE] = "live",
	[FDP_PEER_LATE] = "late",     [FDP_PEER_DEAD] = "dead",
	[FDP_PEER_FOLLOWS] = "follows",
};

const char *fdp_peer_state_name(enum fdp_peer_state state)
{
	return (unsigned)state < sizeof names / sizeof *names ? names[state] : "unknown";
}

enum fdp_peer_state fdp_peer_next(enum fdp_peer_state state, enum fdp_peer_event event)
{
	switch (event) {
	case FDP_PEER_JOINS:
		return FDP_PEER_JOINING;
	case FDP_PEER_COMMITS:
		return state == FDP_PEER_JOINING ? FDP_PEER_LIVE : state;
	case FDP_PEER_READIES:
		return state == FDP_PEER_LATE ? FDP_PEER_LIVE : state;
	case FDP_PEER_MISSES:
		return state == FDP_PEER_LIVE ? FDP_PEER_LATE : state;
	case FDP_PEER_EXPIRES:
		return fdp_peer_present(state) ? FDP_PEER_DEAD : state;
	case FDP_PEER_LEAVES:
		return fdp_peer_present(state) ? FDP_PEER_ABSENT : state;
	case FDP_PEER_FOLLOWED:
		return state == FDP_PEER_JOINING ? FDP_PEER_FOLLOWS : state;
	case FDP_PEER_EVENTS:
		break;
	}
	return state;
}
