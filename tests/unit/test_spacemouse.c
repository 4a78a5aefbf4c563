/* The SpaceMouse's reports, and where its cap takes a body. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "tracking/spacemouse.h"

static const struct track_spacemouse_motion motion = {
	.speed_m_s = 1, .turn_rad_s = 1, .reach_m = 2, .home = 2
};

static int decode(const uint8_t *bytes, size_t len, struct track_spacemouse_report *out)
{
	uint8_t *copy = unit_copy(bytes, len);
	const int r = track_spacemouse_decode(copy, len, out);

	free(copy);
	return r;
}

static void the_three_reports(void **state)
{
	const uint8_t moves[] = { 1, 0x5e, 0x01, 0xa2, 0xfe, 0x01, 0x00 };
	const uint8_t turns[] = { 2, 0x5e, 0x01, 0xa2, 0xfe, 0x01, 0x00 };
	const uint8_t buttons[] = { 3, 0x03, 0x80 };
	struct track_spacemouse_report r;

	(void)state;
	assert_int_equal(decode(moves, sizeof moves, &r), GR_OK);
	assert_true(r.moves && !r.turns && !r.presses);
	assert_int_equal(r.move[0], 350);
	assert_int_equal(r.move[1], -350);
	assert_int_equal(r.move[2], 1);
	assert_int_equal(decode(turns, sizeof turns, &r), GR_OK);
	assert_true(!r.moves && r.turns && !r.presses);
	assert_int_equal(r.turn[0], 350);
	assert_int_equal(r.turn[1], -350);
	assert_int_equal(r.turn[2], 1);
	assert_int_equal(decode(buttons, sizeof buttons, &r), GR_OK);
	assert_true(!r.moves && !r.turns && r.presses);
	assert_int_equal(r.buttons, 0x8003);
}

static void all_six_in_one(void **state)
{
	uint8_t bytes[13] = { 1 };
	struct track_spacemouse_report r;

	(void)state;
	for (int i = 1; i < 13; i++)
		bytes[i] = (uint8_t)i;
	assert_int_equal(decode(bytes, sizeof bytes, &r), GR_OK);
	assert_true(r.moves && r.turns && !r.presses);
	for (int i = 0; i < 3; i++) {
		assert_int_equal(r.move[i], 0x0201 + 0x0202 * i);
		assert_int_equal(r.turn[i], 0x0807 + 0x0202 * i);
	}
}

/* Every length from 0 to one too many, of every report; nothing is written by what is refused. */
static void any_other_length_is_refused(void **state)
{
	struct track_spacemouse_report r, untouched;
	uint8_t bytes[15] = { 0 };

	(void)state;
	memset(&r, 0x5a, sizeof r);
	untouched = r;
	for (unsigned number = 0; number < 256; number++)
		for (size_t len = 0; len < sizeof bytes; len++) {
			const bool right = (number == 1 && (len == 7 || len == 13)) ||
					   (number == 2 && len == 7) ||
					   (number == 3 && len >= 3 && len <= 7);
			int wanted = right || (number == 0x17 && len)	    ? GR_OK
				     : !len || (number >= 1 && number <= 3) ? -TRACK_FAULT_LENGTH
									    : -TRACK_FAULT_FORMAT;

			if (right)
				continue;
			if (number == 0x17 && len) /* about its battery */
				wanted = GR_NOTHING;
			bytes[0] = (uint8_t)number;
			assert_int_equal(decode(bytes, len, &r), wanted);
		}
	assert_memory_equal(&r, &untouched, sizeof r);
}

static void buttons_of_any_length(void **state)
{
	const uint8_t bytes[7] = { 3, 1, 2, 4, 0xff, 0xff, 0xff };
	struct track_spacemouse_report r;

	(void)state;
	assert_int_equal(decode(bytes, 3, &r), GR_OK);
	assert_int_equal(r.buttons, 0x0201);
	assert_int_equal(decode(bytes, 4, &r), GR_OK);
	assert_int_equal(r.buttons, 0x040201);
	for (size_t len = 5; len <= 7; len++) {
		assert_int_equal(decode(bytes, len, &r), GR_OK);
		assert_int_equal(r.buttons, 0x7f040201);
	}
}

/* ---- motion ---- */

/* One second with the cap so, told ten times. */
static void push(struct track_spacemouse_state *s, const int16_t move[3], const int16_t turn[3])
{
	struct track_spacemouse_report r = { .moves = true, .turns = true };

	memcpy(r.move, move, sizeof r.move);
	memcpy(r.turn, turn, sizeof r.turn);
	if (!s->now_ns)
		track_spacemouse_move(s, &motion, GR_NS_PER_S);
	for (int i = 0; i < 10; i++) {
		track_spacemouse_take(s, &motion, &r, s->now_ns);
		track_spacemouse_move(s, &motion, s->now_ns + GR_NS_PER_S / 10);
	}
}

static const int16_t still[3] = { 0, 0, 0 };

static void it_goes_where_it_is_pushed(void **state)
{
	/* right, towards the user, down: right, back, down of the base */
	static const int16_t pushed[3][3] = { { 350, 0, 0 }, { 0, 350, 0 }, { 0, 0, 350 } };
	static const float wanted[3][3] = { { 1, 0, 0 }, { 0, 0, 1 }, { 0, -1, 0 } };
	struct track_report out;

	(void)state;
	for (int i = 0; i < 3; i++) {
		struct track_spacemouse_state s = { 0 };

		push(&s, pushed[i], still);
		track_spacemouse_pose(&s, &out);
		for (int k = 0; k < 3; k++)
			assert_true(fabsf(out.T_base_sensor.p[k] - wanted[i][k]) < 1e-5f);
		assert_true(out.T_base_sensor.q[3] == 1.0f);
		assert_int_equal(out.has, TRACK_POSITION | TRACK_ORIENTATION | TRACK_BUTTONS |
						  TRACK_AXIS_VALUES);
		/* The axes say how it is pushed, in the base's axes. */
		for (int k = 0; k < 3; k++)
			assert_true(out.axes[k] == wanted[i][k]);
	}
}

static void it_turns_as_it_is_turned(void **state)
{
	static const int16_t turned[3][3] = { { 350, 0, 0 }, { 0, 350, 0 }, { 0, 0, 350 } };
	/* about right, about back, about down */
	static const float wanted[3][3] = { { 1, 0, 0 }, { 0, 0, 1 }, { 0, -1, 0 } };
	struct track_report out;

	(void)state;
	for (int i = 0; i < 3; i++) {
		struct track_spacemouse_state s = { 0 };

		push(&s, still, turned[i]);
		track_spacemouse_pose(&s, &out);
		for (int k = 0; k < 3; k++)
			assert_true(fabsf(out.T_base_sensor.q[k] - wanted[i][k] * sinf(0.5f)) <
				    1e-5f);
	}
}

/* Forward is where it heads, and level, however it looks up. */
static void forward_is_ahead_and_level(void **state)
{
	static const int16_t left[3] = { 0, 0, -350 }, up[3] = { 350, 0, 0 },
			     ahead[3] = { 0, -350, 0 };
	struct track_spacemouse_state s = { 0 };
	const vec3 forward = { 0, 0, -1 };
	struct track_report out;
	vec3 points;

	(void)state;
	push(&s, still, left);
	push(&s, still, up);
	push(&s, ahead, still);
	track_spacemouse_pose(&s, &out);
	assert_true(fabsf(out.T_base_sensor.p[0] + sinf(1)) < 1e-5f);
	assert_true(out.T_base_sensor.p[1] == 0);
	assert_true(fabsf(out.T_base_sensor.p[2] + cosf(1)) < 1e-5f);
	gr_pose_direction(&out.T_base_sensor, forward, points);
	assert_true(fabsf(points[1] - sinf(1)) < 1e-5f);
}

static void slowly_near_the_middle_and_no_further_than_it_may(void **state)
{
	static const int16_t little[3] = { 17, 0, 0 }, half[3] = { 175, 0, 0 },
			     over[3] = { 430, 0, 0 };
	struct track_spacemouse_state s = { 0 };

	(void)state;
	push(&s, little, still); /* in the first 5 % */
	assert_true(s.place_m[0] == 0);
	push(&s, half, still);
	assert_true(fabsf(s.place_m[0] - 0.2244f) < 1e-3f); /* (0.45 / 0.95)^2 */
	for (int i = 0; i < 5; i++)
		push(&s, over, over);
	assert_true(s.place_m[0] == 2);
	assert_true(s.pitch_rad == 1.5f);
	assert_true(fabsf(s.heading_rad) <= (float)GLM_PI && fabsf(s.roll_rad) <= (float)GLM_PI);
}

static void a_button_takes_it_home(void **state)
{
	static const int16_t pushed[3] = { 350, 350, 350 };
	const struct track_spacemouse_report other = { .presses = true, .buttons = 1 };
	const struct track_spacemouse_report home = { .presses = true, .buttons = 3 };
	struct track_spacemouse_state s = { 0 };

	(void)state;
	push(&s, pushed, pushed);
	track_spacemouse_take(&s, &motion, &other, s.now_ns);
	assert_true(s.place_m[0] != 0);
	track_spacemouse_take(&s, &motion, &home, s.now_ns);
	assert_true(s.place_m[0] == 0 && s.place_m[1] == 0 && s.place_m[2] == 0 &&
		    s.heading_rad == 0);
	assert_int_equal(s.buttons, 3);
	/* While it is held down it is pressed no more. */
	push(&s, pushed, still);
	track_spacemouse_take(&s, &motion, &home, s.now_ns);
	assert_true(s.place_m[0] != 0);
}

/* The report of the release got lost; a thread was away; the clock stood still. */
static void times_that_are_odd(void **state)
{
	static const int16_t pushed[3] = { 350, 0, 0 };
	struct track_spacemouse_state s = { 0 };

	(void)state;
	push(&s, pushed, still);
	assert_true(track_spacemouse_moves(&s));
	for (int i = 0; i < 20; i++)
		track_spacemouse_move(&s, &motion, s.now_ns + GR_NS_PER_S / 10);
	assert_false(track_spacemouse_moves(&s));
	assert_true(fabsf(s.place_m[0] - 1.4f) < 1e-5f); /* it was told 0.1 s before: 0.4 s more */
	s = (struct track_spacemouse_state){ 0 };
	push(&s, pushed, still);
	track_spacemouse_take(&s, &motion,
			      &(struct track_spacemouse_report){ .moves = true, .move = { 350 } },
			      s.now_ns + 60 * GR_NS_PER_S);
	track_spacemouse_move(&s, &motion, s.now_ns + 60 * GR_NS_PER_S);
	assert_true(fabsf(s.place_m[0] - 1.1f) < 1e-5f);
	track_spacemouse_move(&s, &motion, s.now_ns);
	track_spacemouse_move(&s, &motion, s.now_ns - GR_NS_PER_S);
	assert_true(fabsf(s.place_m[0] - 1.1f) < 1e-5f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_three_reports),
		cmocka_unit_test(all_six_in_one),
		cmocka_unit_test(any_other_length_is_refused),
		cmocka_unit_test(buttons_of_any_length),
		cmocka_unit_test(it_goes_where_it_is_pushed),
		cmocka_unit_test(it_turns_as_it_is_turned),
		cmocka_unit_test(forward_is_ahead_and_level),
		cmocka_unit_test(slowly_near_the_middle_and_no_further_than_it_may),
		cmocka_unit_test(a_button_takes_it_home),
		cmocka_unit_test(times_that_are_odd),
	};

	return cmocka_run_group_tests_name("spacemouse", tests, NULL, NULL);
}
