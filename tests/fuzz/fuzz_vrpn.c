/*
 * What a VRPN server may send behind its cookie: a stream of messages, or
 * datagrams (where the first byte is odd, to a client that knows the names).
 */
#include "base/result.h"
#include "tests/unit/vrpn_bytes.h"
#include "tracking/vrpn.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

static void check(const struct track_report *r)
{
	if (r->sensor >= TRACK_VRPN_SENSORS || !r->has || r->axis_count > TRACK_AXES)
		abort();
	for (int i = 0; i < 7; i++) {
		const float v = i < 3 ? r->T_base_sensor.p[i] : r->T_base_sensor.q[i - 3];

		if ((r->has & TRACK_POSITION) && !(fabsf(v) <= TRACK_PLACE_MAX_M))
			abort();
	}
	for (unsigned i = 0; i < r->axis_count; i++)
		if (!(fabsf(r->axes[i]) <= 1))
			abort();
}

/* What was read can be written, and is read as the same. */
static void check_again(const struct track_vrpn_message *m, size_t whole)
{
	static uint8_t out[TRACK_VRPN_MESSAGE_MOST];
	struct track_vrpn_message again;
	size_t len = 0, used;

	/* Microseconds of more than a second may carry beyond what 32 bits of seconds hold. */
	if (m->time_ns / GR_NS_PER_S > UINT32_MAX)
		return;
	if (!track_vrpn_encode(m, out, sizeof out, &len) || len != whole ||
	    track_vrpn_decode(out, len, &again, &used) != GR_OK || used != len ||
	    again.time_ns != m->time_ns || again.sender != m->sender || again.type != m->type ||
	    again.len != m->len || memcmp(again.body, m->body, m->len) != 0)
		abort();
}

static void take_all(struct track_vrpn_state *state, const uint8_t *bytes, size_t len, bool datagram)
{
	static struct track_vrpn_reports reports;
	struct track_vrpn_message message;
	size_t at = 0, used = 0;

	while (track_vrpn_decode(bytes + at, len - at, &message, &used) == GR_OK) {
		if (used < TRACK_VRPN_HEADER || used > len - at ||
		    message.len > used - TRACK_VRPN_HEADER)
			abort();
		check_again(&message, used);
		if (track_vrpn_take(state, &message, datagram, &reports) < 0 && reports.count)
			abort();
		if (reports.count > TRACK_VRPN_SENSORS)
			abort();
		for (unsigned i = 0; i < reports.count; i++)
			check(&reports.reports[i]);
		at += used;
	}
	track_vrpn_rest(state, &reports);
	for (unsigned i = 0; i < reports.count; i++)
		check(&reports.reports[i]);
}

static void know_names(struct track_vrpn_state *state)
{
	static struct vrpn_bytes names;

	names.len = 0;
	vrpn_name(&names, TRACK_VRPN_SENDER, 0, state->device);
	vrpn_name(&names, TRACK_VRPN_TYPE, 0, "vrpn_Tracker Pos_Quat");
	vrpn_name(&names, TRACK_VRPN_TYPE, 1, "vrpn_Button Change");
	vrpn_name(&names, TRACK_VRPN_TYPE, 2, "vrpn_Button States");
	vrpn_name(&names, TRACK_VRPN_TYPE, 3, "vrpn_Analog Channel");
	take_all(state, names.at, names.len, false);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	static struct track_vrpn_state state;
	const bool datagram = len && (bytes[0] & 1);
	uint8_t *copy;

	if (!len)
		return 0;
	copy = malloc(len);
	if (!copy)
		abort();
	memcpy(copy, bytes + 1, len - 1);
	memset(&state, 0, sizeof state);
	strcpy(state.device, "Tracker0");
	if (datagram)
		know_names(&state);
	if (len > TRACK_VRPN_COOKIE)
		(void)track_vrpn_check_cookie(copy);
	take_all(&state, copy, len - 1, datagram);
	free(copy);
	return 0;
}
