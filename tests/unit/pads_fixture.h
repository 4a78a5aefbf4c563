/* Gamepads and SpaceMouse with the real hidapi over mocked nodes: plugged, saying things, taken. */
#ifndef GROTTO_TESTS_UNIT_PADS_FIXTURE_H
#define GROTTO_TESTS_UNIT_PADS_FIXTURE_H

#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "tests/unit/hid_items.h"
#include "tests/unit/mock_hid.h"
#include "tests/unit/sony_bytes.h"
#include "tracking/gamepad.h"
#include "tracking/hid_descriptor.h"
#include "tracking/sony.h"
#include "tracking/spacemouse.h"

#include <errno.h>
#include <poll.h>

#define PATIENCE_NS (60 * GR_NS_PER_S)
#define MOCKS 3

static UMockdevTestbed *bed; /* main makes it */

/* One node. */
struct mock_pad {
	struct mock_hid *hid;
	struct sony_made made;	 /* of a Sony */
	bool paired_signs, mute; /* mute: it has no calibration to say */
	bool deaf;		 /* it does not switch its mode */
	_Atomic unsigned asked;	 /* for its calibration */
	bool plugged;
};

/* A clock that a test can put forward. */
struct ahead_clock {
	_Atomic int64_t ahead_ns;
	struct gr_clock clock;
};

struct fixture {
	struct mock_pad pads[MOCKS];
	struct track_device *device;
	struct track_reader reader;
	struct ahead_clock clock;
};

static int64_t now_ahead(void *ctx)
{
	return gr_clock_now(&gr_clock_monotonic) + ((struct ahead_clock *)ctx)->ahead_ns;
}

static inline int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);

	*state = f;
	if (!f)
		return -1;
	f->clock.clock = (struct gr_clock){ now_ahead, &f->clock };
	return 0;
}

static inline void unplug(struct mock_pad *pad)
{
	pad->plugged = false;
	mock_hid_unplug(pad->hid, true);
}

static inline int teardown(void **state)
{
	struct fixture *f = *state;

	track_device_destroy(&f->device);
	for (int i = 0; i < MOCKS; i++) {
		if (f->pads[i].plugged)
			unplug(&f->pads[i]);
		mock_hid_free(&f->pads[i].hid);
	}
	free(f);
	return 0;
}

static inline struct track_status status_of(const struct fixture *f)
{
	struct track_status status;

	track_device_status(f->device, &status);
	return status;
}

static inline struct track_counters counters_of(const struct fixture *f)
{
	struct track_counters counters;

	track_device_counters(f->device, &counters);
	return counters;
}

static inline void assert_why(const struct fixture *f, const char *part)
{
	const struct track_status status = status_of(f);

	if (!strstr(status.why, part))
		fail_msg("\"%s\" is not in \"%s\"", part, status.why);
}

static inline void until(struct fixture *f, enum track_state wanted)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;

	do {
		track_device_turn(f->device, 20);
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
		f->clock.ahead_ns += GR_NS_PER_S; /* it does not wait before it tries again */
	} while (status_of(f).state != wanted);
}

static inline struct track_report next(struct fixture *f)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;
	struct track_report r;

	while (track_device_take(f->device, &f->reader, &r, 1) == 0) {
		track_device_turn(f->device, 20);
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
	}
	return r;
}

/* ---- nodes ---- */

static inline void plug(struct mock_pad *pad, const struct mock_hid_params *params)
{
	struct mock_hid_params p = *params;

	p.port = p.number + 1;
	if (!p.name)
		p.name = "Pad";
	if (!p.serial)
		p.serial = "";
	mock_hid_free(&pad->hid); /* of an earlier time */
	pad->hid = mock_hid_plug(bed, &p);
	pad->plugged = true;
}

static const uint8_t joystick_descriptor[] = {
	APPLICATION(JOYSTICK), REPORT(1), USAGE(0x30), USAGE(0x31),  RANGE(-127, 127),
	FIELD(8, 2),	       VARIABLE,  PAGE(9),     USAGES(1, 8), RANGE(0, 1),
	FIELD(1, 8),	       VARIABLE,  END,
};
static const uint8_t mouse_descriptor[] = {
	APPLICATION(2), PAGE(9), USAGES(1, 8), RANGE(0, 1), FIELD(1, 8), VARIABLE, END,
};
static const uint8_t cap_descriptor[] = {
	APPLICATION(MULTI_AXIS), REPORT(1),    USAGE(0x30), USAGE(0x31), USAGE(0x32),
	RANGE16(-500, 500),	 FIELD(16, 3), RELATIVE,    END,
};
static const uint8_t sony_descriptor[] = { DUALSHOCK4_DESCRIPTOR };

static inline void plug_joystick(struct mock_pad *pad, int number, const char *serial)
{
	plug(pad, &(struct mock_hid_params){ .number = number,
					     .vendor = 0x0079,
					     .product = 0x0006,
					     .serial = serial,
					     .descriptor = joystick_descriptor,
					     .descriptor_len = sizeof joystick_descriptor });
}

static inline void plug_spacemouse(struct mock_pad *pad, int number)
{
	plug(pad, &(struct mock_hid_params){ .number = number,
					     .vendor = 0x256f,
					     .product = 0xc635,
					     .name = "SpaceMouse Compact",
					     .descriptor = cap_descriptor,
					     .descriptor_len = sizeof cap_descriptor });
}

static int sony_feature(void *ctx, uint8_t *bytes, int room)
{
	struct mock_pad *pad = ctx;
	const struct sony_made *m = &pad->made;
	uint8_t made[64];
	const size_t len =
		sony_make_calibration(made, m->dualsense, m->bluetooth, pad->paired_signs, 1);

	pad->asked++;
	if (pad->mute || bytes[0] != made[0] || (size_t)room < len)
		return -EPIPE;
	memcpy(bytes, made, len);
	return (int)len;
}

static inline void plug_sony(struct mock_pad *pad, int number, bool dualsense, bool bluetooth,
			     uint16_t product, const char *serial)
{
	pad->made = (struct sony_made){ .dualsense = dualsense,
					.bluetooth = bluetooth,
					.buttons = { 8 } };
	pad->paired_signs = dualsense || !(bluetooth || product == 0x0ba0);
	pad->asked = 0;
	plug(pad, &(struct mock_hid_params){ .number = number,
					     .vendor = 0x054c,
					     .product = product,
					     .bluetooth = bluetooth,
					     .name = "Wireless Controller",
					     .serial = serial,
					     .descriptor = sony_descriptor,
					     .descriptor_len = sizeof sony_descriptor,
					     .ops = { .get_feature = sony_feature, .ctx = pad } });
}

/* 4 ms later: the short report until it was asked for its calibration, by Bluetooth. */
static inline void sony_say(struct mock_pad *pad)
{
	const uint8_t small[10] = { 1, 128, 128, 128, 128, 8 };
	uint8_t bytes[SONY_MOST];
	size_t len;

	pad->made.count++;
	pad->made.time += pad->made.dualsense ? 12000 : 750;
	pad->made.accel[1] = 8192 + 40;
	len = sony_make(bytes, &pad->made);
	if (pad->made.bluetooth && (pad->deaf || !pad->asked))
		mock_hid_push(pad->hid, small, sizeof small);
	else
		mock_hid_push(pad->hid, bytes, len);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

#endif
