/*
 * How far each method's light is from the truth, fitted to the hardest of the
 * bench's rooms (Cornell's spot: most of its light comes from one small bright
 * place), with its mirror for what mirrors cost:
 *   grotto bench --fit scenes/cornell-spot.scene scenes/cornell-mirror.scene
 * In the box the errors are about half (docs/results.md).
 */
#include "renderer/gi/plan.h"

#include <math.h>

/* Surfels: what no setting takes away, what their spacing and their links do. */
#define SURFEL_FLOOR 0.017
#define SURFEL_SPACING 1.07 /* per spacing over the side of a cube of the scene's area */
#define SURFEL_LINKS 0.25   /* over the root of their number */
/* A lamp that moves: taps are points of a patch, bounces come a gather at a time. */
#define SURFEL_TAPS 0.02    /* over the root of their number */
#define SURFEL_LAG 0.01     /* over the number of gathers */
/* Probes: of a cell over the same side; their directions are few. */
#define PROBE_FLOOR 0.08
#define PROBE_CELL 1.42
/* Lattices: two bands carry no beams, whatever the cells; finer ones carry less far. */
#define LATTICE_FLOOR 0.18
#define LATTICE_FINE 0.0097 /* a cell along the longest side */
#define LATTICE_COARSE 1.0 /* over their number */
#define LATTICE_LAG 0.1 /* over the number of steps, a lamp moving */
/* Mirrors, for what knows none: over their share of the area. */
#define MIRROR_MISSED 2.7

static double square(double v)
{
	return v * v;
}

/* Side of the cube that has as much surface. */
static double side_of(const struct gi_facts *facts)
{
	return sqrt(facts->area_m2 / 6);
}

static double surfel_error(const struct gi_facts *facts, const struct scene_gi *gi)
{
	double sum = square(SURFEL_FLOOR) + square(SURFEL_SPACING * (double)gi->spacing_m / side_of(facts)) +
		     square(SURFEL_LINKS) / gi->links;

	if (facts->lamps_moving > 0)
		sum += square(SURFEL_TAPS) / gi->taps + square(SURFEL_LAG / gi->gathers);
	return sqrt(sum);
}

static double probe_error(const struct gi_facts *facts, const struct scene_gi *gi)
{
	double longest = fmax(fmax(facts->size_m[0], facts->size_m[1]), facts->size_m[2]);

	return sqrt(square(surfel_error(facts, gi)) + square(PROBE_FLOOR) +
		    square(PROBE_CELL * longest / gi->probes / side_of(facts)));
}

static double lattice_error(const struct gi_facts *facts, const struct scene_gi *gi)
{
	double still = LATTICE_FLOOR + LATTICE_FINE * gi->lattice + LATTICE_COARSE / gi->lattice;
	double sum = square(still) + square(MIRROR_MISSED * facts->mirror_share);

	if (facts->lamps_moving > 0)
		sum += square(LATTICE_LAG / gi->steps);
	if (facts->environment)
		sum += 1;
	return sqrt(sum);
}

double gi_plan_error(const struct gi_facts *facts, const struct scene_gi *gi)
{
	switch (gi->method) {
	case SCENE_GI_LPV: return lattice_error(facts, gi);
	case SCENE_GI_SURFELS: return surfel_error(facts, gi);
	case SCENE_GI_PROBES: return probe_error(facts, gi);
	case SCENE_GI_NONE:
	case SCENE_GI_AUTO: break;
	}
	/* all of the indirect light is missing */
	return 1;
}
