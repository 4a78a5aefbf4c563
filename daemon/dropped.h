/*
 * Datagrams that a daemon dropped, by reason: a line a minute for each, and
 * at the end what no line has told yet. One thread; never allocates.
 */
#ifndef GROTTO_DAEMON_DROPPED_H
#define GROTTO_DAEMON_DROPPED_H

#include "base/log.h"
#include "daemon/socket.h"

#include <stdint.h>

#define DROPPED_REASONS 16 /* negative results (base/result.h) */

/* Zero-initialise. */
struct dropped {
	struct gr_log_limit reasons[DROPPED_REASONS];
};

/* result: what the protocol said to the datagram; now_ns: CLOCK_MONOTONIC. */
void dropped_add(struct dropped *dropped, int result, const struct net_address *from,
		 int64_t now_ns);
/* A line for each reason of which some are not told yet; then none are left. */
void dropped_finish(struct dropped *dropped);

#endif
