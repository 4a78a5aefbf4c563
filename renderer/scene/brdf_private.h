/* Inside of a table: the grid (brdf_table.c) and its sampling (brdf_sampling.c). */
#ifndef GROTTO_RENDERER_SCENE_BRDF_PRIVATE_H
#define GROTTO_RENDERER_SCENE_BRDF_PRIVATE_H

#include "renderer/scene/brdf_read.h"
#include "renderer/scene/brdf_table.h"

#define GRID_HALF 72       /* theta_h = pi/2 t^2: fine where highlights are */
#define GRID_DIFFERENCE 46 /* theta_d, every 2 degrees */
#define GRID_AZIMUTH 10    /* phi_d 0..pi/2, every 10 degrees */
#define GRID_POINTS (GRID_HALF * GRID_DIFFERENCE * GRID_AZIMUTH)

/* Of the directional reflectance: angles 0, 1 .. 90 degrees. */
#define LIMIT_ANGLES 91

/* Cells of the outgoing directions for sampling, for each of SAMPLING_IN angles of wo. */
#define SAMPLING_IN 45    /* every 2 degrees, the middle of each */
#define SAMPLING_THETA 45 /* every 2 degrees */
#define SAMPLING_PHI 60   /* 0..pi away from the mirror's azimuth, finer near it: pi t^2 */
#define SAMPLING_CELLS (SAMPLING_THETA * SAMPLING_PHI)
#define SAMPLING_COSINE 0.2

struct brdf_table {
	float (*grid)[3]; /* [half][difference][azimuth] */
	float limit[LIMIT_ANGLES][3];
	float (*sums)[SAMPLING_CELLS + 1]; /* SAMPLING_IN rising sums, 0 to 1 */
	struct brdf_table_facts facts;
};

/* Along the normal's plane of wo: theta 0..pi/2, phi the azimuth between the two. */
void brdf_evaluate_angles(const struct brdf_table *table, double theta_i, double theta_o,
			  double phi, double out[3]);
/* Fills `sums` from the grid. GR_ERR_NOMEM. */
int brdf_build_sampling(struct brdf_table *table);

#endif
