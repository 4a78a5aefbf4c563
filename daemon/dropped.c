#include "daemon/dropped.h"

#include "base/result.h"

#include <inttypes.h>

static const char *reason_name(int result)
{
	return result == GR_ERR_MISMATCH ? "of another session" : gr_result_name(result);
}

void dropped_add(struct dropped *dropped, int result, const struct net_address *from,
		 int64_t now_ns)
{
	int reason = result < 0 && result > -DROPPED_REASONS ? -result : 0;
	struct gr_log_limit *limit = &dropped->reasons[reason];
	char text[NET_ADDRESS_TEXT];
	uint64_t times;

	if (!gr_log_limit(limit, now_ns, &times))
		return;
	net_address_text(from, text);
	gr_warning("dropped a datagram from %s: %s (%" PRIu64 " such since the last line, %" PRIu64
		   " in all)", text, reason_name(result), times, limit->total);
}

void dropped_finish(struct dropped *dropped)
{
	for (int i = 0; i < DROPPED_REASONS; i++) {
		struct gr_log_limit *limit = &dropped->reasons[i];

		if (limit->since == 0)
			continue;
		gr_warning("dropped %" PRIu64 " more datagram%s: %s (%" PRIu64 " in all)",
			   limit->since, limit->since == 1 ? "" : "s",
			   i == 0 ? "for another reason" : reason_name(-i), limit->total);
		limit->since = 0;
	}
}
