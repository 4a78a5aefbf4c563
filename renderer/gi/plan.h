/*
 * gi.method = "auto": which method computes a scene's indirect light, with what
 * settings, from what the scene holds and what a frame may cost. A pure
 * function: equal facts, wishes and costs give equal plans on every machine.
 *
 * Costs are measured on the GPU (calibrate.h), errors are fitted to the bench
 * (plan_error.c). Of each method what is chosen errs least of all that fits the
 * budget, of what errs alike (within GI_PLAN_ALIKE) the cheapest; of methods,
 * which errs least with all that it leaves out. So a larger budget never gives a
 * larger error.
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
	bool moving_geometry; /* things that move; models of this version are loaded without their animations */
	/* What is more than on an area alone, 0 when it was not looked for: */
	double edge_surfels_m; /* along edges: surfels times metres of spacing */
	double piece_surfels;  /* of pieces that have one whatever the spacing */
};
/* Never fails; a scene without triangles has area 0. */
void gi_facts_take(struct gi_facts *out, const struct scene *scene, const struct scene_file *file);
/*
 * Finds edge_surfels_m and piece_surfels: surfels are placed twice, coarsely
 * (surfel_count.h). Of the scene alone, whatever was baked before: all nodes
 * find the same. Some tenths of a second, and twice what Embree takes for the
 * scene. GR_OK; as surfel_count, facts unchanged.
 */
int gi_facts_count(struct gi_facts *facts, const struct scene *scene);

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

#define GI_PLAN_TEXT 160 /* room for settings in words */
struct gi_plan {
	struct scene_gi gi; /* never SCENE_GI_AUTO; its budget_ms as wanted */
	double update_ms;   /* expected, of a frame in which the light changes; 0 when steady */
	double error;       /* expected nRMSE of irradiance on surfaces; a share */
	double error_least, error_most; /* between which scenes like the bench's lie */
	double surfels;     /* expected, or as baked; 0: none */
	bool baked;         /* surfels is what was baked */
	bool adopted;       /* another node's choice: it may cost more than the budget here */
	bool within;        /* the budget; false: this is the least that there is */
	uint64_t code;      /* of what shapes the light: equal exactly when walls would agree; never 0 */
	char why[720];      /* for the log */
};
/*
 * wanted: what the scene file says; its budget, and the settings that are no
 * question of time, stay. A budget that is no number counts as none.
 */
void gi_plan_make(struct gi_plan *out, const struct gi_facts *facts, const struct scene_gi *wanted,
		  const struct gi_costs *costs);
/* Costs are measured to about this factor: by less a budget is not exceeded. */
#define GI_PLAN_LEEWAY 1.1
/*
 * Once the surfels are there: cost and text by their real number. What is
 * baked stays, so that nodes cannot differ by what each had baked before. False:
 * it costs more than the budget by GI_PLAN_LEEWAY; *out_right: the plan that
 * this number would have led to.
 */
bool gi_plan_baked(struct gi_plan *plan, const struct gi_facts *facts, const struct gi_costs *costs,
		   size_t surfels, struct gi_plan *out_right);
/*
 * The plan of another node with the same scene, by its code: what it costs
 * on this GPU. From outside: false, *out unchanged and *out_why a constant when
 * it is none, or none that a node would have chosen for these facts (wanted: as
 * for gi_plan_make).
 */
bool gi_plan_adopt(struct gi_plan *out, const struct gi_facts *facts, const struct scene_gi *wanted,
		   const struct gi_costs *costs, uint64_t code, const char **out_why);
/* A scene file's least. */
#define GI_PLAN_BUDGET_LEAST 0.1
/* The budget to write for what costs so much (above 0): two digits, rounded up. Milliseconds. */
double gi_plan_budget_for(double ms);
/* Settings in words, as "surfels 0.2 m apart, 256 links, 1 gather, 16 taps". */
void gi_plan_settings(char *text, size_t size, const struct scene_gi *gi);
/* Whether there is anything to choose by cost. */
bool gi_plan_needs_costs(const struct gi_facts *facts);
/* What settings cost and how they err, by the same models. ms of a frame; a share. */
double gi_plan_cost_ms(const struct gi_facts *facts, const struct scene_gi *gi,
		       const struct gi_costs *costs);
double gi_plan_error(const struct gi_facts *facts, const struct scene_gi *gi);
/* The factors over and under it within which the bench's scenes lie; >= 1. */
void gi_plan_spread(enum scene_gi_method method, double *out_under, double *out_over);
/* About how many surfels settings give. */
double gi_plan_surfels(const struct gi_facts *facts, const struct scene_gi *gi);
/*
 * What shapes the light in a plan's settings, as one number that nodes compare
 * and tell. From the lowest bit: 3 method; then for lpv 1 mode, 8 lattice,
 * 8 steps, 12 rsm_pixels, 13 link_rays; for surfels and probes 7 two digits of
 * the spacing in metres, 5 their power of ten plus 16 (both 0: usual), 13 links,
 * 5 gathers, 7 taps, 7 probes (0 without).
 */
uint64_t gi_plan_code(const struct scene_gi *gi);
/* The settings again; others of *out stay. False, *out unchanged: what no plan would be. From outside. */
bool gi_plan_decode(uint64_t code, struct scene_gi *out);

#endif
