/*
 * The lattice's light on the CPU: the plain form of what the compute shaders
 * do. Tests hold the GPU against it, and the calibration uses it. Not made to
 * be quick.
 *
 * L <- I + P L: I what the surfaces emit (light that has just been reflected
 * for the first time), P one hop to all 26 neighbours with what the links stop
 * reflected back. The steady state is the sum over all numbers of hops; no
 * step scales what an earlier one left (cf. seed 004, eq. 3.4).
 */
#ifndef GROTTO_RENDERER_GI_LPV_CPU_H
#define GROTTO_RENDERER_GI_LPV_CPU_H

#include "renderer/gi/link.h"
#include "renderer/gi/sectors.h"

#include <stdbool.h>

#define LPV_CELL_FLOATS 12 /* per band: F, Vx, Vy, Vz [W] */

struct lpv_cpu {
	const struct links *links; /* NULL: all open */
	struct lattice lattice;
	struct sectors sectors;
	struct sector_medium medium;
	bool clamp;    /* negative sector fluxes to zero, rescaled so that the cell's flux stays */
	bool periodic; /* wraps around (tests); without links only */
	float calibration; /* factor on irradiance, see lpv_cpu_calibrate */
	float *inject, *light, *next;
	double escaped[3]; /* flux that left the lattice in the last step, W */
};

/* Links must outlive it; lattice is used when links is NULL. GR_OK or GR_ERR_NOMEM. */
int lpv_cpu_init(struct lpv_cpu *out, const struct links *links, const struct lattice *lattice);
void lpv_cpu_finish(struct lpv_cpu *lpv);

/*
 * Adds light that leaves a surface point (scene frame) with flux W per band.
 * False when no cell in front of it lies in the lattice.
 */
bool lpv_cpu_inject(struct lpv_cpu *lpv, const float position[3], const float normal[3],
		    const float flux[3]);
void lpv_cpu_step(struct lpv_cpu *lpv);
/* Irradiance at a surface point, W/m^2 per band. */
void lpv_cpu_irradiance(const struct lpv_cpu *lpv, const float position[3],
			const float normal[3], float out[3]);

#endif
