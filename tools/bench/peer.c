#include <config.h> /* ppoll */

#include "tools/bench/peer.h"

#include "base/clock.h"

#include <poll.h>

#define FDS_MOST 8

const struct peer *const peers[PEERS] = {
	&peer_tcp, &peer_enet, &peer_norm, &peer_norm_parity, &peer_pgm,
};

void peer_wait(const int *fds, unsigned count, int64_t until_ns)
{
	struct pollfd polled[FDS_MOST];
	int64_t left_ns = until_ns - gr_clock_now(&gr_clock_monotonic);
	struct timespec ts;

	left_ns = left_ns < 0 ? 0 : left_ns > PEER_WAITS_MOST_NS ? PEER_WAITS_MOST_NS : left_ns;
	ts = (struct timespec){ .tv_nsec = (long)left_ns };
	count = count < FDS_MOST ? count : FDS_MOST;
	for (unsigned i = 0; i < count; i++)
		polled[i] = (struct pollfd){ .fd = fds[i], .events = POLLIN };
	ppoll(polled, count, &ts, NULL);
}
