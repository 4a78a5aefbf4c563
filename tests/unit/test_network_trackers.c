/* A room whose head comes from DTrack and whose wand comes from a VRPN server, as the master has it. */
#include "tests/unit/unit_config.h"

#include "base/log.h"
#include "daemon/trackers.h"
#include "tests/unit/mock_vrpn.h"

static const char room[] =
	"name = \"room\";\n"
	"walls = ( { name = \"front\"; lower_left = [-1.5, 0.0, -1.5]; lower_right = [1.5, 0.0, -1.5];\n"
	"  upper_left = [-1.5, 2.0, -1.5]; pixels = [600, 400];\n"
	"  nodes = ( { address = \"127.0.0.1\"; port = 5001; } ); } );\n"
	"room = { min = [-2.0, 0.0, -2.5]; max = [2.0, 2.5, 2.5]; };\n"
	"network = { master_address = \"127.0.0.1\"; };\n"
	"trackers = (\n"
	"	{ name = \"art\"; kind = \"dtrack\"; dtrack = { up = \"z\"; port = %u; };\n"
	"	  bind = ( { body = \"head\"; sensor = \"body2\"; } ); },\n"
	"	{ name = \"lab\"; kind = \"vrpn\"; base = { position = [0.0, 0.5, 0.0]; };\n"
	"	  vrpn = { device = \"Wand\"; address = \"127.0.0.1\"; port = %u; };\n"
	"	  bind = ( { body = \"wand\"; sensor = \"4\"; buttons = \"7 - a0\"; } ); } );\n";

struct fixture {
	struct mock_vrpn server;
	uint16_t port;
	int controller;
	struct layout *layout;
	struct gr_diag diag;
	struct trackers trackers;
	struct master_input input;
};

static int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);
	char text[2000];
	int len;

	mock_vrpn_start(&f->server);
	f->port = net_free_port(SOCK_DGRAM);
	f->controller = net_socket(SOCK_DGRAM, "127.0.0.1", 0);
	len = snprintf(text, sizeof text, room, (unsigned)f->port, (unsigned)f->server.port);
	if (layout_parse(text, (size_t)len, "room.cave", &f->layout, &f->diag) != GR_OK ||
	    trackers_open(&f->trackers, f->layout, &f->diag) != GR_OK ||
	    trackers_start(&f->trackers) != GR_OK) {
		unit_diag_print(&f->diag);
		return -1;
	}
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	trackers_close(&f->trackers);
	layout_destroy(&f->layout);
	gr_diag_finish(&f->diag);
	mock_vrpn_stop(&f->server);
	close(f->controller);
	free(f);
	return 0;
}

/* A metre to the right, two from the viewer, 1.7 up, by a room's calibration with z up. */
static void send_head(const struct fixture *f, unsigned number)
{
	const struct sockaddr_in to = net_at("127.0.0.1", f->port);
	char text[200];
	const int len = snprintf(text, sizeof text,
				 "fr %u\r\n6d 1 [2 1.000][1000.0 2000.0 1700.0][1 0 0 0 1 0 0 0 1]\r\n",
				 number);

	assert_int_equal(sendto(f->controller, text, (size_t)len, 0, (const struct sockaddr *)&to, sizeof to),
			 len);
}

static void send_wand(struct fixture *f, uint64_t time_us)
{
	vrpn_button(&f->server.say, f->server.sender, f->server.button, 7, 1);
	vrpn_channels(&f->server.say, f->server.sender, f->server.channels, 1, &(double){ 0.9 });
	vrpn_pose(&f->server.say, time_us, f->server.sender, f->server.pose, 4, 0.25);
	mock_vrpn_flush(&f->server);
}

static bool both_tracked(struct fixture *f)
{
	const int64_t now_ns = gr_clock_now(&gr_clock_monotonic);

	trackers_poll(&f->trackers, now_ns, now_ns);
	trackers_sample(&f->trackers, now_ns, &f->input);
	return f->input.head.tracked && f->input.wand.tracked;
}

static void head_and_wand(void **state)
{
	struct fixture *f = *state;
	unsigned number = 0;
	uint64_t time_us = 1000000;

	mock_vrpn_accept(&f->server, false);
	mock_vrpn_greet(&f->server, "vrpn: ver. 07.35  0\0\0\0\0", "Wand", 20);
	net_wait(f->trackers.all[0].device,
		 (send_head(f, ++number), send_wand(f, time_us += 1000), both_tracked(f)));
	assert_vector(f->input.head.T_room_body.p, 1, 1.7, -2);
	assert_vector(f->input.wand.T_room_body.p, 0.25, 1.5, 2);
	assert_int_equal(f->input.buttons, 5); /* the first and, by the channel, the third */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(head_and_wand, setup, teardown),
	};

	gr_log_init("test", GR_LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
