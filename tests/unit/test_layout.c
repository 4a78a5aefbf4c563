/* Layouts: the shipped ones, every kind of fault with its line, save and load again, walls. */
#include "base/result.h"
#include "tests/unit/layout_text.h"

#include <math.h>

/*
 * One change to the base text, and what must be said about it: on the line of
 * `mark` (a piece of the changed text), about `key`. `errors` is how many
 * errors in all, 0 for a warning only.
 */
struct fault {
	const char *find, *replace, *mark, *key, *message;
	unsigned errors;
};

static const struct fault faults[] = {
	/* unknown keys */
	{ "pixels = [600, 400]", "pixel = [600, 400]", "pixel =", "walls[0].pixel",
	  "unknown key, did you mean \"pixels\"?", 2 },
	{ "mtu = 1500", "mtu = 1500; colour = 1", "colour", "network.colour",
	  "unknown key; known here: cast, interface", 1 },
	{ "name = \"room\"", "nmae = \"room\"", "nmae", "nmae", "did you mean \"name\"?", 1 },
	{ "part = [0.5", "prat = [0.5", "prat", "walls[0].nodes[1].prat", "did you mean \"part\"?", 2 },
	{ "wand = false;", "wand = false; sim = { seeed = 1; };", "seeed", "trackers[0].sim.seeed",
	  "did you mean \"seed\"?", 1 },
	/* wrong types */
	{ "pixels = [600, 400]", "pixels = \"600x400\"", "pixels = \"", "walls[0].pixels",
	  "expected 2 numbers [ ], found a string \"600x400\"", 1 },
	{ "pixels = [600, 400]", "pixels = [600.5, 400.0]", "pixels = [600.5", "walls[0].pixels",
	  "expected a whole number, found a number with a fraction", 1 },
	{ "mtu = 1500", "mtu = \"big\"", "mtu", "network.mtu",
	  "expected a whole number, found a string \"big\"", 1 },
	{ "frame_hz = 60.0", "frame_hz = true", "frame_hz", "rates.frame_hz",
	  "expected a number, found true or false", 1 },
	{ "name = \"room\"", "name = 5", "name = 5", "name",
	  "expected a string \"...\", found a whole number", 1 },
	{ "file = \"x.log\"", "file = \"x.log\"; loop = 0", "loop = 0", "trackers[1].loop",
	  "expected true or false, found a whole number", 1 },
	{ "rates = { frame_hz = 60.0; }", "rates = 60", "rates = 60", "rates",
	  "expected a group { }, found a whole number", 1 },
	{ "nodes = ( { address", "nodes = ( 7, { address", "nodes = ( 7", "walls[1].nodes[0]",
	  "expected a group { }, found a whole number", 1 },
	{ "lower_left = [-1.5, 0.0, -1.5]", "lower_left = [-1.5, 0.0]", "lower_left = [-1.5, 0.0]",
	  "walls[0].lower_left", "expected 3 numbers, found 2", 1 },
	/* out of range */
	{ "mtu = 1500", "mtu = 500", "mtu", "network.mtu", "500 is outside 576 to 9000 bytes", 1 },
	{ "port = 5001", "port = 80", "port = 80", "walls[0].nodes[0].port",
	  "80 is outside 1024 to 65535", 1 },
	{ "port = 5001", "port = 70000", "port = 70000", "walls[0].nodes[0].port",
	  "70000 is outside 1024 to 65535", 1 },
	{ "port = 5001", "port = -5000000000L", "port = -5", "walls[0].nodes[0].port",
	  "-5000000000 is outside", 1 },
	{ "frame_hz = 60.0", "frame_hz = 0.0", "frame_hz", "rates.frame_hz",
	  "0 is outside 1 to 1000 Hz", 1 },
	{ "frame_hz = 60.0", "frame_hz = 1e999", "frame_hz", "rates.frame_hz",
	  "is not a finite number", 1 },
	{ "name = \"room\"", "eye_separation_m = 63", "eye_sep", "eye_separation_m",
	  "63 is outside 0 to 0.2 m", 1 },
	/* choices */
	{ "eyes = \"mono\"", "eyes = \"side-by-sdie\"", "eyes =", "walls[0].eyes",
	  "\"side-by-sdie\" is not known, did you mean \"side-by-side\"?; one of \"mono\", ", 1 },
	{ "kind = \"sim\"", "kind = \"magnetic\"", "kind = \"mag", "trackers[0].kind",
	  "\"magnetic\" is not known; one of \"sim\", \"replay\"", 1 },
	/* missing */
	{ "		name = \"front\";\n", "", "{\n", "walls[0].name", "missing; it is", 1 },
	{ "address = \"127.0.0.1\"; port = 5003;", "port = 5003;", "port = 5003",
	  "walls[1].nodes[0].address", "missing; it is the machine that draws", 1 },
	{ "		upper_left = [-1.5, 2.0, -1.5];\n", "", "{\n",
	  "walls[0].upper_left", "missing; a wall needs lower_left", 1 },
	{ "		size = [3.0, 3.0];\n", "", "{\n\t\tname = \"floor\"", "walls[1].size",
	  "missing; a wall needs three corners, or center and size", 1 },
	{ "		size = [3.0, 3.0];\n", "lower_left = [0.0, 0.0, 0.0];", "{\n\t\tname = \"floor\"",
	  "walls[1]", "given by corners and by center and size; keep one", 1 },
	/* not a rectangle */
	{ "upper_left = [-1.5, 2.0, -1.5]", "upper_left = [-1.45, 2.0, -1.5]", "upper_left",
	  "walls[0].upper_left", "measures 88.57 degrees, a rectangle's 90 (0.1 allowed)", 1 },
	{ "upper_left = [-1.5, 2.0, -1.5]", "upper_left = [-1.4, 2.0, -1.5]", "upper_left",
	  "walls[0].upper_left", "[-1.5000, 2.0025, -1.5000] would be right", 1 },
	{ "lower_right = [1.5, 0.0, -1.5]", "lower_right = [-1.5, 0.0, -1.5]", "lower_right",
	  "walls[0].lower_right", "0 m from lower_left; a wall's sides are at least 0.01 m", 1 },
	{ "upper_left = [-1.5, 2.0, -1.5]", "upper_left = [2.5, 0.0, -1.5]", "upper_left",
	  "walls[0].upper_left", "all three corners are on one line", 1 },
	/* left-handed, behind, outside */
	{ "lower_left = [-1.5, 0.0, -1.5];\n		lower_right = [1.5, 0.0, -1.5];\n"
	  "		upper_left = [-1.5,",
	  "lower_left = [1.5, 0.0, -1.5];\n		lower_right = [-1.5, 0.0, -1.5];\n"
	  "		upper_left = [1.5,",
	  "lower_left", "walls[0].lower_left",
	  "wall \"front\" is left-handed: seen from the start pose its front faces away; exchange", 1 },
	{ "pitch_deg = -90.0", "pitch_deg = 90.0", "{\n\t\tname = \"floor\"", "walls[1].lower_left",
	  "wall \"floor\" is left-handed", 1 },
	{ "head = [0.0, 1.7, 0.5]", "head = [0.0, 2.7, 0.5]", "head = [", "start.head",
	  "the left eye is outside the room: y is 2.700 m, the room has 0.000 to 2.000", 1 },
	{ "head = [0.0, 1.7, 0.5]", "head = [1.48, 1.7, 0.5]", "head = [", "start.head",
	  "the right eye is outside the room: x is 1.512 m", 1 },
	{ "start = { head = [0.0, 1.7, 0.5]; };",
	  "room = { min = [-3.0, 0.0, -4.0]; max = [3.0, 3.0, 3.0]; };\n"
	  "start = { head = [0.0, 1.7, -2.0]; };",
	  "head = [0.0, 1.7, -2.0]", "start.head", "an eye is 0.500 m behind wall \"front\"", 1 },
	{ "start = {", "room = { min = [-3.0, 0.0, 3.0]; max = [3.0, 3.0, -3.0]; };\nstart = {",
	  "room =", "room.min", "z is 3 and max has -3; min must be the smaller one", 1 },
	{ "start = {", "room = { min = [-3.0, 0.0, 3.0]; };\nstart = {", "room =", "room.max",
	  "missing; it is the corner opposite to min", 1 },
	/* names */
	{ "name = \"floor\"", "name = \"front\"", "name = \"front\";\n		center",
	  "walls[1].name", "wall \"front\" is there twice", 1 },
	{ "name = \"n2\"", "name = \"n1\"", "name = \"n1\"; address = \"127.0.0.1\"; port = 5002",
	  "walls[0].nodes[1].name", "node \"n1\" is there twice (line 10)", 1 },
	{ "name = \"t2\"", "name = \"t1\"", "name = \"t1\"; kind = \"replay\"", "trackers[1].name",
	  "tracker \"t1\" is there twice", 1 },
	{ "name = \"front\"", "name = \"front wall\"", "name = \"front wall\"", "walls[0].name",
	  "\"front wall\" cannot be a name: 1 to 31 letters", 1 },
	{ "name = \"n1\"", "name = \"../n1\"", "name = \"../n1\"", "walls[0].nodes[0].name",
	  "cannot be a name", 1 },
	/* who draws what */
	{ "port = 5002", "port = 5001", "name = \"n2\"", "walls[0].nodes[1].port",
	  "127.0.0.1 port 5001 is taken by node \"n1\"; give each its own", 1 },
	{ "port = 5003", "port = 5000", "port = 5000; } );\n	}", "walls[1].nodes[0].port",
	  "127.0.0.1 port 5000 is taken by the master; give each its own", 1 },
	{ "port = 5003", "port = 5003; projector = { black = [0.1, 0.1, 0.1]; gain = [1.0, 0.1, 1.0]; }",
	  "gain", "walls[1].nodes[0].projector.gain", "0.1 is no more than black, which is 0.1", 1 },
	{ "port = 5003", "port = 5003; target = \"window\"; projector = { depth = \"float\"; }", "depth",
	  "walls[1].nodes[0].projector.depth", "\"float\" is for target = \"headless\"", 1 },
	{ "port = 5003", "port = 5003; projector = { table = \"t.csv\"; gamma = [2.0, 2.0, 2.0]; }", "gamma",
	  "walls[1].nodes[0].projector.gamma", "not used: the table says it", 0 },
	{ "part = [0.5, 0.0, 1.0, 1.0]", "part = [0.4, 0.0, 1.0, 1.0]", "part = [0.4",
	  "walls[0].nodes[1].part", "overlaps the part of node \"n1\"", 1 },
	{ "part = [0.5, 0.0, 1.0, 1.0]", "part = [1.0, 0.0, 0.5, 1.0]", "part = [1.0",
	  "walls[0].nodes[1].part", "x runs from 1 to 0.5; the first must be the smaller one", 1 },
	{ "part = [0.5, 0.0, 1.0, 1.0]", "part = [0.5, 0.0, 0.5005, 1.0]", "part = [0.5, 0.0, 0.5005",
	  "walls[0].nodes[1].part", "not one pixel wide; the wall has 600", 1 },
	{ "part = [0.5, 0.0, 1.0, 1.0]", "part = [0.5, 0.0, 1.0, 0.5]", "nodes = ( { name = \"n1\"",
	  "walls[0].nodes", "75.0 % of the wall is drawn for the left eye; the rest stays dark", 0 },
	{ "pixels = [600, 400]", "pixels = [601, 400]", "part = [0.0", "walls[0].nodes[0].part",
	  "an edge falls inside a pixel (columns 0.00 to 300.50 of 601)", 0 },
	{ "nodes = ( { address = \"127.0.0.1\"; port = 5003; } )", "nodes = ( )", "nodes = ( )",
	  "walls[1].nodes", "no node draws this wall", 1 },
	{ "eyes = \"mono\"", "eyes = \"eye-per-node\"", "nodes = ( { name = \"n1\"",
	  "walls[0].nodes[0].eye", "missing; the wall says eyes = \"eye-per-node\"", 2 },
	{ "name = \"n1\";", "name = \"n1\"; eye = \"left\";", "eye = \"left\"",
	  "walls[0].nodes[0].eye", "only where the wall says eyes = \"eye-per-node\"", 1 },
	{ "name = \"n1\";", "name = \"n1\"; eye = \"left\"; eyes = \"mono\";", "eye = \"left\"",
	  "walls[0].nodes[0].eye", "given beside eyes; keep one of the two", 1 },
	/* addresses and the net */
	{ "address = \"127.0.0.1\"; port = 5001", "address = \"localhost\"; port = 5001", "localhost",
	  "walls[0].nodes[0].address", "not a numeric IPv4 or IPv6 address, did you mean \"127.0.0.1\"", 1 },
	{ "address = \"127.0.0.1\"; port = 5001", "address = \"127.0.0.256\"; port = 5001", "127.0.0.256",
	  "walls[0].nodes[0].address", "not a numeric IPv4 or IPv6 address; write it as", 1 },
	{ "address = \"127.0.0.1\"; port = 5001", "address = \"0.0.0.0\"; port = 5001", "0.0.0.0",
	  "walls[0].nodes[0].address", "0.0.0.0 is not one machine's address", 1 },
	{ "address = \"127.0.0.1\"; port = 5001", "address = \"239.1.1.1\"; port = 5001", "239.1.1.1",
	  "walls[0].nodes[0].address", "239.1.1.1 is not one machine's address", 1 },
	{ "address = \"127.0.0.1\"; port = 5001", "address = \"::1\"; port = 5001", "::1",
	  "walls[0].nodes[0].address", "is IPv6, the master's IPv4; use one of the two", 1 },
	/* without a key: each address of the room that others could reach */
	{ "address = \"127.0.0.1\"; port = 5001", "address = \"192.0.2.7\"; port = 5001",
	  "192.0.2.7", "walls[0].nodes[0].address",
	  "192.0.2.7 is not on loopback, so every machine needs the cluster's key: network.key_file", 1 },
	{ "address = \"127.0.0.1\"; port = 5003", "address = \"128.0.0.1\"; port = 5003",
	  "128.0.0.1", "walls[1].nodes[0].address", "128.0.0.1 is not on loopback, so", 1 },
	{ "master_address = \"127.0.0.1\"", "master_address = \"192.0.2.1\"", "192.0.2.1",
	  "network.master_address", "192.0.2.1 is not on loopback, so", 1 },
	{ "mtu = 1500", "cast = \"multicast\"; group = \"239.1.1.1\"", "network =",
	  "network.interface", "missing, and the system's choice is not loopback, so", 1 },
	{ "mtu = 1500", "cast = \"multicast\"; group = \"239.1.1.1\";\ninterface = \"lo1\"", "lo1",
	  "network.interface", "\"lo1\" is not loopback, so", 1 },
	{ "mtu = 1500", "cast = \"broadcast\"; interface = \"lo\";\ngroup = \"192.0.2.255\"", "192.0.2.255",
	  "network.group", "192.0.2.255 is not on loopback, so", 1 },
	{ "mtu = 1500", "cast = \"multicast\"; key_file = \"k\"", "network =", "network.group",
	  "missing; cast = \"multicast\" needs a multicast group such as", 1 },
	{ "mtu = 1500", "cast = \"multicast\"; key_file = \"k\"; group = \"192.0.2.255\"", "group =",
	  "network.group", "192.0.2.255 is not a multicast group; those are 224.0.0.0 to", 1 },
	{ "mtu = 1500", "cast = \"multicast\"; key_file = \"k\"; group = \"ff02::71\"", "group =",
	  "network.group", "is IPv6, the master's address IPv4", 1 },
	{ "mtu = 1500", "cast = \"broadcast\"; key_file = \"k\"; group = \"239.1.1.1\"", "group =",
	  "network.group", "239.1.1.1 is not an IPv4 broadcast address", 1 },
	{ "mtu = 1500", "cast = \"auto\"; key_file = \"k\"", "network =", "network.group",
	  "missing; cast = \"auto\" needs a multicast group such as", 1 },
	{ "mtu = 1500", "cast = \"auto\"; group = \"239.1.1.1\"", "network =",
	  "network.interface", "missing, and the system's choice is not loopback, so", 1 },
	{ "mtu = 1500", "cast = \"auto\"; group = \"127.255.255.255\"; interface = \"lo\"", "127.255",
	  "network.group", "127.255.255.255 is not a multicast group", 1 },
	{ "mtu = 1500", "cast = \"multicast\"; group = \"239.1.1.1\"; interface = \"lo\";\nloop = false", "loop",
	  "network.loop", "false, but node \"n1\" is on the master's machine", 1 },
	{ "mtu = 1500", "group = \"239.1.1.1\"", "group =", "network.group",
	  "not used: cast is \"unicast\"", 0 },
	{ "mtu = 1500", "interface = \"a-very-long-name\"", "interface", "network.interface",
	  "is not an interface's name; those have 1 to 15 bytes", 1 },
	{ "mtu = 1500", "key_file = \"\"", "key_file", "network.key_file", "empty; leave the key out", 1 },
	{ "mtu = 1500", "key_file = \"a\\nb\"", "key_file", "network.key_file",
	  "holds a control character (byte 10)", 1 },
	/* who does not keep up */
	{ "mtu = 1500; };", "mtu = 1500; };\nslow = { policy = \"drop\"; };", "slow =", "slow.policy",
	  "\"drop\" is not known; one of \"evict\", \"wait\", \"half\"", 1 },
	{ "mtu = 1500; };", "mtu = 1500; };\nslow = { limit_ms = 50.5; };", "slow =", "slow.limit_ms",
	  "50.5 ms, but nobody waits longer than rates.barrier_deadline_ms, 50", 1 },
	{ "mtu = 1500; };", "mtu = 1500; };\nslow = { policy = \"wait\"; limit_ms = 1001.0; };", "slow =",
	  "slow.limit_ms", "1001 ms, but nobody waits longer than wait_most_ms, 1000", 1 },
	{ "mtu = 1500; };", "mtu = 1500; };\nslow = { policy = \"wait\"; wait_most_ms = 49.0; };", "slow =",
	  "slow.wait_most_ms", "49 ms is less than all wait anyway (rates.barrier_deadline_ms, 50)", 1 },
	/* masters that stand by */
	{ "rates = { frame_hz = 60.0; }", "standby = ( { address = \"127.0.0.1\"; port = 5000; } )", "standby",
	  "standby[0].port", "127.0.0.1 port 5000 is taken by the master", 1 },
	{ "rates = { frame_hz = 60.0; }", "standby = ( { address = \"127.0.0.2\"; },\n{ address = \"127.0.0.2\"; } )",
	  "{ address = \"127.0.0.2\"; } )", "standby[1].port", "127.0.0.2 port 27100 is taken by a standby", 1 },
	{ "rates = { frame_hz = 60.0; }", "standby = ( { address = \"127.0.0.1\"; port = 5002; } )", "port = 5002",
	  "walls[0].nodes[1].port", "127.0.0.1 port 5002 is taken by a standby", 1 },
	{ "rates = { frame_hz = 60.0; }", "standby = ( { address = \"::1\"; } )", "standby", "standby[0].address",
	  "is IPv6, the master's IPv4", 1 },
	{ "rates = { frame_hz = 60.0; }", "standby = ( { address = \"192.0.2.9\"; } )", "standby",
	  "standby[0].address", "192.0.2.9 is not on loopback, so every machine", 1 },
	{ "rates = { frame_hz = 60.0; }", "standby = ( { address = \"backup\"; } )", "standby",
	  "standby[0].address", "\"backup\" is not a numeric IPv4 or IPv6 address", 1 },
	{ "rates = { frame_hz = 60.0; }", "standby = ( { port = 5000; } )", "standby", "standby[0].address",
	  "missing", 1 },
	{ "frame_hz = 60.0", "takeover_frames = 3", "takeover_frames", "rates.takeover_frames",
	  "3 is outside 4 to 100000 frames", 1 },
	/* the rest */
	{ "name = \"room\"", "control_socket = \"control\"", "control_socket", "control_socket",
	  "\"control\" is not absolute", 1 },
	{ "wand = false", "wand = true", "head = false", "trackers[1].wand",
	  "tracker \"t1\" tracks the wand already", 1 },
	{ "head = false; file = \"x.log\"", "head = false", "name = \"t2\"", "trackers[1].file",
	  "missing; a replay needs the log that it replays", 1 },
	{ "wand = false", "wand = false; head = false", "name = \"t1\"", "trackers[0]",
	  "tracks neither head nor wand", 1 },
	{ "wand = false", "wand = false; file = \"y\"", "file = \"y\"", "trackers[0].file",
	  "not used: only kind = \"replay\" reads a log", 0 },
};

/* 1 when the fault is not named as it should be. */
static unsigned check_fault(const struct fault *fault)
{
	char *text = unit_replace(layout_text, fault->find, fault->replace);
	enum gr_severity severity = fault->errors ? GR_DIAG_ERROR : GR_DIAG_WARNING;
	struct gr_diag diag = { 0 };
	struct layout *layout = (struct layout *)&diag;
	char start[256];
	int result = layout_text_parse(text, &layout, &diag);
	unsigned bad = 0;

	snprintf(start, sizeof start, "t.cave:%d: %s: ", unit_line(text, fault->mark), fault->key);
	if (!unit_diag_has(&diag, severity, start, fault->message) || diag.errors != fault->errors ||
	    result != (fault->errors ? GR_ERR_CONFIG : GR_OK) || !layout != !!fault->errors) {
		printf("# wanted %s...%s... and %u errors, result %d\n", start, fault->message,
		       fault->errors, result);
		unit_diag_print(&diag);
		bad = 1;
	}
	layout_destroy(&layout);
	gr_diag_finish(&diag);
	free(text);
	return bad;
}

static void test_faults(void **state)
{
	unsigned bad = 0;

	(void)state;
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
		bad += check_fault(&faults[i]);
	assert_int_equal(bad, 0);
	printf("# %zu kinds of fault, each with its line\n", sizeof faults / sizeof *faults);
}

static void test_base(void **state)
{
	struct gr_diag diag = { 0 };
	struct layout *layout;
	int pixels[2];
	vec3 corner[3];

	(void)state;
	assert_int_equal(layout_text_parse(layout_text, &layout, &diag), GR_OK);
	unit_diag_print(&diag);
	assert_int_equal(diag.count, 0);
	assert_int_equal(layout->wall_count, 2);
	assert_int_equal(layout->node_count, 3);
	assert_int_equal(layout->walls[1].line, 15);
	assert_int_equal(layout->nodes[1].line, 12);
	assert_int_equal(layout_find_node(layout, "n2"), 1);
	assert_int_equal(layout_find_node(layout, "floor"), 2); /* the wall's name */
	assert_int_equal(layout_find_node(layout, "ceiling"), -1);
	layout_node_pixels(layout, 1, pixels);
	assert_int_equal(pixels[0], 300);
	assert_int_equal(pixels[1], 400);
	layout_node_corners(layout, 1, corner[0], corner[1], corner[2]);
	assert_float_equal(corner[0][0], 0, 1e-7);
	assert_float_equal(corner[1][0], 1.5, 1e-7);
	assert_float_equal(corner[2][1], 2, 1e-7);
	/* The floor by its middle: "lower" is nearest to who looks to the front. */
	assert_float_equal(layout->walls[1].lower_left[0], -1.5, 1e-6);
	assert_float_equal(layout->walls[1].lower_left[2], 1.5, 1e-6);
	assert_float_equal(layout->walls[1].upper_left[2], -1.5, 1e-6);
	assert_null(layout_key_path(layout));
	assert_int_equal(layout->rates.barrier_deadline_ns, 50000000);
	assert_int_equal(layout->slow.policy, LAYOUT_SLOW_EVICT);
	assert_int_equal(layout->slow.limit_ns, 0);
	layout_destroy(&layout);
	assert_null(layout);
	layout_destroy(&layout);
	gr_diag_finish(&diag);
}

/* All faults of a file at once; and no end of lines when all is wrong. */
static void test_many(void **state)
{
	struct gr_diag diag = { 0 };
	struct layout *layout;
	char *text = calloc(1, 200000);
	size_t len;

	(void)state;
	assert_int_equal(layout_text_parse("walls = ( { pixels = [0, 0]; eyes = \"x\"; nope = 1; } );\nmtu = 3;\n",
			       &layout, &diag),
			 GR_ERR_CONFIG);
	/* pixels, eyes, nope, mtu; missing name, nodes, center, size */
	assert_int_equal(diag.errors, 8);
	gr_diag_finish(&diag);

	len = (size_t)sprintf(text, "%s", layout_text);
	for (int i = 0; i < 5000; i++)
		len += (size_t)sprintf(text + len, "zz%d = 1;\n", i);
	assert_int_equal(layout_text_parse(text, &layout, &diag), GR_ERR_CONFIG);
	assert_int_equal(diag.count, 65);
	assert_non_null(strstr(diag.items[64].text, "more faults are not shown"));
	gr_diag_finish(&diag);
	free(text);
}

static void test_too_many_nodes(void **state)
{
	char *text = calloc(1, 100000);
	size_t len = (size_t)sprintf(text, "walls = (");
	struct gr_diag diag = { 0 };
	struct layout *layout;

	(void)state;
	/* Two walls of 33 nodes: each list is short enough, the room is not. */
	for (int w = 0; w < 2; w++) {
		len += (size_t)sprintf(text + len,
				       "%s{ name = \"w%d\"; center = [0.0, 1.5, %d.0]; size = [3.0, 3.0];\n"
				       "heading_deg = %d; pixels = [3300, 100]; nodes = (\n",
				       w ? "," : "", w, w ? 2 : -2, w ? 180 : 0);
		for (int n = 0; n < 33; n++)
			len += (size_t)sprintf(text + len,
					       "%s{ name = \"n%d-%d\"; address = \"127.0.0.1\"; port = %d; "
					       "part = [%.9f, 0.0, %.9f, 1.0]; }\n",
					       n ? "," : "", w, n, 2000 + w * 100 + n, n / 33.0,
					       (n + 1) / 33.0);
		len += (size_t)sprintf(text + len, "); }");
	}
	sprintf(text + len, ");\n");
	assert_int_equal(layout_text_parse(text, &layout, &diag), GR_ERR_CONFIG);
	if (diag.errors != 1 || !unit_diag_has(&diag, GR_DIAG_ERROR, "t.cave:", "more than 64 nodes")) {
		unit_diag_print(&diag);
		fail();
	}
	gr_diag_finish(&diag);
	free(text);
}

/* Saved, loaded and saved again: the same text, the same hash. */
static void check_round_trip(const struct layout *layout)
{
	char *first = NULL, *second = NULL;
	size_t size;
	FILE *out = open_memstream(&first, &size);
	struct gr_diag diag = { 0 };
	struct layout *again;

	assert_int_equal(layout_write(out, layout), GR_OK);
	fclose(out);
	if (layout_parse(first, size, layout->path, &again, &diag) != GR_OK || diag.count) {
		unit_diag_print(&diag);
		fail_msg("%s", first);
	}
	assert_memory_equal(again->hash, layout->hash, sizeof again->hash);
	out = open_memstream(&second, &size);
	assert_int_equal(layout_write(out, again), GR_OK);
	fclose(out);
	assert_string_equal(first, second);
	layout_destroy(&again);
	free(first);
	free(second);
}

static const char *const shipped[] = { "cave4", "cave5-stereo", "powerwall", "desk" };
static const size_t shipped_nodes[] = { 4, 10, 4, 1 };

static void test_shipped(void **state)
{
	const char *folder = getenv("srcdir");

	(void)state;
	for (size_t i = 0; i < sizeof shipped / sizeof *shipped; i++) {
		struct gr_diag diag = { 0 };
		struct layout *layout;
		char path[1024];

		snprintf(path, sizeof path, "%s/layouts/%s.cave", folder ? folder : ".", shipped[i]);
		if (layout_load(path, &layout, &diag) != GR_OK) {
			unit_diag_print(&diag);
			fail_msg("%s", path);
		}
		assert_string_equal(layout->name, shipped[i]);
		assert_int_equal(layout->node_count, shipped_nodes[i]);
		layout_report_geometry(layout, &diag);
		assert_int_equal(diag.warnings, 0);
		check_round_trip(layout);
		layout_destroy(&layout);
		gr_diag_finish(&diag);
	}
}

/* Every optional key given, with values that are not the defaults. */
static const char full[] =
	"name = \"full\"; eye_separation_m = 0.0651; control_socket = \"/tmp/a \\\"b\\\\.sock\";\n"
	"walls = ( { name = \"w\"; center = [0.1, 1.3, -2.2]; size = [3.1, 2.3];\n"
	"	heading_deg = 7.3; pitch_deg = -11.7; roll_deg = 3.3; pixels = [1000, 800];\n"
	"	eyes = \"eye-per-node\"; nodes = (\n"
	"	{ name = \"a\"; address = \"2001:db8::1\"; eye = \"left\"; port = 2000; target = \"window\";\n"
	"	  display = \":7.1\"; monitor = 3; gpu = 2; projector = { gain = [1.1, 1.0, 0.9]; dither = true;\n"
	"	  black = [0.01, 0.02, 0.03]; gamma = [2.1, 2.2, 2.3]; depth = \"10\"; }; },\n"
	"	{ name = \"b\"; address = \"2001:db8::2\"; eye = \"right\"; port = 2000;\n"
	"	  target = \"fullscreen\"; part = [0.0, 0.0, 0.3, 1.0]; projector = { table = \"b.csv\"; }; },\n"
	"	{ name = \"c\"; address = \"2001:db8::3\"; eye = \"right\"; part = [0.3, 0.0, 1.0, 1.0]; } ); },\n"
	"	{ name = \"v\"; center = [0.0, 1.3, 2.2]; size = [3.0, 2.0]; heading_deg = 180; pixels = [640, 480];\n"
	"	eyes = \"top-bottom\"; nodes = ( { address = \"2001:db8::4\"; eyes = \"side-by-side\"; } ); } );\n"
	"network = { cast = \"multicast\"; interface = \"eth7\"; group = \"ff15::71\"; group_port = 3001;\n"
	"	master_address = \"2001:db8::9\"; master_port = 3000; ttl = 4; mtu = 8999; key_file = \"k/key\"; };\n"
	"rates = { frame_hz = 119.88; barrier_deadline_ms = 8.123457; evict_frames = 7;\n"
	"	display_latency_ms = 12.3; takeover_frames = 12; };\n"
	"slow = { policy = \"wait\"; limit_ms = 7.5; frames = 33; wait_most_ms = 123.4; rejoin_most_s = 12.5; };\n"
	"standby = ( { address = \"2001:db8::10\"; port = 3005; }, { address = \"2001:db8::11\"; } );\n"
	"start = { head = [0.1, 1.61, 0.2]; head_heading_deg = 13.1; head_pitch_deg = -3.7;\n"
	"	head_roll_deg = 1.9; wand = [0.3, 1.1, -0.2]; wand_heading_deg = -20.2;\n"
	"	wand_pitch_deg = 33.3; wand_roll_deg = 4.4; };\n"
	"room = { min = [-2.0, 0.0, -3.0]; max = [2.0, 2.9, 3.0]; };\n"
	"trackers = ( { name = \"s\"; kind = \"sim\"; wand = false; sim = { rate_hz = 90.5;\n"
	"	noise_position_m = 0.0013; noise_angle_deg = 0.7; latency_ms = 13.37; dropout_per_s = 0.3;\n"
	"	dropout_ms = 250.5; seed = 4294967295L; walk_radius_m = 0.77; walk_speed_m_s = 0.31; }; },\n"
	"	{ name = \"r\"; kind = \"replay\"; head = false; file = \"logs/a.log\"; loop = false; } );\n";

static void test_round_trip(void **state)
{
	struct gr_diag diag = { 0 };
	struct layout *layout;
	char *key;

	(void)state;
	if (layout_text_parse(full, &layout, &diag) != GR_OK || diag.count) {
		unit_diag_print(&diag);
		fail();
	}
	assert_int_equal(layout->nodes[0].eyes, LAYOUT_EYES_LEFT);
	assert_int_equal(layout->nodes[1].eyes, LAYOUT_EYES_RIGHT);
	assert_int_equal(layout->nodes[3].eyes, LAYOUT_EYES_SIDE_BY_SIDE);
	assert_string_equal(layout->nodes[3].name, "v");
	assert_int_equal(layout->trackers[0].sim.seed, 4294967295u);
	assert_int_equal(layout->rates.barrier_deadline_ns, 8123457);
	assert_int_equal(layout->slow.policy, LAYOUT_SLOW_WAIT);
	assert_int_equal(layout->slow.limit_ns, 7500000);
	assert_int_equal(layout->slow.frames, 33);
	assert_int_equal(layout->slow.wait_most_ns, 123400000);
	assert_int_equal(layout->slow.rejoin_most_ns, INT64_C(12500000000));
	assert_int_equal(layout->standby_count, 2);
	assert_string_equal(layout->standby[0].address, "2001:db8::10");
	assert_int_equal(layout->standby[1].port, 27100);
	assert_string_equal(layout->control_socket, "/tmp/a \"b\\.sock");
	assert_true(gr_pose_valid(&layout->start_head));
	key = layout_key_path(layout);
	assert_string_equal(key, "k/key");
	free(key);
	check_round_trip(layout);
	layout_destroy(&layout);
	gr_diag_finish(&diag);
}

/* What the hash covers and what it leaves out, as docs/layout.md says. */
static void test_hash(void **state)
{
	static const struct {
		const char *find, *replace;
		bool differs;
	} cases[] = {
		{ "name = \"full\"", "name = \"other\"", false },
		{ "name = \"full\"", "/* a comment */ name = \"full\"", false },
		{ "eye_separation_m = 0.0651", "eye_separation_m = 0.0652", true },
		{ "[0.1, 1.3, -2.2]", "[0.1, 1.3, -2.21]", true },
		{ "pixels = [1000, 800]", "pixels = [1000, 801]", true },
		{ "address = \"2001:db8::3\"", "address = \"2001:db8::5\"", true },
		{ "port = 2000", "port = 2001", true },
		{ "monitor = 3", "monitor = 4", false },
		{ "gpu = 2", "gpu = 3", false },
		{ "target = \"fullscreen\"", "target = \"headless\"", false },
		{ "interface = \"eth7\"", "interface = \"eth8\"", false },
		{ "key_file = \"k/key\"", "key_file = \"/k\"", false },
		{ "mtu = 8999", "mtu = 8998", true },
		{ "evict_frames = 7", "evict_frames = 8", true },
		{ "policy = \"wait\"", "policy = \"evict\"", false },
		{ "takeover_frames = 12", "takeover_frames = 13", true },
		{ "2001:db8::10", "2001:db8::12", true },
		{ "port = 3005", "port = 3006", true },
		{ "head_roll_deg = 1.9", "head_roll_deg = 2.0", true },
		{ "max = [2.0, 2.9, 3.0]", "max = [2.0, 2.9, 3.1]", true },
		{ "walk_radius_m = 0.77", "walk_radius_m = 0.78", false },
		{ "/tmp/a", "/tmp/b", false },
	};
	struct gr_diag diag = { 0 };
	struct layout *layout, *other;

	(void)state;
	assert_int_equal(layout_text_parse(full, &layout, &diag), GR_OK);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char *text = unit_replace(full, cases[i].find, cases[i].replace);

		assert_int_equal(layout_text_parse(text, &other, &diag), GR_OK);
		if (cases[i].differs != !!memcmp(layout->hash, other->hash, 32))
			fail_msg("\"%s\" for \"%s\"", cases[i].replace, cases[i].find);
		layout_destroy(&other);
		free(text);
	}
	layout_destroy(&layout);
	gr_diag_finish(&diag);
}

static void test_files(void **state)
{
	char name[] = "test_layout_XXXXXX";
	int fd = mkstemp(name);
	FILE *file = fdopen(fd, "w");
	struct gr_diag diag = { 0 };
	struct layout *layout;

	(void)state;
	assert_int_equal(layout_load("does/not/exist.cave", &layout, &diag), GR_ERR_IO);
	assert_true(unit_diag_has(&diag, GR_DIAG_ERROR, "does/not/exist.cave: ", "No such file"));
	assert_null(layout);
	assert_int_equal(layout_load("/", &layout, &diag), GR_ERR_CONFIG);
	assert_true(unit_diag_has(&diag, GR_DIAG_ERROR, "/: ", "is not a regular file"));
	for (int i = 0; i <= 1024 * 1024; i++)
		fputc('\n', file);
	fclose(file);
	assert_int_equal(layout_load(name, &layout, &diag), GR_ERR_CONFIG);
	assert_true(unit_diag_has(&diag, GR_DIAG_ERROR, name, "is longer than 1048576 bytes"));
	remove(name);
	gr_diag_finish(&diag);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_base),	   cmocka_unit_test(test_faults),
		cmocka_unit_test(test_many),	   cmocka_unit_test(test_too_many_nodes),
		cmocka_unit_test(test_shipped),	   cmocka_unit_test(test_round_trip),
		cmocka_unit_test(test_hash),	   cmocka_unit_test(test_files),
	};

	return cmocka_run_group_tests_name("layout", tests, NULL, NULL);
}
