/* Polhemus' trackers with the real libusb under their drivers: what happens while they run. */
#include "tests/unit/polhemus_fixture.h"

#include <errno.h>
#include <libusb.h>

/* ---- what goes wrong meanwhile ---- */

static void damage_is_counted_and_goes_nowhere(void **state)
{
	struct fixture *f = *state;
	uint8_t bytes[MAKE_VIPER_MOST];
	size_t len;

	f->mock.viper = true;
	mock_polhemus_plug(&f->mock, bed);
	create_model(f, TRACK_POLHEMUS_MODEL_VIPER);
	until(f, TRACK_RUNNING);
	mock_polhemus_tick(&f->mock);
	next(f);
	len = make_viper_pose(bytes, 1, 1);
	bytes[40] ^= 0x10;
	mock_usb_push(f->mock.usb, bytes, len);
	f->mock.frame = 2;
	mock_polhemus_tick(&f->mock);
	struct track_report r = next(f);
	assert_made(&r, 2);
	assert_int_equal(counters_of(f).faults[TRACK_FAULT_CHECKSUM], 1);
	assert_int_equal(counters_of(f).missed, 1);
	/* Whole, but no pose: zeroes for a quaternion. */
	len = make_viper_pose(bytes, 3, 1);
	memset(bytes + 24 + 16, 0, 16);
	const struct gr_writer w = { bytes + len - 4, 4, 0, true };
	struct gr_writer sum = w;
	gr_write_u32(&sum, track_viper_checksum(bytes, len - 4));
	mock_usb_push(f->mock.usb, bytes, len);
	/* A sensor that there is not, one that repeats another, angles. */
	for (int i = 0; i < 3; i++) {
		len = make_viper_pose(bytes, 4, 1);
		bytes[24] = (uint8_t)(i == 0 ? 16 : i == 1 ? 0x80 : 0);
		bytes[25] = i == 2 ? 3 : bytes[25];
		sum = w;
		gr_write_u32(&sum, track_viper_checksum(bytes, len - 4));
		mock_usb_push(f->mock.usb, bytes, len);
	}
	/* Inches. */
	len = make_viper_pose(bytes, 5, 1);
	bytes[25] &= 0xfc;
	sum = w;
	gr_write_u32(&sum, track_viper_checksum(bytes, len - 4));
	mock_usb_push(f->mock.usb, bytes, len);
	r = next(f);
	assert_true(fabsf(r.T_base_sensor.p[2] + 0.505f * 0.0254f) < 1e-6f);
	assert_int_equal(counters_of(f).faults[TRACK_FAULT_POSE], 1);
	assert_int_equal(counters_of(f).faults[TRACK_FAULT_SENSOR], 2);
	assert_int_equal(counters_of(f).faults[TRACK_FAULT_FORMAT], 1);
}

static void sensors_come_and_go(void **state)
{
	struct fixture *f = *state;

	for (int i = 0; i < 2; i++) {
		uint32_t lost = 0;

		f->mock = (struct mock_polhemus){ .viper = i == 0, .sensors = 7 };
		mock_polhemus_plug(&f->mock, bed);
		create_model(f, i == 0 ? TRACK_POLHEMUS_MODEL_VIPER : TRACK_POLHEMUS_MODEL_LIBERTY);
		until(f, TRACK_RUNNING);
		for (int frame = 0; frame < 30; frame++) {
			f->mock.sensors = frame < 10 ? 7 : frame < 20 ? 5 : 7;
			mock_polhemus_tick(&f->mock);
		}
		while (counters_of(f).reports < 80 + 1) {
			const struct track_report r = next(f);

			lost += (r.has & TRACK_LOST) != 0;
			assert_true(!(r.has & TRACK_LOST) || r.sensor == 1);
		}
		assert_int_equal(lost, 1);
		track_device_destroy(&f->device);
		mock_polhemus_unplug(&f->mock);
		mock_polhemus_finish(&f->mock);
		memset(&f->reader, 0, sizeof f->reader);
	}
}

static void a_halted_endpoint_goes_on(void **state)
{
	struct fixture *f = *state;

	f->mock.viper = true;
	mock_polhemus_plug(&f->mock, bed);
	create_model(f, TRACK_POLHEMUS_MODEL_VIPER);
	until(f, TRACK_RUNNING);
	for (uint32_t i = 0; i < 20; i++) {
		mock_usb_push_error(f->mock.usb, -EPIPE);
		mock_polhemus_tick(&f->mock);
		const struct track_report r = next(f);
		assert_made(&r, i);
	}
	assert_int_equal(mock_usb_reads(f->mock.usb), 16);
	/* Again and again with nothing between: that is no hiccup. */
	for (int i = 0; i < 10; i++)
		mock_usb_push_error(f->mock.usb, -EPIPE);
	until(f, TRACK_FAILED);
	assert_why(f, "the USB connection broke: ");
	until(f, TRACK_RUNNING);
	/* The cable has a bad contact. */
	mock_usb_push_error(f->mock.usb, -EPROTO);
	until(f, TRACK_FAILED);
	assert_why(f, "the USB connection broke: ");
	until(f, TRACK_RUNNING);
	assert_int_equal(counters_of(f).opened, 3);
}

static void one_that_falls_silent_is_set_up_again(void **state)
{
	struct fixture *f = *state;
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;
	struct track_report r;
	int64_t last_ns;

	f->mock.viper = true;
	mock_polhemus_plug(&f->mock, bed);
	create_model(f, TRACK_POLHEMUS_MODEL_VIPER);
	until(f, TRACK_RUNNING);
	f->mock.frame = 1000;
	mock_polhemus_tick(&f->mock);
	last_ns = next(f).device_ns;
	/* Switched off and on: what it was told is forgotten, and it counts from 0. */
	pthread_mutex_lock(&f->mock.lock);
	f->mock.sending = false;
	f->mock.units[0] = 0;
	f->mock.frame = 0;
	pthread_mutex_unlock(&f->mock.lock);
	while (!mock_polhemus_sends(&f->mock)) {
		track_device_turn(f->device, 100);
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
	}
	assert_int_equal(f->mock.units[0], TRACK_VIPER_METRES);
	assert_int_equal(status_of(f).state, TRACK_RUNNING);
	mock_polhemus_tick(&f->mock);
	r = next(f);
	assert_made(&r, 0);
	assert_true(r.device_ns > last_ns);
	assert_int_equal(counters_of(f).opened, 1);
}

/* ---- several, plugging ---- */

static void of_two_one_is_chosen(void **state)
{
	static const struct {
		struct track_polhemus_params params;
		const char *device;
	} choices[] = {
		{ { .number = 0 }, "/dev/bus/usb/001/002" },
		{ { .number = 1 }, "/dev/bus/usb/001/003" },
		{ { .path = "1-3" }, "/dev/bus/usb/001/003" },
		{ { .serial = "V0002" }, "/dev/bus/usb/001/003" }, /* what it says itself */
		{ { .serial = "USB-2" }, "/dev/bus/usb/001/003" }, /* what its descriptor says */
		{ { .serial = "V0001", .path = "1-2" }, "/dev/bus/usb/001/002" },
	};
	struct fixture *f = *state;

	f->mock = (struct mock_polhemus){ .viper = true, .serial = "V0001", .usb_serial = "USB-1" };
	f->second = (struct mock_polhemus){ .viper = true, .serial = "V0002", .usb_serial = "USB-2" };
	f->second.number = 3;
	mock_polhemus_plug(&f->mock, bed);
	mock_polhemus_plug(&f->second, bed);
	for (size_t i = 0; i < sizeof choices / sizeof *choices; i++) {
		struct mock_polhemus *other =
			strstr(choices[i].device, "/002") ? &f->second : &f->mock;

		create(f, choices[i].params);
		until(f, TRACK_RUNNING);
		assert_why(f, choices[i].device);
		assert_false(mock_usb_claimed(other->usb));
		assert_false(mock_polhemus_sends(other));
		track_device_destroy(&f->device);
	}
	create(f, (struct track_polhemus_params){ .serial = "V0001", .path = "1-3" });
	until(f, TRACK_ABSENT);
	assert_string_equal(status_of(f).why,
			    "no Polhemus VIPER with serial number V0001 at USB 1-3 is plugged in");
	track_device_destroy(&f->device);
	create(f, (struct track_polhemus_params){ .number = 2 });
	until(f, TRACK_ABSENT);
	assert_string_equal(status_of(f).why, "no Polhemus VIPER number 2 is plugged in");
}

/* A state that the device's own thread comes to. */
static void await(const struct fixture *f, enum track_state wanted)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;

	while (status_of(f).state != wanted) {
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
		poll(NULL, 0, 2);
	}
}

static void plug_and_unplug(struct fixture *f, struct mock_polhemus *mock, struct unit_random *random,
			    unsigned *early)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;

	mock_polhemus_plug(mock, bed);
	start_ticking(f, mock);
	if (unit_random_u32(random) % 2)
		await(f, TRACK_RUNNING);
	else
		poll(NULL, 0, (int)(unit_random_u32(random) % 100));
	*early += status_of(f).state != TRACK_RUNNING;
	poll(NULL, 0, (int)(unit_random_u32(random) % 20));
	stop_ticking(f);
	mock_usb_hang_up(mock->usb);
	while (mock_usb_claimed(mock->usb)) {
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
		poll(NULL, 0, 1);
	}
	mock_polhemus_unplug(mock);
	await(f, TRACK_ABSENT);
}

/* At any moment, while it is being set up too; in the end it runs. */
static void unplugged_and_plugged_again(void **state)
{
	struct fixture *f = *state;
	const unsigned rounds = getenv("GROTTO_LONG") ? 200 : 5;
	struct unit_random random = unit_random_start("unplug");
	unsigned early = 0;
	libusb_context *held; /* see mock_usb_unplug */

	assert_int_equal(libusb_init(&held), 0);
	for (unsigned model = 0; model < 2; model++) {
		/* Kept until the end: the driver may still hold one that it has not yet told of. */
		struct mock_polhemus *mocks = calloc(rounds + 1, sizeof *mocks);

		create_model(f, (enum track_polhemus_model)model);
		assert_int_equal(track_device_start(f->device), GR_OK);
		for (unsigned i = 0; i <= rounds; i++) {
			mocks[i] = (struct mock_polhemus){ .viper = model == 0,
							   .number = 2 + (int)(i % 3),
							   .sensors = 3,
							   .sending = i % 2 };
			if (i < rounds)
				plug_and_unplug(f, &mocks[i], &random, &early);
		}
		mock_polhemus_plug(&mocks[rounds], bed);
		await(f, TRACK_RUNNING);
		track_device_destroy(&f->device);
		mock_polhemus_unplug(&mocks[rounds]);
		for (unsigned i = 0; i <= rounds; i++)
			mock_polhemus_finish(&mocks[i]);
		free(mocks);
	}
	libusb_exit(held);
	printf("# unplugged and plugged again 2 x %u times, %u before it ran\n", rounds, early);
}

/* Nothing is lost or changes places at 1000 frames a second. */
static void a_thousand_frames_a_second(void **state)
{
	struct fixture *f = *state;
	const int64_t frames = getenv("GROTTO_LONG") ? 60000 : 1000;
	const int64_t start_ns = gr_clock_now(&gr_clock_monotonic) + 200 * GR_NS_PER_MS;
	int64_t last_ns = -1, count = 0, latest_ns = 0, sum_ns = 0, said_ns[256] = { 0 };
	int64_t heard_ns = start_ns;
	struct track_report r;

	f->mock.viper = true;
	mock_polhemus_plug(&f->mock, bed);
	create(f, (struct track_polhemus_params){ .rate_hz = 960 });
	assert_int_equal(track_device_start(f->device), GR_OK);
	await(f, TRACK_RUNNING);
	for (int64_t i = 0; i < frames || count < frames;) {
		const int64_t now_ns = gr_clock_now(&gr_clock_monotonic);

		assert_true(now_ns < heard_ns + PATIENCE_NS);
		if (i < frames && i - count < 200 && now_ns >= start_ns + i * GR_NS_PER_MS) {
			said_ns[i++ % 256] = now_ns;
			mock_polhemus_tick(&f->mock);
		} else {
			nanosleep(&(struct timespec){ .tv_nsec = 100000 }, NULL);
		}
		while (track_device_take(f->device, &f->reader, &r, 1) == 1) {
			const int64_t late_ns = r.arrived_ns - said_ns[count % 256];

			assert_true(r.device_ns > last_ns);
			assert_made(&r, (uint32_t)count++);
			last_ns = r.device_ns;
			heard_ns = now_ns;
			latest_ns = late_ns > latest_ns ? late_ns : latest_ns;
			sum_ns += late_ns;
		}
	}
	assert_int_equal(f->reader.missed, 0);
	assert_int_equal(counters_of(f).missed, 0);
	printf("# %lld frames at 1000 Hz: none lost; published %.2f ms after they were sent, at "
	       "worst %.1f\n",
	       (long long)frames, (double)sum_ns / (double)frames * 1e-6, (double)latest_ns * 1e-6);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		TEST(damage_is_counted_and_goes_nowhere),
		TEST(sensors_come_and_go),
		TEST(a_halted_endpoint_goes_on),
		TEST(one_that_falls_silent_is_set_up_again),
		TEST(of_two_one_is_chosen),
		TEST(unplugged_and_plugged_again),
		TEST(a_thousand_frames_a_second),
	};
	int failed;

	(void)argc;
	bed = mock_begin(argv);
	failed = cmocka_run_group_tests_name("polhemus_life", tests, NULL, NULL);
	g_object_unref(bed);
	return failed;
}
