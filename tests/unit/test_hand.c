/* In the hand: the ring of layouts, the law of speed, turning, the torch, settings; at any frame rate. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/hand.h"
#include "daemon/hand_color.h"

#include <math.h>

#define BIT(button) (1u << (button))

/* As the layout's defaults. */
static const struct layout_hand bindings = {
	.next = 3, .fly = 0, .drag = 4, .reset = 2, .lamps = 1, .torch = 0, .dimmer = 1,
	.brighter = 2, .quality = 0, .fewer = 1, .more = 2, .saturation = 0, .hue = 1,
	.absorption = 0, .scattering = 1, .hud = true, .hud_scale = 1,
};

struct fixture {
	struct scene_file scene;
	struct scene_lamp lamps[3];
	struct layout_hand bindings;
	struct hand hand;
	struct master_settings settings;
	struct gr_pose room;
	struct master_input input;
};

static int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);
	const vec3 head = { 0, 1.7f, 0.5f }, wand = { 0.3f, 1.2f, 0.1f }, place = { 10, 0, -5 };

	if (!f)
		return -1;
	f->scene.lamps = f->lamps;
	f->scene.lamp_count = 3;
	f->lamps[0] = (struct scene_lamp){ .kind = SCENE_LAMP_DIRECTIONAL, .on = true };
	f->lamps[1] = (struct scene_lamp){ .kind = SCENE_LAMP_SPOT, .on = true };
	f->lamps[2] = (struct scene_lamp){ .kind = SCENE_LAMP_SPOT, .mount = SCENE_MOUNT_WAND };
	for (int i = 0; i < 3; i++) {
		f->lamps[i].direction[2] = -1;
		f->lamps[i].intensity[0] = f->lamps[i].intensity[1] = f->lamps[i].intensity[2] = 40;
	}
	f->lamps[2].position[1] = 0.05f;
	f->scene.gi = (struct scene_gi){ .method = SCENE_GI_LPV, .steps = 8, .gathers = 2 };
	f->scene.tone = (struct scene_tone){ .exposure = 1, .gamma_display = 2.2f, .gamma_end_to_end = 1.1f,
					     .adaptation = 100, .luminance_max = 1e4f, .bias = 0.85f };
	gr_pose_heading(place, (float)M_PI / 2, &f->scene.room);
	f->bindings = bindings;
	hand_init(&f->hand, &f->bindings, &f->scene);
	master_settings_init(&f->settings, &f->scene, 0.06f);
	f->room = f->scene.room;
	gr_pose_heading(head, 0, &f->input.head.T_room_body);
	gr_pose_heading(wand, 0, &f->input.wand.T_room_body);
	f->input.head.tracked = f->input.wand.tracked = true;
	f->input.step_ns = 10 * GR_NS_PER_MS;
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	free(*state);
	return 0;
}

static void step(struct fixture *f, uint32_t buttons)
{
	f->input.buttons = buttons;
	assert_int_equal(hand_step(&f->hand, &f->input, &f->settings, &f->room), GR_OK);
}

static void press(struct fixture *f, int button)
{
	step(f, BIT(button));
	step(f, 0);
}

static void hold(struct fixture *f, uint32_t buttons, double seconds, int hz)
{
	f->input.step_ns = GR_NS_PER_S / hz;
	for (int i = 0; i < (int)lrint(seconds * hz); i++)
		step(f, buttons);
}

/* v = d^2.5 0.4^-2.5 1.4 m/s (seed 004, "User Interaction"), and no faster than at a metre. */
static void speed_is_the_thesis(void **state)
{
	struct fixture *f = *state;
	double worst = 0;

	for (int i = 0; i <= 1000; i++) {
		const double d = i * 1e-3, law = pow(d, 2.5) * pow(0.4, -2.5) * 1.4;

		worst = fmax(worst, fabs((double)hand_fly_speed((float)d) - law));
	}
	printf("# largest difference to the law: %.2g m/s\n", worst);
	assert_true(worst < 4e-6);
	assert_float_equal(hand_fly_speed(0.4f), 1.4f, 1e-6f);
	assert_float_equal(hand_fly_speed(7), hand_fly_speed(1), 0);
	assert_float_equal(hand_fly_speed(-1), 0, 0);
	/* The distance is that on the floor plan: how high the hand is does not count. */
	for (int i = 0; i < 3; i++) {
		f->room = f->scene.room;
		f->input.wand.T_room_body.p[1] = 0.4f + 0.6f * (float)i;
		step(f, BIT(0));
		hold(f, BIT(0), 1, 100);
		step(f, 0);
		assert_float_equal(f->room.p[0], 10 - hand_fly_speed(0.5f), 2e-5f);
		assert_float_equal(f->room.p[1], 0, 1e-6f);
		assert_float_equal(f->room.p[2], -5, 2e-5f);
	}
}

/* A hand that sweeps, turns and reaches out while it flies, drags and pushes, at `hz`. */
static void play(struct fixture *f, int hz, struct gr_pose *room, struct hand *hand,
		 struct master_settings *settings)
{
	const int64_t step_ns = GR_NS_PER_S / hz;

	hand_init(&f->hand, &f->bindings, &f->scene);
	master_settings_init(&f->settings, &f->scene, 0.06f);
	f->room = f->scene.room;
	for (int n = 0; n <= 6 * hz; n++) {
		const double t = (double)n / hz;
		const vec3 at = { (float)(0.3 * sin(2 * t)), 1.2f, (float)(0.1 - 0.3 * sin(1.3 * t)) };
		uint32_t buttons = 0;

		gr_pose_heading(at, (float)(0.8 * sin(1.7 * t)), &f->input.wand.T_room_body);
		/* Changes of what is held fall on frames of both rates. */
		if (n >= hz / 4 && n <= 2 * hz)
			buttons |= BIT(0);
		if (n >= hz / 2 && n <= 3 * hz / 2)
			buttons |= BIT(4);
		if (n > 3 * hz && n <= 3 * hz + hz / 10)
			buttons |= BIT(3);
		if (n > 4 * hz && n <= 5 * hz)
			buttons |= BIT(2);
		f->input.axes[0] = n > 7 * hz / 2 && n <= 9 * hz / 2 ? 0.7f : 0;
		f->input.axes[1] = n > 7 * hz / 2 && n <= 5 * hz ? -0.9f : 0;
		f->input.step_ns = n ? step_ns : 0;
		step(f, buttons);
	}
	*room = f->room;
	*hand = f->hand;
	*settings = f->settings;
}

static void frame_rate_does_not_matter(void **state)
{
	static const int rates[] = { 60, 120, 240, 1000 };
	struct fixture *f = *state;
	struct gr_pose rooms[4];
	struct hand hands[4];
	struct master_settings settings[4];

	for (int i = 0; i < 4; i++) {
		play(f, rates[i], &rooms[i], &hands[i], &settings[i]);
		assert_int_equal(hands[i].mode, HAND_LIGHTING);
	}
	for (int i = 0; i < 3; i++) {
		const double off = hypot(hypot(rooms[i].p[0] - rooms[3].p[0], rooms[i].p[1] - rooms[3].p[1]),
					 rooms[i].p[2] - rooms[3].p[2]);
		const double turn = 2 * acos(fmin(1, fabs((double)glm_quat_dot(rooms[i].q, rooms[3].q))));
		double color = 0;

		for (int k = 6; k < 9; k++)
			color = fmax(color, fabs((double)settings[i].lamp_intensity[k] /
							 (double)settings[3].lamp_intensity[k] - 1));
		printf("# %d Hz against 1000 Hz: room %.3f mm, %.4f degrees; torch %.2g; flown %.2f m\n",
		       rates[i], off * 1e3, turn * 180 / M_PI, color,
		       (double)glm_vec3_distance(rooms[i].p, f->scene.room.p));
		assert_true(off < 0.5e-3 * 60 / rates[i]);
		assert_true(turn < 1e-3);
		assert_true(color < 2e-4);
	}
}

static void seen(const struct gr_pose *room, const vec3 scene, vec3 out)
{
	struct gr_pose T_room_scene;

	gr_pose_inverse(room, &T_room_scene);
	gr_pose_point(&T_room_scene, scene, out);
}

/* What the visitor sees turns with the hand, about the head; the floor stays level unless it may tilt. */
static void drag_turns_the_scene(void **state)
{
	struct fixture *f = *state;
	const vec3 at = { 0.3f, 1.2f, 0.1f }, rock = { 7, 1, -9 };
	vec3 axis = { 0.6f, 0.8f, 0 }, before, after, head_before, head_after, up = { 0, 1, 0 }, turned;
	versor turn;

	seen(&f->room, rock, before);
	gr_pose_point(&f->room, f->input.head.T_room_body.p, head_before);
	step(f, BIT(4));
	gr_pose_heading(at, 0.5f, &f->input.wand.T_room_body);
	step(f, BIT(4));
	seen(&f->room, rock, after);
	gr_pose_point(&f->room, f->input.head.T_room_body.p, head_after);
	assert_true(glm_vec3_distance(head_before, head_after) < 2e-5f);
	/* By half a radian counter-clockwise seen from above, as the hand. */
	glm_vec3_sub(before, f->input.head.T_room_body.p, before);
	glm_vec3_sub(after, f->input.head.T_room_body.p, after);
	glm_vec3_rotate(before, 0.5f, up);
	assert_true(glm_vec3_distance(before, after) < 1e-4f);
	/* Back with the hand, and exactly where it was: nothing adds up. */
	for (int i = 0; i < 1000; i++) {
		gr_pose_heading(at, 0.001f * (float)(i % 700), &f->input.wand.T_room_body);
		step(f, BIT(4));
	}
	gr_pose_heading(at, 0, &f->input.wand.T_room_body);
	step(f, BIT(4));
	assert_true(glm_vec3_distance(f->room.p, f->scene.room.p) < 5e-4f);
	assert_true(fabsf(glm_quat_dot(f->room.q, f->scene.room.q)) > 1 - 1e-6f);
	step(f, 0);

	/* A hand that tilts turns no floor, and with turn = "free" it does. */
	for (int free = 0; free < 2; free++) {
		f->bindings.turn = free ? LAYOUT_TURN_FREE : LAYOUT_TURN_LEVEL;
		f->room = f->scene.room;
		gr_pose_heading(at, 0, &f->input.wand.T_room_body);
		step(f, BIT(4));
		glm_quatv(turn, 0.7f, axis);
		glm_quat_copy(turn, f->input.wand.T_room_body.q);
		step(f, BIT(4));
		gr_pose_direction(&f->room, up, turned);
		assert_true(free ? turned[1] < 0.95f : turned[1] > 1 - 1e-6f);
		step(f, 0);
	}
}

static void reset_and_the_ring(void **state)
{
	struct fixture *f = *state;

	hold(f, BIT(0), 1, 60);
	assert_true(glm_vec3_distance(f->room.p, f->scene.room.p) > 1);
	step(f, BIT(2));
	assert_memory_equal(&f->room, &f->scene.room, sizeof f->room);
	step(f, 0);
	for (int i = 1; i <= 7; i++) {
		press(f, 3);
		assert_int_equal(f->hand.mode, i % HAND_MODES);
	}
	/* Held it goes on but once. */
	hold(f, BIT(3), 1, 60);
	assert_int_equal(f->hand.mode, HAND_SETTINGS);
	step(f, 0);
	/* What was pressed for one layout is none of the next's, until it is let go. */
	press(f, 3);
	assert_int_equal(f->hand.mode, HAND_NAVIGATION);
	step(f, BIT(0));
	step(f, BIT(0) | BIT(3));
	hold(f, BIT(0), 0.1, 60);
	assert_int_equal(f->hand.mode, HAND_LIGHTING);
	assert_false(f->hand.put_down);
	step(f, 0);
	step(f, BIT(0));
	assert_true(f->hand.put_down);
	/* A button that is bound to nothing, and a wand that has none. */
	f->bindings.next = -1;
	step(f, 0);
	step(f, UINT32_MAX & ~7u);
	assert_int_equal(f->hand.mode, HAND_LIGHTING);
}

static void torch_goes_with_the_hand(void **state)
{
	struct fixture *f = *state;
	struct gr_pose T_scene_wand;
	vec3 tip, ahead = { 0, 0, -1 }, direction, left;

	assert_int_equal(f->hand.torch, 2); /* a spot in the hand before one on the wall */
	press(f, 3);
	assert_false(f->settings.lamp_on >> 2 & 1);
	step(f, BIT(0));
	assert_true(f->settings.lamp_on >> 2 & 1); /* who takes it wants its light */
	gr_pose_mul(&f->room, &f->input.wand.T_room_body, &T_scene_wand);
	gr_pose_point(&T_scene_wand, f->lamps[2].position, tip);
	gr_pose_direction(&T_scene_wand, ahead, direction);
	assert_true(glm_vec3_distance(tip, f->hand.position) < 1e-6f);
	assert_true(glm_vec3_distance(direction, f->hand.direction) < 1e-6f);
	f->input.wand.T_room_body.p[0] += 0.5f;
	step(f, BIT(0));
	assert_true(glm_vec3_distance(tip, f->hand.position) > 0.4f);
	step(f, 0);
	memcpy(left, f->hand.position, sizeof left);
	f->input.wand.T_room_body.p[0] -= 1;
	step(f, 0);
	assert_memory_equal(left, f->hand.position, sizeof left); /* it stays there */
	/* Switched off and on again it is the wand's own once more. */
	press(f, 3);
	press(f, 3);
	assert_int_equal(f->hand.mode, HAND_NAVIGATION);
	press(f, 1);
	assert_true(f->hand.put_down && !(f->settings.lamp_on >> 2 & 1));
	press(f, 1);
	assert_true(!f->hand.put_down && f->settings.lamp_on >> 2 & 1);
	/* Without one in the hand it is the spot on the wall, and its light goes along the wand. */
	f->scene.lamp_count = 2;
	hand_init(&f->hand, &f->bindings, &f->scene);
	assert_int_equal(f->hand.torch, 1);
	press(f, 3);
	step(f, BIT(0));
	gr_pose_point(&f->room, f->input.wand.T_room_body.p, tip);
	assert_true(glm_vec3_distance(tip, f->hand.position) < 1e-5f);
	/* The sun is no torch. */
	f->scene.lamp_count = 1;
	hand_init(&f->hand, &f->bindings, &f->scene);
	assert_int_equal(f->hand.torch, -1);
	press(f, 3);
	hold(f, BIT(0) | BIT(2), 1, 60);
	assert_false(f->hand.put_down);
}

static void colours_go_round(void **state)
{
	struct unit_random random = unit_random_start("hand colour");
	static const float wheel[6][3] = { { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 },
					   { 0, 1, 1 }, { 0, 0, 1 }, { 1, 0, 1 } };
	double worst = 0;

	(void)state;
	for (int i = 0; i < 6; i++) {
		struct hand_color c = { (float)i / 6, 1, 1 };
		float rgb[3];

		hand_color_rgb(&c, rgb);
		for (int k = 0; k < 3; k++)
			assert_float_equal(rgb[k], wheel[i][k], 1e-6f);
	}
	for (int i = 0; i < 200000; i++) {
		const double scale = pow(10, unit_random_range(&random, -6, 8));
		float rgb[3], back[3];
		struct hand_color c;

		for (int k = 0; k < 3; k++)
			rgb[k] = unit_random_u32(&random) % 8 ? (float)(scale * unit_random_range(&random, 0, 1)) : 0;
		hand_color_of(rgb, 0.25f, &c);
		assert_true(c.hue >= 0 && c.hue < 1 && c.saturation >= 0 && c.saturation <= 1);
		hand_color_rgb(&c, back);
		for (int k = 0; k < 3; k++)
			worst = fmax(worst, fabs((double)back[k] - (double)rgb[k]) / fmax((double)c.value, 1e-30));
	}
	printf("# worst round trip: %.2g of the strongest band\n", worst);
	assert_true(worst < 1e-6);
}

/* Through grey and back to the same hue; round the wheel; to the limits and not beyond. */
static void lighting_changes_colour(void **state)
{
	struct fixture *f = *state;
	float *rgb = f->settings.lamp_intensity + 6;
	float red[3] = { 40, 10, 10 };
	struct hand_color c;

	press(f, 3);
	memcpy(rgb, red, sizeof red);
	f->input.axes[1] = 1;
	hold(f, 0, 1, 60); /* a quarter of the wheel */
	hand_color_of(rgb, 0, &c);
	assert_float_equal(c.hue, HAND_HUE_PER_S, 1e-4f);
	assert_float_equal(c.saturation, 0.75f, 1e-4f);
	assert_float_equal(c.value, 40, 1e-3f);
	hold(f, 0, 3, 60);
	for (int k = 0; k < 3; k++)
		assert_float_equal(rgb[k], red[k], 2e-3f);
	f->input.axes[1] = 0;
	f->input.axes[0] = -1;
	hold(f, 0, 3, 60);
	assert_float_equal(rgb[0], 40, 1e-3f);
	assert_float_equal(rgb[1], 40, 1e-3f);
	f->input.axes[0] = 1;
	hold(f, 0, 1.5, 60);
	hand_color_of(rgb, 0, &c);
	assert_float_equal(c.saturation, 0.75f, 1e-3f);
	assert_true(c.hue < 1e-3f || c.hue > 1 - 1e-3f);
	f->input.axes[0] = 0.1f; /* in the dead zone: nothing, to the bit */
	memcpy(red, rgb, sizeof red);
	hold(f, 0, 5, 60);
	assert_memory_equal(red, rgb, sizeof red);
	f->input.axes[0] = 0;
	hold(f, BIT(2), 2, 60);
	hand_color_of(rgb, 0, &c);
	assert_float_equal(c.value / 40, exp2f(2 * HAND_OCTAVES_PER_S), 1e-2f);
	hold(f, BIT(2), 60, 60);
	hand_color_of(rgb, 0, &c);
	assert_float_equal(c.value, HAND_INTENSITY_MOST, 0.1);
	hold(f, BIT(1), 60, 60);
	hand_color_of(rgb, 0, &c);
	assert_float_equal(c.value, HAND_INTENSITY_LEAST, 1e-7);
	assert_float_equal(c.saturation, 0.75f, 1e-2f); /* still red when it is bright again */
	memset(rgb, 0, 3 * sizeof *rgb); /* a lamp that the file has dark */
	step(f, BIT(2));
	assert_float_equal(rgb[0], HAND_INTENSITY_LEAST, 1e-9);
}

static void settings_have_limits(void **state)
{
	struct fixture *f = *state;

	press(f, 3);
	press(f, 3);
	press(f, 2);
	assert_int_equal(f->settings.gi_steps, 9);
	assert_int_equal(f->settings.gi_gathers, 3);
	hold(f, BIT(1), 1, 60); /* held counts once */
	step(f, 0);
	assert_int_equal(f->settings.gi_steps, 8);
	for (int i = 0; i < 200; i++)
		press(f, 2);
	assert_int_equal(f->settings.gi_steps, 128);
	assert_int_equal(f->settings.gi_gathers, 16);
	for (int i = 0; i < 200; i++)
		press(f, 1);
	assert_int_equal(f->settings.gi_steps, 1);
	assert_int_equal(f->settings.gi_gathers, 1);
	f->input.axes[0] = 1;
	f->input.axes[1] = -1;
	hold(f, 0, 1, 60);
	assert_float_equal(f->settings.absorption, HAND_MEDIUM_PER_S, 1e-4f);
	assert_float_equal(f->settings.scattering, 0, 0);
	hold(f, 0, 60, 60);
	assert_float_equal(f->settings.absorption, HAND_MEDIUM_MOST, 0);
	f->settings.scattering = 5; /* set by hand: goes down from there, and not up */
	f->input.axes[1] = 1;
	hold(f, 0, 1, 60);
	assert_float_equal(f->settings.scattering, 5, 0);
	f->input.axes[1] = -1;
	hold(f, 0, 1, 60);
	assert_float_equal(f->settings.scattering, 5 - HAND_MEDIUM_PER_S, 1e-4f);
}

/* Quality is on: more work from when the light has not changed for a while until it does. */
static void quality_refines_at_rest(void **state)
{
	static const int rates[] = { 60, 240 };
	struct fixture *f = *state;
	struct hand_light light;

	memset(&light, 0, sizeof light);
	light.on = 4;
	for (int k = 0; k < 2; k++) {
		const int64_t step_ns = GR_NS_PER_S / rates[k];
		int64_t rest_ns = 0;

		hand_init(&f->hand, &f->bindings, &f->scene);
		light.position[7] += 1;
		for (int i = 0; i < rates[k]; i++)
			assert_int_equal(hand_refine(&f->hand, &light, step_ns), 1); /* it is off */
		press(f, 3);
		press(f, 3);
		press(f, 0);
		assert_true(f->hand.quality);
		assert_int_equal(hand_refine(&f->hand, &light, step_ns), HAND_REFINE);
		for (int i = 0; i < rates[k]; i++) {
			light.intensity[6] += 1;
			assert_int_equal(hand_refine(&f->hand, &light, step_ns), 1);
		}
		while (hand_refine(&f->hand, &light, step_ns) == 1)
			rest_ns += step_ns;
		printf("# at %d Hz it refines after %.1f ms\n", rates[k], (double)rest_ns * 1e-6);
		assert_true(llabs(rest_ns + step_ns - HAND_REST_NS) <= step_ns);
		light.absorption += 0.1f;
		assert_int_equal(hand_refine(&f->hand, &light, step_ns), 1);
	}
}

/* What is wrong changes nothing at all, whatever is pressed. */
static void bad_input_is_refused(void **state)
{
	struct fixture *f = *state;
	const float bad[] = { NAN, INFINITY, -INFINITY, 1.5f, -1e30f };
	const struct fixture before = *f;
	const struct master_input good = f->input;

#define REFUSED(...) do { \
	f->input = good; f->input.buttons = UINT32_MAX; __VA_ARGS__; \
	assert_int_equal(hand_step(&f->hand, &f->input, &f->settings, &f->room), GR_ERR_RANGE); \
	assert_memory_equal(&f->hand, &before.hand, sizeof f->hand); \
	assert_memory_equal(&f->settings, &before.settings, sizeof f->settings); \
	assert_memory_equal(&f->room, &before.room, sizeof f->room); } while (0)
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		for (int k = 0; k < TRACK_AXES; k++)
			REFUSED(f->input.axes[k] = bad[i]);
	REFUSED(f->input.step_ns = -1);
	REFUSED(f->input.wand.T_room_body.p[1] = NAN);
	REFUSED(f->input.wand.T_room_body.p[1] = 1e6f);
	REFUSED(f->input.wand.T_room_body.q[0] = 2);
	REFUSED(f->input.head.T_room_body.p[2] = -INFINITY);
#undef REFUSED
	/* A stall of an hour moves no further than a tenth of a second. */
	f->input = good;
	f->input.step_ns = 3600 * GR_NS_PER_S;
	step(f, BIT(0));
	step(f, BIT(0));
	assert_float_equal(f->room.p[0], 10 - 0.1f * hand_fly_speed(0.5f), 1e-5f);
}

/* A wand that is lost does nothing, and what it holds when it is back is not pressed anew. */
static void a_lost_wand_does_nothing(void **state)
{
	struct fixture *f = *state;

	step(f, BIT(3));
	assert_int_equal(f->hand.mode, HAND_LIGHTING);
	f->input.wand.tracked = false;
	step(f, 0);
	f->input.wand.tracked = true;
	step(f, BIT(3));
	assert_int_equal(f->hand.mode, HAND_LIGHTING);
	step(f, 0);
	f->input.wand.tracked = false;
	hold(f, UINT32_MAX, 1, 60);
	assert_int_equal(f->hand.mode, HAND_LIGHTING);
	assert_memory_equal(&f->room, &f->scene.room, sizeof f->room);
	/* Pressed while it was lost, and held still. */
	f->input.wand.tracked = true;
	step(f, BIT(3));
	assert_int_equal(f->hand.mode, HAND_LIGHTING);
	step(f, 0);
	step(f, BIT(3));
	assert_int_equal(f->hand.mode, HAND_SETTINGS);
}

/* Any input at all: the room stays a pose, the settings stay in their ranges. */
static void anything_keeps_the_state_sound(void **state)
{
	struct unit_random random = unit_random_start("hand");
	struct fixture *f = *state;
	struct param_state *params;
	const char *refused = "";

	assert_int_equal(param_state_create(&params), GR_OK);
	f->bindings.turn = LAYOUT_TURN_FREE;
	for (uint64_t i = 1; i <= 50000; i++) {
		vec3 axis = { (float)unit_random_range(&random, -1, 1), (float)unit_random_range(&random, -1, 1), 1 };

		if (unit_random_u32(&random) % 4 == 0)
			f->input.buttons = unit_random_u32(&random) & unit_random_u32(&random) & 31;
		for (int k = 0; k < 2; k++)
			f->input.axes[k] = (float)unit_random_range(&random, -1, 1);
		f->input.step_ns = (int64_t)unit_random_range(&random, 0, 5e7);
		f->input.wand.tracked = unit_random_u32(&random) % 50 != 0;
		glm_quatv(f->input.wand.T_room_body.q, (float)unit_random_range(&random, -3, 3), axis);
		for (int k = 0; k < 3; k++)
			f->input.wand.T_room_body.p[k] = (float)unit_random_range(&random, -2, 2);
		step(f, f->input.buttons);
		assert_true(gr_pose_valid(&f->room));
		assert_true(master_settings_apply(&f->settings, params, i, &refused) >= 0);
		assert_true(hand_write(&f->hand, f->input.step_ns, params, i, &refused) >= 0);
	}
	param_state_destroy(&params);
}

int main(void)
{
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
	const struct CMUnitTest tests[] = {
		WITH(speed_is_the_thesis),
		WITH(frame_rate_does_not_matter),
		WITH(drag_turns_the_scene),
		WITH(reset_and_the_ring),
		WITH(torch_goes_with_the_hand),
		WITH(colours_go_round),
		WITH(lighting_changes_colour),
		WITH(settings_have_limits),
		WITH(quality_refines_at_rest),
		WITH(bad_input_is_refused),
		WITH(a_lost_wand_does_nothing),
		WITH(anything_keeps_the_state_sound),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
