/* A desk without tracking: three devices at once under the real hidapi, as the master has them. */
#include "tests/unit/pads_fixture.h"
#include "tests/unit/unit_config.h"

#include "base/log.h"
#include "daemon/trackers.h"

static const char room[] =
	"name = \"desk\";\n"
	"walls = ( { name = \"front\"; lower_left = [-1.5, 0.0, -1.5]; lower_right = [1.5, 0.0, "
	"-1.5];\n"
	"  upper_left = [-1.5, 2.0, -1.5]; pixels = [600, 400];\n"
	"  nodes = ( { address = \"127.0.0.1\"; port = 5001; } ); } );\n"
	"room = { min = [-2.0, 0.0, -2.5]; max = [2.0, 2.5, 2.5]; };\n"
	"network = { master_address = \"127.0.0.1\"; };\n"
	"start = { wand = [0.25, 1.25, -0.5]; };\n"
	"trackers = (\n"
	"	{ name = \"cap\"; kind = \"spacemouse\"; base = { position = [0.0, 1.5, 1.0]; };\n"
	"	  spacemouse = { speed_m_s = 2.0; reach_m = 0.5; }; filter = { kind = \"none\"; "
	"};\n"
	"	  bind = ( { body = \"head\"; sensor = \"cap\"; } ); },\n"
	"	{ name = \"turn\"; kind = \"dualsense\"; base = { heading_deg = 90.0; };\n"
	"	  bind = ( { body = \"wand\"; position = false; input = false; } ); },\n"
	"	{ name = \"stick\"; kind = \"gamepad\"; pad = { vendor = 0x0079; product = 6; };\n"
	"	  bind = ( { body = \"wand\"; position = false; orientation = false; buttons = \"3 "
	"- 1\"; } ); } );\n";

struct desk {
	struct mock_pad cap, turn, stick;
	struct layout *layout;
	struct gr_diag diag;
	struct trackers trackers;
	struct master_input input;
};

static int begin(void **state)
{
	struct desk *d = calloc(1, sizeof *d);

	if (layout_parse(room, sizeof room - 1, "desk.cave", &d->layout, &d->diag) != GR_OK ||
	    trackers_open(&d->trackers, d->layout, &d->diag) != GR_OK) {
		unit_diag_print(&d->diag);
		return -1;
	}
	plug_spacemouse(&d->cap, 0);
	plug_sony(&d->turn, 1, true, false, 0x0ce6, "");
	plug_joystick(&d->stick, 2, "");
	d->input.wand.T_room_body = d->layout->start_wand;
	*state = d;
	return trackers_start(&d->trackers);
}

static int end(void **state)
{
	struct desk *d = *state;
	struct mock_pad *pads[] = { &d->cap, &d->turn, &d->stick };

	trackers_close(&d->trackers);
	for (int i = 0; i < 3; i++) {
		unplug(pads[i]);
		mock_hid_free(&pads[i]->hid);
	}
	layout_destroy(&d->layout);
	gr_diag_finish(&d->diag);
	free(d);
	return 0;
}

static bool as_wanted(const struct master_input *in)
{
	/* The cap is pushed to the right until it may go no further, and has come to rest there. */
	return in->head.tracked && fabsf(in->head.T_room_body.p[0] - 0.5f) < 5e-7f && in->wand.tracked &&
	       in->buttons == 5;
}

static void head_by_the_cap_wand_by_two_pads(void **state)
{
	const uint8_t right[] = { 1, 0x5e, 1, 0, 0, 0, 0 }, pressed[] = { 1, 0, 0, 0x05 };
	struct desk *d = *state;
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;
	const vec3 ahead = { 0, 0, -1 };
	vec3 points;

	do {
		const int64_t now_ns = gr_clock_now(&gr_clock_monotonic);

		assert_true(now_ns < end_ns);
		mock_hid_push(d->cap.hid, right, sizeof right);
		mock_hid_push(d->stick.hid, pressed, sizeof pressed);
		sony_say(&d->turn);
		poll(NULL, 0, 4);
		trackers_poll(&d->trackers, now_ns, now_ns);
		trackers_sample(&d->trackers, now_ns, &d->input);
	} while (!as_wanted(&d->input));
	assert_vector(d->input.head.T_room_body.p, 0.5, 1.5, 1);
	/* Where it stood, turned as its base is. */
	assert_vector(d->input.wand.T_room_body.p, 0.25, 1.25, -0.5);
	gr_pose_direction(&d->input.wand.T_room_body, ahead, points);
	assert_true(fabsf(points[0] + 1) < 1e-3f);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(head_by_the_cap_wand_by_two_pads, begin, end),
	};
	int failed;

	(void)argc;
	bed = mock_begin(argv);
	gr_log_init("test", GR_LOG_ERROR);
	failed = cmocka_run_group_tests_name("pads_room", tests, NULL, NULL);
	g_object_unref(bed);
	return failed;
}
