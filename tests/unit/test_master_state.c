/* From tracking and settings to parameters, and from parameters to what is drawn. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/live_source.h"
#include "daemon/master_state.h"
#include "daemon/node_frame.h"

#include <math.h>

/* A scene with one lamp of each mount. */
struct fixture {
	struct layout layout;
	struct scene_file scene;
	struct scene_lamp lamps[4];
	struct master_state state;
	struct master_input input;
	struct param_state *params;
	uint64_t frame;
	const char *refused;
};

static const char *const lamp_names[] = { "ceiling", "torch", "brow", "moth" };

static void make_lamps(struct fixture *f)
{
	static const enum scene_lamp_mount mounts[] = { SCENE_MOUNT_FIXED, SCENE_MOUNT_WAND,
							SCENE_MOUNT_HEAD, SCENE_MOUNT_ORBIT };

	for (int i = 0; i < 4; i++) {
		struct scene_lamp *lamp = &f->lamps[i];
		strcpy(lamp->name, lamp_names[i]);
		lamp->kind = SCENE_LAMP_SPOT;
		lamp->mount = mounts[i];
		lamp->on = i != 1;
		lamp->direction[2] = -1;
		lamp->intensity[0] = lamp->intensity[1] = lamp->intensity[2] = (float)(10 * (i + 1));
	}
	f->lamps[0].position[1] = 2.5f;
	f->lamps[0].direction[1] = -1;
	f->lamps[0].direction[2] = 0;
	f->lamps[3].position[2] = 4; /* the circle begins at +z of the centre */
	f->lamps[3].orbit_center[1] = 1;
	f->lamps[3].orbit_radius_m = 2;
	f->lamps[3].orbit_period_s = 8;
}

static int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);
	const vec3 head = { 0, 1.7f, 0.5f }, wand = { 0.3f, 1.2f, 0.1f };

	f->layout.eye_separation_m = 0.064f;
	f->layout.hand = (struct layout_hand){
		.next = 3, .fly = 0, .lamps = 1, .reset = 2, .drag = -1, .torch = 0, .dimmer = 1, .brighter = 2,
		.quality = 0, .fewer = 1, .more = 2, .hue = 1, .scattering = 1, .hud = true, .hud_scale = 1,
	};
	gr_pose_heading(head, 0, &f->layout.start_head);
	gr_pose_heading(wand, 0, &f->layout.start_wand);
	f->scene.lamps = f->lamps;
	f->scene.lamp_count = 4;
	f->scene.gi = (struct scene_gi){ .method = SCENE_GI_LPV, .steps = 12, .gathers = 1, .incremental = 0.5f };
	f->scene.tone = (struct scene_tone){ .curve = SCENE_CURVE_REINHARD, .exposure = 3,
					     .adaptation = 100, .luminance_max = 1e4f, .bias = 0.85f,
					     .gamma_display = 2.2f, .gamma_end_to_end = 1.25f };
	f->scene.scattering_per_m = 0.1f;
	const vec3 place = { 10, 0, -5 };
	gr_pose_heading(place, (float)M_PI / 2, &f->scene.room); /* room's front is scene -x */
	make_lamps(f);
	if (param_state_create(&f->params) < 0)
		return -1;
	master_state_init(&f->state, &f->layout, &f->scene);
	master_state_start_input(&f->state, &f->input);
	f->input.step_ns = 10 * GR_NS_PER_MS;
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	param_state_destroy(&f->params);
	free(f);
	return 0;
}

static int next(struct fixture *f, bool restart)
{
	f->frame++;
	f->input.time_ns += f->input.step_ns;
	return master_state_frame(&f->state, &f->input, restart, f->params, f->frame, &f->refused);
}

static void near3(const float *a, float x, float y, float z)
{
	assert_float_equal(a[0], x, 1e-5f);
	assert_float_equal(a[1], y, 1e-5f);
	assert_float_equal(a[2], z, 1e-5f);
}

static void scene_file_becomes_parameters(void **state)
{
	struct fixture *f = *state;

	assert_int_equal(next(f, true), GR_OK);
	assert_int_equal(*param_u32(f->params, PARAM_LAMP_ON), 0xd);
	assert_int_equal(*param_u32(f->params, PARAM_GI_ON), 1);
	assert_int_equal(*param_u32(f->params, PARAM_GI_STEPS), 12);
	assert_int_equal(*param_u32(f->params, PARAM_TONE_CURVE), 1);
	assert_float_equal(*param_f32(f->params, PARAM_GAMMA_ENCODE), 1.25f / 2.2f, 1e-6f);
	assert_float_equal(*param_f32(f->params, PARAM_EYE_SEPARATION), 0.064f, 1e-7f);
	assert_float_equal(*param_f32(f->params, PARAM_SCATTERING), 0.1f, 1e-7f);
	assert_int_equal(*(const uint64_t *)param_get(f->params, PARAM_FRAME_TIME), 10 * GR_NS_PER_MS);
	assert_int_equal(*(const uint64_t *)param_get(f->params, PARAM_GI_EPOCH), 1);
	near3(param_f32(f->params, PARAM_HEAD_POSITION), 0, 1.7f, 0.5f);
	near3(param_f32(f->params, PARAM_ROOM_POSITION), 10, 0, -5);
	near3(param_f32(f->params, PARAM_LAMP_INTENSITY) + 6, 30, 30, 30);
}

static void what_does_not_change_keeps_its_version(void **state)
{
	struct fixture *f = *state;

	next(f, true);
	next(f, false);
	assert_int_equal(param_version(f->params, PARAM_FRAME_TIME), 2);
	assert_int_equal(param_version(f->params, PARAM_GI_EPOCH), 1);
	assert_int_equal(param_version(f->params, PARAM_HEAD_POSITION), 1);
	assert_int_equal(param_version(f->params, PARAM_LAMP_INTENSITY), 1);
	next(f, true);
	assert_int_equal(*(const uint64_t *)param_get(f->params, PARAM_GI_EPOCH), 3);
}

static void lamps_follow_their_mounts(void **state)
{
	struct fixture *f = *state;
	const float *p, *d;

	f->input.step_ns = 2 * GR_NS_PER_S; /* a quarter of the orbit */
	next(f, true);
	p = param_f32(f->params, PARAM_LAMP_POSITION);
	d = param_f32(f->params, PARAM_LAMP_DIRECTION);
	near3(p, 0, 2.5f, 0);
	near3(d, 0, -1, 0);
	/* T_scene_room turns the room's -z to scene -x, its x to scene -z. */
	near3(p + 3, 10 + 0.1f, 1.2f, -5 - 0.3f);
	near3(d + 3, -1, 0, 0);
	near3(p + 6, 10 + 0.5f, 1.7f, -5);
	near3(d + 6, -1, 0, 0);
	/* From +z counter-clockwise seen from above: a quarter later at +x, still looking in. */
	near3(p + 9, 2, 1, 0);
	near3(d + 9, -1, 0, 0);
	/* What no lamp uses is zero. */
	near3(p + 12, 0, 0, 0);
}

static void orbit_is_a_circle_for_any_time(void **state)
{
	struct fixture *f = *state;
	struct unit_random random = unit_random_start("orbit");
	double worst = 0;

	for (int i = 0; i < 20000; i++) {
		vec3 p, d;
		float *c = f->lamps[3].orbit_center;

		f->lamps[3].orbit_period_s = (float)unit_random_range(&random, -20, 20);
		int64_t t = (int64_t)(unit_random_range(&random, 0, 1) * 9e17);
		master_lamp_place(&f->lamps[3], &GR_POSE_IDENTITY, &GR_POSE_IDENTITY, t, p, d);
		double r = hypot(p[0] - c[0], p[2] - c[2]);
		double n = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		worst = fmax(worst, fmax(fabs(r - 2), fabs(n - 1)));
	}
	f->lamps[3].orbit_period_s = 0;
	vec3 p, d;
	master_lamp_place(&f->lamps[3], &GR_POSE_IDENTITY, &GR_POSE_IDENTITY, GR_NS_PER_S, p, d);
	near3(p, 0, 1, 2);
	printf("# largest error of radius and direction: %.2g\n", worst);
	assert_true(worst < 5e-7);
}

static void wand_flies_the_room(void **state)
{
	struct fixture *f = *state;

	f->input.buttons = 1;
	f->input.wand.tracked = false;
	next(f, false);
	near3(f->state.T_scene_room.p, 10, 0, -5); /* a lost wand does not fly */
	f->input.wand.tracked = true;
	next(f, false);
	next(f, false);
	/* Wand and head are 0.5 m apart on the floor plan; it points to scene -x. */
	float way = 1.4f * powf(0.5f / 0.4f, 2.5f) * 0.01f;
	near3(f->state.T_scene_room.p, 10 - way, 0, -5);
	near3(param_f32(f->params, PARAM_ROOM_POSITION), 10 - way, 0, -5);
	/* A stall of ten seconds moves no further than one of 0.1 s. */
	f->input.step_ns = 10 * GR_NS_PER_S;
	next(f, false);
	near3(f->state.T_scene_room.p, 10 - 11 * way, 0, -5);
	f->input.buttons = 4;
	next(f, false);
	near3(f->state.T_scene_room.p, 10, 0, -5);
}

static void torch_is_switched_once_a_press(void **state)
{
	struct fixture *f = *state;

	f->input.wand.tracked = true;
	f->input.buttons = 2;
	next(f, false);
	assert_int_equal(*param_u32(f->params, PARAM_LAMP_ON), 0xf);
	next(f, false); /* still held */
	assert_int_equal(*param_u32(f->params, PARAM_LAMP_ON), 0xf);
	f->input.buttons = 0;
	next(f, false);
	f->input.buttons = 2;
	next(f, false);
	assert_int_equal(*param_u32(f->params, PARAM_LAMP_ON), 0xd);
}

static void values_out_of_range_are_named(void **state)
{
	struct fixture *f = *state;

	next(f, true);
	f->input.head.T_room_body.p[1] = 2000;
	assert_int_equal(next(f, false), GR_ERR_RANGE);
	assert_string_equal(f->refused, param_info(PARAM_HEAD_POSITION)->name);
	near3(param_f32(f->params, PARAM_HEAD_POSITION), 0, 1.7f, 0.5f);
	/* Flying out of the world: the room stays at its rim and can come back. */
	f->input.head.T_room_body.p[1] = 1.7f;
	f->state.T_scene_room.p[0] = -1e5f;
	f->input.wand.tracked = true;
	f->input.buttons = 1;
	f->input.step_ns = 100 * GR_NS_PER_MS;
	assert_int_equal(next(f, false), GR_OK);
	assert_int_equal(next(f, false), GR_ERR_RANGE);
	assert_float_equal(f->state.T_scene_room.p[0], -1e5f, 0);
}

static int set(struct fixture *f, char *why, size_t size, const char *text)
{
	static char line[256];
	char *words[16], *save, *word;
	int n = 0;

	snprintf(line, sizeof line, "%s", text);
	for (word = strtok_r(line, " ", &save); word; word = strtok_r(NULL, " ", &save))
		words[n++] = word;
	return master_settings_set(&f->state.settings, &f->scene, words, n, why, size);
}

static void settings_change_what_they_name(void **state)
{
	struct fixture *f = *state;
	char why[200];

	assert_int_equal(set(f, why, sizeof why, "lamp torch on"), GR_OK);
	assert_int_equal(set(f, why, sizeof why, "lamp ceiling off"), GR_OK);
	assert_int_equal(set(f, why, sizeof why, "lamp_intensity moth 1 2.5 3"), GR_OK);
	assert_int_equal(set(f, why, sizeof why, "gi_steps 20"), GR_OK);
	assert_int_equal(set(f, why, sizeof why, "absorption 0.25"), GR_OK);
	assert_int_equal(set(f, why, sizeof why, "exposure 1e2"), GR_OK);
	assert_int_equal(set(f, why, sizeof why, "tone_curve 3"), GR_OK);
	assert_int_equal(set(f, why, sizeof why, "adaptation 0.04"), GR_OK);
	next(f, false);
	assert_int_equal(*param_u32(f->params, PARAM_TONE_CURVE), 3);
	assert_float_equal(param_f32(f->params, PARAM_ADAPTATION)[1], 0.04, 1e-6);
	assert_float_equal(param_f32(f->params, PARAM_PIGMENT)[0], 1, 1e-6);
	assert_float_equal(param_f32(f->params, PARAM_PIGMENT)[1], 0.5, 1e-6); /* half-bleached there */
	assert_int_equal(*param_u32(f->params, PARAM_LAMP_ON), 0xe);
	assert_int_equal(*param_u32(f->params, PARAM_GI_STEPS), 20);
	assert_float_equal(*param_f32(f->params, PARAM_ABSORPTION), 0.25, 0);
	assert_float_equal(*param_f32(f->params, PARAM_EXPOSURE), 100, 0);
	near3(param_f32(f->params, PARAM_LAMP_INTENSITY) + 9, 1, 2.5f, 3);
}

static void wrong_settings_change_nothing(void **state)
{
	struct fixture *f = *state;
	struct master_settings before = f->state.settings;
	static const char *const wrong[] = {
		"", "gi_steps", "gi_steps 0", "gi_steps 129", "gi_steps 8.5", "gi_steps 8 9",
		"gi_steps nan", "gi_steps 8x", "absorption -1", "absorption nan", "absorption inf",
		"exposure 0", "exposure 1e99", "tone_curve 4", "adaptation 0", "tone_bias 1", "luminance_max nan", "lamp", "lamp torch", "lamp torch up",
		"lamp sun on", "lamp_intensity moth 1 2", "lamp_intensity moth 1 2 -3",
		"lamp_intensity sun 1 2 3", "head_position 1 2 3", "frame_time 5",
		"a-word-that-is-much-longer-than-any-setting-could-ever-be-in-this-house 1",
	};

	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		/* Also with little room for the reason. */
		for (size_t size = 1; size < 300; size += 37) {
			char *why = calloc(1, size);
			assert_int_equal(set(f, why, size, wrong[i]), GR_ERR_RANGE);
			assert_true(size == 1 || *why);
			assert_true(strlen(why) < size);
			free(why);
		}
	}
	assert_memory_equal(&before, &f->state.settings, sizeof before);
}

/* What a standby adopts gives the same parameters again, with time gone on. */
static void another_goes_on(void **state)
{
	struct fixture *f = *state;
	struct master_state other;
	struct live_source live;
	struct param_state *theirs;
	char *const exposure[] = { (char *)"exposure", (char *)"7" };
	char *const lamp[] = { (char *)"lamp", (char *)"ceiling", (char *)"off" };
	char why[200];

	assert_int_equal(master_settings_set(&f->state.settings, &f->scene, exposure, 2, why, sizeof why), GR_OK);
	assert_int_equal(master_settings_set(&f->state.settings, &f->scene, lamp, 3, why, sizeof why), GR_OK);
	f->state.T_scene_room.p[0] = 4;
	f->state.settings.lamp_on &= ~8u; /* the moth: else the light never rests */
	f->input.wand.tracked = true;
	for (int i = 0; i < 2; i++) { /* to the settings, and there quality */
		f->input.buttons = 8;
		next(f, false);
		f->input.buttons = 0;
		next(f, false);
		if (i == 0) { /* on the way the torch is put down, and turned */
			f->input.buttons = 1;
			f->input.axes[0] = 1;
			next(f, false);
			f->input.buttons = 0;
			f->input.axes[0] = 0;
			next(f, false);
			f->input.wand.T_room_body.p[0] += 0.1f;
		}
	}
	f->input.buttons = 1;
	f->input.step_ns = 10 * GR_NS_PER_MS;
	for (int i = 0; i < 20; i++)
		next(f, false);
	assert_int_equal(*param_u32(f->params, PARAM_GI_REFINE), HAND_REFINE);
	assert_int_equal(*param_u32(f->params, PARAM_HAND_MODE), HAND_SETTINGS);
	assert_int_equal(*param_u32(f->params, PARAM_HAND_FLAGS),
			 HAND_FLAG_HUD | HAND_FLAG_QUALITY | HAND_FLAG_PUT_DOWN);
	f->input.buttons = 4097;
	f->input.time_ns = 5 * GR_NS_PER_S;
	assert_int_equal(master_state_frame(&f->state, &f->input, true, f->params, 99, &f->refused), GR_OK);
	master_state_init(&other, &f->layout, &f->scene);
	master_state_adopt(&other, f->params);
	assert_int_equal(other.epoch, 99);
	assert_int_equal(param_state_create(&theirs), GR_OK);
	param_state_copy(theirs, f->params);
	assert_int_equal(master_state_frame(&other, &f->input, false, theirs, 100, &f->refused), GR_OK);
	/* Not one parameter has changed. */
	assert_int_equal(param_state_hash(theirs, 0), param_state_hash(f->params, 0));
	param_state_destroy(&theirs);

	live_source_init(&live, &f->layout, &f->scene, NULL, false);
	live_source_adopt(&live, f->params, 14, 100, 100 + GR_NS_PER_S);
	assert_int_equal(live.base_ns + (100 + GR_NS_PER_S) - live.start_ns, 6 * GR_NS_PER_S);
	assert_int_equal(live.last_time_ns, 5 * GR_NS_PER_S);
	f->layout.rates.frame_hz = 60;
	live_source_init(&live, &f->layout, &f->scene, NULL, true);
	live_source_adopt(&live, f->params, 120, 100, 100 + GR_NS_PER_S);
	assert_int_equal(live.base_ns + 2 * GR_NS_PER_S, 6 * GR_NS_PER_S); /* frame 120 at 60 Hz */
}

static void parameters_become_a_frame(void **state)
{
	struct fixture *f = *state;
	struct render_frame frame;
	const char *refused = NULL;

	render_frame_init(&frame, &f->scene);
	next(f, true);
	assert_int_equal(node_frame_fill(&frame, &f->scene, f->params, 1, &refused), GR_OK);
	assert_int_equal(frame.frame, 1);
	near3(frame.T_scene_room.p, 10, 0, -5);
	near3(frame.T_room_head.p, 0, 1.7f, 0.5f);
	assert_true(frame.lamps[0].on && !frame.lamps[1].on && frame.lamps[3].on);
	near3(frame.lamps[2].intensity, 30, 30, 30);
	assert_int_equal(frame.gi_steps, 12);
	assert_int_equal(frame.gi_epoch, 1);
	assert_true(frame.gi_on);
	assert_int_equal(frame.curve, SCENE_CURVE_REINHARD);
	assert_float_equal(frame.exposure, 3, 0);
}

/* A state of defaults has rotations of all zeros: none. */
static void no_rotation_is_identity(void **state)
{
	struct fixture *f = *state;
	struct render_frame frame;
	const char *refused = NULL;

	render_frame_init(&frame, &f->scene);
	assert_int_equal(node_frame_fill(&frame, &f->scene, f->params, 1, &refused), GR_OK);
	assert_float_equal(frame.T_room_head.q[3], 1, 0);
}

static void senseless_parameters_are_refused(void **state)
{
	struct fixture *f = *state;
	struct render_frame frame, before;
	const char *refused = NULL;
	float q[4] = { 0.5f, 0.5f, 0.5f, 0 }, directions[48] = { 0 };

	render_frame_init(&frame, &f->scene);
	before = frame;
	next(f, true);
	param_set(f->params, PARAM_HEAD_ROTATION, q, 2);
	assert_int_equal(node_frame_fill(&frame, &f->scene, f->params, 2, &refused), GR_ERR_RANGE);
	assert_string_equal(refused, param_info(PARAM_HEAD_ROTATION)->name);
	assert_memory_equal(&frame, &before, sizeof frame);
	next(f, true);
	param_set(f->params, PARAM_HEAD_ROTATION, GR_POSE_IDENTITY.q, 3);
	param_set(f->params, PARAM_LAMP_DIRECTION, directions, 3);
	assert_int_equal(node_frame_fill(&frame, &f->scene, f->params, 3, &refused), GR_ERR_RANGE);
	assert_string_equal(refused, param_info(PARAM_LAMP_DIRECTION)->name);
	/* A lamp that is off, or a point lamp, needs none. */
	for (int i = 0; i < 4; i++)
		f->lamps[i].kind = SCENE_LAMP_POINT;
	assert_int_equal(node_frame_fill(&frame, &f->scene, f->params, 3, &refused), GR_OK);
}

int main(void)
{
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
	const struct CMUnitTest tests[] = {
		WITH(another_goes_on), WITH(scene_file_becomes_parameters),
		WITH(what_does_not_change_keeps_its_version),
		WITH(lamps_follow_their_mounts),
		WITH(orbit_is_a_circle_for_any_time),
		WITH(wand_flies_the_room),
		WITH(torch_is_switched_once_a_press),
		WITH(values_out_of_range_are_named),
		WITH(settings_change_what_they_name),
		WITH(wrong_settings_change_nothing),
		WITH(parameters_become_a_frame),
		WITH(no_rotation_is_identity),
		WITH(senseless_parameters_are_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
