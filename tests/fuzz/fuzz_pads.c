/*
 * Reports of Sony's pads and of SpaceMouse, as they come and with their
 * checksum mended; then what is made of a run of them.
 */
#include "base/result.h"
#include "tests/unit/sony_bytes.h"
#include "tracking/sony.h"
#include "tracking/spacemouse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

struct run {
	enum track_sony_model model;
	bool bluetooth, paired;
	struct track_sony_state sony;
	struct track_spacemouse_state cap;
	struct track_spacemouse_motion motion;
	int64_t now_ns;
};

static void check(const struct track_report *r, float reach)
{
	float norm = 0;

	if (r->axis_count > TRACK_AXES || r->sensor != 0 || r->device_ns < 0)
		abort();
	for (unsigned i = 0; i < r->axis_count; i++)
		if (!(fabsf(r->axes[i]) <= 1))
			abort();
	for (int i = 0; i < 3; i++)
		if (!(fabsf(r->T_base_sensor.p[i]) <= reach))
			abort();
	for (int i = 0; i < 4; i++)
		norm += r->T_base_sensor.q[i] * r->T_base_sensor.q[i];
	if ((r->has & TRACK_ORIENTATION) && !(fabsf(norm - 1) < 1e-3f))
		abort();
	if ((r->has & TRACK_BATTERY) && !(r->battery >= 0 && r->battery <= 1))
		abort();
}

static void sony(struct run *run, const uint8_t *bytes, size_t len)
{
	struct track_sony_calibration calibration;
	struct track_sony_report raw;
	struct track_report report;

	if (track_sony_calibrate(run->model, run->bluetooth, run->paired, bytes, len,
				 &calibration) == GR_OK)
		run->sony.calibration = calibration;
	if (track_sony_decode(run->model, bytes, len, &raw) != GR_OK)
		return;
	(void)track_sony_take(run->model, &run->sony, &raw, run->now_ns, &report);
	check(&report, 0);
}

static void cap(struct run *run, const uint8_t *bytes, size_t len)
{
	struct track_spacemouse_report raw;
	struct track_report report;

	track_spacemouse_move(&run->cap, &run->motion, run->now_ns);
	if (track_spacemouse_decode(bytes, len, &raw) == GR_OK)
		track_spacemouse_take(&run->cap, &run->motion, &raw, run->now_ns);
	if (!track_spacemouse_moves(&run->cap) && (run->cap.move[0] != 0 || run->cap.turn[2] != 0))
		abort();
	track_spacemouse_pose(&run->cap, &report);
	check(&report, run->motion.reach_m);
}

/* One byte says whose reports these are; each has a length and a time since the last before it. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	struct run run = { .sony = { .imu.params = TRACK_IMU_STANDARD,
				     .recentre = 1u << TRACK_SONY_OPTIONS },
			   .motion = { 1, 1, 2, 2 } };
	bool mend, is_cap;

	if (len < 1)
		return 0;
	run.model = bytes[0] & 1 ? TRACK_SONY_DUALSENSE : TRACK_SONY_DUALSHOCK4;
	run.bluetooth = bytes[0] & 2;
	run.paired = bytes[0] & 4;
	mend = bytes[0] & 8;
	is_cap = bytes[0] & 16;
	track_sony_nominal(&run.sony.calibration);
	bytes++;
	len--;
	while (len >= 2) {
		const size_t n = bytes[0] < len - 2 ? bytes[0] : len - 2;
		uint8_t *copy = malloc(n ? n : 1);

		if (!copy)
			abort();
		run.now_ns += (int64_t)bytes[1] * bytes[1] * 1000000;
		if (n)
			memcpy(copy, bytes + 2, n);
		if (mend && n > 4)
			sony_seal(n == 41 ? 0xa3 : 0xa1, copy, n);
		if (is_cap)
			cap(&run, copy, n);
		else
			sony(&run, copy, n);
		free(copy);
		bytes += 2 + n;
		len -= 2 + n;
	}
	return 0;
}
