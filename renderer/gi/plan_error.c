/*
 * How far each method's light is from the truth: fitted to the bench's scenes
 * (the Cornell box's spot and mirror, the box open and closed, the grotto,
 * Sponza's building), each of equal weight, by the logarithm of
 * measured over fitted:
 *   grotto bench --fit SCENE... (docs/bench.md has the settings and the spread)
 * Scenes differ more than settings do: in the Cornell box most light comes from
 * one small bright place, the boxes are lit evenly. So a fit says how settings
 * compare, and its spread how far a scene may be from it.
 */
#include "renderer/gi/plan_private.h"

#include <math.h>

/* Surfels: what no setting takes away, what their spacing and their links do. */
#define SURFEL_FLOOR 0.01
#define SURFEL_SPACING 0.8 /* per spacing over the side of a cube of the scene's area */
#define SURFEL_EDGES 0.089  /* per surfel that edges and pieces add, over those of its area */
#define SURFEL_LINKS 0.22   /* over the root of their number */
/* A lamp that moves: taps are points of a patch, bounces come a gather at a time. */
#define SURFEL_TAPS 0.02    /* over the root of their number */
#define SURFEL_LAG 0.01     /* over the number of gathers */
/* Probes: of a cell as of a spacing; their directions are few. */
#define PROBE_FLOOR 0.11
#define PROBE_CELL 0.75
#define PROBE_EDGES 0.062
/* Lattices: two bands carry no beams, whatever the cells. */
#define LATTICE_FLOOR 0.166
#define LATTICE_COARSE 1.3 /* over the cells along the longest side */
#define LATTICE_LAG 0.1 /* over the number of steps, a lamp moving */
/* Mirrors, for what knows none: over their share of the area. */
#define MIRROR_MISSED 2.7
/* An environment, for what knows none, beside other light: how bright either is is not known. */
#define ENVIRONMENT_SHARE 0.5

static double square(double v)
{
	return v * v;
}

/* Side of the cube that has as much surface. */
static double side_of(const struct gi_facts *facts)
{
	return sqrt(facts->area_m2 / 6);
}

/* As surfels a length would stand along edges over those on areas, of one side. */
static double crowding(const struct gi_facts *facts, double length)
{
	return length * (facts->edge_surfels_m + length * facts->piece_surfels) /
	       (SURFEL_DENSITY * facts->area_m2);
}

static double surfel_error(const struct gi_facts *facts, const struct scene_gi *gi)
{
	double spacing = gi_plan_spacing(facts, gi);
	double sum = square(SURFEL_FLOOR) + square(SURFEL_SPACING * spacing / side_of(facts)) +
		     square(SURFEL_EDGES * crowding(facts, spacing)) + square(SURFEL_LINKS) / gi->links;

	if (facts->lamps_moving > 0)
		sum += square(SURFEL_TAPS) / gi->taps + square(SURFEL_LAG / gi->gathers);
	return sqrt(sum);
}

static double probe_error(const struct gi_facts *facts, const struct scene_gi *gi)
{
	double cell = fmax(fmax(facts->size_m[0], facts->size_m[1]), facts->size_m[2]) / gi->probes;

	return sqrt(square(surfel_error(facts, gi)) + square(PROBE_FLOOR) +
		    square(PROBE_CELL * cell / side_of(facts)) + square(PROBE_EDGES * crowding(facts, cell)));
}

static double lattice_error(const struct gi_facts *facts, const struct scene_gi *gi)
{
	double sum = square(LATTICE_FLOOR + LATTICE_COARSE / gi->lattice);

	if (facts->lamps_moving > 0)
		sum += square(LATTICE_LAG / gi->steps);
	return sqrt(sum);
}

/* The mean chord of a convex room is 4 V / S (Cauchy); what stands in it shortens the way. */
double gi_plan_scattered(const struct gi_facts *facts)
{
	double volume = facts->size_m[0] * facts->size_m[1] * facts->size_m[2];

	if (!(facts->scattering_per_m > 0))
		return 0;
	return -expm1(-facts->scattering_per_m * 4 * volume / facts->area_m2);
}

double gi_plan_error_missing(const struct gi_facts *facts, enum scene_gi_method method)
{
	bool others = facts->lamps_fixed + facts->lamps_moving > 0 || facts->emissive_triangles > 0;
	double environment = facts->environment ? (others ? ENVIRONMENT_SHARE : 1) : 0;

	switch (method) {
	case SCENE_GI_LPV: return sqrt(square(MIRROR_MISSED * facts->mirror_share) + square(environment));
	case SCENE_GI_SURFELS:
	case SCENE_GI_PROBES: return gi_plan_scattered(facts);
	case SCENE_GI_NONE:
	case SCENE_GI_AUTO: break;
	}
	/* all of the indirect light */
	return 1;
}

double gi_plan_error_settings(const struct gi_facts *facts, const struct scene_gi *gi)
{
	switch (gi->method) {
	case SCENE_GI_LPV: return lattice_error(facts, gi);
	case SCENE_GI_SURFELS: return surfel_error(facts, gi);
	case SCENE_GI_PROBES: return probe_error(facts, gi);
	case SCENE_GI_NONE:
	case SCENE_GI_AUTO: break;
	}
	return 0;
}

/* Between which factors the bench's cases lie about the fit. */
void gi_plan_spread(enum scene_gi_method method, double *out_under, double *out_over)
{
	static const double spread[][2] = {
		[SCENE_GI_NONE] = { 1, 1 },	  [SCENE_GI_LPV] = { 1.6, 2.4 },
		[SCENE_GI_SURFELS] = { 2.9, 2.2 }, [SCENE_GI_PROBES] = { 2, 2 },
		[SCENE_GI_AUTO] = { 1, 1 },
	};

	*out_under = spread[method][0];
	*out_over = spread[method][1];
}

double gi_plan_error(const struct gi_facts *facts, const struct scene_gi *gi)
{
	return sqrt(square(gi_plan_error_settings(facts, gi)) +
		    square(gi_plan_error_missing(facts, gi->method)));
}
