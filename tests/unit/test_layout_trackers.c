/* Devices in a layout: bindings, faults with their lines, written and read again. */
#include "tests/unit/layout_text.h"

#include "base/clock.h"
#include "base/result.h"

/* A replayed head's input, a Hydra and a second one that gives the wand's buttons. */
static const char devices[] =
	"trackers = (\n"
	"	{ name = \"one\"; kind = \"hydra\"; latency_ms = 4.5; serial = \"A1\";\n"
	"	  base = { position = [0.5, 1.0, -0.4]; heading_deg = 90.0; scale = 1.25; };\n"
	"	  bind = ( { body = \"head\"; sensor = \"left\"; offset = [0.0, -0.1, 0.0]; pitch_deg = 30.0; },\n"
	"	    { body = \"wand\"; sensor = \"right\"; input = false; } ); },\n"
	"	{ name = \"two\"; kind = \"hydra\"; number = 1;\n"
	"	  bind = ( { body = \"wand\"; position = false; orientation = false;\n"
	"	    buttons = \"bumper - 1\"; axes = \"stick_x -stick_y\"; } ); }\n"
	");\n";

static struct layout *parse(const char *text, struct gr_diag *diag)
{
	struct layout *layout;
	char *whole = layout_text_with_trackers(layout_text, text);

	layout_text_parse(whole, &layout, diag);
	free(whole);
	return layout;
}

static void what_it_says_is_there(void **state)
{
	struct gr_diag diag = { 0 };
	struct layout *layout = parse(devices, &diag);
	const struct layout_tracker *one, *two;
	const vec3 ahead = { 0, 0, -1 };
	vec3 turned;

	(void)state;
	unit_diag_print(&diag);
	assert_non_null(layout);
	assert_int_equal(diag.count, 0);
	assert_int_equal(layout->tracker_count, 2);
	one = &layout->trackers[0];
	two = &layout->trackers[1];
	assert_true(layout_tracker_is_device(one));
	assert_true(one->head && one->wand && !two->head && two->wand);
	assert_int_equal(one->latency_ns, 4500000);
	assert_string_equal(one->serial, "A1");
	assert_float_equal(one->scale, 1.25, 1e-6);
	assert_float_equal(one->room_base.pose.p[0], 0.5, 1e-6);
	gr_pose_direction(&one->room_base.pose, ahead, turned);
	assert_float_equal(turned[0], -1, 1e-6); /* 90 degrees to the left */
	assert_int_equal(one->binding_count, 2);
	assert_string_equal(one->bindings[0].sensor, "left");
	assert_int_equal(one->bindings[0].body, LAYOUT_HEAD);
	assert_float_equal(one->bindings[0].sensor_body.pose.p[1], -0.1, 1e-6);
	gr_pose_direction(&one->bindings[0].sensor_body.pose, ahead, turned);
	assert_float_equal(turned[1], 0.5, 1e-6); /* 30 degrees up */
	assert_false(one->bindings[1].input);
	assert_int_equal(two->number, 1);
	assert_string_equal(two->bindings[0].buttons, "bumper - 1");
	assert_string_equal(two->bindings[0].axes, "stick_x -stick_y");
	assert_null(one->bindings[0].buttons);
	layout_destroy(&layout);
	gr_diag_finish(&diag);
}

static void written_and_read_again(void **state)
{
	struct gr_diag diag = { 0 };
	struct layout *layout = parse(devices, &diag), *again = NULL;
	char *text = NULL, *second = NULL;
	size_t len = 0;
	FILE *file = open_memstream(&text, &len);

	(void)state;
	assert_int_equal(layout_write(file, layout), GR_OK);
	fclose(file);
	assert_int_equal(layout_text_parse(text, &again, &diag), GR_OK);
	unit_diag_print(&diag);
	assert_int_equal(diag.count, 0); /* nor a warning */
	for (size_t i = 0; i < layout->tracker_count; i++) {
		const struct layout_tracker *a = &layout->trackers[i], *b = &again->trackers[i];

		assert_string_equal(a->name, b->name);
		assert_memory_equal(&a->room_base, &b->room_base, sizeof a->room_base);
		assert_int_equal(a->binding_count, b->binding_count);
		for (size_t k = 0; k < a->binding_count; k++)
			assert_memory_equal(&a->bindings[k].sensor_body, &b->bindings[k].sensor_body,
					    sizeof a->bindings[k].sensor_body);
	}
	assert_string_equal(again->trackers[1].bindings[0].axes, "stick_x -stick_y");
	file = open_memstream(&second, &len);
	assert_int_equal(layout_write(file, again), GR_OK);
	fclose(file);
	assert_string_equal(text, second);
	layout_destroy(&layout);
	layout_destroy(&again);
	gr_diag_finish(&diag);
	free(text);
	free(second);
}

static const struct layout_fault faults[] = {
	{ "sensor = \"right\"; input = false;", "sensor = \"right\";", "position = false",
	  "trackers[1].bind[0].input", "tracker \"one\" gives the wand's input already; say input = false in one",
	  1 },
	{ "position = false; orientation", "orientation", "{ body = \"wand\"; orientation",
	  "trackers[1].bind[0].position",
	  "tracker \"one\" gives the wand's position already; say position = false in one", 1 },
	{ "body = \"wand\"; sensor = \"right\"", "body = \"head\"; sensor = \"right\"",
	  "{ body = \"head\"; sensor = \"right\"", "trackers[0].bind[1].position",
	  "tracker \"one\" gives the head's position already", 1 },
	{ "input = false; } ); }", "input = false; position = false; orientation = false; } ); }",
	  "sensor = \"right\"", "trackers[0].bind[1]",
	  "gives nothing of the wand; leave it out or set position, orientation or input", 1 },
	{ "pitch_deg = 30.0;", "pitch_deg = 30.0;\nbuttons = \"1\";", "buttons = \"1\"",
	  "trackers[0].bind[0].buttons", "a head has none; give them to the wand", 1 },
	{ "body = \"head\"; ", "", "bind = ( { sensor = \"left\"", "trackers[0].bind[0].body",
	  "missing; it is what the sensor is on", 1 },
	{ "\"head\"", "\"heads\"", "\"heads\"", "trackers[0].bind[0].body",
	  "\"heads\" is not known, did you mean \"head\"?", 1 },
	{ "scale = 1.25", "scale = 0.0", "base =", "trackers[0].base.scale",
	  "0 is outside 0.001 to 1000", 1 },
	{ "scale = 1.25", "scael = 1.25", "base =", "trackers[0].base.scael",
	  "unknown key, did you mean \"scale\"?", 1 },
	{ "kind = \"hydra\"; number", "kind = \"hidra\"; number", "hidra", "trackers[1].kind",
	  "did you mean \"hydra\"?", 1 },
	{ "number = 1;", "number = 1; head = false;", "name = \"two\"", "trackers[1].head",
	  "not used: only sim and replay track bodies as a whole", 0 },
	{ "number = 1;", "number = 1; sim = { seed = 2; };", "name = \"two\"", "trackers[1].sim",
	  "not used: only kind = \"sim\" is simulated", 0 },
	{ "name = \"two\"; kind = \"hydra\"; number = 1;\n", "name = \"two\"; kind = \"sim\"; head = false; wand = false;\n",
	  "name = \"two\"", "trackers[1]", "tracks neither head nor wand", 1 },
	{ "\"hydra\"; latency_ms", "\"sim\"; head = false; latency_ms", "latency_ms",
	  "trackers[0].latency_ms", "not used: only a device has it", 1 /* two's input */ },
	{ "	{ name = \"two\"", "	{ name = \"new\"; kind = \"sim\"; wand = false; },\n	{ name = \"two\"",
	  "name = \"new\"", "trackers[1].head", "tracker \"one\" tracks the head already", 1 },
};

static void faults_are_named(void **state)
{
	unsigned bad = 0;

	(void)state;
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
		bad += layout_text_check_fault(&faults[i], layout_text, devices);
	assert_int_equal(bad, 0);
}

static void a_device_needs_bindings(void **state)
{
	struct gr_diag diag = { 0 };

	(void)state;
	assert_null(parse("trackers = ( { name = \"x\"; kind = \"hydra\"; } );\n", &diag));
	assert_int_equal(diag.errors, 1);
	assert_true(unit_diag_has(&diag, GR_DIAG_ERROR, "t.cave:", "missing; say what its sensors are on"));
	gr_diag_finish(&diag);
}

static const char magnetic[] =
	"trackers = ( { name = \"one\"; kind = \"viper\"; serial = \"V1\";\n"
	"	polhemus = { path = \"1-2.4\"; rate_hz = 480; hemisphere = [0.0, -1.0, 0.5];\n"
	"	  follow = true; filter = true; };\n"
	"	bind = ( { body = \"head\"; } ); },\n"
	"	{ name = \"two\"; kind = \"patriot\"; bind = ( { body = \"wand\"; sensor = \"2\"; } ); } );\n";

static void a_polhemus_has_a_group_of_its_own(void **state)
{
	struct gr_diag diag = { 0 };
	struct layout *layout = parse(magnetic, &diag), *again = NULL;
	char *text = NULL;
	size_t len = 0;
	FILE *file = open_memstream(&text, &len);

	(void)state;
	unit_diag_print(&diag);
	assert_non_null(layout);
	assert_int_equal(layout_write(file, layout), GR_OK);
	fclose(file);
	assert_int_equal(layout_text_parse(text, &again, &diag), GR_OK);
	assert_int_equal(diag.count, 0);
	for (int i = 0; i < 2; i++) {
		const struct layout *l = i ? again : layout;
		const struct layout_polhemus *one = &l->trackers[0].polhemus;
		const struct layout_polhemus *two = &l->trackers[1].polhemus;

		assert_string_equal(one->path, "1-2.4");
		assert_int_equal(one->rate_hz, 480);
		assert_vector(one->hemisphere, 0, -1, 0.5);
		assert_true(one->follow && one->filter);
		assert_null(two->path);
		assert_int_equal(two->rate_hz, 240);
		assert_vector(two->hemisphere, 0, 0, 0);
		assert_false(two->follow || two->filter);
	}
	layout_destroy(&layout);
	layout_destroy(&again);
	gr_diag_finish(&diag);
	free(text);
}

static void faults_of_a_polhemus_are_named(void **state)
{
	static const struct {
		const char *find, *replace, *key, *message;
		enum gr_severity severity;
	} wrong[] = {
		{ "480", "100", "trackers[0].polhemus.rate_hz",
		  "a VIPER has no 100 Hz; it has 30, 60, 120, 240, 480 and 960", GR_DIAG_ERROR },
		{ "hemisphere = [0.0, -1.0, 0.5];", "", "trackers[0].polhemus.follow",
		  "from where is not known; say in which half of space the sensors begin",
		  GR_DIAG_ERROR },
		{ "viper", "hydra", "trackers[0].polhemus",
		  "not used: only kind = \"viper\", \"liberty\" and \"patriot\" are Polhemus'",
		  GR_DIAG_WARNING },
	};

	(void)state;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		char *text = unit_replace(magnetic, wrong[i].find, wrong[i].replace);
		struct gr_diag diag = { 0 };
		struct layout *layout = parse(text, &diag);

		unit_diag_print(&diag);
		assert_int_equal(diag.count, 1);
		assert_int_equal(layout == NULL, wrong[i].severity == GR_DIAG_ERROR);
		assert_true(unit_diag_has(&diag, wrong[i].severity, "t.cave:", wrong[i].message));
		assert_true(unit_diag_has(&diag, wrong[i].severity, "t.cave:", wrong[i].key));
		layout_destroy(&layout);
		gr_diag_finish(&diag);
		free(text);
	}
}

static const char pads[] =
	"trackers = ( { name = \"one\"; kind = \"gamepad\"; serial = \"S1\";\n"
	"	pad = { vendor = 0x046d; product = 0xc216; path = \"1-2.4\"; triggers = \"z rz\"; dead_zone = 0.2; };\n"
	"	bind = ( { body = \"wand\"; position = false; orientation = false; } ); },\n"
	"	{ name = \"two\"; kind = \"dualsense\"; pad = { recentre = \"options\"; };\n"
	"	bind = ( { body = \"wand\"; position = false; input = false; } ); },\n"
	"	{ name = \"three\"; kind = \"spacemouse\"; spacemouse = { speed_m_s = 2.0; turn_deg_s = 90.0;\n"
	"	  reach_m = 5.0; home = \"2\"; path = \"1-1\"; }; bind = ( { body = \"head\"; } ); } );\n";

static void pads_have_groups_of_their_own(void **state)
{
	struct gr_diag diag = { 0 };
	struct layout *layout = parse(pads, &diag), *again = NULL;
	char *text = NULL;
	size_t len = 0;
	FILE *file = open_memstream(&text, &len);

	(void)state;
	unit_diag_print(&diag);
	assert_non_null(layout);
	assert_int_equal(layout_write(file, layout), GR_OK);
	fclose(file);
	assert_int_equal(layout_text_parse(text, &again, &diag), GR_OK);
	unit_diag_print(&diag);
	assert_int_equal(diag.count, 0);
	for (int i = 0; i < 2; i++) {
		const struct layout_tracker *t = i ? again->trackers : layout->trackers;

		assert_int_equal(t[0].pad.vendor, 0x046d);
		assert_int_equal(t[0].pad.product, 0xc216);
		assert_string_equal(t[0].pad.path, "1-2.4");
		assert_string_equal(t[0].pad.triggers, "z rz");
		assert_float_equal(t[0].pad.dead_zone, 0.2, 1e-6);
		assert_string_equal(t[0].pad.recentre, "");
		assert_string_equal(t[1].pad.recentre, "options");
		assert_float_equal(t[1].pad.dead_zone, 0.08, 1e-6);
		assert_null(t[1].pad.path);
		assert_float_equal(t[2].spacemouse.speed_m_s, 2, 1e-6);
		assert_float_equal(t[2].spacemouse.turn_rad_s, 1.5707963, 1e-6);
		assert_float_equal(t[2].spacemouse.reach_m, 5, 1e-6);
		assert_string_equal(t[2].spacemouse.home, "2");
		assert_string_equal(t[2].spacemouse.path, "1-1");
	}
	layout_destroy(&layout);
	layout_destroy(&again);
	gr_diag_finish(&diag);
	free(text);
}

static const struct layout_fault pad_faults[] = {
	{ "vendor = 0x046d; ", "", "product", "trackers[0].pad.product",
	  "of which vendor is not said; give vendor, too", 1 },
	{ "0.2; }", "0.2; recentre = \"1\"; }", "recentre", "trackers[0].pad.recentre",
	  "not used: only kind = \"dualshock4\" and \"dualsense\" know how they are turned", 0 },
	{ "recentre = \"options\"", "vendor = 1", "vendor = 1", "trackers[1].pad.vendor",
	  "not used: only kind = \"gamepad\" is chosen by vendor", 0 },
	{ "recentre = \"options\"", "triggers = \"x\"", "triggers = \"x\"", "trackers[1].pad.triggers",
	  "not used: only of kind = \"gamepad\" it is not known", 0 },
	{ "\"gamepad\"; serial = \"S1\";", "\"hydra\"; ", "pad = { vendor", "trackers[0].pad",
	  "not used: only kind = \"gamepad\", \"dualshock4\" and \"dualsense\" are pads", 0 },
	{ "kind = \"spacemouse\"", "kind = \"hydra\"", "name = \"three\"", "trackers[2].spacemouse",
	  "not used: only kind = \"spacemouse\" is one", 0 },
	{ "0.2; }", "1.0; }", "1.0; }", "trackers[0].pad.dead_zone", "1 is outside 0 to 0.9", 1 },
	{ "0xc216", "65536", "65536", "trackers[0].pad.product", "65536 is outside 0 to 65535", 1 },
};

static void faults_of_pads_are_named(void **state)
{
	unsigned bad = 0;

	(void)state;
	for (size_t i = 0; i < sizeof pad_faults / sizeof *pad_faults; i++)
		bad += layout_text_check_fault(&pad_faults[i], layout_text, pads);
	assert_int_equal(bad, 0);
}

/* What is done in windows is a wand beside a tracked head; what its buttons do stands in `hand`. */
static const char hand[] =
	"trackers = ( { name = \"walker\"; kind = \"sim\"; wand = false; },\n"
	"	{ name = \"keys\"; kind = \"window\"; } );\n"
	"hand = { drag = 1; lamps = -1; hue = 2; turn = \"free\"; hud_scale = 0.5; };\n";

static void the_hand_is_bound(void **state)
{
	struct gr_diag diag = { 0 };
	struct layout *layout = parse(hand, &diag), *again = NULL;
	char *text = NULL;
	size_t len = 0;
	FILE *file = open_memstream(&text, &len);

	(void)state;
	unit_diag_print(&diag);
	assert_int_equal(diag.count, 0);
	assert_int_equal(layout->trackers[1].kind, LAYOUT_TRACKER_WINDOW);
	assert_true(!layout->trackers[1].head && layout->trackers[1].wand);
	assert_false(layout_tracker_is_device(&layout->trackers[1]));
	assert_int_equal(layout->hand.next, 3);
	assert_int_equal(layout->hand.fly, 0);
	assert_int_equal(layout->hand.drag, 1);
	assert_int_equal(layout->hand.lamps, -1);
	assert_int_equal(layout->hand.hue, 2);
	assert_int_equal(layout->hand.turn, LAYOUT_TURN_FREE);
	assert_true(layout->hand.hud);
	assert_int_equal(layout_write(file, layout), GR_OK);
	fclose(file);
	assert_int_equal(layout_text_parse(text, &again, &diag), GR_OK);
	unit_diag_print(&diag);
	assert_int_equal(diag.count, 0);
	assert_memory_equal(&again->hand, &layout->hand, sizeof again->hand);
	/* The master alone reads it: walls need not agree. */
	again->hand.next = 7;
	layout_items(again, NULL, 0, again->hash);
	assert_memory_equal(again->hash, layout->hash, sizeof again->hash);
	layout_destroy(&layout);
	layout_destroy(&again);
	gr_diag_finish(&diag);
	free(text);
}

static const struct layout_fault hand_faults[] = {
	{ "drag = 1;", "drag = 0;", "drag = 0", "hand.drag",
	  "button 0 is fly already in navigation; give it another, or -1 for none", 1 },
	{ "drag = 1;", "drag = 1; next = 0;", "next = 0", "hand.fly", "button 0 is next already in navigation", 3 },
	{ "hue = 2", "hue = 0", "hue = 0", "hand.hue", "axis 0 is saturation already in lighting", 1 },
	{ "drag = 1;", "drag = 32;", "drag = 32", "hand.drag", "32 is outside -1 to 31", 1 },
	{ "hud_scale = 0.5", "hud_scale = 0.0", "hud_scale", "hand.hud_scale", "0 is outside 0.1 to 10", 1 },
	{ "turn = \"free\"", "turn = \"fre\"", "turn", "hand.turn", "did you mean \"free\"?", 1 },
	{ "drag = 1;", "drga = 1;", "drga", "hand.drga", "did you mean \"drag\"?", 1 },
	{ "kind = \"sim\"; wand = false;", "kind = \"sim\";", "keys", "trackers[1].wand",
	  "tracker \"walker\" tracks the wand already", 1 },
	{ "kind = \"window\";", "kind = \"window\"; wand = false;", "keys", "trackers[1]",
	  "tracks neither head nor wand", 1 },
};

static void faults_of_the_hand_are_named(void **state)
{
	unsigned bad = 0;

	(void)state;
	for (size_t i = 0; i < sizeof hand_faults / sizeof *hand_faults; i++)
		bad += layout_text_check_fault(&hand_faults[i], layout_text, hand);
	assert_int_equal(bad, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_it_says_is_there),
		cmocka_unit_test(written_and_read_again),
		cmocka_unit_test(faults_are_named),
		cmocka_unit_test(the_hand_is_bound),
		cmocka_unit_test(faults_of_the_hand_are_named),
		cmocka_unit_test(a_device_needs_bindings),
		cmocka_unit_test(a_polhemus_has_a_group_of_its_own),
		cmocka_unit_test(faults_of_a_polhemus_are_named),
		cmocka_unit_test(pads_have_groups_of_their_own),
		cmocka_unit_test(faults_of_pads_are_named),
	};

	return cmocka_run_group_tests_name("layout_trackers", tests, NULL, NULL);
}
