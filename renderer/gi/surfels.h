/*
 * Relit surfels on the GPU (docs/surfels.md): the light of a static scene's
 * surfaces under lamps that move. Per frame: the lamps' light on each surfel,
 * some gathers over the links of surfel_set.h, and what shading reads.
 *
 * Two methods share it. "surfels" shades from the surfels around a point;
 * "probes" from spherical harmonics on a grid, fed by the surfels, as what
 * moves is lit.
 *
 * A frame's work is counted, never measured: equal nodes hold equal bits. After
 * a change as many gathers follow as bring what is left of the light before
 * under 1e-5 of it (a bound from links and reflectances), then work stops.
 *
 * Shared work (struct gi_share_ops): a slice is a run of surfels. A node
 * relights and gathers its own, rounds the result to 32 bits a colour, and uses
 * it, like the others' slices, from the next frame on: all nodes see the same
 * bytes, one frame late, and later bounces cross from slice to slice once a
 * frame. A slice that is less than one rounding step away from what was sent is
 * not sent. What is not taken (take()) is not used here either.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_GI_SURFELS_H
#define GROTTO_RENDERER_GI_SURFELS_H

#include "renderer/gi/gi.h"
#include "renderer/gi/surfel_set.h"

/* Slices that the work can be shared out into. */
#define SURFELS_SLICES_MAX 64

struct surfels_params {
	int gathers; /* a frame, >= 1, unless the frame says another number */
	bool probes; /* shade from the probes; the set must have some */
	bool lamps;  /* the scene has any: update() will be given them */
};
#define SURFELS_PARAMS_DEFAULT { .gathers = 2, .probes = false, .lamps = true }

/*
 * The set is used during the call only. GR_OK; GR_ERR_RANGE for one that is
 * empty, or too large for this GPU's buffers (the log says which and how much);
 * GR_ERR_NOMEM; GR_ERR_GL.
 */
int gi_surfels_create(struct gi_method **out, const struct surfel_set *set,
		      const struct surfels_params *params);

#endif
