/* DTrack's driver over real sockets: bursts, duplicates, disorder, strangers, silence, two rooms. */
#include "tests/unit/unit.h"

#include "tests/unit/net_device.h"
#include "tracking/dtrack.h"

#define MS GR_NS_PER_MS
#define TAKE 512

struct room {
	struct track_device *device;
	struct track_reader reader;
	struct track_report reports[TAKE];
	uint16_t port;
	int fd; /* of the controller */
	uint32_t number;
};

static void start(struct room *room, struct track_dtrack_params params, const char *controller)
{
	*room = (struct room){ .port = net_free_port(SOCK_DGRAM) };
	params.port = room->port;
	if (!params.silence_ns)
		params.silence_ns = NET_DEADLINE_NS; /* this process may not run for a while */
	room->fd = net_socket(SOCK_DGRAM, controller, 0);
	assert_int_equal(track_dtrack_create(&room->device, &params, &gr_clock_monotonic), GR_OK);
	assert_int_equal(track_device_start(room->device), GR_OK);
}

static void end(struct room *room)
{
	track_device_destroy(&room->device);
	close(room->fd);
}

static void send_to(const struct room *room, int fd, const void *bytes, size_t len)
{
	const struct sockaddr_in to = net_at("127.0.0.1", room->port);

	assert_int_equal(sendto(fd, bytes, len, 0, (const struct sockaddr *)&to, sizeof to), len);
}

/* Body 0 at x metres, at a time of day. */
static void send_frame(const struct room *room, uint32_t number, int64_t ts_ns, double x_m)
{
	char text[256];
	const int n = snprintf(text, sizeof text,
			       "fr %u\r\nts %.6f\r\n6d 1 [0 1.000][%.3f 0.000 0.000]"
			       "[1.000000 0.000000 0.000000 0.000000 1.000000 0.000000 0.000000 "
			       "0.000000 1.000000]\r\n",
			       number, (double)ts_ns * 1e-9, x_m * 1000);

	send_to(room, room->fd, text, (size_t)n);
}

static int64_t now(void)
{
	return gr_clock_now(&gr_clock_monotonic);
}

/* Time of day by the controller's clock, which began at `zero`. */
static int64_t ts(int64_t zero)
{
	return now() - zero;
}

static void wait_ms(int ms)
{
	nanosleep(&(struct timespec){ .tv_nsec = ms * 1000000L }, NULL);
}

/* Frames until it has been taken up, and what came of them forgotten. */
static void bring_up(struct room *room, int64_t zero)
{
	struct track_report report = { 0 };

	net_wait(room->device,
		 (send_frame(room, ++room->number, ts(zero), 0), net_is(room->device, TRACK_RUNNING)));
	/* The last of them tells that nothing is on its way any more. */
	wait_ms(1);
	send_frame(room, ++room->number, ts(zero), -1);
	net_wait(room->device,
		 (track_device_take(room->device, &room->reader, &report, 1) == 1 &&
		  report.T_base_sensor.p[0] < -0.5f));
}

/* The next `count` reports. */
static void take(struct room *room, int count)
{
	int got = 0;

	net_wait(room->device,
		 (got += track_device_take(room->device, &room->reader, room->reports + got, count - got),
		  got == count));
}

/* ---- */

static void frames_of_a_body(void **state)
{
	/* A clock that began nine hours ago, for all that it matters. */
	const int64_t zero = now() - 9 * 3600 * GR_NS_PER_S;
	struct room room;

	(void)state;
	start(&room, (struct track_dtrack_params){ 0 }, "127.0.0.1");
	bring_up(&room, zero);
	for (int i = 0; i < 20; i++, wait_ms(2))
		send_frame(&room, ++room.number, ts(zero), i);
	take(&room, 20);
	for (int i = 0; i < 20; i++) {
		const struct track_report *r = &room.reports[i];

		assert_int_equal(r->sensor, 0);
		assert_float_equal(r->T_base_sensor.p[0], i, 1e-6);
		assert_true(r->time_ns <= r->arrived_ns);
		assert_true(r->arrived_ns <= now());
		/* Not hours ago, though its clock says so. */
		assert_true(r->arrived_ns - r->time_ns < 60 * GR_NS_PER_S);
		assert_true(i == 0 || r->time_ns > r[-1].time_ns);
	}
	assert_int_equal(net_counters(room.device).missed, 0);
	assert_int_equal(net_counters(room.device).faults[TRACK_FAULT_ORDER], 0);
	end(&room);
}

/* Eight at once after a stall are spread out again as they were measured. */
static void bursts_of_eight(void **state)
{
	const int64_t zero = now() - 100 * GR_NS_PER_S, step = 10 * MS;
	struct room room;

	(void)state;
	start(&room, (struct track_dtrack_params){ 0 }, "127.0.0.1");
	bring_up(&room, zero);
	for (int burst = 0; burst < 5; burst++) {
		const int64_t last = (wait_ms(100), ts(zero));

		for (int i = 0; i < 8; i++)
			send_frame(&room, ++room.number, last - (7 - i) * step, i);
		take(&room, 8);
		for (int i = 1; i < 8; i++) {
			const struct track_report *r = &room.reports[i];

			assert_float_equal(r->T_base_sensor.p[0], i, 1e-6);
			assert_int_equal((r->device_ns - r[-1].device_ns + 500) / 1000, step / 1000);
			assert_true(r->time_ns > r[-1].time_ns && r->time_ns <= r->arrived_ns);
		}
		printf("# of %d ms, a burst that arrived within %.3f ms is given %.3f ms\n",
		       (int)(7 * step / MS),
		       (double)(room.reports[7].arrived_ns - room.reports[0].arrived_ns) * 1e-6,
		       (double)(room.reports[7].time_ns - room.reports[0].time_ns) * 1e-6);
	}
	assert_int_equal(net_counters(room.device).missed, 0);
	end(&room);
}

static void duplicates_and_disorder(void **state)
{
	const int64_t zero = now();
	struct room room;

	(void)state;
	start(&room, (struct track_dtrack_params){ .address = "127.0.0.1" }, "127.0.0.1");
	bring_up(&room, zero);
	for (int i = 0; i < 50; i++, wait_ms(1)) {
		const uint32_t first = room.number + 1;
		const int64_t at = ts(zero);

		/* 2, 2, 1, 4 and never 3. */
		send_frame(&room, first + 1, at - MS / 2, 2 * i);
		send_frame(&room, first + 1, at - MS / 2, 77);
		send_frame(&room, first, at - MS, 77);
		send_frame(&room, first + 3, at, 2 * i + 1);
		room.number += 4;
	}
	take(&room, 100);
	for (int i = 0; i < 100; i++)
		assert_float_equal(room.reports[i].T_base_sensor.p[0], i, 1e-6);
	assert_int_equal(net_counters(room.device).faults[TRACK_FAULT_ORDER], 100);
	/* As far as it can be told when they came too late. */
	assert_int_equal(net_counters(room.device).missed, 100);
	end(&room);
}

static uint64_t refused(const struct room *room)
{
	const struct track_counters counters = net_counters(room->device);

	return counters.faults[TRACK_FAULT_FORMAT] + counters.faults[TRACK_FAULT_LENGTH];
}

static void damaged_datagrams_move_nothing(void **state)
{
	struct unit_random random = unit_random_start("damaged");
	const int64_t zero = now();
	static char big[65507];
	struct room room;

	(void)state;
	start(&room, (struct track_dtrack_params){ 0 }, "127.0.0.1");
	send_to(&room, room.fd, "x", 1); /* refused while it is awaited, too */
	bring_up(&room, zero);
	memset(big, '1', sizeof big);
	memcpy(big, "fr 9\n6d 1 [0 1][", 16);
	for (int i = 0; i < 100; i++) {
		uint8_t noise[64];

		for (size_t k = 0; k < sizeof noise; k++)
			noise[k] = (uint8_t)unit_random_u32(&random);
		send_to(&room, room.fd, noise, (size_t)i % sizeof noise);
	}
	/* The two of no bytes are too short, nearly all others no frames. */
	net_wait(room.device, refused(&room) >= 100);
	send_to(&room, room.fd, big, sizeof big);
	net_wait(room.device, refused(&room) >= 101);
	send_frame(&room, ++room.number, ts(zero), 5);
	take(&room, 1);
	assert_float_equal(room.reports[0].T_base_sensor.p[0], 5, 1e-6);
	assert_true(net_counters(room.device).faults[TRACK_FAULT_LENGTH] >= 2);
	assert_int_equal(net_counters(room.device).faults[TRACK_FAULT_ORDER], 0);
	end(&room);
}

static void strangers_are_not_heard(void **state)
{
	const int64_t zero = now();
	struct room room;
	int stranger;

	(void)state;
	start(&room, (struct track_dtrack_params){ .address = "127.0.0.3" }, "127.0.0.3");
	stranger = net_socket(SOCK_DGRAM, "127.0.0.2", 0);
	/* As long as nobody else speaks, the status names who does. */
	net_wait(room.device,
		 (send_to(&room, stranger, "fr 1\n", 5), net_is(room.device, TRACK_ABSENT) &&
		  strstr(net_status(room.device).why, "but from 127.0.0.2:")));
	bring_up(&room, zero);
	for (int i = 0; i < 10; i++)
		send_to(&room, stranger, "fr 90\n6d 0\n", 11);
	send_frame(&room, ++room.number, ts(zero), 5);
	take(&room, 1);
	assert_false(room.reports[0].has & TRACK_LOST);
	assert_float_equal(room.reports[0].T_base_sensor.p[0], 5, 1e-6);
	close(stranger);
	end(&room);
}

static void two_rooms(void **state)
{
	const int64_t zero = now();
	struct room rooms[2];

	(void)state;
	for (int i = 0; i < 2; i++)
		start(&rooms[i], (struct track_dtrack_params){ 0 }, "127.0.0.1");
	for (int i = 0; i < 2; i++)
		bring_up(&rooms[i], zero + i * 3600 * GR_NS_PER_S);
	for (int i = 0; i < 2; i++) {
		send_frame(&rooms[i], ++rooms[i].number, ts(zero + i * 3600 * GR_NS_PER_S), i + 1);
		take(&rooms[i], 1);
		assert_float_equal(rooms[i].reports[0].T_base_sensor.p[0], i + 1, 1e-6);
	}
	for (int i = 0; i < 2; i++)
		end(&rooms[i]);
}

/* The measurement ends and begins again, with another clock and another counter. */
static void silence_and_return(void **state)
{
	const int64_t zero = now();
	struct room room;

	(void)state;
	start(&room, (struct track_dtrack_params){ .silence_ns = 3 * GR_NS_PER_S }, "127.0.0.1");
	net_wait(room.device, net_is(room.device, TRACK_ABSENT));
	assert_non_null(strstr(net_status(room.device).why, "start the measurement"));
	bring_up(&room, zero - 3600 * GR_NS_PER_S);
	net_wait(room.device, net_is(room.device, TRACK_ABSENT));
	assert_int_equal(net_counters(room.device).opened, 1);
	room.number = 0;
	bring_up(&room, zero);
	assert_int_equal(net_counters(room.device).opened, 2);
	send_frame(&room, ++room.number, ts(zero), 5);
	take(&room, 1);
	assert_float_equal(room.reports[0].T_base_sensor.p[0], 5, 1e-6);
	end(&room);
}

static void a_port_that_is_taken(void **state)
{
	const int taken = net_socket(SOCK_DGRAM, "0.0.0.0", 0);
	struct track_device *device;
	const struct track_dtrack_params params = { .port = net_port(taken) };

	(void)state;
	assert_int_equal(track_dtrack_create(&device, &params, &gr_clock_monotonic), GR_OK);
	track_device_turn(device, 0);
	assert_int_equal(net_status(device).state, TRACK_BUSY);
	assert_non_null(strstr(net_status(device).why, "another tracker of the layout"));
	track_device_destroy(&device);
	close(taken);
}

static void groups(void **state)
{
	const int64_t zero = now();
	const struct in_addr loopback = { htonl(INADDR_LOOPBACK) };
	struct track_dtrack_params params = { .group = "239.255.77.1",
					      .interface_name = "nosuch0",
					      .port = net_free_port(SOCK_DGRAM) };
	struct sockaddr_in to;
	struct room room;

	(void)state;
	assert_int_equal(track_dtrack_create(&room.device, &params, &gr_clock_monotonic), GR_OK);
	track_device_turn(room.device, 0);
	assert_int_equal(net_status(room.device).state, TRACK_ABSENT);
	assert_non_null(strstr(net_status(room.device).why, "multicast group"));
	track_device_destroy(&room.device);
	params.interface_name = "lo";
	start(&room, params, "127.0.0.1");
	if (setsockopt(room.fd, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback) < 0)
		fail();
	to = net_at("239.255.77.1", room.port);
	net_wait(room.device,
		 sendto(room.fd, "fr 1\n", 5, 0, (struct sockaddr *)&to, sizeof to) != 5 ||
			 net_is(room.device, TRACK_RUNNING));
	send_frame(&room, 2, ts(zero), 5);
	take(&room, 1);
	end(&room);
}

static void a_firewall_is_opened(void **state)
{
	const int controller = net_socket(SOCK_DGRAM, "127.0.0.1", 50107);
	struct sockaddr_in from;
	socklen_t len = sizeof from;
	struct room room;
	char byte;

	(void)state;
	if (controller < 0) {
		printf("# UDP port 50107 is taken here\n");
		skip();
	}
	start(&room, (struct track_dtrack_params){ .address = "127.0.0.1", .knock = true },
	      "127.0.0.1");
	assert_int_equal(recvfrom(controller, &byte, 1, 0, (struct sockaddr *)&from, &len), 1);
	assert_int_equal(ntohs(from.sin_port), room.port);
	close(controller);
	end(&room);
}

static void addresses_that_are_none(void **state)
{
	static const struct track_dtrack_params bad[] = {
		{ .address = "controller" },
		{ .address = "10.0.0.256" },
		{ .address = "::1" },
		{ .group = "" },
		{ .interface_name = "a-name-too-long-" },
	};
	struct track_device *device = NULL;

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
		assert_int_equal(track_dtrack_create(&device, &bad[i], &gr_clock_monotonic),
				 GR_ERR_RANGE);
	assert_null(device);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(frames_of_a_body),
		cmocka_unit_test(bursts_of_eight),
		cmocka_unit_test(duplicates_and_disorder),
		cmocka_unit_test(damaged_datagrams_move_nothing),
		cmocka_unit_test(strangers_are_not_heard),
		cmocka_unit_test(two_rooms),
		cmocka_unit_test(silence_and_return),
		cmocka_unit_test(a_port_that_is_taken),
		cmocka_unit_test(groups),
		cmocka_unit_test(a_firewall_is_opened),
		cmocka_unit_test(addresses_that_are_none),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
