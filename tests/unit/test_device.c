/* What all tracking devices have in common: the life of one, its clock, what is refused, the
 * hand-over. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "tests/unit/fake_device.h"

#define MS GR_NS_PER_MS

struct fixture {
	struct fake_clock clock;
	struct fake_device *fake;
	struct track_device *device;
	struct track_reader reader;
};

static int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);

	f->clock.now_ns = GR_NS_PER_S;
	f->fake = fake_create(&f->clock);
	f->device = &f->fake->device;
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	track_device_destroy(&f->device);
	free(f);
	return 0;
}

static enum track_state state_of(const struct fixture *f)
{
	struct track_status status;

	track_device_status(f->device, &status);
	return (enum track_state)status.state;
}

static struct track_counters counters_of(const struct fixture *f)
{
	struct track_counters counters;

	track_device_counters(f->device, &counters);
	return counters;
}

static void turn(struct fixture *f)
{
	track_device_turn(f->device, 0);
}

/* ---- life ---- */

static void a_device_that_comes_and_goes(void **state)
{
	struct fixture *f = *state;
	struct track_status status;

	assert_int_equal(state_of(f), TRACK_OFF);
	f->fake->opens_as = TRACK_ABSENT;
	turn(f);
	assert_int_equal(state_of(f), TRACK_ABSENT);
	turn(f); /* not at once again */
	assert_int_equal(f->fake->opened, 0);
	f->fake->opens_as = TRACK_RUNNING;
	f->clock.now_ns += 100 * MS;
	turn(f);
	track_device_status(f->device, &status);
	assert_int_equal(status.state, TRACK_RUNNING);
	assert_string_equal(status.why, "opened");
	assert_int_equal(status.since_ns, f->clock.now_ns);
	f->clock.now_ns += 5 * GR_NS_PER_S;
	f->fake->gone = true;
	turn(f);
	track_device_status(f->device, &status);
	assert_int_equal(status.state, TRACK_ABSENT);
	assert_string_equal(status.why, "unplugged");
	assert_int_equal(status.since_ns, f->clock.now_ns);
	assert_int_equal(f->fake->closed, 1);
	f->clock.now_ns += 100 * MS;
	turn(f);
	assert_int_equal(state_of(f), TRACK_RUNNING);
	assert_int_equal(counters_of(f).opened, 2);
	f->fake->queue[f->fake->queued++] = fake_report(1, 0);
	turn(f);
	assert_int_equal(counters_of(f).reports, 1);
}

static void tries_get_rarer_down_to_one_in_two_seconds(void **state)
{
	struct fixture *f = *state;
	int64_t last_ns = 0, gap_ns = 0;
	int tries = 0;

	f->fake->opens_as = TRACK_DENIED;
	for (int ms = 0; ms < 20000; ms++, f->clock.now_ns += MS) {
		const int64_t before = f->device->retry_ns;

		/* Only when it is due, or turn would wait for real. */
		if (f->device->retry_ns > f->clock.now_ns)
			continue;
		turn(f);
		if (f->device->retry_ns == before)
			continue;
		gap_ns = f->clock.now_ns - last_ns;
		last_ns = f->clock.now_ns;
		tries++;
	}
	assert_int_equal(state_of(f), TRACK_DENIED);
	assert_int_equal(gap_ns, 2 * GR_NS_PER_S);
	assert_in_range(tries, 10, 15); /* 0.1 + 0.2 + 0.4 + 0.8 + 1.6 + 2 + 2 ... */
}

static void a_thread_ends_when_told(void **state)
{
	struct fixture *f = *state;

	/* Blocks in its own read for as long as it may; destroy would hang without the wake. */
	f->fake->waits = true;
	assert_int_equal(track_device_start(f->device), GR_OK);
	track_device_destroy(&f->device);
	assert_null(f->device);
}

/* ---- what is published ---- */

static void assert_refused(struct fixture *f, struct track_report report, enum track_fault fault)
{
	const uint64_t before = counters_of(f).faults[fault];
	struct track_report out;

	assert_int_equal(track_device_publish(f->device, &report), -(int)fault);
	assert_int_equal(counters_of(f).faults[fault], before + 1);
	assert_int_equal(track_device_take(f->device, &f->reader, &out, 1), 0);
}

static void what_is_no_pose_goes_nowhere(void **state)
{
	struct fixture *f = *state;
	const float bad[] = { NAN, INFINITY, -INFINITY, 1001.0f };
	struct track_report r;

	for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
		for (int i = 0; i < 3; i++) {
			r = fake_report(1, 0);
			r.T_base_sensor.p[i] = bad[k];
			assert_refused(f, r, TRACK_FAULT_POSE);
		}
	for (int i = 0; i < 4; i++) {
		r = fake_report(1, 0);
		r.T_base_sensor.q[i] = NAN;
		assert_refused(f, r, TRACK_FAULT_POSE);
	}
	r = fake_report(1, 0);
	memset(r.T_base_sensor.q, 0, sizeof r.T_base_sensor.q);
	assert_refused(f, r, TRACK_FAULT_POSE);
	r = fake_report(1, 0);
	r.sensor = TRACK_SENSORS;
	assert_refused(f, r, TRACK_FAULT_SENSOR);
	r = fake_report(1, 0);
	r.has |= TRACK_AXIS_VALUES;
	r.axis_count = TRACK_AXES + 1;
	assert_refused(f, r, TRACK_FAULT_FORMAT);
	r.axis_count = 2;
	r.axes[1] = NAN;
	assert_refused(f, r, TRACK_FAULT_FORMAT);
}

static void a_quaternion_is_made_unit(void **state)
{
	struct fixture *f = *state;
	struct track_report r = fake_report(1, 0), out;

	r.T_base_sensor.q[1] = 0.1f; /* length 1.005 */
	assert_int_equal(track_device_publish(f->device, &r), GR_OK);
	assert_int_equal(track_device_take(f->device, &f->reader, &out, 1), 1);
	assert_true(gr_pose_valid(&out.T_base_sensor));
	assert_true(fabsf(glm_quat_norm(out.T_base_sensor.q) - 1.0f) < 1e-6f);
	/* A lost sensor's pose is never looked at, nor handed on. */
	r = fake_report(2, NAN);
	r.has |= TRACK_LOST;
	assert_int_equal(track_device_publish(f->device, &r), GR_OK);
	assert_int_equal(track_device_take(f->device, &f->reader, &out, 1), 1);
	assert_false(out.has & (TRACK_POSITION | TRACK_ORIENTATION));
}

static void duplicates_and_stragglers_are_dropped(void **state)
{
	struct fixture *f = *state;
	struct track_report out[8], r;

	r = fake_report(100 * MS, 1);
	assert_int_equal(track_device_publish(f->device, &r), GR_OK);
	assert_int_equal(track_device_take(f->device, &f->reader, out, 8), 1);
	assert_refused(f, fake_report(100 * MS, 1), TRACK_FAULT_ORDER);
	assert_refused(f, fake_report(90 * MS, 1), TRACK_FAULT_ORDER);
	/* Another sensor has a past of its own. */
	r = fake_report(90 * MS, 1);
	r.sensor = 1;
	assert_int_equal(track_device_publish(f->device, &r), GR_OK);
	r = fake_report(110 * MS, 2);
	assert_int_equal(track_device_publish(f->device, &r), GR_OK);
	assert_int_equal(track_device_take(f->device, &f->reader, out, 8), 2);
}

static void a_clock_that_was_set_is_followed(void **state)
{
	struct fixture *f = *state;
	struct track_report r, out;
	int64_t last_ns = 0;
	int refused = 0;

	/* Hours ahead, then back to midnight, then back by half a second. */
	const int64_t begins[] = { 86399 * GR_NS_PER_S, 0, -500 * MS + 40 * 10 * MS };

	for (size_t k = 0; k < sizeof begins / sizeof *begins; k++)
		for (int i = 0; i < 40; i++, f->clock.now_ns += 10 * MS) {
			r = fake_report(begins[k] + i * 10 * MS, 0);
			if (track_device_publish(f->device, &r) < 0) {
				refused++;
				continue;
			}
			assert_int_equal(track_device_take(f->device, &f->reader, &out, 1), 1);
			assert_true(out.time_ns > last_ns);
			assert_true(out.time_ns <= f->clock.now_ns);
			last_ns = out.time_ns;
		}
	assert_int_equal(refused, 7); /* eight in a row are no stragglers */
	assert_int_equal(counters_of(f).steps, 2);
}

/* ---- clock ---- */

static void a_burst_is_spread_out_again(void **state)
{
	struct fixture *f = *state;
	struct track_report r, out;

	for (int i = 0; i < 1000; i++) {
		const bool stalled =
			i % 100 >= 92; /* eight arrive together, with the last of them */

		r = fake_report(i * 4 * MS, 0);
		f->clock.now_ns =
			10 * GR_NS_PER_S + (stalled ? i / 100 * 100 + 99 : i) * 4 * MS + 1 * MS;
		assert_int_equal(track_device_publish(f->device, &r), GR_OK);
		assert_int_equal(track_device_take(f->device, &f->reader, &out, 1), 1);
		assert_int_equal(out.arrived_ns, f->clock.now_ns);
		/* As measured, plus the least delay of 1 ms. */
		assert_in_range(llabs(out.time_ns - (10 * GR_NS_PER_S + i * 4 * MS + 1 * MS)), 0,
				2000);
	}
}

static void drift_and_late_reports_are_seen_through(void **state)
{
	struct unit_random random = unit_random_start("drift");
	struct track_clock clock = { 0 };
	int64_t worst_ns = 0;

	(void)state;
	track_clock_init(&clock);
	for (int i = 0; i < 60 * 250; i++) {
		const int64_t truth_ns = 5 * GR_NS_PER_S + (int64_t)i * 4 * MS;
		const int64_t device_ns =
			(int64_t)((double)i * 4e6 * (1 + 150e-6)) - 3600 * GR_NS_PER_S;
		/* 0.2 ms at the least, mostly within 1 ms, sometimes 30. */
		const double late_ms = 0.2 - log(unit_random_range(&random, 1e-9, 1)) * 0.4 +
				       (unit_random_u32(&random) % 100 == 0 ? 30 : 0);
		const int64_t arrived_ns = truth_ns + (int64_t)(late_ms * 1e6);
		const int64_t mapped_ns = track_clock_map(&clock, device_ns, arrived_ns, NULL);

		assert_true(mapped_ns <= arrived_ns);
		if (i > 250 && llabs(mapped_ns - truth_ns - 200000) > worst_ns)
			worst_ns = llabs(mapped_ns - truth_ns - 200000);
	}
	printf("# device's clock, 150 ppm fast, delays 0.2 to 40 ms: at worst %.1f us off, drift "
	       "%+.0f ppm\n",
	       (double)worst_ns * 1e-3, track_clock_drift_ppm(&clock));
	assert_true(worst_ns < 100000);
	assert_true(fabs(track_clock_drift_ppm(&clock) - 150) < 20);
	assert_int_equal(clock.steps, 0);
}

static void counters_wrap(void **state)
{
	(void)state;
	assert_int_equal(track_unwrap(5, 8, 6), 5);
	assert_int_equal(track_unwrap(5, 8, 250), 261);
	assert_int_equal(track_unwrap(250, 8, 258), 250);
	assert_int_equal(track_unwrap(250, 8, 1), 250); /* never negative */
	assert_int_equal(track_unwrap(3, 8, 1024), 1027);
	assert_int_equal(track_unwrap(7, 64, 99), 7);
	for (uint64_t n = 0, last = 0; n < 2000; n++) {
		const uint64_t whole = track_unwrap(n & 0xff, 8, last + 1);

		assert_int_equal(whole, n);
		last = whole;
	}
}

/* ---- hand-over ---- */

static void all_reports_come_in_order(void **state)
{
	struct fixture *f = *state;
	struct track_report out[100];
	int64_t next = 0;

	for (int i = 0; i < 10000; i++) {
		struct track_report r = fake_report((i + 1) * MS, 0);

		f->clock.now_ns += MS;
		assert_int_equal(track_device_publish(f->device, &r), GR_OK);
		if (i % 7 && i != 9999)
			continue;
		for (int n; (n = track_device_take(f->device, &f->reader, out, 3)) > 0;)
			for (int k = 0; k < n; k++)
				assert_int_equal(out[k].device_ns, ++next * MS);
	}
	assert_int_equal(next, 10000);
	assert_int_equal(f->reader.missed, 0);
}

static void a_reader_that_was_away_is_told(void **state)
{
	struct fixture *f = *state;
	struct track_report out[1];

	for (int i = 1; i <= 3 * TRACK_HANDOVER; i++) {
		struct track_report r = fake_report(i * MS, 0);

		f->clock.now_ns += MS;
		assert_int_equal(track_device_publish(f->device, &r), GR_OK);
	}
	assert_int_equal(track_device_take(f->device, &f->reader, out, 1), 1);
	assert_int_equal(f->reader.missed, 2 * TRACK_HANDOVER);
	assert_int_equal(out[0].device_ns, (2 * TRACK_HANDOVER + 1) * MS);
}

/* A writer that never waits, against a reader that never does. */
static void *write_many(void *ctx)
{
	for (int64_t i = 1; i <= 200000; i++) {
		struct track_report r = { .device_ns = i,
					  .arrived_ns = -i,
					  .buttons = (uint32_t)i };

		for (int k = 0; k < TRACK_AXES; k++)
			r.axes[k] = (float)(i & 0xffff);
		track_handover_put(ctx, &r);
	}
	return NULL;
}

static void no_report_is_torn(void **state)
{
	struct track_handover *handover = calloc(1, sizeof *handover);
	struct track_reader reader = { 0 };
	struct track_report r;
	pthread_t writer;
	int64_t last = 0;
	uint64_t read = 0;

	(void)state;
	assert_int_equal(pthread_create(&writer, NULL, write_many, handover), 0);
	while (last < 200000) {
		if (track_handover_take(handover, &reader, &r, 1) != 1)
			continue;
		assert_true(r.device_ns > last);
		last = r.device_ns;
		read++;
		assert_int_equal(r.arrived_ns, -last);
		assert_int_equal(r.buttons, (uint32_t)last);
		for (int k = 0; k < TRACK_AXES; k++)
			assert_true(r.axes[k] == (float)(last & 0xffff));
	}
	pthread_join(writer, NULL);
	assert_int_equal(read + reader.missed, 200000);
	printf("# hand-over: %llu read, %llu overwritten first\n", (unsigned long long)read,
	       (unsigned long long)reader.missed);
	free(handover);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(a_device_that_comes_and_goes),
		TEST(tries_get_rarer_down_to_one_in_two_seconds),
		TEST(a_thread_ends_when_told),
		TEST(what_is_no_pose_goes_nowhere),
		TEST(a_quaternion_is_made_unit),
		TEST(duplicates_and_stragglers_are_dropped),
		TEST(a_clock_that_was_set_is_followed),
		TEST(a_burst_is_spread_out_again),
		TEST(all_reports_come_in_order),
		TEST(a_reader_that_was_away_is_told),
		cmocka_unit_test(drift_and_late_reports_are_seen_through),
		cmocka_unit_test(counters_wrap),
		cmocka_unit_test(no_report_is_torn),
	};

	return cmocka_run_group_tests_name("device", tests, NULL, NULL);
}
