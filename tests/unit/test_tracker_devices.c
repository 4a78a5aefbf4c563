/* A device among the master's trackers: bound, timed, lost, silent, hostile; what is said of it. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "daemon/tracker_devices.h"
#include "daemon/trackers.h"
#include "tests/unit/fake_device.h"
#include "tests/unit/unit_config.h"

#define MS GR_NS_PER_MS
#define ZERO_NS (1000 * GR_NS_PER_S) /* CLOCK_MONOTONIC at the master's time 0 */
#define PERIOD_NS (4 * MS)

struct fixture {
	struct layout layout;
	struct layout_tracker tracker;
	struct trackers open;
	struct master_input input;
	struct gr_diag diag;
	struct fake_clock clock;
	struct fake_device *fake;
	int told, taken;
	struct track_sample last;
};

static void on_sample(void *ctx, size_t tracker, const struct track_sample *sample, bool taken)
{
	struct fixture *f = ctx;

	assert_int_equal(tracker, 0);
	f->told++;
	f->taken += taken;
	f->last = *sample;
}

static void bind(struct layout_binding *b, enum layout_body body, const char *sensor)
{
	*b = (struct layout_binding){
		.body = body, .position = true, .orientation = true, .input = true
	};
	strcpy(b->sensor, sensor);
	b->sensor_body.pose = GR_POSE_IDENTITY;
}

/* A Hydra of the layout, but with a fake device in its place. */
static int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);
	const vec3 head = { 0, 1.7f, 0 }, wand = { 0.3f, 1.2f, -0.3f };

	gr_pose_heading(head, 0, &f->layout.start_head);
	gr_pose_heading(wand, 0, &f->layout.start_wand);
	f->layout.path = (char *)"t.cave";
	f->layout.trackers = &f->tracker;
	f->layout.tracker_count = 1;
	strcpy(f->tracker.name, "wands");
	f->tracker.kind = LAYOUT_TRACKER_HYDRA;
	f->tracker.head = f->tracker.wand = true;
	f->tracker.scale = 1;
	f->tracker.room_base.pose = GR_POSE_IDENTITY;
	f->tracker.latency_ns = 3 * MS;
	/* What filters do is test_filter's. */
	f->tracker.filter =
		(struct layout_filter){ .kind = LAYOUT_FILTER_NONE, .ahead_s = 0.1f, .gap_s = 0.5f };
	f->tracker.binding_count = 2;
	bind(&f->tracker.bindings[0], LAYOUT_HEAD, "left");
	bind(&f->tracker.bindings[1], LAYOUT_WAND, "right");
	if (trackers_open(&f->open, &f->layout, &f->diag) != GR_OK)
		return -1;
	track_device_destroy(&f->open.all[0].device);
	f->clock.now_ns = ZERO_NS;
	f->fake = fake_create(&f->clock);
	f->open.all[0].device = &f->fake->device;
	f->open.tap = (struct trackers_tap){ on_sample, f };
	f->input.head.T_room_body = f->layout.start_head;
	f->input.wand.T_room_body = f->layout.start_wand;
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	trackers_close(&f->open);
	gr_diag_finish(&f->diag);
	free(f);
	return 0;
}

/* It is published now; the master has looked, at its own time. */
static void say(struct fixture *f, struct track_report r)
{
	(void)track_device_publish(&f->fake->device, &r);
	trackers_poll(&f->open, f->clock.now_ns - ZERO_NS, f->clock.now_ns);
}

static void pass(struct fixture *f, int64_t ns)
{
	f->clock.now_ns += ns;
	trackers_poll(&f->open, f->clock.now_ns - ZERO_NS, f->clock.now_ns);
}

static void sample(struct fixture *f, int64_t ahead_ns)
{
	trackers_sample(&f->open, f->clock.now_ns - ZERO_NS + ahead_ns, &f->input);
}

static struct track_report report(const struct fixture *f, unsigned sensor, float x)
{
	struct track_report r = fake_report(f->clock.now_ns - ZERO_NS - 77 * GR_NS_PER_S, x);

	r.sensor = sensor;
	return r;
}

static void head_and_wand_follow(void **state)
{
	struct fixture *f = *state;
	struct track_report r;

	f->clock.now_ns += 10 * MS;
	say(f, report(f, 0, 0.5f));
	assert_int_equal(f->told, 1);
	assert_int_equal(f->taken, 1);
	/* By the device's clock it was 77 s earlier; by ours when it arrived, less the latency. */
	assert_true(f->last.device_timed);
	assert_int_equal(f->last.device_ns, 10 * MS - 77 * GR_NS_PER_S);
	assert_int_equal(f->last.time_ns, 7 * MS);
	r = report(f, 1, -0.5f);
	r.has |= TRACK_BUTTONS | TRACK_AXIS_VALUES;
	r.buttons = 0x21;
	r.axis_count = 3;
	r.axes[1] = 0.25f;
	say(f, r);
	sample(f, 0);
	assert_true(f->input.head.tracked && f->input.wand.tracked);
	assert_float_equal(f->input.head.T_room_body.p[0], 0.5, 1e-6);
	assert_float_equal(f->input.wand.T_room_body.p[0], -0.5, 1e-6);
	assert_int_equal(f->input.buttons, 0x21);
	assert_int_equal(f->last.axis_count, 3);
	assert_true(f->last.axes[1] == 0.25f);
}

/* Whatever is no pose, the head does not move. */
static void what_is_hostile_moves_nothing(void **state)
{
	struct fixture *f = *state;
	struct unit_random random = unit_random_start("hostile");
	const float bad[] = { NAN, INFINITY, -INFINITY, 1e30f, 1e-30f, 0 };
	int said = 0;

	for (int i = 0; i < 1000; i++, f->clock.now_ns += PERIOD_NS) {
		struct track_report r = report(f, 0, 0.5f);

		if (unit_random_u32(&random) % 4) {
			said++;
		} else {
			float *value = unit_random_u32(&random) % 2
					       ? &r.T_base_sensor.p[unit_random_u32(&random) % 3]
					       : &r.T_base_sensor.q[3];

			*value = bad[unit_random_u32(&random) %
				     (value == &r.T_base_sensor.q[3] ? 6 : 4)];
		}
		say(f, r);
		if (f->told == 0)
			continue;
		sample(f, 20 * MS);
		assert_float_equal(f->input.head.T_room_body.p[0], 0.5, 1e-6);
		assert_true(gr_pose_valid(&f->input.head.T_room_body));
	}
	assert_int_equal(f->taken, said);
}

/* q and -q are the same turn. */
static void signs_of_quaternions_do_not_matter(void **state)
{
	struct fixture *f = *state;
	struct unit_random random = unit_random_start("signs");

	for (int i = 0; i < 200; i++, f->clock.now_ns += PERIOD_NS) {
		struct track_report r = report(f, 0, 0);
		const float sign = unit_random_u32(&random) % 2 ? 1.0f : -1.0f,
			    half = 0.002f * (float)i;

		r.T_base_sensor.q[1] = sign * sinf(half);
		r.T_base_sensor.q[3] = sign * cosf(half);
		say(f, r);
		/* Between the samples and 10 ms after the last: 1 rad/s, as steady as it is. */
		for (int at = -6; i > 20 && at <= 10; at += 4) {
			const struct gr_pose *T = &f->input.head.T_room_body;

			sample(f, at * MS);
			assert_true(fabs(2 * atan2(fabs((double)T->q[1]), fabs((double)T->q[3])) -
					 (2 * (double)half + (at + 3) * 1e-3)) < 1e-4);
		}
	}
}

static void a_lost_sensor_holds_and_jumps_back(void **state)
{
	struct fixture *f = *state;
	int64_t seen_ns;

	for (int i = 0; i < 100; i++, f->clock.now_ns += PERIOD_NS)
		say(f, report(f, 0, 0.5f));
	for (int i = 0; i < 100; i++, f->clock.now_ns += PERIOD_NS) {
		struct track_report r = report(f, 0, NAN);

		r.has = TRACK_LOST | TRACK_DEVICE_TIME;
		say(f, r);
		sample(f, 0);
		assert_false(f->input.head.tracked);
		assert_float_equal(f->input.head.T_room_body.p[0], 0.5, 1e-6);
	}
	assert_true(track_history_seen(&f->open.history, TRACK_HEAD, &seen_ns));
	assert_int_equal(seen_ns, 99 * PERIOD_NS - 3 * MS);
	assert_int_equal(f->open.all[0].stats.dropouts, 1);
	assert_false(f->open.all[0].stats.tracked[TRACK_HEAD]);
	say(f, report(f, 0, -0.5f));
	sample(f, 0);
	assert_true(f->input.head.tracked);
	assert_int_equal(f->open.all[0].stats.dropouts, 1);
}

/* As a room has it: on for a moment, back without a jump, and known since when. */
static void a_moving_head_that_is_lost_goes_back_to_where_it_was_seen(void **state)
{
	struct fixture *f = *state;
	const struct track_filter_params params = track_filter_defaults(TRACK_FILTER_KALMAN);
	const int64_t lead_ns = 20 * MS;
	double last = 0, before, most = 0;
	int64_t seen_ns, last_ns = 0;

	for (int body = 0; body < TRACK_BODIES; body++)
		track_filter_init(&f->open.history.filters[body], &params);
	for (int i = 0; i < 250; i++, f->clock.now_ns += PERIOD_NS) {
		last = 0.5 * i * PERIOD_NS * 1e-9;
		last_ns = f->clock.now_ns - ZERO_NS - f->tracker.latency_ns;
		say(f, report(f, 0, (float)last));
	}
	sample(f, lead_ns);
	before = (double)f->input.head.T_room_body.p[0];
	for (int i = 0; i < 750; i++, f->clock.now_ns += PERIOD_NS) {
		struct track_report r = report(f, 0, NAN);

		r.has = TRACK_LOST | TRACK_DEVICE_TIME;
		say(f, r);
		sample(f, lead_ns);
		assert_false(f->input.head.tracked);
		/* No faster than it was. */
		assert_true(fabs((double)f->input.head.T_room_body.p[0] - before) < 0.6 * PERIOD_NS * 1e-9);
		before = (double)f->input.head.T_room_body.p[0];
		most = fmax(most, before - last);
		assert_true(track_history_seen(&f->open.history, TRACK_HEAD, &seen_ns));
		assert_int_equal(seen_ns, last_ns);
	}
	printf("# lost at 0.5 m/s: %.1f mm on at most, then %.2f mm from where it was seen\n", most * 1e3,
	       (before - last) * 1e3);
	assert_true(most > 0.005 && most < 0.05);
	assert_true(fabs(before - last) < 0.001);
}

static void silence_is_a_drop_out(void **state)
{
	struct fixture *f = *state;

	for (int i = 0; i < 10; i++, f->clock.now_ns += PERIOD_NS)
		say(f, report(f, 0, 0.5f));
	pass(f, 90 * MS);
	assert_int_equal(f->open.all[0].stats.dropouts, 0);
	pass(f, 20 * MS);
	assert_int_equal(f->open.all[0].stats.dropouts, 1);
	sample(f, 0);
	assert_true(f->input.head.tracked); /* for half a second its pose is good enough */
	pass(f, 500 * MS);
	sample(f, 0);
	assert_false(f->input.head.tracked);
	assert_float_equal(f->input.head.T_room_body.p[0], 0.5, 1e-6);
	assert_int_equal(f->open.all[0].stats.dropouts, 1);
}

static void rate_and_evenness(void **state)
{
	struct fixture *f = *state;
	const struct tracker_stats *stats = &f->open.all[0].stats;

	for (int i = 0; i < 1000; i++, f->clock.now_ns += PERIOD_NS)
		say(f, report(f, 0, 0));
	assert_float_equal(stats->rate_hz, 250, 1.5);
	assert_float_equal(stats->jitter_ms, 0, 1e-6);
	/* 2 and 6 ms in turn: as many, 2 ms from the middle. */
	for (int i = 0; i < 1000; i++, f->clock.now_ns += i % 2 ? 2 * MS : 6 * MS)
		say(f, report(f, 0, 0));
	assert_float_equal(stats->rate_hz, 250, 1.5);
	assert_float_equal(stats->jitter_ms, 2, 0.02);
}

/* Both wands of a report come at once, some microseconds apart: one arrival, and an even one. */
static void rate_of_two_sensors(void **state)
{
	struct fixture *f = *state;
	const struct tracker_stats *stats = &f->open.all[0].stats;

	for (int i = 0; i < 1000; i++, f->clock.now_ns += PERIOD_NS) {
		say(f, report(f, 0, 0));
		f->clock.now_ns += 10000;
		say(f, report(f, 1, 0));
		f->clock.now_ns -= 10000;
	}
	assert_float_equal(stats->rate_hz, 250, 1.5);
	assert_float_equal(stats->jitter_ms, 0, 1e-6);
	assert_int_equal(stats->heard, 2000);
}

static void what_is_said_of_it(void **state)
{
	struct fixture *f = *state;
	struct track_report r = report(f, 0, NAN);
	char text[4096];
	size_t len;

	track_device_turn(&f->fake->device, 0);
	say(f, r);
	r = report(f, 0, 0.5f);
	r.has |= TRACK_BATTERY;
	r.battery = 0.5f;
	say(f, r);
	f->clock.now_ns += 5 * MS;
	assert_int_equal(trackers_answer(&f->open, f->clock.now_ns, text, sizeof text, &len),
			 GR_OK);
	assert_non_null(strstr(text, "\"name\":\"wands\",\"kind\":\"fake\",\"state\":\"running\""));
	assert_non_null(strstr(text, "\"faults\":{\"pose\":1}"));
	assert_non_null(strstr(text, "\"battery\":0.5"));
	assert_non_null(strstr(text, "\"age_ms\":5"));
	assert_non_null(strstr(text, "\"tracked\":[\"head\"]"));
	assert_non_null(strstr(text, "\"poses\":[{\"body\":\"head\",\"tracked\":true"));
	assert_non_null(strstr(text, "\"sensors\":[{\"body\":\"head\",\"sensor\":\"a\",\"reports\":1,\"age_ms\":5,"
				     "\"lost\":false,\"position_m\":[0.5,1,2],\"orientation\":[0,0,0,1]},"
				     "{\"body\":\"wand\",\"sensor\":\"b\",\"reports\":0}]"));
	assert_int_equal(trackers_answer(&f->open, f->clock.now_ns, text, 100, &len), GR_ERR_RANGE);
}

/* The frame loop was away for seconds: what is kept is taken, the rest counted. */
static void a_master_that_was_away(void **state)
{
	struct fixture *f = *state;

	for (int i = 0; i < 3000; i++, f->clock.now_ns += PERIOD_NS) {
		struct track_report r = report(f, 0, 0.001f * (float)i);

		assert_int_equal(track_device_publish(&f->fake->device, &r), GR_OK);
	}
	pass(f, 0);
	assert_int_equal(f->told, TRACK_HANDOVER);
	assert_int_equal(f->open.all[0].reader.missed, 3000 - TRACK_HANDOVER);
	sample(f, -PERIOD_NS);
	assert_true(f->input.head.T_room_body.p[0] > 2.99f);
}

/* What a layout says of a pad's buttons and axes by name is known before anything is opened. */
static void names_that_a_pad_does_not_have(void **state)
{
	static const struct {
		enum layout_tracker_kind kind;
		const char *triggers, *button;
		const char *message; /* NULL: nothing is wrong */
	} cases[] = {
		{ LAYOUT_TRACKER_GAMEPAD, " rx  slider", "", NULL },
		{ LAYOUT_TRACKER_GAMEPAD, "rx l2", "",
		  "\"l2\" is no axis of it; it has x, y, z, rx, ry, rz, slider, slider2" },
		{ LAYOUT_TRACKER_DUALSHOCK4, NULL, "share", NULL },
		{ LAYOUT_TRACKER_DUALSENSE, NULL, "create", "\"create\" is no button of it; it has cross, circle" },
		{ LAYOUT_TRACKER_SPACEMOUSE, NULL, "31", NULL },
		{ LAYOUT_TRACKER_SPACEMOUSE, NULL, "32", "\"32\" is no button of it; it has 1, 2, 3" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct layout_tracker tracker = { .name = "pad", .kind = cases[i].kind, .line = 7 };
		const struct layout layout = { .path = (char *)"t.cave",
					       .trackers = &tracker,
					       .tracker_count = 1 };
		struct gr_diag diag = { 0 };

		tracker.pad.triggers = (char *)cases[i].triggers;
		strcpy(tracker.pad.recentre, cases[i].button);
		strcpy(tracker.spacemouse.home, cases[i].button);
		tracker_devices_check(&layout, &diag);
		unit_diag_print(&diag);
		assert_int_equal(diag.errors, cases[i].message != NULL);
		if (cases[i].message)
			assert_true(unit_diag_has(&diag, GR_DIAG_ERROR, "t.cave:7", cases[i].message));
		gr_diag_finish(&diag);
	}
}

int main(void)
{
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
	const struct CMUnitTest tests[] = {
		WITH(head_and_wand_follow),
		WITH(what_is_hostile_moves_nothing),
		WITH(signs_of_quaternions_do_not_matter),
		WITH(a_lost_sensor_holds_and_jumps_back),
		WITH(a_moving_head_that_is_lost_goes_back_to_where_it_was_seen),
		WITH(silence_is_a_drop_out),
		WITH(rate_and_evenness),
		WITH(rate_of_two_sensors),
		WITH(what_is_said_of_it),
		WITH(a_master_that_was_away),
		cmocka_unit_test(names_that_a_pad_does_not_have),
	};

	gr_log_init("test", GR_LOG_ERROR);
	return cmocka_run_group_tests_name("tracker_devices", tests, NULL, NULL);
}
