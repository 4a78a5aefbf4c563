/* VRPN's driver over real sockets: both ways to connect, restarts, silence, peers that are hostile. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "tests/unit/mock_vrpn.h"
#include "tracking/vrpn.h"

#define COOKIE "vrpn: ver. 07.35  0\0\0\0\0"
#define TAKE 256

struct fixture {
	struct mock_vrpn server;
	struct track_device *device;
	struct track_reader reader;
	struct track_report reports[TAKE];
};

static int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);

	mock_vrpn_start(&f->server);
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	track_device_destroy(&f->device);
	mock_vrpn_stop(&f->server);
	free(f);
	return 0;
}

/* Silence and patience that are not given are longer than this process may be kept from running. */
static void start(struct fixture *f, bool udp, int64_t silence_ns, int64_t patience_ns)
{
	const struct track_vrpn_params params = {
		.device = "Tracker0",
		.address = "127.0.0.1",
		.port = f->server.port,
		.udp = udp,
		.silence_ns = silence_ns ? silence_ns : 2 * NET_DEADLINE_NS,
		.patience_ns = patience_ns ? patience_ns : 2 * NET_DEADLINE_NS,
	};

	assert_int_equal(track_vrpn_create(&f->device, &params, &gr_clock_monotonic), GR_OK);
	assert_int_equal(track_device_start(f->device), GR_OK);
}

static void wait_for(struct fixture *f, enum track_state state, const char *why)
{
	net_wait(f->device, net_is(f->device, state) && strstr(net_status(f->device).why, why));
}

/* A connection whose names begin with the number `first`, until the device runs. */
static void serve(struct fixture *f, bool udp, int32_t first)
{
	mock_vrpn_accept(&f->server, udp);
	mock_vrpn_greet(&f->server, COOKIE, "Tracker0", first);
	wait_for(f, TRACK_RUNNING, "Tracker0 at 127.0.0.1:");
	net_wait(f->device, (mock_vrpn_listen(&f->server), f->server.named && f->server.pings > 0 &&
							    (!udp || f->server.client_udp)));
}

static void take(struct fixture *f, int count)
{
	int got = 0;

	net_wait(f->device,
		 (got += track_device_take(f->device, &f->reader, f->reports + got, count - got),
		  got == count));
}

static void say_pose(struct fixture *f, uint64_t time_us, int32_t sensor, double x)
{
	vrpn_pose(&f->server.say, time_us, f->server.sender, f->server.pose, sensor, x);
}

/* ---- */

static void poses_by_tcp(void **state)
{
	const uint64_t start_us = UINT64_C(1700000000000000);
	struct fixture *f = *state;

	start(f, false, 0, 0);
	serve(f, false, 10);
	for (int i = 0; i < 20; i++) {
		say_pose(f, start_us + 10000 * (uint64_t)i, i % 2, i);
		mock_vrpn_flush(&f->server);
	}
	take(f, 20);
	for (int i = 0; i < 20; i++) {
		const struct track_report *r = &f->reports[i];

		assert_int_equal(r->sensor, i % 2);
		assert_vector(r->T_base_sensor.p, i, 1, 2);
		assert_int_equal(r->has, TRACK_POSITION | TRACK_ORIENTATION | TRACK_DEVICE_TIME);
		/* Its clock is of 2023, the report of just now. */
		assert_true(r->time_ns <= r->arrived_ns);
		assert_true(r->arrived_ns - r->time_ns < 60 * GR_NS_PER_S);
		assert_int_equal(r->device_ns, 10 * GR_NS_PER_MS * i);
	}
}

/* One byte at a time, then all at once: a stream has no ends of messages. */
static void streams_have_no_edges(void **state)
{
	struct fixture *f = *state;

	start(f, false, 0, 0);
	serve(f, false, 0);
	say_pose(f, 1000, 0, 1);
	vrpn_name(&f->server.say, -1, 77, "odd"); /* a body of eight, padded from it */
	say_pose(f, 2000, 0, 2);
	for (size_t i = 0; i < f->server.say.len; i++)
		assert_int_equal(send(f->server.fd, f->server.say.at + i, 1, MSG_NOSIGNAL), 1);
	f->server.say.len = 0;
	take(f, 2);
	assert_float_equal(f->reports[1].T_base_sensor.p[0], 2, 0);
	for (int i = 0; i < 100; i++)
		say_pose(f, 3000 + (uint64_t)i, i % 8, i);
	mock_vrpn_flush(&f->server);
	take(f, 100);
	for (int i = 0; i < 100; i++)
		assert_float_equal(f->reports[i].T_base_sensor.p[0], i, 0);
	assert_int_equal(net_counters(f->device).faults[TRACK_FAULT_ORDER], 0);
}

static void buttons_and_channels(void **state)
{
	static const double values[] = { 0.5, -1 };
	struct fixture *f = *state;

	start(f, false, 0, 0);
	serve(f, false, 100);
	say_pose(f, 1000, 1, 0);
	vrpn_button(&f->server.say, f->server.sender, f->server.button, 3, 1);
	vrpn_channels(&f->server.say, f->server.sender, f->server.channels, 2, values);
	say_pose(f, 2000, 1, 0);
	mock_vrpn_flush(&f->server);
	take(f, 4);
	assert_int_equal(f->reports[1].has, TRACK_BUTTONS);
	assert_int_equal(f->reports[1].sensor, 1);
	assert_int_equal(f->reports[1].buttons, 8);
	assert_float_equal(f->reports[2].axes[0], 0.5, 0);
	assert_int_equal(f->reports[3].has, TRACK_POSITION | TRACK_ORIENTATION | TRACK_DEVICE_TIME |
						    TRACK_BUTTONS | TRACK_AXIS_VALUES);
	assert_float_equal(f->reports[3].axes[1], -1, 0);
}

/* A device of buttons alone says nothing while it rests, and is there nevertheless. */
static void buttons_alone_rest(void **state)
{
	struct fixture *f = *state;

	start(f, false, 0, 0);
	serve(f, false, 0);
	vrpn_button(&f->server.say, f->server.sender, f->server.button, 0, 1);
	mock_vrpn_flush(&f->server);
	take(f, 5);
	for (int i = 0; i < 5; i++)
		assert_int_equal(f->reports[i].buttons, 1);
	vrpn_button(&f->server.say, f->server.sender, f->server.button, 0, 0);
	mock_vrpn_flush(&f->server);
	net_wait(f->device, track_device_take(f->device, &f->reader, f->reports, 1) == 1 &&
				    f->reports[0].buttons == 0);
}

/* The server connects back, poses are datagrams, several in one. */
static void poses_by_udp(void **state)
{
	struct fixture *f = *state;
	int stranger = net_socket(SOCK_DGRAM, "127.0.0.2", 0);

	start(f, true, 0, 0);
	serve(f, true, 30);
	for (int i = 0; i < 8; i++)
		say_pose(f, 1000 + 1000 * (uint64_t)i, 0, i);
	mock_vrpn_datagram(&f->server, f->server.udp);
	take(f, 8);
	for (int i = 0; i < 8; i++)
		assert_float_equal(f->reports[i].T_base_sensor.p[0], i, 0);
	/* A duplicate, a straggler, one that is cut off, one that names things, one of a stranger. */
	say_pose(f, 8000, 0, 77);
	mock_vrpn_datagram(&f->server, f->server.udp);
	say_pose(f, 7500, 0, 77);
	mock_vrpn_datagram(&f->server, f->server.udp);
	say_pose(f, 9000, 0, 8);
	say_pose(f, 9500, 0, 77);
	f->server.say.len -= 1;
	mock_vrpn_datagram(&f->server, f->server.udp);
	vrpn_name(&f->server.say, -1, f->server.sender, "Another");
	mock_vrpn_datagram(&f->server, f->server.udp);
	say_pose(f, 9600, 0, 77);
	mock_vrpn_datagram(&f->server, stranger);
	say_pose(f, 10000, 0, 9);
	mock_vrpn_datagram(&f->server, f->server.udp);
	take(f, 2);
	assert_float_equal(f->reports[0].T_base_sensor.p[0], 8, 0);
	assert_float_equal(f->reports[1].T_base_sensor.p[0], 9, 0);
	assert_int_equal(net_counters(f->device).faults[TRACK_FAULT_ORDER], 2);
	assert_int_equal(net_counters(f->device).faults[TRACK_FAULT_LENGTH], 1);
	assert_int_equal(net_counters(f->device).faults[TRACK_FAULT_FORMAT], 1);
	/* What is reliable comes by the connection. */
	vrpn_button(&f->server.say, f->server.sender, f->server.button, 1, 1);
	mock_vrpn_flush(&f->server);
	take(f, 1);
	assert_int_equal(f->reports[0].buttons, 2);
	close(stranger);
}

/* Each time other numbers for the same names, and a clock that begins anew. */
static void restarts(void **state, bool udp)
{
	struct fixture *f = *state;

	start(f, udp, 0, 0);
	for (int i = 0; i < 3; i++) {
		serve(f, udp, 100 - 13 * i);
		vrpn_button(&f->server.say, f->server.sender, f->server.button, 0, 1);
		say_pose(f, (uint64_t)(10 - i) * 3600000000u, 0, i);
		mock_vrpn_flush(&f->server);
		net_wait(f->device, track_device_take(f->device, &f->reader, f->reports, 1) == 1 &&
					    (f->reports[0].has & TRACK_POSITION));
		assert_float_equal(f->reports[0].T_base_sensor.p[0], i, 0);
		assert_int_equal(net_counters(f->device).opened, i + 1);
		mock_vrpn_hang_up(&f->server);
		wait_for(f, TRACK_ABSENT, "has closed the connection");
	}
}

static void restarts_by_tcp(void **state)
{
	restarts(state, false);
}

static void restarts_by_udp(void **state)
{
	restarts(state, true);
}

static void a_server_that_takes_its_leave(void **state)
{
	struct fixture *f = *state;

	start(f, false, 0, 0);
	serve(f, false, 0);
	vrpn_message(&f->server.say, 0, 0, -5, "", 0);
	mock_vrpn_flush(&f->server);
	wait_for(f, TRACK_ABSENT, "the VRPN server has ended");
}

/* ---- what is wrong is said ---- */

static void nobody_there(void **state)
{
	struct fixture *f = *state;

	mock_vrpn_stop(&f->server);
	start(f, false, 0, 0);
	wait_for(f, TRACK_ABSENT, "no VRPN server answers at 127.0.0.1:");
	track_device_destroy(&f->device);
	start(f, true, 0, GR_NS_PER_S);
	wait_for(f, TRACK_ABSENT, "no VRPN server answers at 127.0.0.1:");
	mock_vrpn_start(&f->server);
}

static void a_server_of_something_else(void **state)
{
	struct fixture *f = *state;

	start(f, false, 0, 0);
	mock_vrpn_accept(&f->server, false);
	mock_vrpn_greet(&f->server, "HTTP/1.1 400 Bad Request", NULL, 0);
	wait_for(f, TRACK_FAILED, "is no VRPN server");
	mock_vrpn_hang_up(&f->server);
	mock_vrpn_accept(&f->server, false);
	mock_vrpn_greet(&f->server, "vrpn: ver. 06.00  0\0\0\0\0", NULL, 0);
	wait_for(f, TRACK_FAILED, "version 07");
	mock_vrpn_hang_up(&f->server);
	track_device_destroy(&f->device);
	/* And one that says nothing. */
	start(f, false, 0, GR_NS_PER_S);
	wait_for(f, TRACK_ABSENT, "no VRPN server answers");
}

static void a_device_that_the_server_has_not(void **state)
{
	struct fixture *f = *state;

	start(f, false, 0, 0);
	mock_vrpn_accept(&f->server, false);
	mock_vrpn_greet(&f->server, COOKIE, "Tracker1", 0);
	wait_for(f, TRACK_ABSENT, "has no device \"Tracker0\"; it has Somebody, Tracker1");
	/* It is plugged into the server later. */
	mock_vrpn_hang_up(&f->server);
	serve(f, false, 0);
}

/* Four gigabytes, at any place: no memory, no wait, another connection. */
static void hostile_lengths(void **state)
{
	static const uint32_t lengths[] = { UINT32_MAX, 0x80000000u, 70000, 23, 0 };
	struct fixture *f = *state;

	start(f, false, 0, 0);
	for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
		serve(f, false, 0);
		say_pose(f, 1000, 0, 1);
		vrpn_u32(&f->server.say, lengths[i]);
		mock_vrpn_flush(&f->server);
		wait_for(f, TRACK_FAILED, "a length that none has");
		mock_vrpn_hang_up(&f->server);
	}
	assert_int_equal(net_counters(f->device).faults[TRACK_FAULT_LENGTH], 5);
}

/* Noise, and names without end: refused, counted, over. */
static void hostile_peers(void **state)
{
	struct unit_random random = unit_random_start("noise");
	struct fixture *f = *state;

	start(f, false, 0, 0);
	for (int i = 0; i < 5; i++) {
		serve(f, false, 0);
		for (int k = 0; k < 1000; k++)
			vrpn_u32(&f->server.say, unit_random_u32(&random) | 0x01000000);
		mock_vrpn_flush(&f->server);
		wait_for(f, TRACK_FAILED, "a length that none has");
		mock_vrpn_hang_up(&f->server);
	}
	serve(f, false, 0);
	for (int i = 0; i < 20000; i++) {
		vrpn_name(&f->server.say, -1 - i % 2, i % 4000 - 1000, "a name");
		if (f->server.say.len > 60000)
			mock_vrpn_flush(&f->server);
	}
	vrpn_name(&f->server.say, -1, f->server.sender, "Tracker0");
	vrpn_name(&f->server.say, -2, f->server.pose, "vrpn_Tracker Pos_Quat");
	say_pose(f, 1000, 0, 5);
	mock_vrpn_flush(&f->server);
	take(f, 1);
	assert_float_equal(f->reports[0].T_base_sensor.p[0], 5, 0);
	/* Of numbers from -1000 to 2999 half are out of bounds. */
	assert_int_equal(net_counters(f->device).faults[TRACK_FAULT_FORMAT], 10000);
}

/* It lives as long as it answers. */
static void silence(void **state)
{
	struct fixture *f = *state;

	gr_log_set_level((enum gr_log_level)0);
	start(f, false, 4 * GR_NS_PER_S, 0);
	f->server.answers = true;
	serve(f, false, 0);
	net_wait(f->device, (mock_vrpn_listen(&f->server), f->server.pings >= 5));
	assert_int_equal(net_counters(f->device).opened, 1);
	assert_true(net_is(f->device, TRACK_RUNNING));
	f->server.answers = false;
	wait_for(f, TRACK_ABSENT, "has not answered for 4 s");
	mock_vrpn_hang_up(&f->server);
	f->server.answers = true;
	serve(f, false, 50);
	assert_int_equal(net_counters(f->device).opened, 2);
	gr_log_set_level(GR_LOG_ERROR);
}

static void names_and_addresses_that_are_none(void **state)
{
	static const char long_name[] = "0123456789012345678901234567890123456789012345678901234567890123456789"
					"012345678901234567890123456789";
	static const struct track_vrpn_params bad[] = {
		{ .device = NULL, .address = "127.0.0.1" },
		{ .device = "", .address = "127.0.0.1" },
		{ .device = long_name, .address = "127.0.0.1" },
		{ .device = "a", .address = NULL },
		{ .device = "a", .address = "localhost" },
		{ .device = "a", .address = "::1" },
	};
	struct track_device *device = NULL;

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
		assert_int_equal(track_vrpn_create(&device, &bad[i], &gr_clock_monotonic),
				 GR_ERR_RANGE);
	assert_null(device);
}

int main(void)
{
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
	const struct CMUnitTest tests[] = {
		WITH(poses_by_tcp),
		WITH(streams_have_no_edges),
		WITH(buttons_and_channels),
		WITH(buttons_alone_rest),
		WITH(poses_by_udp),
		WITH(restarts_by_tcp),
		WITH(restarts_by_udp),
		WITH(a_server_that_takes_its_leave),
		WITH(nobody_there),
		WITH(a_server_of_something_else),
		WITH(a_device_that_the_server_has_not),
		WITH(hostile_lengths),
		WITH(hostile_peers),
		WITH(silence),
		cmocka_unit_test(names_and_addresses_that_are_none),
	};

	gr_log_init("test", GR_LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
