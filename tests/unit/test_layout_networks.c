/* Trackers of the network in a layout: keys, faults with their lines, written and read again. */
#include "tests/unit/layout_text.h"

#include "base/result.h"

static const char trackers[] =
	"trackers = (\n"
	"	{ name = \"art\"; kind = \"dtrack\"; dtrack = {\n"
	"	    up = \"z\"; port = 5001; address = \"10.0.0.5\";\n"
	"	    group = \"239.1.2.3\"; interface = \"eth1\"; knock = true;\n"
	"	    stick_x_plus = \"right\"; stick_y_plus = \"down\"; };\n"
	"	  bind = ( { body = \"head\"; sensor = \"body0\"; } ); },\n"
	"	{ name = \"lab\"; kind = \"vrpn\"; vrpn = {\n"
	"	    device = \"Tracker 0\"; address = \"10.0.0.6\"; port = 3884; transport = \"udp\"; };\n"
	"	  bind = ( { body = \"wand\"; sensor = \"1\"; } ); }\n"
	");\n";

/* Their port 5000 is the usual one of DTrack. */
static char *room_text(void)
{
	return unit_replace(layout_text, "master_port = 5000", "master_port = 27100");
}

static struct layout *parse(const char *text, struct gr_diag *diag)
{
	struct layout *layout = NULL;
	char *room = room_text(), *whole = layout_text_with_trackers(room, text);

	layout_text_parse(whole, &layout, diag);
	free(whole);
	free(room);
	return layout;
}

static void check_values(const struct layout *layout)
{
	const struct layout_dtrack *art = &layout->trackers[0].dtrack;
	const struct layout_vrpn *lab = &layout->trackers[1].vrpn;

	assert_int_equal(layout->trackers[0].kind, LAYOUT_TRACKER_DTRACK);
	assert_int_equal(art->up, LAYOUT_UP_Z);
	assert_int_equal(art->port, 5001);
	assert_string_equal(art->address, "10.0.0.5");
	assert_string_equal(art->group, "239.1.2.3");
	assert_string_equal(art->interface, "eth1");
	assert_true(art->knock);
	assert_int_equal(art->stick_x_plus, LAYOUT_STICK_RIGHT);
	assert_int_equal(art->stick_y_plus, LAYOUT_STICK_DOWN);
	assert_int_equal(layout->trackers[1].kind, LAYOUT_TRACKER_VRPN);
	assert_string_equal(lab->device, "Tracker 0");
	assert_string_equal(lab->address, "10.0.0.6");
	assert_int_equal(lab->port, 3884);
	assert_int_equal(lab->transport, LAYOUT_UDP);
}

static void what_it_says_is_there(void **state)
{
	struct gr_diag diag = { 0 };
	struct layout *layout = parse(trackers, &diag), *again = NULL;
	char *text = NULL;
	size_t len = 0;
	FILE *file = open_memstream(&text, &len);

	(void)state;
	unit_diag_print(&diag);
	assert_int_equal(diag.count, 0);
	assert_non_null(layout);
	check_values(layout);
	assert_int_equal(layout_write(file, layout), GR_OK);
	fclose(file);
	assert_int_equal(layout_text_parse(text, &again, &diag), GR_OK);
	unit_diag_print(&diag);
	assert_int_equal(diag.count, 0); /* nor a warning of the other kind's keys */
	check_values(again);
	layout_destroy(&layout);
	layout_destroy(&again);
	gr_diag_finish(&diag);
	free(text);
}

static void what_it_does_not_say_is_the_default(void **state)
{
	struct gr_diag diag = { 0 };
	struct layout *layout = parse(
		"trackers = ( { name = \"art\"; kind = \"dtrack\"; bind = ( { body = \"head\"; } ); },\n"
		"{ name = \"lab\"; kind = \"vrpn\"; vrpn = { device = \"a\"; address = \"127.0.0.1\"; };\n"
		"  bind = ( { body = \"wand\"; } ); } );\n",
		&diag);
	const struct layout_dtrack *art;

	(void)state;
	unit_diag_print(&diag);
	assert_int_equal(diag.count, 0);
	assert_non_null(layout);
	art = &layout->trackers[0].dtrack;
	assert_int_equal(art->port, 5000);
	assert_int_equal(art->up, LAYOUT_UP_Y);
	assert_null(art->address);
	assert_false(art->knock);
	assert_int_equal(art->stick_x_plus, LAYOUT_STICK_LEFT);
	assert_int_equal(art->stick_y_plus, LAYOUT_STICK_UP);
	assert_int_equal(layout->trackers[1].vrpn.port, 3883);
	assert_int_equal(layout->trackers[1].vrpn.transport, LAYOUT_TCP);
	layout_destroy(&layout);
	gr_diag_finish(&diag);
}

#define A99 "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"

static const struct layout_fault faults[] = {
	{ "\"10.0.0.5\"", "\"controller\"", "controller", "trackers[0].dtrack.address",
	  "\"controller\" is not a numeric IPv4 address; write it as 192.0.2.1", 1 },
	{ "\"10.0.0.5\"", "\"2001:db8::1\"", "2001", "trackers[0].dtrack.address",
	  "is not a numeric IPv4 address", 1 },
	{ "\"10.0.0.5\"", "\"239.0.0.1\"", "239.0.0.1", "trackers[0].dtrack.address",
	  "239.0.0.1 is not one machine's address", 1 },
	{ "\"239.1.2.3\"", "\"10.1.2.3\"", "10.1.2.3", "trackers[0].dtrack.group",
	  "\"10.1.2.3\" is not an IPv4 multicast group; those are 224.0.0.0 to", 1 },
	{ "\"239.1.2.3\"", "\"ff02::1\"", "ff02", "trackers[0].dtrack.group", "is not an IPv4 multicast", 1 },
	{ "\"eth1\"", "\"a-very-long-name\"", "a-very", "trackers[0].dtrack.interface",
	  "is not an interface's name; those have 1 to 15 bytes", 1 },
	{ "group = \"239.1.2.3\"; ", "", "interface", "trackers[0].dtrack.interface",
	  "not used: only a group is heard on an interface", 0 },
	{ " address = \"10.0.0.5\";", "", "knock", "trackers[0].dtrack.knock",
	  "needs the controller's address to send to", 1 },
	{ "port = 5001", "port = 1023", "port = 1023", "trackers[0].dtrack.port", "1024 to 65535", 1 },
	{ "port = 5001", "port = 27100", "port = 27100; address", "trackers[0].dtrack.port",
	  "UDP port 27100 is the master's own (network.master_port)", 1 },
	{ "up = \"z\"", "up = \"x\"", "up = ", "trackers[0].dtrack.up", "y", 1 },
	{ "stick_x_plus = \"right\"", "stick_x_plus = \"rihgt\"", "rihgt",
	  "trackers[0].dtrack.stick_x_plus", "did you mean \"right\"?", 1 },
	{ "knock = true", "knok = true", "knok", "trackers[0].dtrack.knok", "did you mean \"knock\"?", 1 },
	{ "kind = \"dtrack\"; dtrack = {", "kind = \"dtrack\"; number = 2; dtrack = {", "number",
	  "trackers[0].number", "not used: what comes by the network is told apart by its address", 0 },
	{ "kind = \"vrpn\"; vrpn = {", "kind = \"vrpn\"; serial = \"x\"; vrpn = {", "serial",
	  "trackers[1].serial", "not used: what comes by the network", 0 },
	{ "kind = \"dtrack\"; dtrack = {", "kind = \"hydra\"; dtrack = {", "kind = \"hydra\"",
	  "trackers[0].dtrack", "not used: only kind = \"dtrack\" has a controller", 0 },
	{ "device = \"Tracker 0\"; ", "", "kind = \"vrpn\"", "trackers[1].vrpn.device",
	  "missing; it is the server's name for the device", 1 },
	{ "address = \"10.0.0.6\"; ", "", "kind = \"vrpn\"", "trackers[1].vrpn.address",
	  "missing; it is the server's machine, as a numeric IPv4 address", 1 },
	{ "\"10.0.0.6\"", "\"0.0.0.0\"", "0.0.0.0", "trackers[1].vrpn.address",
	  "0.0.0.0 is not one machine's address", 1 },
	{ "Tracker 0", "Tracker0@10.0.0.6", "Tracker0@", "trackers[1].vrpn.device",
	  "\"Tracker0@10.0.0.6\" has an @; the name goes before it, the server is `address`", 1 },
	{ "Tracker 0", A99 "a", "aaaa", "trackers[1].vrpn.device", "too long; at most 99 bytes", 1 },
	{ "Tracker 0", "Tr\xc3\xa4" "cker", "device", "trackers[1].vrpn.device",
	  "byte 3 is no printable ASCII character", 1 },
	{ "transport = \"udp\"", "transport = \"tpc\"", "tpc", "trackers[1].vrpn.transport",
	  "did you mean \"tcp\"?", 1 },
	{ "kind = \"vrpn\"; vrpn = {", "kind = \"vrpn\"; }, { name = \"x\"; kind = \"hydra\"; vrpn = {",
	  "kind = \"vrpn\"", "trackers[1].vrpn", "missing; say which device of which server: vrpn = {", 2 },
};

static void faults_are_named(void **state)
{
	char *room = room_text();
	unsigned bad = 0;

	(void)state;
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
		bad += layout_text_check_fault(&faults[i], room, trackers);
	free(room);
	assert_int_equal(bad, 0);
}

/* Of what comes to one port each of two would hear a part. */
static void two_rooms_need_two_ports(void **state)
{
	static const char text[] =
		"trackers = ( { name = \"a\"; kind = \"dtrack\"; bind = ( { body = \"head\"; } ); },\n"
		"{ name = \"b\"; kind = \"dtrack\"; dtrack = { port = %d; };\n"
		"  bind = ( { body = \"wand\"; } ); } );\n";
	struct gr_diag diag = { 0 };
	struct layout *layout;
	char both[400];

	(void)state;
	snprintf(both, sizeof both, text, 5002);
	layout = parse(both, &diag);
	unit_diag_print(&diag);
	assert_int_equal(diag.count, 0);
	layout_destroy(&layout);
	gr_diag_finish(&diag);
	snprintf(both, sizeof both, text, 5000);
	layout = parse(both, &diag);
	assert_true(unit_diag_has(&diag, GR_DIAG_ERROR, "t.cave:", "UDP port 5000 is tracker \"a\"'s; give each"));
	layout_destroy(&layout);
	gr_diag_finish(&diag);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_it_says_is_there),
		cmocka_unit_test(what_it_does_not_say_is_the_default),
		cmocka_unit_test(faults_are_named),
		cmocka_unit_test(two_rooms_need_two_ports),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
