/* What settings cost: units of work, each with a time of the GPU's. */
#include "renderer/gi/plan_private.h"

#include "renderer/gi/surfel_bake.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

const struct gi_costs gi_costs_usual = {
	.lattice_frame = 2e6,
	.lattice_cell_step = 180,
	.surfel_frame = 5e5,
	.surfel_tap = 25,
	.surfel_link = 1.5,
};

bool gi_costs_valid(const struct gi_costs *c)
{
	const double frames[] = { c->lattice_frame, c->surfel_frame };
	const double units[] = { c->lattice_cell_step, c->surfel_tap, c->surfel_link };

	for (size_t i = 0; i < COUNT(frames); i++)
		if (!(frames[i] >= 0 && frames[i] < 1e11))
			return false;
	for (size_t i = 0; i < COUNT(units); i++)
		if (!(units[i] > 0 && units[i] < 1e9))
			return false;
	return true;
}

double gi_plan_grid_cells(const struct gi_facts *facts, int longest)
{
	double most = fmax(fmax(facts->size_m[0], facts->size_m[1]), facts->size_m[2]);
	double cells = 1;

	for (int i = 0; i < 3 && most > 0; i++)
		cells *= fmax(1, ceil(facts->size_m[i] / most * longest));
	return cells;
}

double gi_plan_spacing(const struct gi_facts *facts, const struct scene_gi *gi)
{
	double spacing = (double)gi->spacing_m;

	return spacing > 0 ? spacing : sqrt(SURFEL_DENSITY * facts->area_m2 / SURFEL_USUAL);
}

double gi_plan_surfels(const struct gi_facts *facts, const struct scene_gi *gi)
{
	double spacing = gi_plan_spacing(facts, gi);

	return SURFEL_DENSITY * facts->area_m2 / (spacing * spacing) + facts->edge_surfels_m / spacing +
	       facts->piece_surfels;
}

double gi_plan_cost_of(const struct gi_facts *facts, const struct scene_gi *gi,
		       const struct gi_costs *c, double surfels)
{
	double lamps = facts->lamps_fixed + facts->lamps_moving, ns = 0;

	switch (gi->method) {
	case SCENE_GI_LPV:
		ns = c->lattice_frame + gi_plan_grid_cells(facts, gi->lattice) * gi->steps * c->lattice_cell_step;
		break;
	case SCENE_GI_SURFELS:
	case SCENE_GI_PROBES:
		ns = c->surfel_frame + surfels * gi->taps * lamps * c->surfel_tap +
		     surfels * gi->links * gi->gathers * c->surfel_link;
		if (gi->method == SCENE_GI_PROBES)
			ns += gi_plan_grid_cells(facts, gi->probes) * gi->links * c->surfel_link;
		break;
	case SCENE_GI_NONE:
	case SCENE_GI_AUTO:
		break;
	}
	return ns * 1e-6;
}

double gi_plan_cost_ms(const struct gi_facts *facts, const struct scene_gi *gi,
		       const struct gi_costs *costs)
{
	return gi_plan_cost_of(facts, gi, costs, gi_plan_surfels(facts, gi));
}
