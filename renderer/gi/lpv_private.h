/*
 * Inside of the light propagation volumes: buffers and programs, for lpv*.c
 * and for tests that look into the light. GL thread only.
 */
#ifndef GROTTO_RENDERER_GI_LPV_PRIVATE_H
#define GROTTO_RENDERER_GI_LPV_PRIVATE_H

#include "renderer/gi/dispatch.h"
#include "renderer/gi/gi.h"
#include "renderer/gi/link.h"
#include "renderer/gi/sectors.h"

/* Storage and uniform buffer bindings. */
enum lpv_binding {
	LPV_BINDING_BLOCK = 8, /* uniform */
	LPV_BINDING_INJECT = 11, /* written */
	LPV_BINDING_LEAP = 11, /* lpv_leap: four */
	LPV_BINDING_EMITTED = 12,
	LPV_BINDING_NEXT = 13,
	LPV_BINDING_SPLAT = 14,
	LPV_BINDING_CHECK = 15,
	LPV_BINDING_NEW_LIGHT = 15,
};

/* Texture units; 8 to 11 are bound for shading and for the lamps' maps. */
enum lpv_unit {
	LPV_UNIT_LIGHT = 8,
	LPV_UNIT_SURFACE_OF = 9,
	LPV_UNIT_SURFACES = 10,
	LPV_UNIT_FRONTS = 11,
	LPV_UNIT_SENT = 11,
	LPV_UNIT_BEFORE = 11, /* lpv_check */
	LPV_UNIT_START_INJECT = 11, /* lpv_thesis_start */
	LPV_UNIT_EMITTED = 12,
	LPV_UNIT_WHOLE = 13, /* lpv_step */
	LPV_UNIT_BLOCKS = 12, /* lpv_reflect, with the next two */
	LPV_UNIT_INJECT = 13,
	LPV_UNIT_SURFACE_CELLS = 14,
	LPV_UNIT_MAPS = 13, /* lpv_splat: three */
};

/* A buffer that programs write as storage and read as a texture. */
struct lpv_buffer {
	unsigned buffer, texture;
};

/* LatticeBlock in shaders/lpv_lattice.glsl (std140). */
struct lattice_block {
	int32_t size[4];
	float origin[4];
	float sector_a[4], sector_b[4], sector_mu[4];
	float look[4];
	float point[4];
};

#define LPV_LIGHT_FLOATS 12 /* a cell in the light buffers: F, V of three bands */
#define LPV_SEGMENT 16	    /* layers of cells that an invocation walks up */
#define LPV_RING 4          /* frames until a check is read back */

struct lpv_check {
	uint32_t nonfinite, change, largest, bad_texels;
};

/* Seed 004's own scheme, for comparison (lpv_thesis.c). */
struct lpv_thesis {
	unsigned start, step, store; /* programs */
	unsigned images[7];	     /* red, green, blue twice; blockers */
	unsigned table;
	int newest;   /* 0 or 1: which three */
	float energy; /* of the last frame's lamps (section 3.4) */
	int steps;    /* of the last frame: it is lit by as many, another number is another light */
};

/* From darkness to the steady state (lpv_start.c). */
struct lpv_start {
	unsigned programs[3], oldest, sums;
	struct dispatch all;
};

struct lpv {
	struct gi_method base;
	bool is_thesis;
	struct lpv_thesis thesis;
	struct lattice lattice;
	struct sectors sectors;
	float point[3]; /* see struct links */
	float calibration;
	int settle_steps;
	char description[320];

	unsigned step, last_step, reflect, gather, splat_peak, splat_sum, splat_resolve, check; /* programs */
	unsigned block, splat, checks;
	struct lpv_buffer surface_of, fronts, surfaces, surface_cells, whole, inject, emitted, blocks;
	struct lpv_buffer light[2]; /* after the last step of a frame; light[current] is the newest */
	int current;
	struct lpv_buffer sent[2]; /* with a border of one dark cell, scaled by the clamp */
	int sending;      /* sent[sending] is the newest */
	struct lpv_start start;
	struct dispatch per_cell, per_whole, per_surface;
	int surface_count;
	int whole_count; /* of them, done as a whole by lpv_reflect */

	/* What the light stands for. */
	bool started;
	uint64_t epoch, rsm_version;
	float absorption, scattering;
	int steps_since_change;

	/* Checks come back some frames later. */
	const volatile struct lpv_check *check_map;
	void *fences[LPV_RING];
	unsigned ring;
	struct gi_stats stats;
	uint64_t nonfinite_frames;
};

/* Steps from the newest light; the last `looks` (1 or 2) of them can be looked at. */
void lpv_propagate(struct lpv *lpv, int steps, int looks);

/*
 * lpv_start.c: from darkness to the steady state in lpv_start_steps steps, half
 * of settle_steps: between thirds of them it leaps ahead. What is left is under
 * 1e-4 of the largest (tests/accuracy/test_lpv_gl).
 */
int lpv_start_init(struct lpv *lpv);
void lpv_start_finish(struct lpv *lpv);
int lpv_start_steps(const struct lpv *lpv);
void lpv_start(struct lpv *lpv);

/* lpv_thesis.c */
int lpv_thesis_init(struct lpv_thesis *thesis, const struct lattice *lattice,
		    const struct scene *scene);
void lpv_thesis_finish(struct lpv_thesis *thesis);
/* Equation 3.4, then steps, then the light to lpv->light[lpv->current]. */
void lpv_thesis_frame(struct lpv *lpv, float last_share, float this_share, int steps);
/* Only steps; for the benchmark. */
void lpv_thesis_steps(struct lpv_thesis *thesis, const struct lattice *lattice, float absorption,
		      float scattering, int steps);

/* lpv_splat.c: light of the maps into lpv->inject. */
int lpv_splat_init(struct lpv *lpv);
void lpv_splat_finish(struct lpv *lpv);
void lpv_splat(struct lpv *lpv, const struct rsm_set *rsm);

/* lpv_check.c: looks at the newest light, reads what is there of earlier looks. */
int lpv_check_init(struct lpv *lpv);
void lpv_check_finish(struct lpv *lpv);
void lpv_check_submit(struct lpv *lpv);
void lpv_check_collect(struct lpv *lpv);

#endif
