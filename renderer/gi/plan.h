/*
 * gi.method = "auto": which method computes a scene's indirect light, with what
 * settings, from what the scene holds and what a frame may cost. A pure
 * function: equal facts, wishes and costs give equal plans on every machine.
 *
 * Costs are measured on the GPU (calibrate.h), errors come from the bench's
 * table (plan_error.c). What is chosen errs least of all that fits the budget;
 * of what errs alike (within GI_PLAN_ALIKE) the cheapest. So a larger budget
 * never gives a larger error.
 *
 * Thread safe.
 */
#ifndef GROTTO_RENDERER_GI_PLAN_H
#define GROTTO_RENDERER_GI_PLAN_H

#include "config/scene_file.h"
#include "renderer/scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

/* What of a scene decides. */
struct gi_facts {
	double area_m2;      /* of all sides that can be lit: fronts, and backs of what is two-sided */
	double size_m[3];    /* of the bounds */
	size_t triangles;
	size_t emissive_triangles;
	int lamps_fixed, lamps_moving; /* mount fixed; carried or on an orbit */
	double absorption_per_m, scattering_per_m;
	bool environment;    /* light from all around */
	double mirror_share; /* of the area that is mirror, conductor or highlight more than diffuse, 0..1 */
	bool moving_geometry; /* things that move; scene files of this version have none */
};
/* Never fails; a scene without triangles has area 0. */
void gi_facts_take(struct gi_facts *out, const struct scene *scene, const struct scene_file *file);

/* Time of a GPU for each unit of work, nanoseconds; docs/bench.md says how they are measured. */
struct gi_costs {
	double lattice_frame;     /* a frame of the lattice, whatever its size */
	double lattice_cell_step; /* a cell and step */
	double surfel_frame;      /* a frame of the surfels, whatever their number */
	double surfel_tap;        /* a look-up of a lamp's shadow, per surfel, tap and lamp */
	double surfel_link;       /* a link, per surfel (or probe), link and gather */
};
/* Of llvmpipe on two cores: where nothing can be measured, and for the tests. */
extern const struct gi_costs gi_costs_usual;
/* All finite, not negative, the three per unit above zero and below a second. */
bool gi_costs_valid(const struct gi_costs *costs);

/* Errors closer than this factor are alike. */
#define GI_PLAN_ALIKE 1.05

struct gi_plan {
	struct scene_gi gi; /* never SCENE_GI_AUTO */
	double update_ms;   /* expected, of a frame in which the light changes; 0 when steady */
	double error;       /* expected nRMSE of irradiance on surfaces; a share */
	bool within;        /* the budget; false: this is the least that there is */
	uint64_t hash;      /* of what shapes the light: equal exactly when walls would agree */
	char why[320];      /* for the log */
};
/*
 * wanted: what the scene file says; its budget, and the settings that are no
 * question of time, stay. A budget that is no number counts as none.
 */
void gi_plan_make(struct gi_plan *out, const struct gi_facts *facts, const struct scene_gi *wanted,
		  const struct gi_costs *costs);
/* Whether there is anything to choose by cost. */
bool gi_plan_needs_costs(const struct gi_facts *facts);
/* What settings cost and how they err, by the same models. ms of a frame; a share. */
double gi_plan_cost_ms(const struct gi_facts *facts, const struct scene_gi *gi,
		       const struct gi_costs *costs);
double gi_plan_error(const struct gi_facts *facts, const struct scene_gi *gi);
/* About how many surfels settings give. */
double gi_plan_surfels(const struct gi_facts *facts, const struct scene_gi *gi);
/* Of what shapes the light in settings, whether planned or written in a file. */
uint64_t gi_plan_hash(const struct scene_gi *gi);

#endif
