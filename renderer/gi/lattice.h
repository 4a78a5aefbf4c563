/*
 * Where the lattice lies in the scene: cubic cells, aligned with the lower
 * corner of the scene's bounds, `longest` cells along its longest side.
 * Cell (x, y, z) is number x + size[0] (y + size[1] z).
 */
#ifndef GROTTO_RENDERER_GI_LATTICE_H
#define GROTTO_RENDERER_GI_LATTICE_H

#include <stdbool.h>
#include <stddef.h>

#define LATTICE_MAX 128

struct lattice {
	int size[3];     /* cells */
	float origin[3]; /* lower corner, scene, metres */
	float d;         /* side of a cell, metres */
};

/*
 * GR_OK; GR_ERR_RANGE when longest is not 2..LATTICE_MAX or the bounds are
 * not finite, or empty along every axis. A flat side gets one cell.
 */
int lattice_init(struct lattice *out, const float min[3], const float max[3], int longest);

static inline size_t lattice_cells(const struct lattice *l)
{
	return (size_t)l->size[0] * (size_t)l->size[1] * (size_t)l->size[2];
}

static inline size_t lattice_index(const struct lattice *l, int x, int y, int z)
{
	return (size_t)x + (size_t)l->size[0] * ((size_t)y + (size_t)l->size[1] * (size_t)z);
}

static inline bool lattice_inside(const struct lattice *l, int x, int y, int z)
{
	return x >= 0 && y >= 0 && z >= 0 && x < l->size[0] && y < l->size[1] && z < l->size[2];
}

#endif
