/* Gamepads, Sony's pads and SpaceMouse with the real hidapi under their drivers. */
#include "tests/unit/pads_fixture.h"

#include "tracking/hid.h"

#include <grp.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void create_gamepad(struct fixture *f, struct track_gamepad_params params)
{
	assert_int_equal(track_gamepad_create(&f->device, &params, &f->clock.clock), GR_OK);
}

static void create_sony(struct fixture *f, struct track_sony_params params)
{
	assert_int_equal(track_sony_create(&f->device, &params, &f->clock.clock), GR_OK);
}

static void create_spacemouse(struct fixture *f, struct track_spacemouse_params params)
{
	params.motion =
		(struct track_spacemouse_motion){ .speed_m_s = 1, .turn_rad_s = 1, .reach_m = 2 };
	assert_int_equal(track_spacemouse_create(&f->device, &params, &f->clock.clock), GR_OK);
}

/* ---- any gamepad ---- */

static void a_joystick_is_found_by_what_it_says(void **state)
{
	const uint8_t said[] = { 1, 127, 12, 0x81 }, other[] = { 2, 0, 0, 0 };
	struct fixture *f = *state;
	struct track_report r;

	plug(&f->pads[0], &(struct mock_hid_params){ .number = 0,
						     .vendor = 0x1234,
						     .product = 1,
						     .descriptor = mouse_descriptor,
						     .descriptor_len = sizeof mouse_descriptor });
	create_gamepad(f, (struct track_gamepad_params){ .dead_zone = 0.1f });
	until(f, TRACK_ABSENT);
	assert_string_equal(status_of(f).why, "no gamepad is plugged in");
	plug_joystick(&f->pads[1], 1, "");
	until(f, TRACK_RUNNING);
	assert_why(f, "/dev/hidraw1, Pad (0079:0006) at 1-2, 8 buttons, 2 axes");
	mock_hid_push(f->pads[1].hid, said, 3);
	mock_hid_push(f->pads[1].hid, other, sizeof other);
	mock_hid_push(f->pads[1].hid, said, sizeof said);
	r = next(f);
	assert_int_equal(r.has, TRACK_BUTTONS | TRACK_AXIS_VALUES);
	assert_int_equal(r.buttons, 0x81);
	assert_true(r.axes[0] == 1.0f && r.axes[1] == 0); /* in the dead zone */
	assert_int_equal(counters_of(f).faults[TRACK_FAULT_LENGTH], 1);
	assert_int_equal(counters_of(f).faults[TRACK_FAULT_FORMAT], 1);
	/* It says nothing more while it is held so: its state is told again. */
	for (int i = 0; i < 3; i++)
		assert_int_equal(next(f).buttons, 0x81);
}

static void of_several_the_one_that_is_meant(void **state)
{
	static const struct {
		struct track_gamepad_params params;
		const char *why;
	} choices[] = {
		{ { .number = 0 }, "/dev/hidraw0" },
		{ { .number = 1 }, "/dev/hidraw1" },
		{ { .path = "1-2" }, "/dev/hidraw1" },
		{ { .serial = "B" }, "/dev/hidraw1" },
		{ { .vendor = 0x054c }, "/dev/hidraw2" },
		{ { .vendor = 0x0079, .product = 6, .number = 1 }, "/dev/hidraw1" },
		{ { .number = 3 }, "no gamepad number 3 is plugged in" },
		{ { .vendor = 0x46d, .product = 0xc21d }, "no gamepad 046d:c21d is plugged in" },
		{ { .serial = "C", .path = "1-9" },
		  "no gamepad with serial number C at USB 1-9 is plugged in" },
	};
	struct fixture *f = *state;

	plug_joystick(&f->pads[0], 0, "A");
	plug_joystick(&f->pads[1], 1, "B");
	plug_sony(&f->pads[2], 2, true, false, 0x0ce6, "");
	for (size_t i = 0; i < sizeof choices / sizeof *choices; i++) {
		create_gamepad(f, choices[i].params);
		until(f, choices[i].why[0] == '/' ? TRACK_RUNNING : TRACK_ABSENT);
		assert_why(f, choices[i].why);
		track_device_destroy(&f->device);
	}
}

/* A device that somebody named need not call itself a gamepad. */
static void one_that_is_named_may_be_a_mouse(void **state)
{
	struct fixture *f = *state;

	plug(&f->pads[0], &(struct mock_hid_params){ .number = 0,
						     .vendor = 0x1234,
						     .product = 1,
						     .descriptor = mouse_descriptor,
						     .descriptor_len = sizeof mouse_descriptor });
	create_gamepad(f, (struct track_gamepad_params){ .vendor = 0x1234, .product = 1 });
	until(f, TRACK_RUNNING);
	mock_hid_push(f->pads[0].hid, (const uint8_t[]){ 4 }, 1);
	assert_int_equal(next(f).buttons, 4);
}

static void a_descriptor_that_is_malformed_is_named(void **state)
{
	static const uint8_t malformed[] = { APPLICATION(GAMEPAD), USAGE(0x30), RANGE(5, 5),
					     FIELD(8, 1),	   VARIABLE,	END };
	struct fixture *f = *state;

	plug(&f->pads[0], &(struct mock_hid_params){ .number = 0,
						     .vendor = 0x1234,
						     .product = 1,
						     .descriptor = malformed,
						     .descriptor_len = sizeof malformed });
	create_gamepad(f, (struct track_gamepad_params){ 0 });
	until(f, TRACK_FAILED);
	assert_string_equal(status_of(f).why,
			    "/dev/hidraw0: report descriptor, byte 16: an axis whose "
			    "logical maximum is not above its minimum");
	/* It is in nobody's way. */
	plug_joystick(&f->pads[1], 1, "");
	until(f, TRACK_RUNNING);
	assert_why(f, "/dev/hidraw1");
}

/* ---- Sony ---- */

static void by_bluetooth_reading_its_calibration_switches_it(void **state)
{
	struct fixture *f = *state;
	uint8_t bytes[SONY_MOST];

	for (unsigned dualsense = 0; dualsense < 2; dualsense++) {
		struct mock_pad *pad = &f->pads[dualsense];
		struct track_report r;

		plug_sony(pad, (int)dualsense, dualsense, true, dualsense ? 0x0ce6 : 0x09cc,
			  "a4:53:85:00:00:01");
		create_sony(f, (struct track_sony_params){
				       .model = (enum track_sony_model)dualsense });
		until(f, TRACK_RUNNING);
		assert_why(f,
			   dualsense ? "DualSense by Bluetooth, serial number a4:53:85:00:00:01"
				     : "DualShock 4 by Bluetooth, serial number a4:53:85:00:00:01");
		assert_null(strstr(status_of(f).why, "nominal"));
		assert_int_equal(pad->asked, 1);
		pad->made.count = 10;
		for (int i = 0; i < 10; i++)
			sony_say(pad);
		for (int i = 0; i < 10; i++) {
			r = next(f);
			assert_true((r.has & (TRACK_ORIENTATION | TRACK_DEVICE_TIME)) ==
				    (TRACK_ORIENTATION | TRACK_DEVICE_TIME));
			assert_true(fabsf(r.T_base_sensor.q[3] - 1) < 1e-3f);
		}
		assert_int_equal(counters_of(f).missed, 0);
		/* One is damaged on its way: counted, and counted as missing. */
		pad->made.count++;
		sony_make(bytes, &pad->made);
		bytes[20] ^= 4;
		mock_hid_push(pad->hid, bytes, sizeof bytes);
		sony_say(pad);
		(void)next(f);
		assert_int_equal(counters_of(f).faults[TRACK_FAULT_CHECKSUM], 1);
		assert_int_equal(counters_of(f).missed, 1);
		track_device_destroy(&f->device);
		memset(&f->reader, 0, sizeof f->reader);
	}
}

static void one_that_does_not_listen_is_asked_again(void **state)
{
	struct fixture *f = *state;
	struct mock_pad *pad = &f->pads[0];
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;
	struct track_report r;

	pad->deaf = true;
	plug_sony(pad, 0, false, true, 0x05c4, "");
	create_sony(f, (struct track_sony_params){ .model = TRACK_SONY_DUALSHOCK4 });
	until(f, TRACK_RUNNING);
	sony_say(pad);
	r = next(f);
	assert_int_equal(r.has, TRACK_BUTTONS | TRACK_AXIS_VALUES);
	const unsigned before = pad->asked;
	f->clock.ahead_ns += 3 * GR_NS_PER_S;
	sony_say(pad);
	(void)next(f);
	assert_int_equal(pad->asked, before + 1);
	pad->deaf = false;
	do {
		sony_say(pad);
		r = next(f);
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
	} while (!(r.has & TRACK_ORIENTATION));
}

static void a_copy_without_calibration_has_nominal_values(void **state)
{
	struct fixture *f = *state;

	f->pads[0].mute = true;
	plug_sony(&f->pads[0], 0, false, false, 0x05c4, "");
	create_sony(f, (struct track_sony_params){ .model = TRACK_SONY_DUALSHOCK4 });
	until(f, TRACK_RUNNING);
	assert_why(f, "DualShock 4 by USB 1-1, serial number not said; it says no calibration");
	assert_int_equal(f->pads[0].asked, 3);
	sony_say(&f->pads[0]);
	assert_true(next(f).has & TRACK_ORIENTATION);
}

static void the_dongle_has_lost_its_pad(void **state)
{
	struct fixture *f = *state;
	uint8_t bytes[SONY_MOST];

	plug_sony(&f->pads[0], 0, false, false, 0x0ba0, "");
	create_sony(f, (struct track_sony_params){ .model = TRACK_SONY_DUALSHOCK4 });
	until(f, TRACK_RUNNING);
	assert_why(f, "by its dongle at USB 1-1");
	assert_null(strstr(status_of(f).why, "nominal"));
	sony_say(&f->pads[0]);
	assert_false(next(f).has & TRACK_LOST);
	sony_make(bytes, &f->pads[0].made);
	bytes[31] |= 4;
	mock_hid_push(f->pads[0].hid, bytes, 64);
	assert_int_equal(next(f).has, TRACK_LOST);
}

/* A quarter turn to the left, taken for ahead when the button is pressed. */
static void a_button_sets_the_heading(void **state)
{
	struct fixture *f = *state;
	struct mock_pad *pad = &f->pads[0];
	struct track_report r;

	plug_sony(pad, 0, true, false, 0x0df2, "");
	create_sony(f, (struct track_sony_params){ .model = TRACK_SONY_DUALSENSE,
						   .recentre = 1u << TRACK_SONY_OPTIONS });
	until(f, TRACK_RUNNING);
	sony_say(pad);
	(void)next(f);
	pad->made.gyro[1] = 90 * 16;
	for (int i = 0; i < 250; i++) {
		sony_say(pad);
		r = next(f);
	}
	assert_true(fabsf(r.T_base_sensor.q[1] - sqrtf(0.5f)) < 0.01f);
	pad->made.gyro[1] = 0;
	pad->made.buttons[1] = 0x20;
	sony_say(pad);
	r = next(f);
	assert_int_equal(r.buttons, 1u << TRACK_SONY_OPTIONS);
	assert_true(fabsf(r.T_base_sensor.q[1]) < 1e-3f);
}

/* ---- SpaceMouse ---- */

static void a_cap_moves_a_body(void **state)
{
	const uint8_t right[] = { 1, 0x5e, 1, 0, 0, 0, 0 }, released[7] = { 1 },
		      pressed[] = { 3, 2, 0 };
	struct fixture *f = *state;
	struct track_report r;
	float x;

	/* A mouse of the same vendor's, and the other interface of one that has a keyboard, too. */
	plug(&f->pads[1], &(struct mock_hid_params){ .number = 1,
						     .vendor = 0x256f,
						     .product = 0xc650,
						     .descriptor = cap_descriptor,
						     .descriptor_len = sizeof cap_descriptor });
	plug(&f->pads[2], &(struct mock_hid_params){ .number = 2,
						     .vendor = 0x256f,
						     .product = 0xc633,
						     .descriptor = mouse_descriptor,
						     .descriptor_len = sizeof mouse_descriptor });
	create_spacemouse(f, (struct track_spacemouse_params){ 0 });
	until(f, TRACK_ABSENT);
	assert_string_equal(status_of(f).why, "no SpaceMouse is plugged in");
	plug_spacemouse(&f->pads[0], 0);
	until(f, TRACK_RUNNING);
	assert_why(f, "/dev/hidraw0, SpaceMouse Compact (256f:c635) at 1-1");
	r = next(f); /* at rest it is where it is */
	assert_true(r.T_base_sensor.p[0] == 0);
	mock_hid_push(f->pads[0].hid, right, sizeof right);
	do
		r = next(f);
	while (r.axes[0] == 0);
	/* It goes on between reports, until it is let go. */
	do {
		mock_hid_push(f->pads[0].hid, right, sizeof right); /* a hand is never still */
		x = r.T_base_sensor.p[0];
		r = next(f);
		assert_true(r.T_base_sensor.p[0] >= x);
	} while (r.T_base_sensor.p[0] < 0.05f);
	mock_hid_push(f->pads[0].hid, released, sizeof released);
	do
		r = next(f);
	while (r.axes[0] != 0);
	x = r.T_base_sensor.p[0];
	mock_hid_push(f->pads[0].hid, pressed, sizeof pressed);
	do
		r = next(f);
	while (!r.buttons);
	assert_int_equal(r.buttons, 2);
	assert_true(r.T_base_sensor.p[0] == x);
	mock_hid_push(f->pads[0].hid, right, sizeof right - 1);
	mock_hid_push(f->pads[0].hid, (const uint8_t[]){ 0x17, 3 }, 2);
	mock_hid_push(f->pads[0].hid, (const uint8_t[]){ 0x42, 3 }, 2);
	while (!counters_of(f).faults[TRACK_FAULT_FORMAT])
		(void)next(f);
	assert_int_equal(counters_of(f).faults[TRACK_FAULT_LENGTH], 1);
	assert_int_equal(counters_of(f).faults[TRACK_FAULT_FORMAT], 1);
}

/* ---- the life of each ---- */

enum kind { ANY_GAMEPAD, DUALSHOCK4, DUALSENSE, SPACEMOUSE, KINDS };

static void create_kind(struct fixture *f, enum kind kind, int number)
{
	switch (kind) {
	case ANY_GAMEPAD:
		create_gamepad(f, (struct track_gamepad_params){ .number = number });
		break;
	case SPACEMOUSE:
		create_spacemouse(f, (struct track_spacemouse_params){ .number = number });
		break;
	default:
		create_sony(f, (struct track_sony_params){ .model = kind == DUALSENSE,
							   .number = number });
		break;
	}
}

static void plug_kind(struct mock_pad *pad, enum kind kind, int number)
{
	switch (kind) {
	case ANY_GAMEPAD: plug_joystick(pad, number, ""); break;
	case SPACEMOUSE: plug_spacemouse(pad, number); break;
	case DUALSHOCK4: plug_sony(pad, number, false, true, 0x05c4, ""); break;
	default: plug_sony(pad, number, true, false, 0x0ce6, ""); break;
	}
}

static void say_kind(struct mock_pad *pad, enum kind kind)
{
	const uint8_t joystick[] = { 1, 1, 2, 3 }, cap[13] = { 1 };

	if (kind == ANY_GAMEPAD)
		mock_hid_push(pad->hid, joystick, sizeof joystick);
	else if (kind == SPACEMOUSE)
		mock_hid_push(pad->hid, cap, sizeof cap);
	else
		sony_say(pad);
}

static void unplugged_and_plugged_again(void **state)
{
	struct fixture *f = *state;
	const int rounds = getenv("GROTTO_LONG") ? 200 : 3;
	struct unit_random random = unit_random_start("unplug");
	struct mock_pad *pad = &f->pads[0];

	for (unsigned kind = 0; kind < KINDS; kind++) {
		create_kind(f, (enum kind)kind, 0);
		for (int i = 0; i < rounds; i++) {
			plug_kind(pad, (enum kind)kind, i % 3);
			/* Sometimes it goes before it was found. */
			if (i % 4 != 3) {
				until(f, TRACK_RUNNING);
				for (uint32_t n = unit_random_u32(&random) % 8 + 1; n > 0; n--)
					say_kind(pad, (enum kind)kind);
				(void)next(f);
			}
			unplug(pad);
			until(f, TRACK_ABSENT);
		}
		assert_int_equal(counters_of(f).opened, rounds - rounds / 4);
		track_device_destroy(&f->device);
		memset(&f->reader, 0, sizeof f->reader);
	}
	printf("# unplugged and plugged again 4 x %d times\n", rounds);
}

static void of_two_alike_the_second_is_taken(void **state)
{
	struct fixture *f = *state;

	for (unsigned kind = 0; kind < KINDS; kind++) {
		create_kind(f, (enum kind)kind, 1);
		plug_kind(&f->pads[0], (enum kind)kind, 0);
		until(f, TRACK_ABSENT);
		assert_why(f, " number 1 is plugged in");
		plug_kind(&f->pads[1], (enum kind)kind, 1);
		until(f, TRACK_RUNNING);
		assert_why(f, "/dev/hidraw1");
		/* The other one is left alone. */
		assert_int_equal(f->pads[0].asked, 0);
		say_kind(&f->pads[0], (enum kind)kind);
		say_kind(&f->pads[1], (enum kind)kind);
		(void)next(f);
		assert_int_equal(mock_hid_waiting(f->pads[0].hid), 1);
		track_device_destroy(&f->device);
		memset(&f->reader, 0, sizeof f->reader);
		unplug(&f->pads[0]);
		unplug(&f->pads[1]);
	}
}

/* Each on its own thread, which waits for a device that says nothing. */
static void threads_end_soon(void **state)
{
	struct fixture *f = *state;
	int64_t longest_ns = 0;

	for (unsigned kind = 0; kind < KINDS; kind++) {
		const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;
		int64_t begin_ns, took_ns;

		plug_kind(&f->pads[0], (enum kind)kind, 0);
		create_kind(f, (enum kind)kind, 0);
		assert_int_equal(track_device_start(f->device), GR_OK);
		while (status_of(f).state != TRACK_RUNNING) {
			assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
			poll(NULL, 0, 1);
		}
		begin_ns = gr_clock_now(&gr_clock_monotonic);
		track_device_destroy(&f->device);
		took_ns = gr_clock_now(&gr_clock_monotonic) - begin_ns;
		longest_ns = took_ns > longest_ns ? took_ns : longest_ns;
		unplug(&f->pads[0]);
	}
	printf("# a thread ended %.1f ms after it was told to, at most\n",
	       (double)longest_ns * 1e-6);
	assert_true(longest_ns < 10 * GR_NS_PER_S);
}

/* What a user without the udev rule sees. Root may open anything, so somebody else tries. */
static void denied_names_the_rule(void **state)
{
	struct fixture *f = *state;
	g_autofree char *root = umockdev_testbed_get_root_dir(bed);
	int status;
	pid_t child;

	/* The bed is for everybody, and what umockdev puts in a node's place; the node is for
	 * nobody. */
	assert_int_equal(chmod(root, 0755), 0);
	for (unsigned kind = 0; kind < KINDS; kind++) {
		g_autofree char *node = g_strconcat(root, "/dev/hidraw0", NULL);

		plug_kind(&f->pads[0], (enum kind)kind, 0);
		g_autofree char *handler = g_strconcat(root, "/ioctl/dev/hidraw0", NULL);
		assert_int_equal(chmod(node, 0), 0);
		assert_int_equal(chmod(handler, 0777), 0);
		create_kind(f, (enum kind)kind, 0);
		child = fork();
		if (child == 0) {
			if (geteuid() == 0 &&
			    (setgroups(0, NULL) || setgid(65534) || setuid(65534)))
				_exit(77);
			track_device_turn(f->device, 20);
			_exit(status_of(f).state == TRACK_DENIED &&
					      strstr(status_of(f).why, "70-grotto.rules")
				      ? 0
				      : 1);
		}
		assert_int_equal(waitpid(child, &status, 0), child);
		assert_true(WIFEXITED(status));
		if (WEXITSTATUS(status) == 77)
			skip();
		assert_int_equal(WEXITSTATUS(status), 0);
		track_device_destroy(&f->device);
		unplug(&f->pads[0]);
	}
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		TEST(a_joystick_is_found_by_what_it_says),
		TEST(of_several_the_one_that_is_meant),
		TEST(one_that_is_named_may_be_a_mouse),
		TEST(a_descriptor_that_is_malformed_is_named),
		TEST(by_bluetooth_reading_its_calibration_switches_it),
		TEST(one_that_does_not_listen_is_asked_again),
		TEST(a_copy_without_calibration_has_nominal_values),
		TEST(the_dongle_has_lost_its_pad),
		TEST(a_button_sets_the_heading),
		TEST(a_cap_moves_a_body),
		TEST(unplugged_and_plugged_again),
		TEST(of_two_alike_the_second_is_taken),
		TEST(threads_end_soon),
		TEST(denied_names_the_rule),
	};
	int failed;

	(void)argc;
	bed = mock_begin(argv);
	failed = cmocka_run_group_tests_name("pads", tests, NULL, NULL);
	g_object_unref(bed);
	return failed;
}
