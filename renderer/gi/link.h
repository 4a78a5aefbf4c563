/*
 * The geometry lattice: what stands between neighbouring cells. Computed once
 * from the static scene by rays.
 *
 * Every cell is represented by one point near its middle. The link between two
 * neighbouring cells is sampled by paths of two segments, from one point over
 * a point spread across the link to the other. The share that gets through is
 * the link's transmittance. All paths between two cells start and end at the
 * same two points: a closed wall between them, however thin, stops all of
 * them, so no light gets through by any chain of links.
 *
 * Light that is stopped is reflected: each sample knows the reflectance and
 * the normal of what it hit first. Only the lit side reflects: the back of a
 * one-sided material absorbs.
 *
 * (Instead of seed 004's blocker functions, section 3.2.1.)
 */
#ifndef GROTTO_RENDERER_GI_LINK_H
#define GROTTO_RENDERER_GI_LINK_H

#include "renderer/gi/front.h"
#include "renderer/gi/lattice.h"
#include "renderer/gi/sectors.h"
#include "renderer/scene/scene.h"
#include "renderer/trace/rays.h"

#include <stdint.h>

/* Transmittance of an open link; a power of two, so that the shader's scale is exact. */
#define LINK_OPEN 128

/* One stopped link: Phi_j of the cell gives flux reflect * Phi_j back to it. */
struct link_block {
	float reflect[3]; /* (1 - transmittance) * reflectance, per band */
	uint32_t j;       /* direction, 0..25 */
	float facing[3];  /* mean unit normal of what was hit, towards the cell, weighted by reflectance */
	float blocked;    /* 1 - transmittance */
};

/* A cell with at least one link that is not open. */
struct link_surface {
	uint8_t through[28]; /* transmittance * LINK_OPEN of direction j; two unused */
	uint32_t first, count; /* its blocks */
};

struct links {
	struct lattice lattice;
	uint32_t *surface_of; /* per cell: index into surfaces + 1, 0 where all links are open */
	struct link_surface *surfaces;
	size_t surface_count;
	struct link_block *blocks;
	size_t block_count;
	struct fronts fronts;
	size_t rays; /* that were traced */
	float point[3]; /* a cell's point, in cells from its lower corner */
	/* Mean number of hops between two meetings with a surface and mean
	 * reflectance of the band that reflects most, over open cells. */
	double hops_per_bounce, reflectance;
	int settle_steps; /* propagation steps after which a change has died down, see links_create */
};

/*
 * rays_per_link 1..128. albedo_override: components >= 0 replace the
 * materials' diffuse reflectance. GR_OK or GR_ERR_NOMEM.
 *
 * settle_steps: light loses all but `reflectance` every hops_per_bounce steps;
 * so many that 1e-4 is left, at least enough to cross the lattice four times.
 */
int links_create(struct links **out, const struct scene *scene, const struct rays *rays,
		 const struct lattice *lattice, int rays_per_link, const float albedo_override[3]);
void links_destroy(struct links **links);

/* The point that stands for a cell, scene frame. */
void links_point(const struct links *links, const int cell[3], float out[3]);

#endif
