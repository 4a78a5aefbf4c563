/*
 * Datagrams of DTrack, one after the other (apart by form feeds): what is
 * taken are poses, and what is refused changes nothing.
 */
#include "base/result.h"
#include "tracking/dtrack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

static void check(const struct track_report *r)
{
	if (r->sensor >= TRACK_SENSORS || !r->has || r->axis_count > TRACK_AXES)
		abort();
	if ((r->has & TRACK_LOST) && (r->has & (TRACK_POSITION | TRACK_ORIENTATION)))
		abort();
	if ((r->has & TRACK_ORIENTATION) && !(fabsf(glm_vec4_norm((float *)r->T_base_sensor.q) - 1) < 1e-4f))
		abort();
	for (unsigned i = 0; i < 3; i++)
		if ((r->has & TRACK_POSITION) && !isfinite(r->T_base_sensor.p[i]))
			abort();
	for (unsigned i = 0; i < r->axis_count; i++)
		if (!(fabsf(r->axes[i]) <= 1))
			abort();
}

static void one(struct track_dtrack_state *state, const uint8_t *bytes, size_t len,
		int64_t arrived_ns)
{
	const struct track_dtrack_setup setup = { .z_up = len & 1, .stick_x_left = len & 2,
						  .stick_y_down = len & 4 };
	static struct track_dtrack_frame frame, before;
	static struct track_dtrack_reports reports;
	uint8_t *copy = malloc(len ? len : 1);

	if (!copy)
		abort();
	if (len)
		memcpy(copy, bytes, len);
	before = frame;
	if (track_dtrack_decode(copy, len, &frame) != GR_OK) {
		if (memcmp(&frame, &before, sizeof frame) != 0)
			abort();
	} else if (track_dtrack_take(state, &setup, &frame, arrived_ns, &reports) == GR_OK) {
		if (reports.count > TRACK_DTRACK_SENSORS)
			abort();
		for (unsigned i = 0; i < reports.count; i++)
			check(&reports.reports[i]);
	}
	free(copy);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	struct track_dtrack_state state = { 0 };
	int64_t arrived_ns = GR_NS_PER_S;

	for (size_t at = 0; at <= len; arrived_ns += 16 * GR_NS_PER_MS) {
		const uint8_t *feed = at < len ? memchr(bytes + at, '\f', len - at) : NULL;
		const size_t end = feed ? (size_t)(feed - bytes) : len;

		one(&state, bytes + at, end - at, arrived_ns);
		at = end + 1;
	}
	return 0;
}
