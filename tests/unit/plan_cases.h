/* Rooms and wishes that the planner's tests share. */
#ifndef GROTTO_TESTS_PLAN_CASES_H
#define GROTTO_TESTS_PLAN_CASES_H

#include "tests/unit/unit.h"

#include "renderer/gi/plan.h"

/* A room like the Cornell box with one lamp that is carried about. */
static inline struct gi_facts room(void)
{
	return (struct gi_facts){ .area_m2 = 200, .size_m = { 5.5, 5.5, 5.6 }, .triangles = 40,
				  .lamps_moving = 1 };
}

static inline struct scene_gi wish(double budget_ms)
{
	return (struct scene_gi){ .method = SCENE_GI_AUTO, .budget_ms = (float)budget_ms, .lattice = 32,
				  .steps = 8, .rsm_pixels = 128, .link_rays = 32, .links = 256,
				  .gathers = 1, .taps = 16, .probes = 8 };
}

static inline struct gi_plan plan_for(const struct gi_facts *facts, double budget_ms)
{
	const struct scene_gi wanted = wish(budget_ms);
	struct gi_plan plan;

	gi_plan_make(&plan, facts, &wanted, &gi_costs_usual);
	return plan;
}

static inline struct gi_facts any_facts(struct unit_random *r)
{
	struct gi_facts facts = { 0 };
	double size = pow(10, unit_random_range(r, -3, 4));

	for (int i = 0; i < 3; i++)
		facts.size_m[i] = size * unit_random_range(r, 0.01, 1);
	facts.area_m2 = size * size * unit_random_range(r, 0.1, 20);
	facts.triangles = unit_random_u32(r) % 2000000;
	facts.emissive_triangles = unit_random_u32(r) % 3;
	facts.lamps_fixed = (int)(unit_random_u32(r) % 3);
	facts.lamps_moving = (int)(unit_random_u32(r) % 3);
	facts.scattering_per_m = unit_random_u32(r) % 4 ? 0 : pow(10, unit_random_range(r, -6, 2));
	facts.environment = unit_random_u32(r) % 3 == 0;
	facts.mirror_share = unit_random_u32(r) % 2 ? 0 : unit_random_range(r, 0, 1);
	facts.moving_geometry = unit_random_u32(r) % 5 == 0;
	facts.absorption_per_m = unit_random_u32(r) % 3 ? 0 : pow(10, unit_random_range(r, -3, 1));
	facts.piece_surfels = unit_random_u32(r) % 2 ? 0 : pow(10, unit_random_range(r, 0, 6));
	facts.edge_surfels_m = unit_random_u32(r) % 2 ? 0 : size * pow(10, unit_random_range(r, 0, 4));
	return facts;
}

#endif
