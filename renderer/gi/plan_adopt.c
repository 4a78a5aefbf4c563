/* Another node's plan, for the same scene on this node's GPU. */
#include "renderer/gi/plan_private.h"

#include <math.h>

/* Nodes may have counted the scene's surfels otherwise; a plan that is hostile is off by far more. */
#define LEEWAY 2.0

/* Why no node with this scene would have chosen these settings; NULL: one may have. */
static const char *never_chosen(const struct gi_facts *facts, const struct scene_gi *wanted,
				const struct scene_gi *gi)
{
	const double surfels = gi_plan_surfels(facts, gi);

	if (gi->method == SCENE_GI_NONE) {
		struct gi_plan own;

		/* whatever light costs: no settings can be had where this is so */
		gi_plan_make(&own, facts, wanted, &gi_costs_usual);
		return own.gi.method == SCENE_GI_NONE ? NULL : "it leaves out the light that this scene has";
	}
	if (!gi_plan_needs_costs(facts))
		return "it computes light that this scene does not have";
	if (gi->method == SCENE_GI_LPV)
		return gi_plan_lattices_serve(facts, wanted) ? NULL : "no lattice serves this scene";
	if ((gi->method == SCENE_GI_PROBES) != facts->moving_geometry)
		return facts->moving_geometry ? "surfels alone do not light what moves"
					      : "probes are for what moves, and nothing does";
	/* not (<=): what is no number is too many */
	if (!(surfels <= LEEWAY * PLAN_SURFELS_MOST && surfels * gi->links <= LEEWAY * PLAN_RAYS_MOST))
		return "it has more surfels or links than a plan may bake";
	if (gi->method == SCENE_GI_PROBES &&
	    !(gi_plan_grid_cells(facts, gi->probes) * gi->links <= LEEWAY * PLAN_RAYS_MOST))
		return "it has more probes than a plan may bake";
	return NULL;
}

bool gi_plan_adopt(struct gi_plan *out, const struct gi_facts *facts, const struct scene_gi *wanted,
		   const struct gi_costs *costs, uint64_t code, const char **out_why)
{
	struct gi_plan plan = { .gi = *wanted, .adopted = true };

	*out_why = "the scene file names its method";
	if (wanted->method != SCENE_GI_AUTO)
		return false;
	*out_why = "it is none that this version knows";
	if (!gi_plan_decode(code, &plan.gi))
		return false;
	*out_why = never_chosen(facts, wanted, &plan.gi);
	if (*out_why)
		return false;
	if (plan.gi.method == SCENE_GI_LPV)
		plan.gi.share = SCENE_SHARE_LOCAL;
	gi_plan_expect(&plan, facts, gi_costs_valid(costs) ? costs : &gi_costs_usual);
	*out = plan;
	return true;
}
