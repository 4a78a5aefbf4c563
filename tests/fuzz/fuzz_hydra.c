/* The Hydra's bytes, as they come and with their checksum mended; then a run of them. */
#include "base/result.h"
#include "tests/unit/hydra_bytes.h"
#include "tracking/hydra.h"

#include <math.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

static void check(const struct track_report *r)
{
	if (r->sensor > 1 || r->axis_count != 3 || r->buttons > 0x7f || r->device_ns < 0)
		abort();
	for (int i = 0; i < 3; i++)
		if (!(fabsf(r->T_base_sensor.p[i]) <= 32.768f) || !(fabsf(r->axes[i]) <= 1))
			abort();
	for (int i = 0; i < 4; i++)
		if (!(fabsf(r->T_base_sensor.q[i]) <= 1))
			abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	struct track_hydra_state state = { 0 };
	struct track_hydra_report raw;
	struct track_report out[TRACK_HYDRA_WANDS];
	uint8_t *copy = malloc(len ? len : 1), mended[HYDRA_BYTES];
	int64_t now_ns = 0;

	if (!copy)
		abort();
	if (len)
		memcpy(copy, bytes, len);
	if (track_hydra_decode(copy, len, &raw) == GR_OK && len != HYDRA_BYTES)
		abort();
	free(copy);
	for (size_t at = 0; at + HYDRA_BYTES <= len; at += HYDRA_BYTES) {
		memcpy(mended, bytes + at, sizeof mended);
		hydra_seal(mended);
		/* The two bytes that were the checksum say when it arrives: up to 65 s later. */
		now_ns += (int64_t)(bytes[at + 50] | bytes[at + 51] << 8) * 1000000;
		if (track_hydra_decode(mended, sizeof mended, &raw) != GR_OK)
			continue;
		track_hydra_reports(&state, &raw, now_ns, out);
		check(&out[0]);
		check(&out[1]);
	}
	return 0;
}
