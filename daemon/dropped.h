/*
 * Datagrams that a daemon dropped: for each reason a line a minute and peer of
 * the layout, who share one with nobody; all strangers share one, so that what
 * is remembered of them is nothing. At the end what no line has told yet.
 * One thread; never allocates.
 */
#ifndef GROTTO_DAEMON_DROPPED_H
#define GROTTO_DAEMON_DROPPED_H

#include "base/log.h"
#include "config/layout.h"
#include "daemon/socket.h"

#include <stdint.h>

#define DROPPED_REASONS 16 /* negative results (base/result.h) */

/* Zero-initialise. */
struct dropped {
	/* [0]: strangers; [i + 1]: peer i */
	struct gr_log_limit limits[LAYOUT_MAX_NODES + 1][DROPPED_REASONS];
};

struct dropped_datagram {
	const struct net_address *from;
	int peer;         /* as net_peer says */
	const char *name; /* of that peer, as "node left"; NULL for a stranger */
	const uint8_t *bytes;
	size_t len;
};

/* result: what the protocol said to the datagram; now_ns: CLOCK_MONOTONIC. */
void dropped_add(struct dropped *dropped, int result, const struct dropped_datagram *datagram,
		 int64_t now_ns);
/* A line for each reason of which some are not told yet; then none are left. */
void dropped_finish(struct dropped *dropped);

#endif
