/*
 * Does everybody hold the recorded state? Compares the hash of each replayed
 * frame, on the master and in the answers of the nodes, with the recorded one.
 * Pure, fixed size.
 */
#ifndef GROTTO_DAEMON_REPLAY_CHECK_H
#define GROTTO_DAEMON_REPLAY_CHECK_H

#include <stdbool.h>
#include <stdint.h>

#define REPLAY_CHECK_OPEN 64 /* frames whose answers may be under way at once */
#define REPLAY_CHECK_MASTER (-1)

struct replay_open {
	uint64_t frame; /* 0: unused */
	uint64_t hash;  /* recorded */
	uint64_t live, right, wrong; /* bit per node */
};

struct replay_difference {
	uint64_t frame; /* 0: none */
	int node;       /* or REPLAY_CHECK_MASTER */
	uint64_t recorded, found;
};

struct replay_check {
	uint64_t frames;     /* begun */
	uint64_t master_equal, node_equal; /* frames; answers, one of each node and frame */
	uint64_t different;  /* of both */
	uint64_t unanswered; /* a node that counted in the frame never said that it held it */
	struct replay_difference first;
	struct replay_open open[REPLAY_CHECK_OPEN];
};

/* A frame went out to the nodes in `live`; ours is the master's hash. */
void replay_check_begin(struct replay_check *check, uint64_t frame, uint64_t recorded, uint64_t ours,
			uint64_t live);
void replay_check_held(struct replay_check *check, unsigned node, uint64_t frame, uint64_t hash);
/* No more answers come; those of `cut_off` (0: none) were not waited for. */
void replay_check_end(struct replay_check *check, uint64_t cut_off);
/* After the end: there were frames, and master and nodes held the recorded state in each. */
bool replay_check_passed(const struct replay_check *check);

#endif
