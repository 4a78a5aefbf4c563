/* Report descriptors and reports of any gamepad: what is found, normalised, refused. */
#include "tests/unit/unit.h"

#include "base/result.h"
#include "tests/unit/hid_items.h"
#include "tracking/hid.h"
#include "tracking/hid_descriptor.h"

#include <pthread.h>

static struct track_hid_pads pads;

static void parse(const uint8_t *bytes, size_t len)
{
	uint8_t *copy = unit_copy(bytes, len);
	char why[200] = "";

	if (track_hid_parse(copy, len, false, &pads, why, sizeof why) != GR_OK)
		fail_msg("%s", why);
	free(copy);
}
#define PARSE(...)                                                                                 \
	do {                                                                                       \
		const uint8_t bytes_[] = { __VA_ARGS__ };                                          \
		parse(bytes_, sizeof bytes_);                                                      \
	} while (0)

static struct track_hid_values values;

static int take(const uint8_t *bytes, size_t len, uint8_t triggers)
{
	uint8_t *copy = unit_copy(bytes, len);
	const int r = track_hid_take(&pads, copy, len, triggers, &values);

	free(copy);
	return r;
}
#define TAKE(...)                                                                                  \
	do {                                                                                       \
		const uint8_t bytes_[] = { __VA_ARGS__ };                                          \
		track_hid_rest(&values);                                                           \
		assert_true(take(bytes_, sizeof bytes_, 0) > 0);                                   \
	} while (0)

static void assert_axis(enum track_hid_axis axis, double wanted)
{
	const double is = (double)values.axes[0][axis];

	if (!(fabs(is - wanted) < 1e-6))
		fail_msg("axis %d is %.7f, not %.7f", axis, is, wanted);
}

static void a_dualshock_4(void **state)
{
	uint8_t report[65] = { 1, 0, 255, 128, 64, 0x08 };
	struct track_report common;

	(void)state;
	PARSE(DUALSHOCK4_DESCRIPTOR);
	assert_true(pads.numbered);
	assert_int_equal(pads.pad_count, 1);
	assert_int_equal(pads.usages[0], TRACK_HID_GAMEPAD);
	assert_int_equal(pads.has_axes[0], 0x3f);
	assert_int_equal(pads.has_buttons[0], 0xf0003fff);
	assert_int_equal(pads.bytes[1], 64);
	assert_int_equal(pads.bytes[5], 0);
	track_hid_rest(&values);
	for (size_t len = 0; len < 64; len++)
		assert_int_equal(take(report, len, 0), -TRACK_FAULT_LENGTH);
	assert_int_equal(take(report, 64, 0), 1);
	assert_axis(TRACK_HID_X, -1);
	assert_axis(TRACK_HID_Y, -1); /* 255 is down */
	assert_axis(TRACK_HID_Z, 0);
	assert_axis(TRACK_HID_RZ, 0.5);
	assert_int_equal(values.buttons[0], 0);
	/* Some devices send more than they say: that is not looked at. */
	report[64] = 0xff;
	report[5] = 0xf0;
	report[6] = 0x21;
	assert_int_equal(take(report, 65, 0), 1);
	assert_int_equal(values.buttons[0], 0xf | 1u << 4 | 1u << 9 | 1u << TRACK_HID_HAT_UP);
	/* Two are triggers: nobody but the layout knows that. */
	report[8] = 255;
	report[9] = 51;
	assert_int_equal(take(report, 64, 1 << TRACK_HID_RX | 1 << TRACK_HID_RY), 1);
	assert_axis(TRACK_HID_RX, 1);
	assert_axis(TRACK_HID_RY, 0.2);
	track_hid_report(&values, 0, &common);
	assert_int_equal(common.has, TRACK_BUTTONS | TRACK_AXIS_VALUES);
	assert_int_equal(common.axis_count, TRACK_HID_AXES);
	assert_true(common.axes[TRACK_HID_RX] == 1.0f);
	/* A report that is none of the descriptor's. */
	report[0] = 2;
	assert_int_equal(take(report, 64, 0), -TRACK_FAULT_FORMAT);
}

static void a_hat_has_eight_directions_and_none(void **state)
{
	/* up 1, right 2, down 4, left 8 */
	static const uint8_t wanted[16] = { 1, 3, 2, 6, 4, 12, 8, 9 };

	(void)state;
	for (unsigned low = 0; low < 2; low++) {
		PARSE(APPLICATION(JOYSTICK), USAGE(0x39), RANGE(low, low + 7), FIELD(4, 1),
		      VARIABLE_NULL, FIELD(4, 1), CONSTANT, END);
		for (unsigned i = 0; i < 16; i++) {
			TAKE((uint8_t)(i | 0xa0));
			assert_int_equal(values.buttons[0] >> TRACK_HID_HAT_UP,
					 i < low ? 0 : wanted[i - low]);
		}
	}
	PARSE(APPLICATION(JOYSTICK), USAGE(0x39), RANGE(0, 3), FIELD(8, 1), VARIABLE, END);
	for (unsigned i = 0; i < 6; i++) {
		TAKE((uint8_t)i);
		assert_int_equal(values.buttons[0] >> TRACK_HID_HAT_UP, i < 4 ? 1u << i : 0);
	}
	/* Four buttons instead of a hat, in any order. */
	PARSE(APPLICATION(GAMEPAD), USAGE(0x90), USAGE(0x91), USAGE(0x92), USAGE(0x93), RANGE(0, 1),
	      FIELD(1, 4), VARIABLE, FIELD(4, 1), CONSTANT, END);
	TAKE(0x02);
	assert_int_equal(values.buttons[0], UINT32_C(4) << TRACK_HID_HAT_UP);
	TAKE(0x0c);
	assert_int_equal(values.buttons[0], UINT32_C(10) << TRACK_HID_HAT_UP);
}

/* n bits of a value at a bit of a report, the other way than the decoder: bit by bit. */
static void put(uint8_t *report, unsigned bit, unsigned n, uint32_t value)
{
	for (unsigned i = 0; i < n; i++)
		if (value >> i & 1)
			report[(bit + i) / 8] |= (uint8_t)(1u << (bit + i) % 8);
}

static uint32_t low_bits(unsigned n)
{
	return n == 32 ? UINT32_MAX : (UINT32_C(1) << n) - 1;
}

/* One axis of any width at any place, signed and not: ends, middle, and what is between. */
static void axes_of_any_size_anywhere(void **state)
{
	struct unit_random random = unit_random_start("axes");

	(void)state;
	for (unsigned bits = 2; bits <= 32; bits++)
		for (unsigned shift = 1; shift < 20; shift++)
			for (int sign = 0; sign < 2; sign++) {
				const uint32_t high = low_bits(bits - (unsigned)sign);
				const int64_t low = sign ? -(int64_t)high - 1 : 0;
				const uint32_t raw = unit_random_u32(&random) & low_bits(bits);
				const int64_t value = sign && raw > high
							      ? (int64_t)raw - low_bits(bits) - 1
							      : raw;
				const int64_t middle = sign ? 0 : (int64_t)high / 2 + 1;
				uint8_t report[8];
				const uint32_t l = (uint32_t)low;

				PARSE(APPLICATION(JOYSTICK), 0x17, l & 0xff, l >> 8 & 0xff,
				      l >> 16 & 0xff, (uint8_t)(l >> 24), 0x27, high & 0xff,
				      high >> 8 & 0xff, high >> 16 & 0xff, (uint8_t)(high >> 24),
				      FIELD((uint8_t)shift, 1), CONSTANT, USAGE(0x30),
				      FIELD((uint8_t)bits, 1), VARIABLE, END);
				memset(report, 0, sizeof report);
				put(report, 0, shift, unit_random_u32(&random));
				put(report, shift, bits, raw);
				track_hid_rest(&values);
				assert_int_equal(take(report, (shift + bits + 7) / 8, 0), 1);
				assert_axis(TRACK_HID_X,
					    (double)(value - middle) /
						    (double)(value < middle ? middle - low
									    : high - middle));
			}
}

static void maxima_below_the_minimum_are_unsigned(void **state)
{
	(void)state;
	PARSE(APPLICATION(JOYSTICK), USAGE(0x30), RANGE(0, 0xff), FIELD(8, 1), VARIABLE,
	      USAGE(0x36), RANGE16(0, 0xffff), FIELD(16, 1), VARIABLE, END);
	TAKE(255, 0xff, 0xff);
	assert_axis(TRACK_HID_X, 1);
	assert_axis(TRACK_HID_SLIDER, 1);
	TAKE(0, 0, 0);
	assert_axis(TRACK_HID_X, -1);
	assert_axis(TRACK_HID_SLIDER, 0);
	/* Those of two values, and with a middle of their own. */
	PARSE(APPLICATION(JOYSTICK), USAGE(0x30), RANGE(0, 1), FIELD(8, 1), VARIABLE, USAGE(0x33),
	      RANGE(-127, 127), VARIABLE, END);
	TAKE(0, 0x81);
	assert_axis(TRACK_HID_X, -1);
	assert_axis(TRACK_HID_RX, -1);
	TAKE(1, 127);
	assert_axis(TRACK_HID_X, 1);
	assert_axis(TRACK_HID_RX, 1);
	TAKE(1, 0);
	assert_axis(TRACK_HID_RX, 0);
}

static void what_is_out_of_range_says_nothing(void **state)
{
	const uint8_t inside[] = { 5 }, outside[] = { 200 };

	(void)state;
	PARSE(APPLICATION(JOYSTICK), USAGE(0x30), RANGE(0, 10), FIELD(8, 1), VARIABLE_NULL, END);
	track_hid_rest(&values);
	assert_int_equal(take((const uint8_t[]){ 10 }, 1, 0), 1);
	assert_axis(TRACK_HID_X, 1);
	assert_int_equal(take(outside, 1, 0), 1);
	assert_axis(TRACK_HID_X, 1);
	assert_int_equal(take(inside, 1, 0), 1);
	assert_axis(TRACK_HID_X, 0);
}

static void sliders_pedals_and_wheels(void **state)
{
	(void)state;
	PARSE(APPLICATION(JOYSTICK), PAGE(2), USAGE(0xc4), USAGE(0xc5), USAGE(0xbb), USAGE(0xc8),
	      USAGE(0xba), 0x15, 0, 0x26, 0xff, 0, FIELD(8, 5), VARIABLE, END);
	assert_int_equal(pads.has_axes[0], 1 << TRACK_HID_SLIDER | 1 << TRACK_HID_SLIDER2 |
						   1 << TRACK_HID_X | 1 << TRACK_HID_RZ);
	TAKE(255, 51, 77, 0, 255);
	assert_axis(TRACK_HID_SLIDER, 1);
	assert_axis(TRACK_HID_SLIDER2, 0.2);
	assert_axis(TRACK_HID_X, -1);
	assert_axis(TRACK_HID_RZ, 1);
}

static void arrays_list_what_is_pressed(void **state)
{
	(void)state;
	/* Buttons 1 to 9 as numbers 1 to 9 in two places; 0 is none. */
	PARSE(APPLICATION(GAMEPAD), PAGE(9), USAGES(0, 9), RANGE(0, 9), FIELD(4, 2), ARRAY, PAGE(1),
	      USAGE(0x30), RANGE(-127, 127), FIELD(8, 1), VARIABLE, END);
	assert_int_equal(pads.has_buttons[0], 0x1ff);
	TAKE(0x91, 0);
	assert_int_equal(values.buttons[0], 0x101);
	TAKE(0x00, 0);
	assert_int_equal(values.buttons[0], 0);
	TAKE(0xff, 0); /* numbers of none */
	assert_int_equal(values.buttons[0], 0);
	/* From 1, and cut off where the names end. */
	PARSE(APPLICATION(GAMEPAD), PAGE(9), USAGES(20, 60), RANGE(1, 41), FIELD(8, 1), ARRAY, END);
	TAKE(1);
	assert_int_equal(values.buttons[0], 1u << 19);
	TAKE(9);
	assert_int_equal(values.buttons[0], 1u << 27);
	TAKE(10);
	assert_int_equal(values.buttons[0], 0);
	/* Usages that do not follow on one another: not a gamepad's, passed over. */
	PARSE(APPLICATION(GAMEPAD), PAGE(9), USAGE(1), USAGE(3), RANGE(0, 1), FIELD(8, 1), ARRAY,
	      USAGES(1, 8), FIELD(1, 8), VARIABLE, END);
	assert_int_equal(pads.field_count, 8);
	TAKE(1, 0x81);
	assert_int_equal(values.buttons[0], 0x81);
}

static void buttons_that_measure_count_from_half_their_way(void **state)
{
	(void)state;
	/* The first's range is left over from something else, as in real ones. */
	PARSE(APPLICATION(GAMEPAD), PAGE(9), 0x15, 0, 0x26, 0xff, 0, USAGE(1), FIELD(1, 1),
	      VARIABLE, FIELD(7, 1), CONSTANT, USAGE(2), FIELD(8, 1), VARIABLE, END);
	TAKE(1, 127);
	assert_int_equal(values.buttons[0], 1);
	TAKE(0, 128);
	assert_int_equal(values.buttons[0], 2);
}

static void usages_come_in_many_forms(void **state)
{
	(void)state;
	/* Four bytes with the page in them; a set of alternatives whose first counts; a long item;
	 * strings and designators; states pushed and popped; the last usage goes on. */
	PARSE(APPLICATION(GAMEPAD), PHYSICAL, PUSH, 0x0b, 0x30, 0x00, 0x01, 0x00, RANGE(-1, 1),
	      FIELD(8, 1), VARIABLE, 0xfe, 3, 0x77, 1, 2, 3, 0xa9, 1, USAGE(0x32), USAGE(0x33),
	      0xa9, 0, 0x79, 5, 0x39, 6, VARIABLE, POP, PAGE(9), 0x1b, 1, 0, 9, 0, 0x2b, 4, 0, 9, 0,
	      RANGE(0, 1), FIELD(1, 6), VARIABLE, FIELD(2, 1), CONSTANT, END, END);
	assert_int_equal(pads.has_axes[0], 1 << TRACK_HID_X | 1 << TRACK_HID_Z);
	assert_int_equal(pads.has_buttons[0], 15);
	assert_int_equal(pads.bytes[0], 3);
	TAKE(1, 0xff, 0xff);
	assert_axis(TRACK_HID_X, 1);
	assert_axis(TRACK_HID_Z, -1);
	assert_int_equal(values.buttons[0], 15);
}

/* An adapter with two pads, each in a report of its own; and a mouse, which is none. */
static void several_collections(void **state)
{
	const uint8_t first[] = { 1, 100, 1 }, second[] = { 2, 0x9c, 2 }, mouse[] = { 3, 1, 1 };

	(void)state;
	PARSE(APPLICATION(JOYSTICK), REPORT(1), USAGE(0x30), RANGE(-100, 100), FIELD(8, 1),
	      VARIABLE, PAGE(9), USAGES(1, 8), RANGE(0, 1), FIELD(1, 8), VARIABLE, END,
	      APPLICATION(2), REPORT(3), USAGE(0x30), RANGE(-100, 100), FIELD(8, 2), RELATIVE, END,
	      APPLICATION(GAMEPAD), REPORT(2), USAGE(0x30), RANGE(-100, 100), FIELD(8, 1), VARIABLE,
	      PAGE(9), USAGES(1, 8), RANGE(0, 1), FIELD(1, 8), VARIABLE, END);
	assert_int_equal(pads.pad_count, 2);
	assert_int_equal(pads.bytes[3], 3);
	track_hid_rest(&values);
	assert_int_equal(take(first, sizeof first, 0), 1);
	assert_int_equal(take(second, sizeof second, 0), 2);
	assert_int_equal(take(mouse, sizeof mouse, 0), 0);
	assert_true(values.axes[0][TRACK_HID_X] == 1 && values.axes[1][TRACK_HID_X] == -1);
	assert_true(values.buttons[0] == 1 && values.buttons[1] == 2);
	/* A mouse's wheel and buttons for media beside it are no pad. */
	PARSE(APPLICATION(JOYSTICK), RANGE(0, 1), FIELD(1, 8), PAGE(12), USAGE(0xcd), VARIABLE, END,
	      ONE_BUTTON);
	assert_int_equal(pads.pad_count, 1);
	TAKE(0, 1);
	assert_int_equal(values.buttons[0], 1);
	/* One pad whose state comes in two reports: each leaves the other's part alone. */
	PARSE(APPLICATION(JOYSTICK), REPORT(1), USAGE(0x30), RANGE(-100, 100), FIELD(8, 1),
	      VARIABLE, REPORT(2), PAGE(9), USAGES(1, 8), RANGE(0, 1), FIELD(1, 8), VARIABLE, END);
	track_hid_rest(&values);
	assert_int_equal(take((const uint8_t[]){ 1, 50 }, 2, 0), 1);
	assert_int_equal(take((const uint8_t[]){ 2, 5 }, 2, 0), 1);
	assert_axis(TRACK_HID_X, 0.5);
	assert_int_equal(values.buttons[0], 5);
	assert_int_equal(take((const uint8_t[]){ 1, 0 }, 2, 0), 1);
	assert_int_equal(values.buttons[0], 5);
}

static void a_device_that_is_named_may_call_itself_anything(void **state)
{
	static const uint8_t bytes[] = {
		APPLICATION(MULTI_AXIS), USAGE(0x30), RANGE(-100, 100), FIELD(8, 1), VARIABLE, END
	};
	char why[200];

	(void)state;
	assert_int_equal(track_hid_parse(bytes, sizeof bytes, false, &pads, why, sizeof why),
			 GR_ERR_FORMAT);
	assert_non_null(strstr(why, "no gamepad or joystick"));
	assert_int_equal(track_hid_parse(bytes, sizeof bytes, true, &pads, why, sizeof why), GR_OK);
	assert_int_equal(pads.usages[0], TRACK_HID_MULTI_AXIS);
}

#define B(...)                                                                                     \
	{ __VA_ARGS__ }, sizeof(uint8_t[])                                                         \
	{                                                                                          \
		__VA_ARGS__                                                                        \
	}
static const struct {
	uint8_t bytes[80];
	size_t len;
	const char *why;
} malformed[] = {
	{ B(0), "no gamepad or joystick" },
	{ B(0x05), "byte 0: the descriptor ends within an item" },
	{ B(PAGE(1), 0xfe, 9, 0), "byte 2: the descriptor ends within a long item" },
	{ B(APPLICATION(GAMEPAD)), "byte 6: 1 collections do not end" },
	{ B(APPLICATION(GAMEPAD), END, END), "byte 7: ends a collection that nothing began" },
	{ B(POP), "byte 0: pops a state that nothing pushed" },
	{ B(REPORT(0)), "a report has number 0; 1 to 255 can be" },
	{ B(0x86, 0, 1), "a report has number 256" },
	{ B(FIELD(8, 1), CONSTANT, REPORT(1)), "a report gets number 1 after inputs without one" },
	{ B(PUSH, REPORT(1), POP, FIELD(8, 1), CONSTANT), "an input without a report number" },
	{ B(0x29, 5), "byte 0: a usage maximum without its minimum" },
	{ B(0x19, 5, CONSTANT), "byte 2: a usage minimum without its maximum" },
	{ B(USAGES(5, 4)), "usage maximum 4 is below the minimum 5" },
	{ B(0x77, 0xff, 0xff, 0xff, 0xff, 0x97, 0xff, 0xff, 0xff, 0xff, CONSTANT),
	  "byte 10: report 0 is longer than 1024 bytes" },
	{ B(FIELD(255, 32), CONSTANT, FIELD(8, 4), CONSTANT),
	  "report 0 is longer than 1024 bytes" },
	{ B(APPLICATION(GAMEPAD), PAGE(9), USAGE(1), FIELD(33, 1), VARIABLE),
	  "a button or axis of more than 32 bits" },
	{ B(APPLICATION(GAMEPAD), PAGE(9), USAGES(1, 2), FIELD(64, 1), ARRAY),
	  "a button or axis of more than 32 bits" },
	{ B(APPLICATION(GAMEPAD), USAGE(0x30), RANGE(5, 5), FIELD(8, 1), VARIABLE),
	  "an axis whose logical maximum is not above its minimum" },
	{ B(APPLICATION(GAMEPAD), USAGE(0x39), RANGE(5, 4), FIELD(8, 1), VARIABLE),
	  "an axis whose logical maximum is not above its minimum" },
	{ B(APPLICATION(GAMEPAD), PAGE(9), USAGES(1, 2), RANGE(1, 2), 0x75, 2, 0x96, 1, 1, ARRAY),
	  "more buttons and axes than 256" },
	{ B(FIELD(1, 1), ONE_BUTTON, ONE_BUTTON, ONE_BUTTON, ONE_BUTTON, ONE_BUTTON),
	  "more than 4 gamepads in one device" },
};

static void what_is_malformed_is_refused_with_the_place(void **state)
{
	char why[200];

	(void)state;
	for (size_t i = 0; i < sizeof malformed / sizeof *malformed; i++) {
		uint8_t *copy = unit_copy(malformed[i].bytes, malformed[i].len);

		assert_int_equal(track_hid_parse(copy, malformed[i].len, false, &pads, why,
						 sizeof why),
				 GR_ERR_FORMAT);
		if (!strstr(why, malformed[i].why))
			fail_msg("\"%s\" is not in \"%s\"", malformed[i].why, why);
		free(copy);
	}
}

/* What goes on and on. */
static void limits_hold(void **state)
{
	uint8_t bytes[TRACK_HID_DESCRIPTOR_MOST + 1];
	char why[200];

	(void)state;
	memset(bytes, PUSH, sizeof bytes);
	assert_int_equal(track_hid_parse(bytes, sizeof bytes - 1, false, &pads, why, sizeof why),
			 GR_ERR_FORMAT);
	assert_non_null(strstr(why, "byte 64: more than 64 states are pushed"));
	memset(bytes, 0xa0, sizeof bytes); /* collections without a kind */
	assert_int_equal(track_hid_parse(bytes, sizeof bytes - 1, false, &pads, why, sizeof why),
			 GR_ERR_FORMAT);
	assert_non_null(strstr(why, "byte 64: collections are nested more than 64 deep"));
	memset(bytes, 0x09, sizeof bytes);
	assert_int_equal(track_hid_parse(bytes, sizeof bytes - 1, false, &pads, why, sizeof why),
			 GR_ERR_FORMAT);
	assert_non_null(strstr(why, "byte 256: one item has more than 128 usages"));
	assert_int_equal(track_hid_parse(bytes, sizeof bytes, false, &pads, why, sizeof why),
			 GR_ERR_FORMAT);
	assert_non_null(strstr(why, "4097 bytes long; at most 4096 can be"));
}

/* Cut off anywhere, and with any byte another: an answer, and nothing read that is not there. */
static void cut_off_and_damaged(void **state)
{
	static const uint8_t whole[] = { DUALSHOCK4_DESCRIPTOR };
	struct unit_random random = unit_random_start("damage");
	const uint8_t report[64] = { 1, 2, 3 };
	unsigned accepted = 0;
	char why[200];

	(void)state;
	for (size_t len = 0; len < sizeof whole; len++) {
		uint8_t *copy = unit_copy(whole, len);

		assert_int_equal(track_hid_parse(copy, len, false, &pads, why, sizeof why),
				 GR_ERR_FORMAT);
		free(copy);
	}
	for (int i = 0; i < 20000; i++) {
		uint8_t *copy = unit_copy(whole, sizeof whole);

		copy[unit_random_u32(&random) % sizeof whole] = (uint8_t)unit_random_u32(&random);
		if (track_hid_parse(copy, sizeof whole, i % 2, &pads, why, sizeof why) == GR_OK) {
			accepted++;
			track_hid_rest(&values);
			for (size_t len = 0; len <= sizeof report; len++)
				(void)take(report, len, (uint8_t)i);
			for (int axis = 0; axis < TRACK_HID_AXES; axis++)
				assert_true(fabsf(values.axes[0][axis]) <= 1);
		}
		free(copy);
	}
	printf("# %u of 20000 damaged descriptors are some other pad's\n", accepted);
}

static void *look_and_open(void *ctx)
{
	const struct track_hid_node none = { .path = "/dev/grotto-none" };
	struct track_hid_node nodes[2];
	char why[TRACK_WHY];
	hid_device *hid;

	(void)ctx;
	for (int i = 0; i < 5000; i++) {
		if (track_hid_open(&none, &hid, why, sizeof why) != TRACK_ABSENT)
			return ctx;
		if (i % 100 == 0)
			(void)track_hid_list(0xfffe, 0xfffe, nodes, 2);
	}
	return NULL;
}

/* As the threads of several absent devices do: hidapi's error text is one for all of them. */
static void several_threads_look_at_once(void **state)
{
	pthread_t threads[4];
	char wrong;

	(void)state;
	for (int i = 0; i < 4; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, look_and_open, &wrong), 0);
	for (int i = 0; i < 4; i++) {
		void *result;

		assert_int_equal(pthread_join(threads[i], &result), 0);
		assert_null(result);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_dualshock_4),
		cmocka_unit_test(a_hat_has_eight_directions_and_none),
		cmocka_unit_test(axes_of_any_size_anywhere),
		cmocka_unit_test(maxima_below_the_minimum_are_unsigned),
		cmocka_unit_test(what_is_out_of_range_says_nothing),
		cmocka_unit_test(sliders_pedals_and_wheels),
		cmocka_unit_test(arrays_list_what_is_pressed),
		cmocka_unit_test(buttons_that_measure_count_from_half_their_way),
		cmocka_unit_test(usages_come_in_many_forms),
		cmocka_unit_test(several_collections),
		cmocka_unit_test(a_device_that_is_named_may_call_itself_anything),
		cmocka_unit_test(what_is_malformed_is_refused_with_the_place),
		cmocka_unit_test(limits_hold),
		cmocka_unit_test(cut_off_and_damaged),
		cmocka_unit_test(several_threads_look_at_once),
	};

	return cmocka_run_group_tests_name("hid_descriptor", tests, NULL, NULL);
}
