/* The planner: what it chooses, why, and that more budget is never worse, over many facts. */
#include "tests/unit/unit.h"

#include "base/result.h"
#include "renderer/gi/surfel_bake.h"
#include "renderer/scene/import.h"
#include "tests/unit/plan_cases.h"
#include "tests/unit/shared.h"

#include <math.h>

static void method_follows_the_scene(void **state)
{
	struct gi_facts facts = room();
	struct gi_plan plan = plan_for(&facts, 30);

	(void)state;
	assert_int_equal(plan.gi.method, SCENE_GI_SURFELS);
	assert_true(plan.within && plan.update_ms <= 30 && plan.error < 0.1);
	assert_non_null(strstr(plan.why, "surfels"));
	assert_non_null(strstr(plan.why, "nothing moves but lamps"));
	printf("# %s\n", plan.why);
	facts.scattering_per_m = 0.1;
	plan = plan_for(&facts, 30);
	assert_int_equal(plan.gi.method, SCENE_GI_LPV);
	assert_non_null(strstr(plan.why, "the air scatters"));
	printf("# %s\n", plan.why);
	facts.scattering_per_m = 1;
	facts.environment = true;
	plan = plan_for(&facts, 30);
	assert_int_equal(plan.gi.method, SCENE_GI_LPV);
	assert_non_null(strstr(plan.why, "leaves the environment out"));
	printf("# %s\n", plan.why);
	facts.scattering_per_m = 0;
	for (double budget = 0.01; budget < 1000; budget *= 3) {
		plan = plan_for(&facts, budget);
		assert_int_equal(plan.gi.method, SCENE_GI_SURFELS);
	}
	facts.moving_geometry = true;
	plan = plan_for(&facts, 100);
	assert_int_equal(plan.gi.method, SCENE_GI_PROBES);
	assert_non_null(strstr(plan.why, "things move"));
}

static void nothing_to_light(void **state)
{
	struct gi_facts facts = room();
	struct gi_plan plan;

	(void)state;
	facts.lamps_moving = 0;
	plan = plan_for(&facts, 8);
	assert_int_equal(plan.gi.method, SCENE_GI_NONE);
	assert_non_null(strstr(plan.why, "no lamp, no emissive surface, no environment"));
	assert_true(plan.error <= 0 && plan.update_ms <= 0 && plan.within);
	facts.emissive_triangles = 2;
	assert_int_equal(plan_for(&facts, 8).gi.method, SCENE_GI_SURFELS);
	facts.area_m2 = 0;
	plan = plan_for(&facts, 8);
	assert_int_equal(plan.gi.method, SCENE_GI_NONE);
	assert_non_null(strstr(plan.why, "no surface"));
}

/* Surfels that are expected of a model after they were counted coarsely, and that are there. */
static void counted(const char *path, const char *name, const float *spacings, size_t count)
{
	const struct import_options options = { .scale = 1, .emission_scale = 1 };
	const struct scene_file file = { 0 };
	struct gr_diag diag = { 0 };
	struct gi_facts facts;
	struct scene *scene;

	assert_int_equal(import_model(path, &options, &scene, &diag), GR_OK);
	gi_facts_take(&facts, scene, &file);
	assert_int_equal(gi_facts_count(&facts, scene), GR_OK);
	for (size_t i = 0; i < count; i++) {
		struct surfel_bake_params params = SURFEL_BAKE_PARAMS;
		struct scene_gi gi = wish(8);
		struct surfel_set *set;
		double expected;

		gi.spacing_m = params.spacing_m = spacings[i];
		params.links = 16;
		params.probes = 0;
		assert_int_equal(surfel_bake(&set, scene, NULL, &params, &diag), GR_OK);
		expected = gi_plan_surfels(&facts, &gi);
		printf("# %s, %g m apart: %.0f by area alone, %.0f expected, %zu baked\n", name,
		       (double)spacings[i], 0.7 * facts.area_m2 / pow((double)spacings[i], 2), expected,
		       set->count);
		/* well within what a plan's cost may be off before it warns */
		assert_true(fabs(expected / (double)set->count - 1) < 0.04);
		surfel_set_destroy(&set);
	}
	gr_diag_finish(&diag);
	scene_destroy(&scene);
}

static void counts_are_near(void **state)
{
	const float grotto[] = { 0.5f, 0.34f, 0.25f }, box[] = { 0.4f, 0.2f };
	const float sponza[] = { 1.6f, 0.8f, 0.4f };
	const char *source = getenv("srcdir");
	char path[1024];

	(void)state;
	snprintf(path, sizeof path, "%s/scenes/grotto.gltf", source ? source : ".");
	counted(path, "grotto", grotto, 3);
	snprintf(path, sizeof path, "%s/scenes/box.gltf", source ? source : ".");
	counted(path, "box", box, 2);
	if (getenv("GROTTO_LONG") && shared_file("reference/scenes/models/sponza_part.glb", path))
		counted(path, "Sponza", sponza, 3);
}

/* What is told is what a person can read, and what fits where it goes. */
static void words(void **state)
{
	struct gi_facts facts = room();
	struct gi_plan plan;

	(void)state;
	for (double area = 1e-6; area < 1e12; area *= 10) {
		facts.area_m2 = area;
		for (double budget = 0.1; budget < 1e5; budget *= 10) {
			plan = plan_for(&facts, budget);
			assert_null(strstr(plan.why, "e+"));
			assert_true(plan.error_least <= plan.error && plan.error <= plan.error_most);
		}
	}
}

/* Surfels along edges and on small pieces cost as others do. */
static void edges_count(void **state)
{
	struct gi_facts facts = room();
	const struct gi_plan flat = plan_for(&facts, 30);
	struct gi_plan plan;

	(void)state;
	facts.edge_surfels_m = 1000;
	plan = plan_for(&facts, 30);
	assert_true(plan.within && plan.update_ms <= 30);
	assert_true(plan.error > flat.error);
	assert_true(gi_plan_surfels(&facts, &flat.gi) > 1.5 * flat.surfels);
	assert_true(gi_plan_cost_ms(&facts, &flat.gi, &gi_costs_usual) > 30);
	printf("# with edges: %s\n", plan.why);
}

/* The number that was baked decides what is told, and what would have been right. */
static void as_baked(void **state)
{
	struct gi_facts facts = room();
	struct gi_plan plan = plan_for(&facts, 30), right;
	const uint64_t code = plan.code;
	const double expected_ms = plan.update_ms;

	(void)state;
	assert_true(gi_plan_baked(&plan, &facts, &gi_costs_usual, (size_t)plan.surfels, &right));
	assert_true(plan.baked && fabs(plan.update_ms - expected_ms) < 0.01 * expected_ms);
	assert_false(gi_plan_baked(&plan, &facts, &gi_costs_usual, (size_t)(3 * plan.surfels), &right));
	assert_false(plan.within);
	assert_true(plan.update_ms > 60);
	assert_int_equal(plan.code, code); /* what walls compute is as it was */
	assert_true(right.within && right.update_ms <= 30 && right.code != plan.code);
	printf("# three times as many: %s; right: %s\n", plan.why, right.why);
}

/* The air of the scene file thins what is baked, too: it chooses nothing. */
static void air_that_absorbs(void **state)
{
	struct gi_facts facts = room();

	(void)state;
	facts.emissive_triangles = 2;
	for (double sigma = 0.001; sigma < 100; sigma *= 2) {
		struct gi_plan plan;

		facts.absorption_per_m = sigma;
		plan = plan_for(&facts, 30);
		assert_int_equal(plan.gi.method, SCENE_GI_SURFELS);
		assert_true(isfinite(plan.error));
	}
}

/* What surfels leave out of air that scatters, beside what the lattice errs: no step where it begins. */
static void air_that_scatters(void **state)
{
	struct gi_facts facts = room();
	const struct gi_plan clear = plan_for(&facts, 30);
	double last = 0;
	bool lattice = false;

	(void)state;
	for (double sigma = 1e-6; sigma < 100; sigma *= 1.3) {
		struct gi_plan plan;

		facts.scattering_per_m = sigma;
		plan = plan_for(&facts, 30);
		assert_true(plan.error >= clear.error && plan.error >= last);
		if (sigma < 1e-3)
			assert_true(plan.error < 1.01 * clear.error);
		if (plan.gi.method == SCENE_GI_LPV && !lattice)
			printf("# the lattice from %.3g/m on, after an error of %.1f %%: %s\n", sigma, 100 * last,
			       plan.why);
		if (lattice)
			assert_int_equal(plan.gi.method, SCENE_GI_LPV);
		lattice = plan.gi.method == SCENE_GI_LPV;
		last = plan.error;
	}
	assert_true(lattice && last < 0.25);
	facts.scattering_per_m = 0.1;
	facts.environment = true;
	assert_int_equal(plan_for(&facts, 30).gi.method, SCENE_GI_SURFELS);
	assert_non_null(strstr(plan_for(&facts, 30).why, "which is left out"));
}

/* A term that no setting changes, however large, does not choose the coarsest settings. */
static void what_is_missing_chooses_no_settings(void **state)
{
	struct gi_facts facts = room(), plain;
	struct gi_plan a, b;

	(void)state;
	facts.scattering_per_m = 3;
	plain = facts;
	facts.environment = true;
	facts.mirror_share = 0.3;
	for (double budget = 4; budget < 1000; budget *= 2) {
		a = plan_for(&plain, budget);
		b = plan_for(&facts, budget);
		assert_int_equal(a.gi.method, SCENE_GI_LPV);
		if (b.gi.method == SCENE_GI_LPV)
			assert_int_equal(a.code, b.code);
	}
	facts.mirror_share = 0;
	b = plan_for(&facts, 100);
	assert_int_equal(b.code, plan_for(&plain, 100).code);
	assert_true(b.gi.lattice >= 24 && b.error < 0.6);
	printf("# %s\n", b.why);
}

/* Where nothing fits, the budget that is advised is one in which something does. */
static void advice_fits(void **state)
{
	struct unit_random r = unit_random_start("advice_fits");

	(void)state;
	for (int round = 0; round < 300; round++) {
		const struct gi_facts facts = any_facts(&r);
		const struct gi_plan least = plan_for(&facts, 1e-9);
		double budget = gi_plan_budget_for(least.update_ms);
		struct gi_plan plan;

		if (least.gi.method == SCENE_GI_NONE)
			continue;
		assert_false(least.within);
		assert_true(budget >= GI_PLAN_BUDGET_LEAST && budget < fmax(0.11, 1.11 * least.update_ms));
		plan = plan_for(&facts, budget);
		assert_true(plan.within);
	}
}

/* What was baked and does not fit is not advised as what would. */
static void advice_after_the_bake(void **state)
{
	const struct gi_facts facts = room();
	struct gi_plan plan = plan_for(&facts, 0.1), right;

	(void)state;
	assert_false(gi_plan_baked(&plan, &facts, &gi_costs_usual, (size_t)plan.surfels, &right));
	assert_false(right.within);
	assert_true(plan_for(&facts, gi_plan_budget_for(right.update_ms)).within);
}

static void absurd_wishes(void **state)
{
	const double budgets[] = { 0, -1, 1e-30, (double)NAN, -(double)INFINITY };
	struct gi_facts facts = room();
	struct gi_plan least = plan_for(&facts, 1e-9), most;

	(void)state;
	assert_false(least.within);
	assert_non_null(strstr(least.why, "nothing fits the budget"));
	for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
		struct gi_plan plan = plan_for(&facts, budgets[i]);

		assert_int_equal(plan.code, least.code);
		assert_false(plan.within);
	}
	most = plan_for(&facts, 1e30);
	assert_true(most.within && most.error < least.error);
	assert_int_equal(plan_for(&facts, (double)INFINITY).code, most.code);
	facts.area_m2 = (double)NAN;
	assert_int_equal(plan_for(&facts, 8).gi.method, SCENE_GI_NONE);
	facts = room();
	facts.mirror_share = (double)NAN;
	assert_int_equal(plan_for(&facts, 8).gi.method, SCENE_GI_SURFELS);
	facts = room();
	facts.size_m[1] = (double)NAN;
	assert_true(isfinite(plan_for(&facts, 8).error));
}

static void costs_that_are_none(void **state)
{
	const struct gi_facts facts = room();
	const struct scene_gi wanted = wish(20);
	struct gi_plan usual, plan;
	struct gi_costs costs = gi_costs_usual;

	(void)state;
	assert_true(gi_costs_valid(&costs));
	gi_plan_make(&usual, &facts, &wanted, &costs);
	costs.surfel_link = (double)NAN;
	assert_false(gi_costs_valid(&costs));
	gi_plan_make(&plan, &facts, &wanted, &costs);
	assert_int_equal(plan.code, usual.code);
	costs.surfel_link = 0;
	assert_false(gi_costs_valid(&costs));
	costs = gi_costs_usual;
	costs.lattice_frame = -1;
	assert_false(gi_costs_valid(&costs));
	/* a GPU a thousand times as fast affords more */
	costs = gi_costs_usual;
	costs.surfel_link /= 1000;
	costs.surfel_tap /= 1000;
	costs.surfel_frame /= 1000;
	gi_plan_make(&plan, &facts, &wanted, &costs);
	assert_true(plan.error < usual.error);
	printf("# fast GPU, 20 ms: %s\n", plan.why);
}

static void more_budget_is_never_worse(void **state)
{
	struct unit_random r = unit_random_start("more_budget_is_never_worse");

	(void)state;
	for (int round = 0; round < 300; round++) {
		const struct gi_facts facts = any_facts(&r);
		struct gi_costs costs = gi_costs_usual;
		double last = INFINITY;

		costs.lattice_cell_step *= pow(10, unit_random_range(&r, -4, 1));
		costs.surfel_link *= pow(10, unit_random_range(&r, -4, 1));
		costs.surfel_tap *= pow(10, unit_random_range(&r, -4, 1));
		for (double budget = 1e-3; budget < 1e4; budget *= 1.7) {
			const struct scene_gi wanted = wish(budget);
			struct gi_plan plan, again;

			gi_plan_make(&plan, &facts, &wanted, &costs);
			gi_plan_make(&again, &facts, &wanted, &costs);
			assert_int_equal(plan.code, again.code);
			assert_int_not_equal(plan.gi.method, SCENE_GI_AUTO);
			if (!(plan.error <= last * (1 + 1e-12)))
				fail_msg("budget %g: error %g after %g", budget, plan.error, last);
			if (plan.gi.method != SCENE_GI_NONE) {
				assert_true(plan.within == (plan.update_ms <= (double)wanted.budget_ms));
				assert_true(plan.update_ms > 0 && isfinite(plan.update_ms));
			}
			assert_true(strlen(plan.why) > 0 && strlen(plan.why) < sizeof plan.why - 1);
			last = plan.error;
		}
	}
}

/* What the plan says must be what a scene file may say. */
static void settings_are_in_range(void **state)
{
	struct unit_random r = unit_random_start("settings_are_in_range");

	(void)state;
	for (int round = 0; round < 500; round++) {
		const struct gi_facts facts = any_facts(&r);
		struct gi_plan plan = plan_for(&facts, pow(10, unit_random_range(&r, -1, 4)));

		assert_in_range(plan.gi.lattice, 8, 128);
		assert_in_range(plan.gi.steps, 1, 128);
		assert_in_range(plan.gi.links, 16, 4096);
		assert_in_range(plan.gi.gathers, 1, 16);
		assert_in_range(plan.gi.taps, 16, 64);
		assert_in_range(plan.gi.probes, 1, 64);
		assert_true(plan.gi.spacing_m >= 0 && plan.gi.spacing_m <= 1000);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(method_follows_the_scene),
		cmocka_unit_test(nothing_to_light),
		cmocka_unit_test(counts_are_near),
		cmocka_unit_test(words),
		cmocka_unit_test(edges_count),
		cmocka_unit_test(as_baked),
		cmocka_unit_test(air_that_absorbs),
		cmocka_unit_test(air_that_scatters),
		cmocka_unit_test(what_is_missing_chooses_no_settings),
		cmocka_unit_test(advice_fits),
		cmocka_unit_test(advice_after_the_bake),
		cmocka_unit_test(absurd_wishes),
		cmocka_unit_test(costs_that_are_none),
		cmocka_unit_test(more_budget_is_never_worse),
		cmocka_unit_test(settings_are_in_range),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
