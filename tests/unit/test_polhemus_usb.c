/* Polhemus' trackers with the real libusb under their drivers: finding, setting up. */
#include "tests/unit/polhemus_fixture.h"

/* ---- what is not there ---- */

static void nothing_is_plugged_in(void **state)
{
	static const char *const texts[] = { "no Polhemus VIPER (0f44:bf01) is plugged in",
					     "no Polhemus LIBERTY (0f44:ff20) is plugged in",
					     "no Polhemus PATRIOT (0f44:ef20) is plugged in" };
	struct fixture *f = *state;

	for (int i = 0; i < TRACK_POLHEMUS_MODELS; i++) {
		create_model(f, (enum track_polhemus_model)i);
		until(f, TRACK_ABSENT);
		assert_string_equal(status_of(f).why, texts[i]);
		track_device_destroy(&f->device);
	}
	create(f, (struct track_polhemus_params){ .path = "1-7" });
	until(f, TRACK_ABSENT);
	assert_string_equal(status_of(f).why, "no Polhemus VIPER is plugged in at USB 1-7");
	track_device_destroy(&f->device);
	create(f, (struct track_polhemus_params){ .serial = "X", .path = "1-7" });
	until(f, TRACK_ABSENT);
	assert_string_equal(status_of(f).why,
			    "no Polhemus VIPER with serial number X at USB 1-7 is plugged in");
}

static void what_cannot_be_made(void **state)
{
	struct fixture *f = *state;
	struct track_polhemus_params params = { .rate_hz = 100 };
	char longer[80];

	assert_int_equal(track_polhemus_create(&f->device, &params, &gr_clock_monotonic),
			 GR_ERR_RANGE);
	memset(longer, 'x', sizeof longer);
	longer[sizeof longer - 1] = '\0';
	params.rate_hz = 240;
	params.serial = longer;
	assert_int_equal(track_polhemus_create(&f->device, &params, &gr_clock_monotonic),
			 GR_ERR_RANGE);
	assert_null(f->device);
}

static void a_bare_chip_is_told_apart(void **state)
{
	static const struct {
		enum track_polhemus_model model;
		uint16_t product;
	} bare[] = { { TRACK_POLHEMUS_MODEL_LIBERTY, 0xff21 },
		     { TRACK_POLHEMUS_MODEL_LIBERTY, 0xff11 },
		     { TRACK_POLHEMUS_MODEL_PATRIOT, 0xef21 },
		     { TRACK_POLHEMUS_MODEL_PATRIOT, 0xef11 } };
	struct fixture *f = *state;

	for (size_t i = 0; i < sizeof bare / sizeof *bare; i++) {
		f->mock.product = bare[i].product;
		mock_polhemus_plug(&f->mock, bed);
		create_model(f, bare[i].model);
		until(f, TRACK_FAILED);
		assert_why(f, "has no firmware yet: load the maker's with fxload");
		assert_why(f, "at USB 1-2");
		track_device_destroy(&f->device);
		mock_polhemus_unplug(&f->mock);
		mock_polhemus_finish(&f->mock);
	}
}

static void one_that_may_not_be_opened(void **state)
{
	struct fixture *f = *state;

	f->mock.viper = f->mock.denied = true;
	mock_polhemus_plug(&f->mock, bed);
	create_model(f, TRACK_POLHEMUS_MODEL_VIPER);
	until(f, TRACK_DENIED);
	assert_why(f, "/dev/bus/usb/001/002: no permission; install the udev rule 70-grotto.rules");
}

static void one_that_another_program_has(void **state)
{
	struct fixture *f = *state;

	f->mock.busy = true;
	mock_polhemus_plug(&f->mock, bed);
	create_model(f, TRACK_POLHEMUS_MODEL_LIBERTY);
	until(f, TRACK_BUSY);
	assert_why(f, "/dev/bus/usb/001/002: another program has it; end that one");
	assert_int_equal(counters_of(f).opened, 0);
	/* Which ends: it is taken up without anybody plugging anything. */
	mock_usb_let_go(f->mock.usb);
	until(f, TRACK_RUNNING);
	assert_true(mock_usb_claimed(f->mock.usb));
}

static void one_that_is_something_else(void **state)
{
	struct fixture *f = *state;

	f->mock.no_endpoints = true;
	mock_polhemus_plug(&f->mock, bed);
	create_model(f, TRACK_POLHEMUS_MODEL_LIBERTY);
	until(f, TRACK_FAILED);
	assert_why(f, "has no pair of bulk endpoints");
	assert_false(mock_usb_claimed(f->mock.usb));
}

/* ---- VIPER ---- */

static void a_viper_is_set_up_and_left_silent(void **state)
{
	struct fixture *f = *state;
	const uint32_t sensors = 1u << 0 | 1u << 3 | 1u << 15;
	struct track_report r;

	f->mock.viper = f->mock.unconfigured = true;
	f->mock.sensors = sensors;
	mock_polhemus_plug(&f->mock, bed);
	create(f, (struct track_polhemus_params){ .rate_hz = 480,
						  .hemisphere = { 0, 0, -0.5f },
						  .follow = true });
	until(f, TRACK_RUNNING);
	assert_string_equal(status_of(f).why,
			    "/dev/bus/usb/001/002, USB 1-2, serial number V0001");
	assert_int_equal(mock_usb_configuration(f->mock.usb), 1);
	assert_int_equal(f->mock.units[0], TRACK_VIPER_METRES);
	assert_int_equal(f->mock.units[1], TRACK_VIPER_QUATERNION);
	assert_int_equal(f->mock.rate, 4);
	assert_int_equal(f->mock.predicts, 0);
	assert_int_equal(f->mock.filter_level, 0);
	assert_int_equal(f->mock.hemisphere_bits, 1);
	assert_vector(f->mock.hemisphere, 1, 0, 0); /* the base's -Z is forward */
	assert_int_equal(mock_usb_reads(f->mock.usb), 16);
	for (uint32_t frame = 0; frame < 50; frame++) {
		mock_polhemus_tick(&f->mock);
		for (unsigned i = 0; i < 16; i++) {
			if (!(sensors >> i & 1))
				continue;
			r = next(f);
			assert_int_equal(r.sensor, i);
			assert_made(&r, frame);
			assert_true(r.has & TRACK_BUTTONS && r.buttons == 2);
			assert_true(r.has & TRACK_QUALITY && fabsf(r.quality - 0.8f) < 1e-6f);
			assert_int_equal(r.device_ns, frame * INT64_C(2083333));
		}
	}
	assert_int_equal(counters_of(f).reports, 150);
	track_device_destroy(&f->device);
	assert_false(mock_polhemus_sends(&f->mock));
	assert_false(mock_usb_claimed(f->mock.usb));
	assert_int_equal(mock_usb_reads(f->mock.usb), 0);
}

static void its_own_filter_may_stay(void **state)
{
	struct fixture *f = *state;

	f->mock.viper = true;
	mock_polhemus_plug(&f->mock, bed);
	create(f, (struct track_polhemus_params){ .filter = true });
	until(f, TRACK_RUNNING);
	assert_int_equal(f->mock.filter_level, 2);
	assert_int_equal(f->mock.rate, 3);
	assert_int_equal(mock_polhemus_heard(&f->mock, "0 0"), 0); /* nor the hemisphere */
}

/* Whatever stands in the stream: half a frame, pose frames between the answers. */
static void one_that_was_left_sending_is_taken_over(void **state)
{
	struct fixture *f = *state;

	for (int i = 0; i < 3; i++) {
		const enum track_polhemus_model model = (enum track_polhemus_model)i;

		f->mock = (struct mock_polhemus){ .viper = i == 0, .sending = true, .sensors = 3 };
		f->mock.product = i == 2 ? 0xef20 : 0;
		mock_polhemus_plug(&f->mock, bed);
		mock_usb_push(f->mock.usb, (const uint8_t *)"\1\2\3VPR\377LY\1C ", 13);
		start_ticking(f, &f->mock);
		create_model(f, model);
		until(f, TRACK_RUNNING);
		/* The first may come before all of it is set up: then the second is the first. */
		for (unsigned k = 0, first = next(f).sensor; k < 50; k++)
			assert_int_equal(next(f).sensor, (first + k + 1) % 2);
		assert_int_equal(counters_of(f).faults[TRACK_FAULT_CHECKSUM], 0);
		assert_int_equal(counters_of(f).faults[TRACK_FAULT_FORMAT], 0);
		assert_int_equal(counters_of(f).missed, 0);
		track_device_destroy(&f->device);
		assert_false(mock_polhemus_sends(&f->mock));
		stop_ticking(f);
		mock_polhemus_unplug(&f->mock);
		mock_polhemus_finish(&f->mock);
	}
}

static void a_viper_that_refuses(void **state)
{
	struct fixture *f = *state;

	f->mock.viper = true;
	f->mock.refuses = 1u << TRACK_VIPER_PREDICTION;
	mock_polhemus_plug(&f->mock, bed);
	create_model(f, TRACK_POLHEMUS_MODEL_VIPER);
	until(f, TRACK_RUNNING);
	assert_why(f, "; its own prediction stays as it is, it refuses to predict nothing: no such "
		      "command");
	track_device_destroy(&f->device);

	f->mock.refuses = 1u << TRACK_VIPER_UNITS;
	create_model(f, TRACK_POLHEMUS_MODEL_VIPER);
	until(f, TRACK_FAILED);
	assert_why(f, "/dev/bus/usb/001/002: refuses metres and quaternions: no such command");
	assert_false(mock_usb_claimed(f->mock.usb));
	f->mock.refuses = 0;
	f->mock.not_ready = true;
	until_why(f, "not ready yet");
	assert_int_equal(status_of(f).state, TRACK_FAILED);
	f->mock.not_ready = false;
	f->mock.no_sensors = true;
	until(f, TRACK_RUNNING);
	assert_why(f, "; no sensor is plugged into it");
	track_device_destroy(&f->device);

	f->mock.mute = true;
	create_model(f, TRACK_POLHEMUS_MODEL_VIPER);
	until(f, TRACK_FAILED);
	assert_why(f, "does not answer; switch it off and on");
}

/* A command of 32 or 48 bytes fills packets of 16: the mock waits for the empty one. */
static void a_full_last_packet_is_followed_by_an_empty_one(void **state)
{
	struct fixture *f = *state;

	f->mock.viper = true;
	f->mock.packet = 16;
	mock_polhemus_plug(&f->mock, bed);
	create(f, (struct track_polhemus_params){ .hemisphere = { 1, 0, 0 } });
	until(f, TRACK_RUNNING);
	assert_true(f->mock.empty_packets >= 5);
	/* And the other way a frame of 60 bytes comes in four packets. */
	for (uint32_t i = 0; i < 10; i++) {
		mock_polhemus_tick(&f->mock);
		const struct track_report r = next(f);
		assert_made(&r, i);
	}
}

/* ---- LIBERTY, PATRIOT ---- */

static void a_liberty_is_set_up_and_left_silent(void **state)
{
	struct fixture *f = *state;
	static const unsigned sensors[] = { 0, 2, 15 };
	uint32_t frame;

	f->mock.sensors = 0x8005;
	mock_polhemus_plug(&f->mock, bed);
	create(f, (struct track_polhemus_params){ .model = TRACK_POLHEMUS_MODEL_LIBERTY,
						  .hemisphere = { 0, -2, 0 } });
	until(f, TRACK_RUNNING);
	assert_string_equal(status_of(f).why,
			    "/dev/bus/usb/001/002, USB 1-2, serial number not said");
	assert_true(f->mock.binary && f->mock.centimetres);
	assert_int_equal(f->mock.filter_level, 0);
	assert_vector(f->mock.hemisphere, 0, 0, 1); /* down */
	frame = f->mock.frame;
	for (uint32_t i = 0; i < 50; i++) {
		mock_polhemus_tick(&f->mock);
		for (int k = 0; k < 3; k++) {
			const struct track_report r = next(f);

			assert_int_equal(r.sensor, sensors[k]);
			assert_made(&r, frame + i);
			assert_true(r.has & TRACK_BUTTONS && r.buttons == 1);
			assert_true(r.has & TRACK_QUALITY && r.quality == 1);
		}
	}
	track_device_destroy(&f->device);
	assert_false(mock_polhemus_sends(&f->mock));
}

static void a_patriot_without_the_button_item(void **state)
{
	struct fixture *f = *state;

	f->mock.product = 0xef12;
	f->mock.no_button = true;
	mock_polhemus_plug(&f->mock, bed);
	create_model(f, TRACK_POLHEMUS_MODEL_PATRIOT);
	until(f, TRACK_RUNNING);
	mock_polhemus_tick(&f->mock);
	const struct track_report r = next(f);
	assert_made(&r, f->mock.frame - 1);
	assert_false(r.has & TRACK_BUTTONS);
}

static void a_liberty_that_refuses(void **state)
{
	struct fixture *f = *state;

	f->mock.other_list = true;
	mock_polhemus_plug(&f->mock, bed);
	create_model(f, TRACK_POLHEMUS_MODEL_LIBERTY);
	until(f, TRACK_FAILED);
	assert_why(f, "sends poses of 12 bytes where 40 were asked for (O command)");
	f->mock.other_list = false;
	f->mock.no_sensors = true;
	until(f, TRACK_RUNNING);
	assert_why(f, "; no sensor is plugged into it");
	track_device_destroy(&f->device);
	f->mock.mute = true;
	create_model(f, TRACK_POLHEMUS_MODEL_LIBERTY);
	until(f, TRACK_FAILED);
	assert_why(f, "does not say which stations it has (Ctrl-U)");
	track_device_destroy(&f->device);
	f->mock.mute = f->mock.no_sensors = false;
	f->mock.never_stops = true;
	create_model(f, TRACK_POLHEMUS_MODEL_LIBERTY);
	until(f, TRACK_FAILED);
	assert_why(f, "does not stop sending");
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		TEST(nothing_is_plugged_in),
		TEST(what_cannot_be_made),
		TEST(a_bare_chip_is_told_apart),
		TEST(one_that_may_not_be_opened),
		TEST(one_that_another_program_has),
		TEST(one_that_is_something_else),
		TEST(a_viper_is_set_up_and_left_silent),
		TEST(its_own_filter_may_stay),
		TEST(one_that_was_left_sending_is_taken_over),
		TEST(a_viper_that_refuses),
		TEST(a_full_last_packet_is_followed_by_an_empty_one),
		TEST(a_liberty_is_set_up_and_left_silent),
		TEST(a_patriot_without_the_button_item),
		TEST(a_liberty_that_refuses),
	};
	int failed;

	(void)argc;
	bed = mock_begin(argv);
	failed = cmocka_run_group_tests_name("polhemus_usb", tests, NULL, NULL);
	g_object_unref(bed);
	return failed;
}
