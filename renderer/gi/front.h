/*
 * Which cells stand for the space in front of a surface point. A surface looks
 * light up in, and gives light to, the cells around it whose points it sees;
 * what it sees is traced once from the static scene.
 *
 * The scene's triangles are cut at half cells; what the pieces see of the 27
 * cells around theirs is kept as bits, by half cell and by the axis that the
 * normal follows most. So two walls that meet in one half cell do not mix, and
 * of two rooms that share one (a wall thinner than half a cell on a floor)
 * only the cells of one count: of that which reflects more.
 *
 * (Seed 004, section 3.3.3 takes the point half a cell out along the normal,
 * which beside a crease lies beyond the other wall.)
 */
#ifndef GROTTO_RENDERER_GI_FRONT_H
#define GROTTO_RENDERER_GI_FRONT_H

#include "renderer/gi/lattice.h"
#include "renderer/scene/scene.h"
#include "renderer/trace/rays.h"

#include <stdint.h>

#define FRONT_MASKS 48 /* a cell: half cell x + 2y + 4z, times 6, + 2 axis + (normal < 0) */
#define FRONT_OUT 0.05f /* cells along the normal to the point whose half cell counts */

struct fronts {
	uint32_t *of; /* per cell: record + 1, 0 where no surface is */
	uint32_t *masks; /* FRONT_MASKS a record; bit (x+1) + 3 (y+1) + 9 (z+1) */
	size_t count, rays;
};

/*
 * group: per cell a number below groups: cells that light can pass between;
 * score: what a group's surfaces reflect. point: as struct links. GR_OK or
 * GR_ERR_NOMEM.
 */
int fronts_create(struct fronts *out, const struct scene *scene, const struct rays *rays,
		  const struct lattice *lattice, const float point[3], const uint32_t *group,
		  const float *score);
void fronts_finish(struct fronts *fronts);

/* Mask of a surface point: position in cells from the lattice's corner; 0 unknown. */
uint32_t fronts_at(const struct fronts *fronts, const struct lattice *lattice, const float at[3],
		   const float normal[3], int cell[3]);

#endif
