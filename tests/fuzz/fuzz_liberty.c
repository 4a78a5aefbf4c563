/*
 * LIBERTY's stream: heads that can be believed, text between, poses, station
 * maps. Where it is cut does matter here: what follows a frame is looked at
 * when it is there.
 */
#include "tests/fuzz/fuzz_polhemus.h"
#include "tracking/liberty.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

static void look(const uint8_t *exact, size_t len, void *ctx)
{
	struct track_polhemus_state *state = ctx;
	struct track_polhemus_sensor sensor = { 0 };
	struct track_report report;
	struct track_liberty_pose pose;
	uint16_t detected, active;

	(void)track_liberty_map(exact, len, &detected, &active);
	if (track_liberty_pose(exact, len, &pose) != GR_OK)
		return;
	if (pose.station >= TRACK_LIBERTY_STATIONS || (pose.button && !pose.has_button))
		abort();
	fuzz_frame_number(state, pose.frame, state->arrived_ns + 4000000);
	sensor.sensor = pose.station;
	memcpy(sensor.place_m, pose.place_cm, sizeof sensor.place_m);
	memcpy(sensor.turn, pose.turn, sizeof sensor.turn);
	track_polhemus_report(state, &sensor, &report);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	struct track_polhemus_state state = { 0 };

	if (len < 1)
		return 0;
	track_polhemus_begin(&state, 240);
	(void)fuzz_stream(TRACK_POLHEMUS_LIBERTY, bytes + 1, len - 1, 1 + (size_t)bytes[0] * 4, look,
			  &state);
	/* The decoders by themselves, of any bytes. */
	if (len > 1) {
		uint8_t *exact = malloc(len - 1);

		if (!exact)
			abort();
		memcpy(exact, bytes + 1, len - 1);
		look(exact, len - 1, &state);
		free(exact);
	}
	return 0;
}
