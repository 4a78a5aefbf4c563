/* DualShock 4 and DualSense: every byte, every length, calibration, counters. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "tests/unit/sony_bytes.h"
#include "tracking/sony.h"

static enum track_sony_model model_of(const struct sony_made *m)
{
	return m->dualsense ? TRACK_SONY_DUALSENSE : TRACK_SONY_DUALSHOCK4;
}

static int decode(const struct sony_made *m, const uint8_t *bytes, size_t len,
		  struct track_sony_report *out)
{
	uint8_t *copy = unit_copy(bytes, len);
	const int r = track_sony_decode(model_of(m), copy, len, out);

	free(copy);
	return r;
}

/* All four: each model by USB and by Bluetooth. */
static struct sony_made form(unsigned i)
{
	return (struct sony_made){ .dualsense = i & 1, .bluetooth = i >> 1, .buttons = { 8 } };
}

static void the_checksum_is_zlibs(void **state)
{
	(void)state;
	assert_int_equal(sony_crc((const uint8_t *)"123456789", 9, 0), 0xcbf43926);
}

static void every_field_is_where_it_is(void **state)
{
	struct track_sony_report r;
	uint8_t bytes[SONY_MOST];

	(void)state;
	for (unsigned i = 0; i < 4; i++) {
		struct sony_made m = form(i);
		const size_t at = !m.bluetooth ? 1 : m.dualsense ? 2 : 3;
		const size_t triggers = at + (m.dualsense ? 4 : 7);
		size_t len;

		for (int k = 0; k < 3; k++) {
			m.gyro[k] = -30000 + 1000 * k;
			m.accel[k] = 20000 + 1000 * k;
		}
		m.count = 0x2a;
		m.time = m.dualsense ? 0xfedcba98 : 0xfedc;
		m.battery = 7;
		len = sony_make(bytes, &m);
		for (unsigned k = 0; k < 4; k++)
			bytes[at + k] = (uint8_t)(10 + k);
		bytes[triggers] = 200;
		bytes[triggers + 1] = 201;
		if (m.bluetooth)
			sony_seal(0xa1, bytes, len);
		assert_int_equal(decode(&m, bytes, len, &r), GR_OK);
		for (int k = 0; k < 4; k++)
			assert_int_equal(r.sticks[k], 10 + k);
		assert_int_equal(r.triggers[0], 200);
		assert_int_equal(r.triggers[1], 201);
		for (int k = 0; k < 3; k++) {
			assert_int_equal(r.gyro[k], m.gyro[k]);
			assert_int_equal(r.accel[k], m.accel[k]);
		}
		assert_true(r.motion);
		assert_int_equal(r.sequence, 0x2a);
		assert_int_equal(r.time, m.time);
		assert_true(fabsf(r.battery - 0.7f) < 1e-6f);
		assert_int_equal(r.buttons, 0);
	}
}

static void buttons_and_hat(void **state)
{
	static const uint8_t hat[] = { 1, 3, 2, 6, 4, 12, 8, 9, 0 };
	static const uint8_t order[15] = {
		TRACK_SONY_SQUARE, TRACK_SONY_CROSS,	TRACK_SONY_CIRCLE, TRACK_SONY_TRIANGLE,
		TRACK_SONY_L1,	   TRACK_SONY_R1,	TRACK_SONY_L2,	   TRACK_SONY_R2,
		TRACK_SONY_SHARE,  TRACK_SONY_OPTIONS,	TRACK_SONY_L3,	   TRACK_SONY_R3,
		TRACK_SONY_PS,	   TRACK_SONY_TOUCHPAD, TRACK_SONY_MUTE,
	};
	struct track_sony_report r;
	uint8_t bytes[SONY_MOST];

	(void)state;
	for (unsigned i = 0; i < 4; i++) {
		struct sony_made m = form(i);

		for (unsigned k = 0; k < 16; k++) {
			m.buttons[0] = (uint8_t)k;
			if (k < 9) {
				assert_int_equal(decode(&m, bytes, sony_make(bytes, &m), &r),
						 GR_OK);
				assert_int_equal(r.buttons, (unsigned)hat[k] << TRACK_SONY_UP);
			} else {
				assert_int_equal(decode(&m, bytes, sony_make(bytes, &m), &r),
						 -TRACK_FAULT_FORMAT);
			}
		}
		for (unsigned k = 0; k < 15; k++) {
			const unsigned bit = k + 4;
			const bool there = m.dualsense || k != 14;

			m.buttons[0] = 8;
			m.buttons[1] = m.buttons[2] = 0;
			m.buttons[bit / 8] |= (uint8_t)(1u << bit % 8);
			assert_int_equal(decode(&m, bytes, sony_make(bytes, &m), &r), GR_OK);
			assert_int_equal(r.buttons, there ? UINT32_C(1) << order[k] : 0);
		}
	}
	assert_string_equal(track_sony_buttons[TRACK_SONY_CROSS], "cross");
	assert_string_equal(track_sony_buttons[TRACK_SONY_MUTE], "mute");
	assert_string_equal(track_sony_buttons[TRACK_SONY_LEFT], "left");
	assert_null(track_sony_buttons[TRACK_SONY_BUTTONS]);
}

/* What comes by Bluetooth before the mode is switched: the same nine bytes of both models. */
static void the_short_report_has_no_motion(void **state)
{
	const uint8_t bytes[10] = { 1, 10, 20, 30, 40, 0x28, 0x10, 1, 50, 60 };
	struct track_sony_report r;

	(void)state;
	for (unsigned i = 0; i < 2; i++) {
		const struct sony_made m = form(i);

		assert_int_equal(decode(&m, bytes, sizeof bytes, &r), GR_OK);
		assert_false(r.motion);
		assert_int_equal(r.buttons, 1u << TRACK_SONY_CROSS | 1u << TRACK_SONY_SHARE |
						    1u << TRACK_SONY_PS);
		assert_int_equal(r.sticks[3], 40);
		assert_int_equal(r.triggers[1], 60);
	}
}

static void any_other_length_is_refused(void **state)
{
	struct track_sony_report r, untouched;
	uint8_t bytes[SONY_MOST + 1] = { 0 };

	(void)state;
	memset(&r, 0x5a, sizeof r);
	untouched = r;
	for (unsigned i = 0; i < 4; i++) {
		const struct sony_made m = form(i);
		const size_t whole = sony_make(bytes, &m);

		for (size_t len = 0; len <= SONY_MOST + 1; len++)
			if (len != whole && !(bytes[0] == 1 && len == TRACK_SONY_SHORT_BYTES))
				assert_int_equal(decode(&m, bytes, len, &r), -TRACK_FAULT_LENGTH);
	}
	assert_memory_equal(&r, &untouched, sizeof r);
}

static void any_flipped_bit_is_found_by_bluetooth(void **state)
{
	struct track_sony_report r;
	uint8_t bytes[SONY_MOST];

	(void)state;
	for (unsigned i = 2; i < 4; i++) {
		const struct sony_made m = form(i);

		for (size_t bit = 8; bit < 8 * SONY_MOST; bit++) {
			sony_make(bytes, &m);
			bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
			assert_int_equal(decode(&m, bytes, SONY_MOST, &r), -TRACK_FAULT_CHECKSUM);
		}
	}
}

static void what_is_no_pads_state(void **state)
{
	struct track_sony_report r;
	struct sony_made m = form(0);
	uint8_t bytes[SONY_MOST];

	(void)state;
	/* The dongle, when no pad is near. */
	sony_make(bytes, &m);
	bytes[31] = 4;
	assert_int_equal(decode(&m, bytes, 64, &r), GR_NOTHING);
	/* By Bluetooth a report with sound alone. */
	m = form(2);
	sony_make(bytes, &m);
	bytes[1] = 0x40;
	sony_seal(0xa1, bytes, sizeof bytes);
	assert_int_equal(decode(&m, bytes, sizeof bytes, &r), GR_NOTHING);
	/* Numbers of no report, and of the other model's. */
	for (unsigned number = 0; number < 256; number++)
		for (unsigned i = 2; i < 4; i++) {
			m = form(i);
			sony_make(bytes, &m);
			if (number == 1 || number == bytes[0])
				continue;
			bytes[0] = (uint8_t)number;
			assert_int_equal(decode(&m, bytes, sizeof bytes, &r), -TRACK_FAULT_FORMAT);
		}
}

static void batteries(void **state)
{
	static const struct {
		uint8_t ds4, dualsense;
		float wanted[2];
	} cases[] = {
		{ 0, 0, { 0, 0 } },	   { 5, 5, { 0.5f, 0.5f } },	   { 11, 10, { 1, 1 } },
		{ 0x1b, 0x23, { 1, 1 } },  { 0x13, 0x14, { 0.3f, 0.4f } }, { 15, 15, { 1, 1 } },
		{ 9, 0xa5, { 0.9f, -1 } },
	};
	struct track_sony_report r;
	uint8_t bytes[SONY_MOST];

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		for (unsigned k = 0; k < 2; k++) {
			struct sony_made m = form(k);

			m.battery = k ? cases[i].dualsense : cases[i].ds4;
			assert_int_equal(decode(&m, bytes, sony_make(bytes, &m), &r), GR_OK);
			assert_true(fabsf(r.battery - cases[i].wanted[k]) < 1e-6f);
		}
}

/* ---- calibration ---- */

static void calibrations_are_taken_or_refused(void **state)
{
	struct track_sony_calibration c, nominal, untouched;
	uint8_t bytes[64];

	(void)state;
	track_sony_nominal(&nominal);
	for (unsigned i = 0; i < 8; i++) {
		const struct sony_made m = form(i & 3);
		const bool paired = i >> 2 || m.dualsense;
		const size_t len =
			sony_make_calibration(bytes, m.dualsense, m.bluetooth, paired, 1.1);

		assert_int_equal(track_sony_calibration_bytes(model_of(&m), m.bluetooth), len);
		assert_int_equal(track_sony_calibrate(model_of(&m), m.bluetooth, paired, bytes, len,
						      &c),
				 GR_OK);
		for (int k = 0; k < 6; k++) {
			assert_true(fabs(c.scale[k] / nominal.scale[k] - 1.1) < 1e-3);
			assert_true(c.bias[k] == (k < 3 ? 0 : 40));
		}
		untouched = c;
		for (size_t n = 0; n <= len + 1; n++) {
			uint8_t *copy = unit_copy(bytes, n);

			if (n != len)
				assert_int_equal(track_sony_calibrate(model_of(&m), m.bluetooth,
								      paired, copy, n, &c),
						 -TRACK_FAULT_LENGTH);
			free(copy);
		}
		bytes[0]++;
		assert_int_equal(track_sony_calibrate(model_of(&m), m.bluetooth, paired, bytes, len,
						      &c),
				 -TRACK_FAULT_FORMAT);
		bytes[0]--;
		bytes[10] ^= 1;
		if (m.bluetooth)
			assert_int_equal(track_sony_calibrate(model_of(&m), true, paired, bytes,
							      len, &c),
					 -TRACK_FAULT_CHECKSUM);
		assert_memory_equal(&c, &untouched, sizeof c);
	}
}

/* Copies of these pads send zeroes, or anything. */
static void what_cannot_be_a_calibration_is_none(void **state)
{
	struct unit_random random = unit_random_start("calibration");
	struct track_sony_calibration c;
	uint8_t bytes[64] = { 2 };
	unsigned taken = 0;

	(void)state;
	assert_int_equal(track_sony_calibrate(TRACK_SONY_DUALSHOCK4, false, true, bytes, 37, &c),
			 -TRACK_FAULT_FORMAT);
	for (int i = 0; i < 100000; i++) {
		for (int k = 1; k < 37; k++)
			bytes[k] = (uint8_t)unit_random_u32(&random);
		if (track_sony_calibrate(TRACK_SONY_DUALSHOCK4, false, true, bytes, 37, &c) !=
		    GR_OK)
			continue;
		taken++;
		for (int k = 0; k < 6; k++)
			assert_true(c.scale[k] > 0 && fabs(c.bias[k]) <= 1024);
	}
	assert_true(taken < 10);
	for (int i = 0; i < 3; i++) {
		const size_t len = sony_make_calibration(bytes, false, false, true, 1);

		if (i == 0) /* another speed, another scale */
			sony_put(bytes, 19, 2, 2000);
		else if (i == 1) /* the accelerometer's middle is off by 1/5 g */
			sony_put(bytes, 23, 2, 8192 + 3300);
		else
			sony_put(bytes, 23, 2, (uint32_t)-8152); /* as much as its opposite */
		assert_int_equal(track_sony_calibrate(TRACK_SONY_DUALSHOCK4, false, true, bytes,
						      len, &c),
				 -TRACK_FAULT_FORMAT);
	}
}

/* ---- the common form ---- */

static struct track_sony_state state_of(void)
{
	struct track_sony_state s = { .imu.params = TRACK_IMU_STANDARD };

	track_sony_nominal(&s.calibration);
	return s;
}

static void sticks_and_triggers(void **state)
{
	struct track_sony_state s = state_of();
	struct track_sony_report raw = { .sticks = { 0, 0, 255, 255 },
					 .triggers = { 51, 255 },
					 .battery = -1 };
	struct track_report out;

	(void)state;
	track_sony_take(TRACK_SONY_DUALSENSE, &s, &raw, 0, &out);
	assert_int_equal(out.has, TRACK_BUTTONS | TRACK_AXIS_VALUES);
	assert_int_equal(out.axis_count, 6);
	assert_true(out.axes[0] == -1 && out.axes[1] == 1 && out.axes[2] == 1 && out.axes[3] == -1);
	assert_true(fabsf(out.axes[4] - 0.2f) < 1e-6f && out.axes[5] == 1);
	memset(raw.sticks, 128, sizeof raw.sticks);
	track_sony_take(TRACK_SONY_DUALSENSE, &s, &raw, 0, &out);
	for (int i = 0; i < 4; i++)
		assert_true(out.axes[i] == 0);
}

/*
 * The counters of both go round, reports get lost, and eight come at once
 * after a stall: the device's time goes on as it was, what is missing is counted.
 */
static void counters_wrap_and_gaps_are_counted(void **state)
{
	(void)state;
	for (unsigned model = 0; model < 2; model++) {
		const struct track_sony_bits bits = track_sony_bits((enum track_sony_model)model);
		const uint64_t step = 4 * 3000000 / (uint64_t)bits.step_3ns; /* in 4 ms */
		const uint64_t begin = (UINT64_C(1) << bits.time) - 500 * step;
		struct track_sony_state s = state_of();
		struct track_report out;
		uint64_t missed = 0, sent = 0;
		int64_t first_ns = 0;

		for (uint64_t n = 0; n < 5000; n++) {
			const struct track_sony_report raw = {
				.motion = true,
				.accel = { 0, 8192, 0 },
				.sequence = (uint8_t)(n & ((1u << bits.sequence) - 1)),
				.time = (uint32_t)((begin + n * step) &
						   ((UINT64_C(1) << bits.time) - 1)),
			};
			const int64_t arrived_ns = (int64_t)(n / 8 * 8 + 8) * 4 * GR_NS_PER_MS;

			if (n % 100 == 40 || n % 100 == 41)
				continue;
			missed += track_sony_take((enum track_sony_model)model, &s, &raw,
						  arrived_ns, &out);
			sent++;
			if (n == 0)
				first_ns = out.device_ns;
			assert_true(llabs(out.device_ns - first_ns -
					  (int64_t)n * 4 * GR_NS_PER_MS) <= 1);
		}
		assert_int_equal(missed + sent, 5000);
	}
}

/* It was away for ten seconds: no turn is made up, no report missed. */
static void a_long_silence_is_no_turn(void **state)
{
	(void)state;
	for (unsigned model = 0; model < 2; model++) {
		const struct track_sony_bits bits = track_sony_bits((enum track_sony_model)model);
		struct track_sony_report raw = { .motion = true,
						 .accel = { 0, 8192, 0 },
						 .gyro = { 0, 16000, 0 } };
		struct track_sony_state s = state_of();
		struct track_report out;

		track_sony_take((enum track_sony_model)model, &s, &raw, GR_NS_PER_S, &out);
		raw.time = (uint32_t)(UINT64_C(30000000000) / (uint64_t)bits.step_3ns &
				      ((UINT64_C(1) << bits.time) - 1));
		raw.sequence = 20;
		assert_int_equal(track_sony_take((enum track_sony_model)model, &s, &raw,
						 11 * GR_NS_PER_S, &out),
				 0);
		assert_true(llabs(out.device_ns - 10 * GR_NS_PER_S) < 10000);
		assert_true(fabsf(out.T_base_sensor.q[1]) < 1e-3f);
	}
}

/* A copy says the same time each time: it turns nevertheless, and is timed by its arrival. */
static void a_clock_that_stands_still(void **state)
{
	(void)state;
	for (unsigned model = 0; model < 2; model++) {
		struct track_sony_report raw = { .motion = true, .accel = { 0, 8192, 0 } };
		struct track_sony_state s = state_of();
		struct track_report out;

		for (int i = 0; i <= 250; i++) {
			raw.gyro[1] = i <= TRACK_SONY_STOOD ? 0 : 90 * 16;
			raw.sequence = (uint8_t)(i & 63);
			(void)track_sony_take((enum track_sony_model)model, &s, &raw,
					      i * 4 * GR_NS_PER_MS, &out);
			assert_int_equal(!(out.has & TRACK_DEVICE_TIME), i >= TRACK_SONY_STOOD);
			assert_true(out.has & TRACK_ORIENTATION);
		}
		/* 242 times 4 ms at 90 degrees a second */
		assert_true(fabsf(out.T_base_sensor.q[1] - sinf(0.242f * 4 * 90 / 2 * 0.0174533f)) <
			    1e-3f);
		raw.time = 1000;
		(void)track_sony_take((enum track_sony_model)model, &s, &raw, GR_NS_PER_S, &out);
		assert_true(out.has & TRACK_DEVICE_TIME);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_checksum_is_zlibs),
		cmocka_unit_test(every_field_is_where_it_is),
		cmocka_unit_test(buttons_and_hat),
		cmocka_unit_test(the_short_report_has_no_motion),
		cmocka_unit_test(any_other_length_is_refused),
		cmocka_unit_test(any_flipped_bit_is_found_by_bluetooth),
		cmocka_unit_test(what_is_no_pads_state),
		cmocka_unit_test(batteries),
		cmocka_unit_test(calibrations_are_taken_or_refused),
		cmocka_unit_test(what_cannot_be_a_calibration_is_none),
		cmocka_unit_test(sticks_and_triggers),
		cmocka_unit_test(counters_wrap_and_gaps_are_counted),
		cmocka_unit_test(a_long_silence_is_no_turn),
		cmocka_unit_test(a_clock_that_stands_still),
	};

	return cmocka_run_group_tests_name("sony", tests, NULL, NULL);
}
