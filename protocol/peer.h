/* A node as the master sees it: a pure state machine, drawn in docs/protocol.md. */
#ifndef GROTTO_PROTOCOL_PEER_H
#define GROTTO_PROTOCOL_PEER_H

#include "protocol/master.h"

enum fdp_peer_event {
	FDP_PEER_JOINS,    /* asked, and echoed the challenge */
	FDP_PEER_COMMITS,  /* its snapshot is acknowledged and a frame begins */
	FDP_PEER_READIES,  /* for the frame under way */
	FDP_PEER_MISSES,   /* a barrier */
	FDP_PEER_EXPIRES,  /* missed too many, or went silent while joining */
	FDP_PEER_LEAVES,   /* said so */
	FDP_PEER_FOLLOWED, /* a master: its snapshot is acknowledged */
	FDP_PEER_EVENTS
};

/* Events that mean nothing in a state leave it as it is. */
enum fdp_peer_state fdp_peer_next(enum fdp_peer_state state, enum fdp_peer_event event);

static inline bool fdp_peer_counts(enum fdp_peer_state state)
{
	return state == FDP_PEER_LIVE || state == FDP_PEER_LATE;
}

static inline bool fdp_peer_present(enum fdp_peer_state state)
{
	return state == FDP_PEER_JOINING || state == FDP_PEER_FOLLOWS || fdp_peer_counts(state);
}

#endif
