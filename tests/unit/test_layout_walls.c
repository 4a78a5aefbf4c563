/* Walls by centre and size, what counts as a rectangle, how walls meet. */
#include "base/pose.h"
#include "base/result.h"
#include "config/layout_geometry.h"
#include "tests/unit/layout_text.h"

#include <math.h>

#define DEG 0.017453292519943295

static double distance(const float *a, const float *b)
{
	double sum = 0;

	for (int i = 0; i < 3; i++)
		sum += ((double)a[i] - b[i]) * ((double)a[i] - b[i]);
	return sqrt(sum);
}

/* heading about Y, pitch about X, roll about Z, through quaternions: another way than the loader's. */
static void turned(const double deg[3], struct gr_pose *out)
{
	static const int axis[3] = { 1, 0, 2 };

	*out = GR_POSE_IDENTITY;
	for (int i = 0; i < 3; i++) {
		struct gr_pose turn = GR_POSE_IDENTITY;

		turn.q[axis[i]] = (float)sin(deg[i] * DEG / 2);
		turn.q[3] = (float)cos(deg[i] * DEG / 2);
		gr_pose_mul(out, &turn, out);
	}
}

static const char wall_text[] =
	"walls = ( { name = \"w\"; center = [%.6f, %.6f, %.6f]; size = [%.6f, %.6f];\n"
	"heading_deg = %.6f; pitch_deg = %.6f; roll_deg = %.6f; pixels = [100, 100];\n"
	"nodes = ( { address = \"127.0.0.1\"; } ); } );\n"
	"room = { min = [-20.0, -20.0, -20.0]; max = [20.0, 20.0, 20.0]; };\n"
	"start = { head = [%.6f, %.6f, %.6f]; };\n";

/*
 * Random walls in one sweep: the corners are where turning the front wall
 * puts them, and the eye is taken in front of the wall and refused behind.
 */
static void test_center_sweep(void **state)
{
	struct unit_random r = unit_random_start("walls by centre");
	double worst = 0;

	(void)state;
	for (int n = 0; n < 2000; n++) {
		double c[3], deg[3], size[2], side = n % 2 ? -1 : 1, head[3], away;
		struct gr_diag diag = { 0 };
		struct layout *layout;
		struct gr_pose T;
		vec3 normal, corner;
		char text[1024];
		int result;

		for (int i = 0; i < 3; i++)
			c[i] = unit_random_range(&r, -5, 5);
		deg[0] = unit_random_range(&r, -360, 360);
		deg[1] = unit_random_range(&r, -180, 180);
		deg[2] = unit_random_range(&r, -180, 180);
		size[0] = unit_random_range(&r, 0.02, 10);
		size[1] = unit_random_range(&r, 0.02, 10);
		turned(deg, &T);
		gr_pose_direction(&T, (vec3){ 0, 0, 1 }, normal);
		away = unit_random_range(&r, 0.1, 2);
		for (int i = 0; i < 3; i++)
			head[i] = c[i] + side * normal[i] * away;
		sprintf(text, wall_text, c[0], c[1], c[2], size[0], size[1], deg[0], deg[1], deg[2],
			head[0], head[1], head[2]);
		result = layout_text_parse(text, &layout, &diag);
		if (result != (side > 0 ? GR_OK : GR_ERR_CONFIG)) {
			unit_diag_print(&diag);
			fail_msg("%s", text);
		}
		for (int i = 0; layout && i < 3; i++) {
			static const float signs[3][2] = { { -1, -1 }, { 1, -1 }, { -1, 1 } };
			const struct layout_wall *wall = &layout->walls[0];
			const float *corners[3] = { wall->lower_left, wall->lower_right,
						    wall->upper_left };
			double miss;

			gr_pose_direction(&T,
					  (vec3){ signs[i][0] * (float)size[0] / 2,
						  signs[i][1] * (float)size[1] / 2, 0 },
					  corner);
			for (int k = 0; k < 3; k++)
				corner[k] += (float)c[k];
			miss = distance(corner, corners[i]);
			worst = fmax(worst, miss);
		}
		layout_destroy(&layout);
		gr_diag_finish(&diag);
	}
	printf("# corners by centre against quaternions: worst %.2g m\n", worst);
	/* 3.4e-6 in 20 sweeps: the comparison's own float quaternions on walls of 10 m. */
	assert_true(worst < 5e-6);
}

/* Corners off by less than 0.1 degree pass, by more do not, whatever the wall's place and size. */
static void test_skew_sweep(void **state)
{
	struct unit_random r = unit_random_start("skewed walls");

	(void)state;
	for (int n = 0; n < 2000; n++) {
		double off = unit_random_range(&r, 0.105, 40) * (n & 1 ? 1 : -1);
		double width = unit_random_range(&r, 0.5, 8), height = unit_random_range(&r, 0.5, 8);
		double deg[3] = { unit_random_range(&r, -180, 180), unit_random_range(&r, -80, 80),
				  unit_random_range(&r, -180, 180) };
		struct gr_diag diag = { 0 };
		struct layout *layout;
		struct gr_pose T;
		vec3 p[4];
		char text[1024];
		int result;

		if (n & 2)
			off = unit_random_range(&r, -0.095, 0.095);
		turned(deg, &T);
		gr_pose_direction(&T, (vec3){ (float)-width / 2, (float)-height / 2, 0 }, p[0]);
		gr_pose_direction(&T, (vec3){ (float)width / 2, (float)-height / 2, 0 }, p[1]);
		gr_pose_direction(&T,
				  (vec3){ (float)(-width / 2 + sin(off * DEG) * height),
					  (float)(-height / 2 + cos(off * DEG) * height), 0 },
				  p[2]);
		gr_pose_direction(&T, (vec3){ 0, 0, 2 }, p[3]);
		sprintf(text,
			"walls = ( { name = \"w\"; pixels = [100, 100]; nodes = ( { address = \"127.0.0.1\"; } );\n"
			"lower_left = [%.7f, %.7f, %.7f]; lower_right = [%.7f, %.7f, %.7f];\n"
			"upper_left = [%.7f, %.7f, %.7f]; } );\n"
			"room = { min = [-20.0, -20.0, -20.0]; max = [20.0, 20.0, 20.0]; };\n"
			"start = { head = [%.7f, %.7f, %.7f]; };\n",
			(double)p[0][0], (double)p[0][1], (double)p[0][2], (double)p[1][0],
			(double)p[1][1], (double)p[1][2], (double)p[2][0], (double)p[2][1],
			(double)p[2][2], (double)p[3][0], (double)p[3][1], (double)p[3][2]);
		result = layout_text_parse(text, &layout, &diag);
		if (result != (n & 2 ? GR_OK : GR_ERR_CONFIG) || diag.errors != (n & 2 ? 0 : 1)) {
			unit_diag_print(&diag);
			fail_msg("%.3f degrees off: %s", off, text);
		}
		layout_destroy(&layout);
		gr_diag_finish(&diag);
	}
}

static struct layout_wall front = { .name = "front", .pixels = { 300, 200 },
				    .lower_left = { -1.5f, 0, -1.5f },
				    .lower_right = { 1.5f, 0, -1.5f },
				    .upper_left = { -1.5f, 2, -1.5f } };
static struct layout_wall left = { .name = "left", .pixels = { 300, 200 },
				   .lower_left = { -1.5f, 0, 1.5f },
				   .lower_right = { -1.5f, 0, -1.5f },
				   .upper_left = { -1.5f, 2, 1.5f } };

/* A warning or note of the report about the two walls front and `b`. */
static void check_report(struct layout_wall b, enum gr_severity severity, const char *part)
{
	struct layout_wall walls[2] = { front, b };
	struct layout layout = { .path = (char *)"t.cave", .walls = walls, .wall_count = 2 };
	struct gr_diag diag = { 0 };

	walls[1].line = 9;
	layout_report_geometry(&layout, &diag);
	if (!unit_diag_has(&diag, severity, "t.cave:9: front-", part)) {
		unit_diag_print(&diag);
		fail_msg("no line with \"%s\"", part);
	}
	gr_diag_finish(&diag);
}

static void test_joined(void **state)
{
	struct layout_meeting meeting;

	(void)state;
	assert_true(layout_walls_meet(&front, &left, &meeting));
	assert_int_equal(meeting.edge_a, LAYOUT_EDGE_LEFT);
	assert_int_equal(meeting.edge_b, LAYOUT_EDGE_RIGHT);
	assert_float_equal(meeting.length, 2, 1e-6);
	for (int end = 0; end < 2; end++)
		assert_true(meeting.end[end].distance < 1e-9);
	check_report(left, GR_DIAG_NOTE,
		     "left edge of front meets right edge of left: joined at [-1.500, 0.000, -1.500], "
		     "joined at [-1.500, 2.000, -1.500]");
}

/* The left wall ends 7 mm before the front wall, at its top only: a wall that leans. */
static void test_gap_at_one_end(void **state)
{
	struct layout_wall wall = left;
	struct layout_meeting meeting;
	float turn = 0.0035f; /* 7 mm over 2 m */

	(void)state;
	/* Turned in its own plane about the lower right corner. */
	wall.lower_left[1] = 3 * -turn;
	wall.upper_left[1] = 2 + 3 * -turn;
	wall.upper_left[2] = 1.5f + 2 * turn;
	assert_true(layout_walls_meet(&front, &wall, &meeting));
	assert_float_equal(meeting.end[0].gap, 0, 1e-5);
	assert_float_equal(meeting.end[1].gap, 0.007, 1e-4);
	check_report(wall, GR_DIAG_WARNING,
		     "joined at [-1.500, 0.000, -1.500], gap of 7.0 mm at [-1.500, 2.000, -1.500]");
	/* And at the lower end. */
	wall = left;
	wall.lower_left[1] = 3 * turn;
	wall.upper_left[1] = 2 + 3 * turn;
	wall.lower_left[2] += 2 * turn;
	wall.lower_right[2] += 2 * turn;
	assert_true(layout_walls_meet(&front, &wall, &meeting));
	assert_float_equal(meeting.end[0].gap, 0.007, 1e-4);
	assert_float_equal(meeting.end[1].gap, 0, 1e-4);
}

static void test_overlap_step_shift(void **state)
{
	struct layout_wall wall = left;

	(void)state;
	/* Reaches 12 mm past the front wall's plane. */
	wall.lower_right[2] -= 0.012f;
	check_report(wall, GR_DIAG_WARNING,
		     "overlap of 12.0 mm at [-1.500, 0.000, -1.500], overlap of 12.0 mm at");
	/* Stands 3 mm inside the front wall's edge: that one reaches past it. */
	wall = left;
	wall.lower_left[0] += 0.003f;
	wall.lower_right[0] += 0.003f;
	wall.upper_left[0] += 0.003f;
	check_report(wall, GR_DIAG_NOTE, "overlap of 3.0 mm");
	/* 4 mm outside: a gap that is not worth a warning. */
	wall = left;
	wall.lower_left[0] -= 0.004f;
	wall.lower_right[0] -= 0.004f;
	wall.upper_left[0] -= 0.004f;
	check_report(wall, GR_DIAG_NOTE, "gap of 4.0 mm");
	/* Hangs 20 mm higher than its neighbour. */
	wall = left;
	wall.lower_left[1] += 0.02f;
	wall.lower_right[1] += 0.02f;
	wall.upper_left[1] += 0.02f;
	check_report(wall, GR_DIAG_WARNING, "their ends miss each other by 20.0 mm along the edge");
	/* Beside the front wall in its plane, but 8 mm behind it: a step. */
	wall = front;
	for (int i = 0; i < 3; i++) {
		float *corner = i == 0 ? wall.lower_left : i == 1 ? wall.lower_right : wall.upper_left;

		corner[0] += 3;
		corner[2] -= 0.008f;
	}
	check_report(wall, GR_DIAG_WARNING, "right edge of front meets left edge of front: step of 8.0 mm");
}

static void test_strangers(void **state)
{
	struct layout_meeting meeting;
	struct layout_wall wall = left;

	(void)state;
	/* The right wall has no edge with the left one; nor has one that stands 0.2 m off. */
	for (int i = 0; i < 3; i++)
		wall.lower_left[0] = wall.lower_right[0] = wall.upper_left[0] = 1.5f;
	assert_false(layout_walls_meet(&left, &wall, &meeting));
	wall = left;
	wall.lower_right[2] += 0.2f;
	assert_false(layout_walls_meet(&front, &wall, &meeting));
}

/* Where the room stands and which wall comes first does not change what is measured. */
static void test_frame_sweep(void **state)
{
	struct unit_random r = unit_random_start("walls that meet");
	double worst = 0;

	(void)state;
	for (int n = 0; n < 500; n++) {
		double deg[3] = { unit_random_range(&r, -180, 180), unit_random_range(&r, -80, 80),
				  unit_random_range(&r, -180, 180) };
		double gap = unit_random_range(&r, -0.05, 0.05);
		struct layout_wall a = front, b = left;
		struct layout_meeting meeting, other;
		struct gr_pose T;

		b.lower_right[2] += (float)gap;
		b.lower_left[2] += (float)gap;
		b.upper_left[2] += (float)gap;
		turned(deg, &T);
		for (int i = 0; i < 3; i++)
			T.p[i] = (float)unit_random_range(&r, -3, 3);
		for (int w = 0; w < 2; w++) {
			struct layout_wall *wall = w ? &b : &a;

			gr_pose_point(&T, wall->lower_left, wall->lower_left);
			gr_pose_point(&T, wall->lower_right, wall->lower_right);
			gr_pose_point(&T, wall->upper_left, wall->upper_left);
		}
		assert_true(layout_walls_meet(&a, &b, &meeting));
		assert_true(layout_walls_meet(&b, &a, &other));
		for (int end = 0; end < 2; end++) {
			worst = fmax(worst, fabs(meeting.end[end].gap - gap));
			worst = fmax(worst, fabs(other.end[end].gap - gap));
		}
	}
	printf("# gap in a turned room: worst error %.2g m\n", worst);
	/* 1.0e-6 in 20 sweeps, what float corners of a room of 3 m carry. */
	assert_true(worst < 1.5e-6);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_center_sweep),	   cmocka_unit_test(test_skew_sweep),
		cmocka_unit_test(test_joined),		   cmocka_unit_test(test_gap_at_one_end),
		cmocka_unit_test(test_overlap_step_shift), cmocka_unit_test(test_strangers),
		cmocka_unit_test(test_frame_sweep),
	};

	return cmocka_run_group_tests_name("layout walls", tests, NULL, NULL);
}
