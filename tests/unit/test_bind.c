/* From reports of sensors to samples of head and wand. */
#include "tests/unit/unit.h"

#include "base/result.h"
#include "tracking/bind.h"

static const char *const buttons[] = { "bumper", "1", "2", "start", NULL };
static const char *const axes[] = { "x", "y", "trigger", NULL };
static const struct track_names names = { buttons, axes };
static const struct track_place place = { "t.cave", "buttons", 7 };

static struct track_binding binding_of(enum track_body body, unsigned parts)
{
	struct gr_diag diag = { 0 };
	struct track_binding b = {
		.body = body,
		.parts = parts,
		.scale = 1,
		.T_room_base = GR_POSE_IDENTITY,
		.T_sensor_body = GR_POSE_IDENTITY,
	};

	assert_int_equal(track_bind_buttons(&b, &names, NULL, &place, &diag), GR_OK);
	assert_int_equal(track_bind_axes(&b, &names, NULL, &place, &diag), GR_OK);
	return b;
}

static struct track_report report_of(float x, float y, float z, unsigned has)
{
	return (struct track_report){
		.time_ns = 5000,
		.device_ns = 77,
		.has = has,
		.T_base_sensor = { { x, y, z }, { 0, 0, 0, 1 } },
	};
}

static void about_y(versor q, double degrees)
{
	q[0] = q[2] = 0;
	q[1] = (float)sin(degrees * M_PI / 360);
	q[3] = (float)cos(degrees * M_PI / 360);
}

static void assert_point(const vec3 p, double x, double y, double z)
{
	assert_float_equal(p[0], x, 1e-6);
	assert_float_equal(p[1], y, 1e-6);
	assert_float_equal(p[2], z, 1e-6);
}

#define POSE (TRACK_POSITION | TRACK_ORIENTATION)
#define ALL (TRACK_PART_POSITION | TRACK_PART_ORIENTATION | TRACK_PART_INPUT)
static const struct gr_pose start = { { 9, 9, 9 }, { 0, 0, 0, 1 } };

/*
 * By hand: the sensor is at (1, 0, 0) m of a base that lies at (0, 1, 0) and is
 * turned 90 degrees to the left, whose metre is two; it is turned 90 degrees to
 * the left itself, and the tip is 0.1 m before it.
 */
static void base_scale_and_lever_arm(void **state)
{
	struct track_binding b = binding_of(TRACK_WAND, ALL);
	struct track_report r = report_of(1, 0, 0, POSE);
	struct track_assembly a;
	struct track_sample s;

	(void)state;
	track_assembly_init(&a, &start, b.parts);
	b.T_room_base.p[1] = 1;
	about_y(b.T_room_base.q, 90);
	b.scale = 2;
	b.latency_ns = 1000;
	b.T_sensor_body.p[2] = -0.1f; /* the arm is measured in true metres */
	about_y(r.T_base_sensor.q, 90);
	assert_true(track_bind(&b, &a, &r, &s));
	/* (2, 0, 0) turned left is (0, 0, -2); the sensor looks back: the tip is at +z of it. */
	assert_point(s.T_room_body.p, 0, 1, -1.9);
	assert_float_equal(fabsf(s.T_room_body.q[1]), 1, 1e-6);
	assert_int_equal(s.time_ns, 4000);
	assert_true(s.valid);
	assert_false(s.device_timed);
	assert_int_equal(s.body, TRACK_WAND);
}

static void lost_is_said_and_buttons_go_on(void **state)
{
	struct track_binding b = binding_of(TRACK_WAND, ALL);
	struct track_report r = report_of(1, 2, 3, POSE | TRACK_BUTTONS | TRACK_DEVICE_TIME);
	struct track_assembly a;
	struct track_sample s;

	(void)state;
	track_assembly_init(&a, &start, b.parts);
	r.buttons = 5;
	assert_true(track_bind(&b, &a, &r, &s));
	assert_int_equal(s.buttons, 5);
	assert_true(s.device_timed && s.device_ns == 77);
	r.has = TRACK_LOST | TRACK_BUTTONS;
	r.buttons = 2;
	assert_true(track_bind(&b, &a, &r, &s));
	assert_false(s.valid);
	assert_int_equal(s.buttons, 2);
	assert_point(s.T_room_body.p, 1, 2, 3);
	/* Buttons alone are no sample of a body that has a position: they come with the next. */
	r.has = TRACK_BUTTONS;
	r.buttons = 8;
	assert_false(track_bind(&b, &a, &r, &s));
	r.has = POSE;
	assert_true(track_bind(&b, &a, &r, &s));
	assert_int_equal(s.buttons, 8);
}

/* Place from one device, direction and buttons from another. */
static void parts_of_two_devices(void **state)
{
	struct track_binding where = binding_of(TRACK_WAND, TRACK_PART_POSITION);
	struct track_binding how =
		binding_of(TRACK_WAND, TRACK_PART_ORIENTATION | TRACK_PART_INPUT);
	struct track_report r = report_of(1, 1, 1, POSE);
	struct track_assembly a;
	struct track_sample s;

	(void)state;
	track_assembly_init(&a, &start, where.parts | how.parts);
	where.T_sensor_body.p[2] = -0.2f;
	/* The one that does not lead makes no sample; its own place is not looked at. */
	r.T_base_sensor.p[0] = 55;
	r.has = POSE | TRACK_BUTTONS;
	r.buttons = 1;
	about_y(r.T_base_sensor.q, 90);
	assert_false(track_bind(&how, &a, &r, &s));
	r = report_of(1, 1, 1, TRACK_POSITION);
	assert_true(track_bind(&where, &a, &r, &s));
	/* The lever arm turns with what the other said. */
	assert_point(s.T_room_body.p, 0.8, 1, 1);
	assert_float_equal(s.T_room_body.q[1], sqrt(0.5), 1e-6);
	assert_int_equal(s.buttons, 1);
	/* Orientation that is lost says nothing of the place. */
	r = report_of(0, 0, 0, TRACK_LOST);
	assert_false(track_bind(&how, &a, &r, &s));
}

static void a_gamepad_alone_stands_at_the_start(void **state)
{
	struct track_binding b = binding_of(TRACK_WAND, ALL & ~TRACK_PART_POSITION);
	struct track_binding input = binding_of(TRACK_WAND, TRACK_PART_INPUT);
	struct track_report r = report_of(0, 0, 0, TRACK_ORIENTATION | TRACK_BUTTONS);
	struct track_assembly a;
	struct track_sample s;

	(void)state;
	track_assembly_init(&a, &start, b.parts);
	about_y(r.T_base_sensor.q, 90);
	assert_true(track_bind(&b, &a, &r, &s));
	assert_point(s.T_room_body.p, 9, 9, 9);
	assert_float_equal(s.T_room_body.q[1], sqrt(0.5), 1e-6);
	/* One without a pose at all. */
	track_assembly_init(&a, &start, input.parts);
	r = report_of(0, 0, 0, TRACK_BUTTONS);
	r.buttons = 2;
	assert_true(track_bind(&input, &a, &r, &s));
	assert_int_equal(s.buttons, 2);
	assert_point(s.T_room_body.p, 9, 9, 9);
}

static void names_of_buttons_and_axes(void **state)
{
	struct track_binding b = binding_of(TRACK_WAND, ALL);
	struct track_report r =
		report_of(0, 0, 0, TRACK_POSITION | TRACK_BUTTONS | TRACK_AXIS_VALUES);
	struct gr_diag diag = { 0 };
	struct track_assembly a;
	struct track_sample s;
	/* trigger, pressed? Half-way down it stays as it is. */
	static const struct {
		float trigger;
		bool pressed;
	} pull[] = {
		{ 0.3f, false }, { 0.45f, false }, { 0.51f, true },
		{ 0.45f, true }, { 0.39f, false }, { 0.45f, false },
	};

	(void)state;
	track_assembly_init(&a, &start, b.parts);
	assert_int_equal(track_bind_buttons(&b, &names, " start - trigger  -y bumper", &place,
					    &diag),
			 GR_OK);
	assert_int_equal(b.button_count, 5);
	assert_int_equal(track_bind_axes(&b, &names, "-y - x", &place, &diag), GR_OK);
	assert_int_equal(b.axis_count, 3);
	r.buttons = 1 | 8; /* bumper, start */
	r.axis_count = 3;
	r.axes[0] = 0.25f;
	r.axes[1] = -0.75f;
	for (size_t i = 0; i < sizeof pull / sizeof *pull; i++) {
		r.axes[2] = pull[i].trigger;
		assert_true(track_bind(&b, &a, &r, &s));
		assert_int_equal(s.buttons, 1u | (pull[i].pressed ? 4u : 0) | 8u | 16u);
	}
	assert_int_equal(s.axis_count, 3);
	assert_true(s.axes[0] == 0.75f && s.axes[1] == 0 && s.axes[2] == 0.25f);
	assert_int_equal(diag.count, 0);
}

static void words_that_are_none(void **state)
{
	static const char *const wrong[] = {
		"x", "buttom", "-start", "--", "trigger-", "bumper,1"
	};
	struct track_binding b = binding_of(TRACK_WAND, ALL);
	struct gr_diag diag = { 0 };
	char many[TRACK_BUTTONS_MAX * 2 + 3] = "";

	(void)state;
	for (size_t i = 1; i < sizeof wrong / sizeof *wrong; i++) {
		assert_int_equal(track_bind_buttons(&b, &names, wrong[i], &place, &diag),
				 GR_ERR_CONFIG);
		assert_int_equal(diag.count, i);
	}
	assert_string_equal(diag.items[0].text,
			    "t.cave:7: buttons: \"buttom\" is nothing that this device has; it has "
			    "bumper, 1, 2, start, x, y, trigger, and - for none");
	assert_int_equal(track_bind_axes(&b, &names, "bumper", &place, &diag), GR_ERR_CONFIG);
	for (int i = 0; i <= TRACK_BUTTONS_MAX; i++)
		strcat(many, "- ");
	assert_int_equal(track_bind_buttons(&b, &names, many, &place, &diag), GR_ERR_CONFIG);
	gr_diag_finish(&diag);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(base_scale_and_lever_arm),
		cmocka_unit_test(lost_is_said_and_buttons_go_on),
		cmocka_unit_test(parts_of_two_devices),
		cmocka_unit_test(a_gamepad_alone_stands_at_the_start),
		cmocka_unit_test(names_of_buttons_and_axes),
		cmocka_unit_test(words_that_are_none),
	};

	return cmocka_run_group_tests_name("bind", tests, NULL, NULL);
}
