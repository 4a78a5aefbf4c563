/* The Hydra's driver with the real hidapi under it: mode, reports, unplugging. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "tests/unit/hydra_bytes.h"
#include "tests/unit/mock_hydra.h"
#include "tracking/hid.h"
#include "tracking/hotplug.h"
#include "tracking/hydra.h"

#include <grp.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static UMockdevTestbed *bed;

struct fixture {
	struct mock_hydra hydra;
	struct track_device *device;
	struct track_reader reader;
};

static int setup(void **state)
{
	const struct track_hydra_params params = { 0 };
	struct fixture *f = calloc(1, sizeof *f);

	*state = f;
	return track_hydra_create(&f->device, &params, &gr_clock_monotonic);
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	track_device_destroy(&f->device);
	mock_hydra_finish(&f->hydra);
	free(f);
	return 0;
}

static struct track_status status_of(const struct fixture *f)
{
	struct track_status status;

	track_device_status(f->device, &status);
	return status;
}

/* Turns until it is in a state; each turn waits for the device, not for us. */
static void until(struct fixture *f, enum track_state wanted)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + 60 * GR_NS_PER_S;

	do {
		track_device_turn(f->device, 20);
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
	} while (status_of(f).state != wanted);
}

/* The next report of either wand. */
static struct track_report next(struct fixture *f)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + 60 * GR_NS_PER_S;
	struct track_report r;

	while (track_device_take(f->device, &f->reader, &r, 1) == 0) {
		track_device_turn(f->device, 20);
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
	}
	return r;
}

static void nothing_is_plugged_in(void **state)
{
	struct fixture *f = *state;

	until(f, TRACK_ABSENT);
	assert_string_equal(status_of(f).why, "no Razer Hydra (1532:0300) is plugged in");
}

static void it_is_switched_and_switched_back(void **state)
{
	struct fixture *f = *state;
	struct track_report r;

	mock_hydra_plug(&f->hydra, bed, 0, 1);
	until(f, TRACK_RUNNING);
	assert_int_equal(mock_hydra_mode(&f->hydra), MOCK_HYDRA_MOTION);
	assert_non_null(strstr(status_of(f).why, "/dev/hidraw0 and /dev/hidraw1, serial number "));
	assert_non_null(strstr(status_of(f).why, MOCK_HYDRA_SERIAL));
	for (int i = 0; i < 100; i++)
		mock_hydra_say(&f->hydra, (uint8_t)i, 100 + i, 200, -300);
	for (int i = 0; i < 64; i++) /* as many as hidraw keeps */
		for (unsigned wand = 0; wand < 2; wand++) {
			r = next(f);
			assert_int_equal(r.sensor, wand);
			assert_true(fabsf(r.T_base_sensor.p[0] -
					  (wand ? 0.001f : -0.001f) * (float)(136 + i)) < 1e-6f);
		}
	track_device_destroy(&f->device);
	assert_int_equal(mock_hydra_mode(&f->hydra), MOCK_HYDRA_GAMEPAD);
}

static void one_that_was_in_motion_mode_is_left_there(void **state)
{
	struct fixture *f = *state;

	mock_hydra_plug(&f->hydra, bed, 0, 1);
	mock_hydra_set_mode(&f->hydra, MOCK_HYDRA_MOTION);
	mock_hydra_say(&f->hydra, 1, 100, 0, -100); /* waits in the node until it is opened */
	until(f, TRACK_RUNNING);
	assert_int_equal(f->hydra.switches, 0);
	track_device_destroy(&f->device);
	assert_int_equal(mock_hydra_mode(&f->hydra), MOCK_HYDRA_MOTION);
}

static void damaged_reports_are_counted_and_go_nowhere(void **state)
{
	struct fixture *f = *state;
	uint8_t bytes[HYDRA_BYTES];
	struct track_counters counters;

	mock_hydra_plug(&f->hydra, bed, 0, 1);
	until(f, TRACK_RUNNING);
	hydra_make(bytes, 1, 9999, 0, 0);
	bytes[10] ^= 1;
	mock_hid_push(f->hydra.reports, bytes, sizeof bytes);
	hydra_make(bytes, 2, 100, 0, 0);
	memset(bytes + 6 + 8, 0, 8); /* a quaternion of zeros */
	hydra_seal(bytes);
	mock_hid_push(f->hydra.reports, bytes, sizeof bytes);
	assert_int_equal(next(f).sensor, 1); /* of the last one the wand that is whole */
	track_device_counters(f->device, &counters);
	assert_int_equal(counters.faults[TRACK_FAULT_CHECKSUM], 1);
	assert_int_equal(counters.faults[TRACK_FAULT_POSE], 1);
	assert_int_equal(counters.reports, 1);
}

static void another_program_switches_it(void **state)
{
	struct fixture *f = *state;
	const uint8_t gamepad[12] = { 0 };

	mock_hydra_plug(&f->hydra, bed, 0, 1);
	until(f, TRACK_RUNNING);
	mock_hydra_say(&f->hydra, 1, 100, 0, -100);
	next(f);
	mock_hydra_set_mode(&f->hydra, MOCK_HYDRA_GAMEPAD);
	mock_hid_push(f->hydra.reports, gamepad, sizeof gamepad);
	until(f, TRACK_FAILED);
	assert_non_null(strstr(status_of(f).why, "another program has switched its mode"));
	until(f, TRACK_RUNNING);
	assert_int_equal(mock_hydra_mode(&f->hydra), MOCK_HYDRA_MOTION);
}

/* In gamepad mode interface 0 is silent: nothing but that tells of it. */
static void another_program_switches_it_and_it_is_silent(void **state)
{
	struct fixture *f = *state;
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + 10 * GR_NS_PER_S;

	mock_hydra_plug(&f->hydra, bed, 0, 1);
	until(f, TRACK_RUNNING);
	mock_hydra_say(&f->hydra, 1, 100, 0, -100);
	next(f);
	mock_hydra_set_mode(&f->hydra, MOCK_HYDRA_GAMEPAD);
	while (mock_hydra_mode(&f->hydra) != MOCK_HYDRA_MOTION) {
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
		track_device_turn(f->device, 20);
	}
	mock_hydra_say(&f->hydra, 2, 100, 0, -100);
	next(f);
}

/* It is there before the driver looks, and again after each unplugging, on other nodes. */
static void unplugged_and_plugged_again(void **state)
{
	struct fixture *f = *state;
	const int rounds = getenv("GROTTO_LONG") ? 200 : 10;
	struct unit_random random = unit_random_start("unplug");

	for (int i = 0; i < rounds; i++) {
		const int nodes = i % 3;

		mock_hydra_plug(&f->hydra, bed, nodes, nodes + 1);
		until(f, TRACK_RUNNING);
		for (uint32_t n = unit_random_u32(&random) % 8; n > 0; n--)
			mock_hydra_say(&f->hydra, (uint8_t)n, 100, 0, -100);
		mock_hydra_say(&f->hydra, 99, 123, 0, -100);
		next(f);
		mock_hydra_unplug(&f->hydra);
		until(f, TRACK_ABSENT);
		mock_hydra_finish(&f->hydra);
	}
	struct track_counters counters;
	track_device_counters(f->device, &counters);
	assert_int_equal(counters.opened, rounds);
	printf("# unplugged and plugged again %d times\n", rounds);
}

static void udev_tells_of_it(void **state)
{
	struct fixture *f = *state;
	struct track_hotplug *hotplug = track_hotplug_create("hidraw");
	struct pollfd heard = { .fd = track_hotplug_fd(hotplug), .events = POLLIN };
	bool added = false;

	assert_non_null(hotplug);
	assert_false(track_hotplug_added(hotplug));
	mock_hydra_plug(&f->hydra, bed, 0, 1);
	while (!added) {
		assert_int_equal(poll(&heard, 1, 60000), 1);
		added = track_hotplug_added(hotplug);
	}
	track_hotplug_destroy(&hotplug);
}

/* A state that the device's thread comes to by itself. */
static void await(const struct fixture *f, enum track_state wanted)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + 60 * GR_NS_PER_S;

	while (status_of(f).state != wanted) {
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
		poll(NULL, 0, 2);
	}
}

static void a_thread_of_its_own(void **state)
{
	struct fixture *f = *state;
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + 60 * GR_NS_PER_S;
	struct track_report r;

	assert_int_equal(track_device_start(f->device), GR_OK);
	await(f, TRACK_ABSENT);
	mock_hydra_plug(&f->hydra, bed, 4, 5);
	await(f, TRACK_RUNNING);
	mock_hydra_say(&f->hydra, 1, 100, 0, -100);
	while (track_device_take(f->device, &f->reader, &r, 1) == 0) {
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
		poll(NULL, 0, 2);
	}
	assert_true(fabsf(r.T_base_sensor.p[0] + 0.1f) < 1e-6f);
	mock_hydra_unplug(&f->hydra);
	await(f, TRACK_ABSENT);
}

/* It listens for a quarter of a second before it switches the mode: the end does not wait for that. */
static void its_thread_ends_soon(void **state)
{
	struct fixture *f = *state;
	int64_t begin_ns;

	mock_hydra_plug(&f->hydra, bed, 0, 1);
	assert_int_equal(track_device_start(f->device), GR_OK);
	poll(NULL, 0, 50);
	begin_ns = gr_clock_now(&gr_clock_monotonic);
	track_device_destroy(&f->device);
	printf("# its thread ended %.1f ms after it was told to\n",
	       (double)(gr_clock_now(&gr_clock_monotonic) - begin_ns) * 1e-6);
	assert_int_equal(mock_hydra_mode(&f->hydra), MOCK_HYDRA_GAMEPAD);
}

#define PACED 4096 /* more than wait between the device and the test */

/* When reports were said, and how much later they had been read, checked and handed over. */
struct paced {
	int64_t said_ns[PACED];
	double *late_us;
	int read;
};

/* Left, then right of the same report, and each report the last one's successor. */
static void take_in_order(struct fixture *f, struct paced *paced)
{
	int *read = &paced->read;
	struct track_report r;

	while (track_device_take(f->device, &f->reader, &r, 1) == 1) {
		const float x_m = 0.001f * (float)(100 + *read / 2 % 400);

		assert_int_equal(r.sensor, *read % 2);
		assert_true(fabsf(r.T_base_sensor.p[0] - (r.sensor ? x_m : -x_m)) < 1e-6f);
		paced->late_us[*read / 2] = (double)(r.arrived_ns - paced->said_ns[*read / 2 % PACED]) * 1e-3;
		++*read;
	}
}

static int rising(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/*
 * 1000 a second, and none is lost, merged or out of order. The pace is left
 * where the node is half full, as the kernel would drop what it cannot keep.
 */
static void none_is_lost_at_1000_a_second(void **state)
{
	struct fixture *f = *state;
	const int count = getenv("GROTTO_LONG") ? 60000 : 2000;
	const struct timespec ms = { 0, GR_NS_PER_MS };
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + 600 * GR_NS_PER_S;
	struct paced paced = { .late_us = calloc((size_t)count, sizeof(double)) };
	struct track_counters counters;

	mock_hydra_plug(&f->hydra, bed, 0, 1);
	assert_int_equal(track_device_start(f->device), GR_OK);
	await(f, TRACK_RUNNING);
	for (int i = 0; i < count; i++) {
		while (mock_hid_waiting(f->hydra.reports) > 32)
			nanosleep(&ms, NULL);
		paced.said_ns[i % PACED] = gr_clock_now(&gr_clock_monotonic);
		mock_hydra_say(&f->hydra, (uint8_t)i, 100 + i % 400, 0, -100);
		nanosleep(&ms, NULL);
		take_in_order(f, &paced);
	}
	while (paced.read < 2 * count) {
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
		nanosleep(&ms, NULL);
		take_in_order(f, &paced);
	}
	track_device_counters(f->device, &counters);
	assert_int_equal(paced.read, 2 * count);
	assert_int_equal(counters.reports, 2 * count);
	assert_int_equal(counters.missed, 0);
	assert_int_equal(f->reader.missed, 0);
	qsort(paced.late_us, (size_t)count, sizeof *paced.late_us, rising);
	printf("# %d reports of two wands, 1000 a second: none lost, merged or out of order; handed over p50 %.0f, p99 %.0f "
	       "us after the mocked device said them, the mock's own way included\n",
	       count, paced.late_us[count / 2], paced.late_us[count * 99 / 100]);
	free(paced.late_us);
}

/* What a user without the udev rule sees. Root may open anything, so somebody else tries. */
static void denied_names_the_rule(void **state)
{
	struct fixture *f = *state;
	struct track_hid_node nodes[4];
	char why[TRACK_WHY];
	hid_device *opened;
	int status;
	pid_t child;

	mock_hydra_plug(&f->hydra, bed, 0, 1);
	assert_int_equal(track_hid_list(0x1532, 0x0300, nodes, 4), 2);
	child = fork();
	if (child == 0) {
		if (geteuid() == 0 && (setgroups(0, NULL) || setgid(65534) || setuid(65534)))
			_exit(77);
		/* Who is not root is kept out by the mode of his own node. */
		(void)chmod(nodes[0].path, 0);
		_exit(track_hid_open(&nodes[0], &opened, why, sizeof why) == TRACK_DENIED &&
				      strstr(why, "70-grotto.rules")
			      ? 0
			      : 1);
	}
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_true(WIFEXITED(status));
	if (WEXITSTATUS(status) == 77)
		skip();
	assert_int_equal(WEXITSTATUS(status), 0);
}

static void of_two_the_second_is_taken(void **state)
{
	struct fixture *f = *state;
	const struct track_hydra_params params = { .number = 1 };
	struct mock_hydra second = { 0 };

	track_device_destroy(&f->device);
	assert_int_equal(track_hydra_create(&f->device, &params, &gr_clock_monotonic), GR_OK);
	/* Nodes as they come: 0 and 3 are the first one's, 1 and 2 the second's. */
	mock_hydra_plug(&f->hydra, bed, 0, 3);
	until(f, TRACK_ABSENT);
	assert_non_null(strstr(status_of(f).why, "number 1 is not plugged in"));
	mock_hydra_plug(&second, bed, 1, 2);
	until(f, TRACK_RUNNING);
	assert_non_null(strstr(status_of(f).why, "/dev/hidraw1 and /dev/hidraw2"));
	assert_int_equal(mock_hydra_mode(&second), MOCK_HYDRA_MOTION);
	assert_int_equal(mock_hydra_mode(&f->hydra), MOCK_HYDRA_GAMEPAD);
	track_device_destroy(&f->device);
	mock_hydra_finish(&second);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		TEST(nothing_is_plugged_in),
		TEST(it_is_switched_and_switched_back),
		TEST(one_that_was_in_motion_mode_is_left_there),
		TEST(damaged_reports_are_counted_and_go_nowhere),
		TEST(another_program_switches_it),
		TEST(another_program_switches_it_and_it_is_silent),
		TEST(unplugged_and_plugged_again),
		TEST(udev_tells_of_it),
		TEST(a_thread_of_its_own),
		TEST(its_thread_ends_soon),
		TEST(of_two_the_second_is_taken),
		TEST(none_is_lost_at_1000_a_second),
		TEST(denied_names_the_rule),
	};
	int failed;

	(void)argc;
	bed = mock_begin(argv);
	failed = cmocka_run_group_tests_name("hydra", tests, NULL, NULL);
	g_object_unref(bed);
	return failed;
}
