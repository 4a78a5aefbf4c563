/* The room's eye: from what walls say is looked at to the parameters of a frame. */
#include "unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/master_adapt.h"

static struct scene_tone tone_of(enum scene_adapt adapt)
{
	return (struct scene_tone){ .adapt = adapt, .adapt_s = 0.5f, .adaptation = 100, .luminance_max = 1e4f,
				    .curve = SCENE_CURVE_DRAGO, .exposure = 1, .bias = 0.85f };
}

static struct adapt_sample light(double level, double solid_angle)
{
	return (struct adapt_sample){ solid_angle * log(level), solid_angle, level };
}

static void look_at(struct master_adapt *a, double level)
{
	const struct adapt_sample s = light(level, 0.0239);

	assert_int_equal(master_adapt_take(a, 0, &s), GR_OK);
}

static void run(struct master_adapt *a, double seconds, int hz)
{
	for (int i = 0; i < seconds * hz; i++)
		master_adapt_step(a, 100, GR_NS_PER_S / hz);
}

static void follows(void **state)
{
	(void)state;
	for (int kind = SCENE_ADAPT_PATTANAIK; kind <= SCENE_ADAPT_EXPONENTIAL; kind++) {
		const struct scene_tone tone = tone_of((enum scene_adapt)kind);
		struct master_adapt a;
		double before, largest = 0;

		master_adapt_init(&a, &tone);
		run(&a, 1, 60);
		assert_true(fabs(a.eye.cone / 100 - 1) < 1e-6); /* nothing seen: as it was */
		look_at(&a, 1000);
		run(&a, 10, 60);
		assert_true(fabs(a.eye.cone / 1000 - 1) < 1e-3 && fabs(a.max / 1000 - 1) < 1e-3);
		/* Into the dark, and back. */
		look_at(&a, 0.1);
		before = a.eye.cone;
		master_adapt_step(&a, 100, GR_NS_PER_S / 60);
		assert_true(a.eye.cone < before && a.eye.cone > 0.1);
		run(&a, 10, 60);
		assert_true(fabs(a.eye.cone / 0.1 - 1) < 1e-3);
		look_at(&a, 1000);
		run(&a, 10, 60);
		assert_true(fabs(a.eye.cone / 1000 - 1) < 1e-3);
		/* A still scene: no flicker. */
		for (int i = 0; i < 600; i++) {
			before = a.eye.cone;
			master_adapt_step(&a, 100, GR_NS_PER_S / 60);
			largest = fmax(largest, fabs(a.eye.cone / before - 1));
		}
		printf("# a still scene, model %d: the level changes by at most %.1e a frame\n", kind, largest);
		assert_true(largest < 1e-6);
		/* Looking out between the walls it goes on towards what it saw; a stall is one step. */
		look_at(&a, 50);
		master_adapt_step(&a, 100, GR_NS_PER_S / 60);
		master_adapt_forget(&a, 0);
		master_adapt_step(&a, 100, 100 * GR_NS_PER_S);
		assert_true(fabs(a.eye.cone / 50 - 1) < 1e-6);
		master_adapt_step(&a, 100, -5);
		assert_true(fabs(a.eye.cone / 50 - 1) < 1e-6);
	}
}

static void same_at_any_rate(void **state)
{
	const struct scene_tone tone = tone_of(SCENE_ADAPT_PATTANAIK);
	struct master_adapt slow, fast;

	(void)state;
	master_adapt_init(&slow, &tone);
	master_adapt_init(&fast, &tone);
	look_at(&slow, 3);
	look_at(&fast, 3);
	run(&slow, 0.5, 50);
	run(&fast, 0.5, 200);
	assert_true(fabs(slow.eye.cone / fast.eye.cone - 1) < 1e-9);
	assert_true(fabs(slow.eye.rod_pigment / fast.eye.rod_pigment - 1) < 1e-9);
	assert_true(fabs(slow.max / fast.max - 1) < 1e-9);
}

/* Three walls at the edge of which one looks count with what the eye sees of each. */
static void walls(void **state)
{
	const struct scene_tone tone = tone_of(SCENE_ADAPT_EXPONENTIAL);
	const struct adapt_sample first = light(1, 0.006), second = light(10, 0.006), third = light(1000, 0.012);
	const struct adapt_sample unseen = { 0, 0, 5e5 };
	struct master_adapt a;

	(void)state;
	master_adapt_init(&a, &tone);
	assert_int_equal(master_adapt_take(&a, 3, &first), GR_OK);
	assert_int_equal(master_adapt_take(&a, 7, &second), GR_OK);
	assert_int_equal(master_adapt_take(&a, 63, &third), GR_OK);
	assert_int_equal(master_adapt_take(&a, 1, &unseen), GR_OK); /* bright, and not looked at */
	run(&a, 20, 60);
	assert_true(fabs(a.eye.cone / pow(10, 0.25 * 0 + 0.25 * 1 + 0.5 * 3) - 1) < 1e-6);
	assert_true(fabs(a.max / 5e5 - 1) < 1e-6);
	master_adapt_forget(&a, 63);
	run(&a, 20, 60);
	assert_true(fabs(a.eye.cone / sqrt(10) - 1) < 1e-6);
}

static void refused(void **state)
{
	const double huge = 1e300;
	const struct adapt_sample bad[] = {
		{ NAN, 0.01, 1 },	{ 0, NAN, 1 },	   { 0, 0.01, NAN },	 { INFINITY, 0.01, 1 },
		{ 0, INFINITY, 1 },	{ 0, 0.01, INFINITY }, { 0, -0.01, 1 },	 { 0, 0.01, -1 },
		{ 1, 0, 1 },		{ 0, 0.2, 1 },	   { huge, 0.01, 1 },	 { -huge, 0.01, 1 },
		{ 0.01 * 25, 0.01, 1 }, { 0, 0.01, 1e12 },
	};
	const struct scene_tone tone = tone_of(SCENE_ADAPT_PATTANAIK);
	const struct adapt_sample good = light(7, 0.02);
	struct master_adapt a, before;

	(void)state;
	master_adapt_init(&a, &tone);
	assert_int_equal(master_adapt_take(&a, 2, &good), GR_OK);
	before = a;
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		assert_int_equal(master_adapt_take(&a, 2, &bad[i]), GR_ERR_RANGE);
	assert_int_equal(master_adapt_take(&a, FDP_MAX_NODES, &good), GR_ERR_RANGE);
	master_adapt_forget(&a, FDP_MAX_NODES);
	assert_memory_equal(&a, &before, sizeof a);
}

/* Through the parameters: set, adopted by another master, fixed when the scene says so. */
static void parameters(void **state)
{
	struct scene_tone tone = tone_of(SCENE_ADAPT_PATTANAIK);
	struct param_state *params;
	struct master_adapt a, next;

	(void)state;
	assert_int_equal(param_state_create(&params), GR_OK);
	master_adapt_init(&a, &tone);
	look_at(&a, 3000);
	run(&a, 0.2, 60);
	assert_int_equal(master_adapt_apply(&a, params, 1), GR_OK);
	assert_true(fabs((double)param_f32(params, PARAM_ADAPTATION)[0] / a.eye.cone - 1) < 1e-6);
	assert_true(fabs((double)param_f32(params, PARAM_ADAPTATION)[1] / a.eye.rod - 1) < 1e-6);
	assert_true(a.eye.cone > 1000 && a.eye.rod < a.eye.cone);
	master_adapt_init(&next, &tone);
	master_adapt_adopt(&next, params);
	/* Its settings come from the same parameters, and are no new wish. */
	master_adapt_step(&next, *param_f32(params, PARAM_ADAPTATION), GR_NS_PER_S / 60);
	assert_true(fabs(next.eye.cone / a.eye.cone - 1) < 1e-6 && fabs(next.max / a.max - 1) < 1e-6);
	/* A person's wish counts at once. */
	master_adapt_step(&next, 5, 0);
	assert_true(fabs(next.eye.cone / 5 - 1) < 1e-6);
	/* The darkest and the brightest that there is. */
	for (int i = 0; i < 2; i++) {
		look_at(&a, i ? ADAPT_LEVEL_MAX : ADAPT_LEVEL_MIN);
		run(&a, 60, 60);
		assert_int_equal(master_adapt_apply(&a, params, 2 + (uint64_t)i), GR_OK);
	}
	tone.adapt = SCENE_ADAPT_FIXED;
	master_adapt_init(&a, &tone);
	look_at(&a, 3000);
	run(&a, 1, 60);
	assert_true(fabs(a.eye.cone / 100 - 1) < 1e-9);
	assert_int_equal(master_adapt_apply(&a, params, 9), GR_OK);
	assert_int_equal(param_version(params, PARAM_ADAPTATION), 3);
	param_state_destroy(&params);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(follows), cmocka_unit_test(same_at_any_rate), cmocka_unit_test(walls),
		cmocka_unit_test(refused), cmocka_unit_test(parameters),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
