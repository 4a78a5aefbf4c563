/* What the planner's files share. */
#ifndef GROTTO_RENDERER_GI_PLAN_PRIVATE_H
#define GROTTO_RENDERER_GI_PLAN_PRIVATE_H

#include "renderer/gi/plan.h"

/* Surfels on a surface: of surfel_bake.c, Poisson discs that leave no gap. */
#define SURFEL_DENSITY 0.7

/* What a plan may bake: about half a minute on two cores. */
#define PLAN_RAYS_MOST 2.4e7
#define PLAN_SURFELS_MOST 100000.0

/*
 * gi_plan_error is the root of the sum of the squares of two parts: what settings
 * change, and what a method leaves out whatever its settings. Settings are
 * chosen by the first, or the second would make all of them alike.
 */
double gi_plan_error_settings(const struct gi_facts *facts, const struct scene_gi *gi);
double gi_plan_error_missing(const struct gi_facts *facts, enum scene_gi_method method);
/* Of the light that crosses the scene, the share that its air scatters on the way, 0..1. */
double gi_plan_scattered(const struct gi_facts *facts);
bool gi_plan_has_light(const struct gi_facts *facts);
/* Metres; the baker's own where the settings name none. */
double gi_plan_spacing(const struct gi_facts *facts, const struct scene_gi *gi);
/* Cells (or probes) of a grid with so many along the longest side. */
double gi_plan_grid_cells(const struct gi_facts *facts, int longest);
/* gi_plan_cost_ms with so many surfels. */
double gi_plan_cost_of(const struct gi_facts *facts, const struct scene_gi *gi,
		       const struct gi_costs *costs, double surfels);
/* Whether a lattice may be chosen: it knows neither an environment nor what moves. */
bool gi_plan_lattices_serve(const struct gi_facts *facts, const struct scene_gi *wanted);
/* All else of a plan, from its settings, by the models. */
void gi_plan_expect(struct gi_plan *plan, const struct gi_facts *facts, const struct gi_costs *costs);
/* why, from all else. */
void gi_plan_say(struct gi_plan *plan, const struct gi_facts *facts);

#endif
