#include "daemon/dropped.h"

#include "base/result.h"
#include "protocol/wire.h"

#include <inttypes.h>
#include <stdio.h>

static const char *reason_name(int result)
{
	switch (result) {
	case GR_ERR_AUTH: return "signed with another key";
	case GR_ERR_MISMATCH: return "of another session";
	case GR_ERR_REPLAY: return "said before, or to somebody else";
	case GR_ERR_VERSION: return "of another protocol version";
	default: return gr_result_name(result);
	}
}

/* What it says of itself, and what would be right; nothing of it is proven. */
static void write_reason(char *text, size_t size, int result, const struct dropped_datagram *d)
{
	if (result == GR_ERR_VERSION)
		snprintf(text, size, "it speaks protocol version %u, this daemon %u",
			 fdp_wire_version(d->bytes, d->len), (unsigned)FDP_VERSION);
	else if (result == GR_ERR_AUTH && d->name)
		snprintf(text, size, "signed with another key, or forged; both sides need the same network.key_file");
	else
		snprintf(text, size, "%s", reason_name(result));
}

void dropped_add(struct dropped *dropped, int result, const struct dropped_datagram *datagram,
		 int64_t now_ns)
{
	const int reason = result < 0 && result > -DROPPED_REASONS ? -result : 0;
	const int peer = datagram->peer >= 0 && datagram->peer < LAYOUT_MAX_NODES ? datagram->peer + 1 : 0;
	struct gr_log_limit *limit = &dropped->limits[peer][reason];
	char address[NET_ADDRESS_TEXT], why[128];
	uint64_t times;

	if (!gr_log_limit(limit, now_ns, &times))
		return;
	net_address_text(datagram->from, address);
	write_reason(why, sizeof why, result, datagram);
	gr_warning("dropped a datagram from %s (%s): %s (%" PRIu64 " such since the last line, %" PRIu64
		   " in all)", address, datagram->name ? datagram->name : "not of this room", why, times,
		   limit->total);
}

void dropped_finish(struct dropped *dropped)
{
	for (int i = 0; i < DROPPED_REASONS; i++) {
		uint64_t since = 0, total = 0;

		for (int peer = 0; peer <= LAYOUT_MAX_NODES; peer++) {
			since += dropped->limits[peer][i].since;
			total += dropped->limits[peer][i].total;
			dropped->limits[peer][i].since = 0;
		}
		if (since == 0)
			continue;
		gr_warning("dropped %" PRIu64 " more datagram%s: %s (%" PRIu64 " in all)", since,
			   since == 1 ? "" : "s", i == 0 ? "for another reason" : reason_name(-i), total);
	}
}
