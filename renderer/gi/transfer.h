/*
 * Transfer vectors of seed 004 (section 3.2.2), for the comparison mode: the
 * mean cosine lobe over directions to points of a neighbour cell, in two SH
 * bands in the order (1, -y, z, -x), times kappa.
 *
 * Its search for kappa has a closed form: that a cell's flux is kept asks for
 * kappa = 1/sqrt(sum of the squares of the vectors' first components).
 * Pure functions, thread safe.
 */
#ifndef GROTTO_RENDERER_GI_TRANSFER_H
#define GROTTO_RENDERER_GI_TRANSFER_H

#include "renderer/gi/sectors.h"

struct transfer {
	float vector[SECTOR_COUNT][4]; /* kappa included */
	float fraction[SECTOR_COUNT];  /* share of what is scattered (eq. 2.3) */
	double kappa;
};
void transfer_init(struct transfer *out);
/* Cosine lobe about a unit direction. */
void transfer_lobe(const float direction[3], float out[4]);

/* The thesis' medium: lambda = sigma^mean distance, which grows as cells shrink. */
void transfer_medium(float absorption, float scattering, float d, float *kept, float *scattered);

#endif
