#include "renderer/gi/plan.h"

#include "renderer/gi/plan_private.h"

#include <math.h>

#define SPACING_MOST 1000.0
#define PLAN_TAPS 64 /* with fewer the edge of a moving shadow flickers (docs/results.md) */

static const double surfel_counts[] = { 250, 500, 1000, 2000, 4000, 8000, 16000, 32000, 64000 };
static const int link_counts[] = { 256, 512, 1024 }; /* fewer show as blotches */
static const int gather_counts[] = { 1, 2, 4 };
static const int probe_counts[] = { 4, 8, 12, 16, 24, 32 };
static const int lattice_counts[] = { 8, 12, 16, 20, 24, 32, 48, 64 };
static const int step_counts[] = { 2, 4, 8, 16 };
#define COUNT(array) (sizeof(array) / sizeof *(array))

/* That gives so many, as far as a spacing can. */
static double exact_spacing(const struct gi_facts *facts, double count)
{
	double edge = facts->edge_surfels_m, left = fmax(count - facts->piece_surfels, count / 16);

	return (edge + sqrt(edge * edge + 4 * left * SURFEL_DENSITY * facts->area_m2)) / (2 * left);
}

struct search {
	const struct gi_facts *facts;
	const struct gi_costs *costs;
	double budget_ms;
	struct scene_gi best;
	double cost, error; /* of best; the error is the part that settings change */
	bool any, within;
};

static double kind_of(double error)
{
	return floor(log(error) / log(GI_PLAN_ALIKE));
}

/* Fits before does not fit; then the smaller error, of alike ones the cheaper. */
static bool better(const struct search *s, double cost, double error, bool within)
{
	if (!s->any || within != s->within)
		return !s->any || within;
	if (!within)
		return cost < s->cost;
	if (kind_of(error) < kind_of(s->error) || kind_of(error) > kind_of(s->error))
		return error < s->error;
	return cost < s->cost;
}

static void consider(struct search *s, const struct scene_gi *gi)
{
	double cost = gi_plan_cost_ms(s->facts, gi, s->costs), error = gi_plan_error_settings(s->facts, gi);
	bool within = cost <= s->budget_ms;

	if (!isfinite(cost) || !isfinite(gi_plan_error(s->facts, gi)) ||
	    !better(s, cost, error, within))
		return;
	s->best = *gi;
	s->cost = cost;
	s->error = error;
	s->within = within;
	s->any = true;
}

static void consider_lattices(struct search *s, struct scene_gi gi)
{
	gi.method = SCENE_GI_LPV;
	gi.lpv_mode = SCENE_LPV_REPAIRED;
	gi.share = SCENE_SHARE_LOCAL; /* a lattice is not shared out */
	for (size_t i = 0; i < COUNT(lattice_counts); i++) {
		for (size_t k = 0; k < COUNT(step_counts); k++) {
			gi.lattice = lattice_counts[i];
			gi.steps = step_counts[k];
			consider(s, &gi);
		}
	}
}

/* Two digits: what a person would write; at most what a scene file may say. */
static float spacing_for(const struct gi_facts *facts, double count)
{
	double spacing = fmin(exact_spacing(facts, count), SPACING_MOST);
	double power = pow(10, floor(log10(spacing)) - 1);

	return (float)(round(spacing / power) * power);
}

static void consider_probes(struct search *s, struct scene_gi gi)
{
	gi.method = SCENE_GI_PROBES;
	for (size_t i = 0; i < COUNT(probe_counts); i++) {
		gi.probes = probe_counts[i];
		if (gi_plan_grid_cells(s->facts, gi.probes) * gi.links <= PLAN_RAYS_MOST)
			consider(s, &gi);
	}
}

static void consider_surfels(struct search *s, struct scene_gi gi, bool probes)
{
	gi.method = SCENE_GI_SURFELS;
	for (size_t n = 0; n < COUNT(surfel_counts); n++) {
		gi.spacing_m = spacing_for(s->facts, surfel_counts[n]);
		for (size_t l = 0; l < COUNT(link_counts); l++) {
			gi.links = link_counts[l];
			if (gi_plan_surfels(s->facts, &gi) > PLAN_SURFELS_MOST ||
			    gi_plan_surfels(s->facts, &gi) * gi.links > PLAN_RAYS_MOST)
				continue;
			for (size_t k = 0; k < COUNT(gather_counts); k++) {
				gi.gathers = gather_counts[k];
				gi.taps = PLAN_TAPS;
				if (probes)
					consider_probes(s, gi);
				else
					consider(s, &gi);
			}
		}
	}
}

/* With an environment, or with what moves, it is for air alone. */
bool gi_plan_lattices_serve(const struct gi_facts *facts, const struct scene_gi *wanted)
{
	if (facts->scattering_per_m > 0)
		return true;
	return !facts->environment && !facts->moving_geometry && wanted->share == SCENE_SHARE_LOCAL;
}

/*
 * Two methods, each with its best settings, by all that they err. No leeway
 * here: with it a larger budget could give a larger error.
 */
static const struct search *better_of(const struct search *a, const struct search *b)
{
	double error[2];

	if (!a->any || !b->any)
		return a->any ? a : b;
	if (a->within != b->within)
		return a->within ? a : b;
	error[0] = gi_plan_error(a->facts, &a->best);
	error[1] = gi_plan_error(b->facts, &b->best);
	if (!a->within || !(error[0] < error[1] || error[0] > error[1]))
		return a->cost <= b->cost ? a : b;
	return error[0] < error[1] ? a : b;
}

bool gi_plan_has_light(const struct gi_facts *facts)
{
	return facts->lamps_fixed + facts->lamps_moving > 0 || facts->emissive_triangles > 0 ||
	       facts->environment;
}

bool gi_plan_needs_costs(const struct gi_facts *facts)
{
	return gi_plan_has_light(facts) && isfinite(facts->area_m2) && facts->area_m2 > 0;
}

/* All that follows from the settings. */
static void complete(struct gi_plan *plan, const struct gi_facts *facts)
{
	double under, over;

	gi_plan_spread(plan->gi.method, &under, &over);
	plan->error_least = plan->error / under;
	plan->error_most = plan->error * over;
	plan->code = gi_plan_code(&plan->gi);
	gi_plan_say(plan, facts);
}

void gi_plan_expect(struct gi_plan *plan, const struct gi_facts *facts, const struct gi_costs *costs)
{
	if (plan->gi.method == SCENE_GI_NONE) {
		plan->within = true;
		plan->error = gi_plan_has_light(facts);
	} else {
		plan->update_ms = gi_plan_cost_ms(facts, &plan->gi, costs);
		plan->within = plan->update_ms <= (double)plan->gi.budget_ms;
		plan->error = gi_plan_error(facts, &plan->gi);
	}
	if (plan->gi.method == SCENE_GI_SURFELS || plan->gi.method == SCENE_GI_PROBES)
		plan->surfels = gi_plan_surfels(facts, &plan->gi);
	complete(plan, facts);
}

double gi_plan_budget_for(double ms)
{
	double power = pow(10, floor(log10(ms)) - 1);

	/* a scene file's budget is a float: not below by its rounding */
	return fmax(GI_PLAN_BUDGET_LEAST, ceil(ms / power * (1 + 1e-6)) * power);
}

void gi_plan_make(struct gi_plan *out, const struct gi_facts *facts, const struct scene_gi *wanted,
		  const struct gi_costs *costs)
{
	/* a NaN fits nothing */
	const double budget = wanted->budget_ms > 0 ? (double)wanted->budget_ms : 0;
	struct search surfels = { .facts = facts, .budget_ms = budget,
				  .costs = gi_costs_valid(costs) ? costs : &gi_costs_usual };
	struct search lattices = surfels;
	const struct search *s;

	if (gi_plan_needs_costs(facts)) {
		consider_surfels(&surfels, *wanted, facts->moving_geometry);
		if (gi_plan_lattices_serve(facts, wanted))
			consider_lattices(&lattices, *wanted);
	}
	s = better_of(&surfels, &lattices);
	*out = (struct gi_plan){ .gi = s->any ? s->best : *wanted };
	if (!s->any)
		out->gi.method = SCENE_GI_NONE;
	gi_plan_expect(out, facts, s->costs);
}

bool gi_plan_baked(struct gi_plan *plan, const struct gi_facts *facts, const struct gi_costs *costs,
		   size_t surfels, struct gi_plan *out_right)
{
	const struct gi_costs *c = gi_costs_valid(costs) ? costs : &gi_costs_usual;
	double spacing = (double)plan->gi.spacing_m, budget = (double)plan->gi.budget_ms;
	struct gi_facts found = *facts;
	double flat = SURFEL_DENSITY * facts->area_m2 / (spacing * spacing) + facts->piece_surfels;

	plan->surfels = (double)surfels;
	plan->baked = true;
	plan->update_ms = gi_plan_cost_of(facts, &plan->gi, c, plan->surfels);
	plan->within = plan->update_ms <= budget;
	complete(plan, facts);
	found.edge_surfels_m = fmax(0, (plan->surfels - flat) * spacing);
	gi_plan_make(out_right, &found, &plan->gi, c);
	return !(plan->update_ms > GI_PLAN_LEEWAY * budget);
}
