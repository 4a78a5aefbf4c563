/* VIPER's stream: framing, resynchronisation, poses, replies. */
#include "tests/fuzz/fuzz_polhemus.h"
#include "tracking/viper.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

static void look(const uint8_t *exact, size_t len, void *ctx)
{
	struct track_polhemus_state *state = ctx;
	struct track_viper_reply reply;
	struct track_viper_pose pose;

	if (track_viper_reply(exact, len, &reply) == GR_OK && reply.len > sizeof reply.payload)
		abort();
	if (track_viper_pose(exact, len, &pose) != GR_OK)
		return;
	if (pose.count > TRACK_VIPER_SENSORS || len != 28 + 32 * (size_t)pose.count)
		abort();
	fuzz_frame_number(state, pose.frame, state->arrived_ns + 4000000);
	for (unsigned i = 0; i < pose.count; i++) {
		struct track_polhemus_sensor sensor = { .sensor = pose.sensors[i].sensor };
		struct track_report report;

		if (track_viper_metres(pose.sensors[i].position_unit) <= 0)
			abort();
		memcpy(sensor.place_m, pose.sensors[i].place, sizeof sensor.place_m);
		memcpy(sensor.turn, pose.sensors[i].turn, sizeof sensor.turn);
		track_polhemus_report(state, &sensor, &report);
	}
}

/* The decoders by themselves: of any bytes, and with a right length and sum, which no mutation finds. */
static void alone(const uint8_t *bytes, size_t len)
{
	struct track_polhemus_state state = { 0 };
	uint8_t *copy = malloc(len ? len : 1);
	uint16_t sum;

	if (!copy)
		abort();
	memcpy(copy, bytes, len);
	track_polhemus_begin(&state, 240);
	look(copy, len, &state);
	if (len < 28 || len > TRACK_VIPER_FRAME_MOST) {
		free(copy);
		return;
	}
	copy[4] = (uint8_t)(len - 8);
	copy[5] = (uint8_t)((len - 8) >> 8);
	copy[6] = copy[7] = copy[len - 1] = copy[len - 2] = 0;
	sum = track_viper_checksum(copy, len - 4);
	copy[len - 4] = (uint8_t)sum;
	copy[len - 3] = (uint8_t)(sum >> 8);
	look(copy, len, &state);
	free(copy);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	struct track_polhemus_state state = { 0 };
	struct fuzz_found cut, whole;

	if (len < 1)
		return 0;
	track_polhemus_begin(&state, 240);
	cut = fuzz_stream(TRACK_POLHEMUS_VIPER, bytes + 1, len - 1, 1 + (size_t)bytes[0] * 4, look,
			  &state);
	whole = fuzz_stream(TRACK_POLHEMUS_VIPER, bytes + 1, len - 1, 1024, NULL, NULL);
	if (cut.frames != whole.frames || cut.hash != whole.hash)
		abort();
	alone(bytes + 1, len - 1);
	return 0;
}
