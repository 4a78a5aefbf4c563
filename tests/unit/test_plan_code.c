/* A plan as a code that nodes of a room exchange: read again, adopted, or refused. */
#include "tests/unit/plan_cases.h"

static void code_is_of_what_shapes_the_light(void **state)
{
	struct scene_gi a = wish(8), b;

	(void)state;
	a.method = SCENE_GI_SURFELS;
	b = a;
	b.budget_ms = 3;
	b.lattice = 48;
	assert_int_equal(gi_plan_code(&a), gi_plan_code(&b));
	b.links = 255;
	assert_int_not_equal(gi_plan_code(&a), gi_plan_code(&b));
	b = a;
	b.spacing_m = 0.25f;
	assert_int_not_equal(gi_plan_code(&a), gi_plan_code(&b));
	a.method = b.method = SCENE_GI_LPV;
	assert_int_equal(gi_plan_code(&a), gi_plan_code(&b));
	b.steps++;
	assert_int_not_equal(gi_plan_code(&a), gi_plan_code(&b));
	assert_int_not_equal(gi_plan_code(&a), 0);
}

/* What was coded is what comes out; what no plan would be is refused, and changes nothing. */
static void codes_are_read_again(void **state)
{
	struct unit_random r = unit_random_start("codes_are_read_again");
	size_t refused = 0;

	(void)state;
	for (int round = 0; round < 500; round++) {
		const struct gi_facts facts = any_facts(&r);
		const struct gi_plan plan = plan_for(&facts, pow(10, unit_random_range(&r, -1, 4)));
		struct scene_gi gi = wish(8);
		char said[GI_PLAN_TEXT], read[GI_PLAN_TEXT];

		assert_true(gi_plan_decode(plan.code, &gi));
		assert_int_equal(gi_plan_code(&gi), plan.code);
		gi_plan_settings(said, sizeof said, &plan.gi);
		gi_plan_settings(read, sizeof read, &gi);
		assert_string_equal(said, read);
	}
	for (int round = 0; round < 200000; round++) {
		const struct scene_gi before = wish(8);
		struct scene_gi gi = before;
		uint64_t code = (uint64_t)unit_random_u32(&r) << 32 | unit_random_u32(&r);

		code >>= unit_random_u32(&r) % 64;
		if (gi_plan_decode(code, &gi)) {
			assert_int_equal(gi_plan_code(&gi), code);
			continue;
		}
		assert_memory_equal(&gi, &before, sizeof gi);
		refused++;
	}
	assert_true(refused > 1000);
}

/* Costs of a GPU, by which one node of a room may differ from another. */
static struct gi_costs any_costs(struct unit_random *r)
{
	struct gi_costs costs = gi_costs_usual;

	costs.lattice_frame *= pow(10, unit_random_range(r, -2, 1));
	costs.lattice_cell_step *= pow(10, unit_random_range(r, -2, 1));
	costs.surfel_frame *= pow(10, unit_random_range(r, -2, 1));
	costs.surfel_tap *= pow(10, unit_random_range(r, -2, 1));
	costs.surfel_link *= pow(10, unit_random_range(r, -2, 1));
	return costs;
}

/* Any node's plan can be every node's: the same settings, at the cost that they have here. */
static void plans_are_adopted(void **state)
{
	struct unit_random r = unit_random_start("plans_are_adopted");
	size_t differ = 0, over = 0;

	(void)state;
	for (int round = 0; round < 300; round++) {
		const struct gi_facts facts = any_facts(&r);
		const struct scene_gi wanted = wish(pow(10, unit_random_range(&r, 0, 3)));
		const struct gi_costs ours = any_costs(&r), theirs = any_costs(&r);
		struct gi_plan own, room_plan, adopted;
		const char *why = "";

		gi_plan_make(&own, &facts, &wanted, &ours);
		gi_plan_make(&room_plan, &facts, &wanted, &theirs);
		if (!gi_plan_adopt(&adopted, &facts, &wanted, &ours, room_plan.code, &why))
			fail_msg("refused: %s (%s)", why, room_plan.why);
		assert_int_equal(adopted.code, room_plan.code);
		assert_true(fabs(adopted.error - room_plan.error) <= 1e-6 * room_plan.error);
		assert_true(fabs(adopted.update_ms - gi_plan_cost_ms(&facts, &adopted.gi, &ours)) <=
			    1e-9 * adopted.update_ms);
		assert_true(adopted.gi.share == room_plan.gi.share && adopted.adopted && !adopted.baked);
		assert_int_equal(adopted.within, adopted.update_ms <= (double)wanted.budget_ms);
		over += !adopted.within && room_plan.within;
		assert_true(adopted.within || strstr(adopted.why, "it is the room's plan"));
		differ += own.code != room_plan.code;
	}
	printf("# of 300 pairs of nodes %zu plan differently, %zu adopt what exceeds their budget\n", differ, over);
	assert_true(differ > 50 && over > 10);
}

static void refuse_adoption(const struct gi_facts *facts, const struct scene_gi *wanted, uint64_t code,
			    const char *expected)
{
	const struct gi_plan before = { .update_ms = 3, .why = "as before" };
	struct gi_plan plan = before;
	const char *why = NULL;

	assert_false(gi_plan_adopt(&plan, facts, wanted, &gi_costs_usual, code, &why));
	assert_non_null(why);
	if (!strstr(why, expected))
		fail_msg("'%s' is not '%s'", why, expected);
	assert_memory_equal(&plan, &before, sizeof plan);
}

/* A code is from outside: what no node with this scene would choose is not baked. */
static void hostile_plans(void **state)
{
	const struct gi_facts facts = room(), dark = { .area_m2 = 200, .size_m = { 5, 5, 5 } };
	struct scene_gi wanted = wish(20), gi = wanted;
	struct gi_facts still = facts;

	(void)state;
	refuse_adoption(&facts, &wanted, 0, "none that this version knows");
	refuse_adoption(&facts, &wanted, UINT64_MAX, "none that this version knows");
	gi.method = SCENE_GI_SURFELS;
	gi.spacing_m = 0.01f;
	refuse_adoption(&facts, &wanted, gi_plan_code(&gi), "more surfels or links");
	gi.spacing_m = 1e-9f;
	refuse_adoption(&facts, &wanted, gi_plan_code(&gi), "more surfels or links");
	gi.spacing_m = 0.1f;
	gi.links = 4096;
	refuse_adoption(&facts, &wanted, gi_plan_code(&gi), "more surfels or links");
	gi.links = 256;
	refuse_adoption(&dark, &wanted, gi_plan_code(&gi), "light that this scene does not have");
	gi.method = SCENE_GI_PROBES;
	refuse_adoption(&facts, &wanted, gi_plan_code(&gi), "nothing does");
	gi.method = SCENE_GI_NONE;
	refuse_adoption(&facts, &wanted, gi_plan_code(&gi), "leaves out the light");
	still.environment = true;
	gi.method = SCENE_GI_LPV;
	refuse_adoption(&still, &wanted, gi_plan_code(&gi), "no lattice serves");
	wanted.method = SCENE_GI_SURFELS;
	refuse_adoption(&facts, &wanted, plan_for(&facts, 20).code, "the scene file names its method");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(code_is_of_what_shapes_the_light),
		cmocka_unit_test(codes_are_read_again),
		cmocka_unit_test(plans_are_adopted),
		cmocka_unit_test(hostile_plans),
	};
	return cmocka_run_group_tests_name("plan_code", tests, NULL, NULL);
}
