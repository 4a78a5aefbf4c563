#include "tools/doctor/room.h"

#include "tools/report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* A quartz keeps within 100 ppm of another; more is a clock that is being set or stops. */
#define SKEW_MOST_PPM 200
/* More of what is sent than this is sent again. */
#define REPAIRS_SHARE 0.01

struct finding room_judge_node(struct json_object *node)
{
	const char *name = report_text(node, "name"), *state = report_text(node, "state");

	if (report_count(node, "mismatches") > 0)
		return finding_do(finding(FINDING_WARN, "node %s is %s and held another state than the master %lld "
					  "times", name, state, (long long)report_count(node, "mismatches")),
				  "it got a snapshot each time; where it goes on: memory or build of that machine");
	if (!strcmp(state, "live"))
		return finding(FINDING_OK, "node %s is live: %lld swapped, %lld missed", name,
			       (long long)report_count(node, "swapped"),
			       (long long)report_count(node, "missed"));
	if (!strcmp(state, "late"))
		return finding_do(finding(FINDING_WARN, "node %s is late: it draws %.1f ms", name,
					  report_number(node, "render_ms")),
				  "a lighter scene or light, a faster GPU, or a longer rates.barrier_deadline_ms");
	if (!strcmp(state, "joining"))
		return finding(FINDING_SKIP, "node %s is joining", name);
	return finding_do(finding(FINDING_FAIL, "node %s is %s", name, state),
			  "start it; if it runs: grotto doctor --node %s on its machine, and the master's log for "
			  "why it may not join", name);
}

struct finding room_judge_clock(struct json_object *node, int64_t lead_ns)
{
	const char *name = report_text(node, "name");
	double error_us = report_number(node, "clock.error_us"), skew = report_number(node, "clock.skew_ppm");

	if (!json_object_get_boolean(report_member(node, "clock.known")))
		return finding(FINDING_SKIP, "the clock of node %s is not known yet", name);
	if (!(fabs(skew) <= SKEW_MOST_PPM))
		return finding_do(finding(FINDING_WARN, "the clock of node %s runs %+.0f ppm against the master's",
					  name, skew),
				  "a clock daemon that steers hard, or a clock source other than tsc, on one of both");
	if (!(error_us * 1e3 <= (double)lead_ns))
		return finding_do(finding(FINDING_WARN, "the clock of node %s is known to %.0f us, a swap is set %.0f "
					  "us ahead at most", name, error_us, (double)lead_ns * 1e-3),
				  "a slow or busy way: other traffic on the room's net, a card that waits to "
				  "interrupt (`ethtool -C IF rx-usecs 0`)");
	return finding(FINDING_OK, "the clock of node %s is known to %.0f us, %+.2f ppm", name, error_us, skew);
}

void room_judge_wire(struct json_object *status, struct findings *out)
{
	struct json_object *bad = report_member(status, "wire.bad");
	int64_t sent = report_count(status, "wire.datagrams_out"), repairs = report_count(status, "wire.repairs");
	int64_t failed = report_count(status, "wire.send_failed"), dropped = 0;

	if (json_object_is_type(bad, json_type_object)) {
		json_object_object_foreach(bad, kind, count) {
			(void)kind;
			dropped += json_object_get_int64(count);
		}
	}
	if (report_count(status, "wire.bad.auth") > 0)
		findings_add(out, finding_do(finding(FINDING_WARN, "%" PRId64 " datagrams were signed with another "
						     "key", report_count(status, "wire.bad.auth")),
					     "the same network.key_file on all machines; the log names who"));
	else if (dropped > 0)
		findings_add(out, finding_do(finding(FINDING_WARN, "%" PRId64 " datagrams were dropped as no part of "
						     "the room's talk", dropped),
					     "the master's log says which and from whom; strangers have no business "
					     "on the room's net"));
	else
		findings_add(out, finding(FINDING_OK, "no datagram was dropped"));
	if (failed > 0)
		findings_add(out, finding_do(finding(FINDING_WARN, "%" PRId64 " datagrams could not be sent", failed),
					     "the master's log names the reason: no route, a firewall (EPERM), MTU"));
	if ((double)repairs > REPAIRS_SHARE * (double)sent && repairs > 10)
		findings_add(out, finding_do(finding(FINDING_WARN, "%" PRId64 " of %" PRId64 " datagrams were sent "
						     "again", repairs, sent),
					     "packets are lost: checks `nic`, `drops` and `buffers` on both sides"));
	else
		findings_add(out, finding(FINDING_OK, "%" PRId64 " of %" PRId64 " datagrams were sent again", repairs,
					  sent));
}
