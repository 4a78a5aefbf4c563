/* The grid that finds the surfels around a point. */
#include "renderer/gi/surfel_set.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DENSE_MOST ((uint64_t)1 << 21) /* cells; more are hashed */

/*
 * Cells that a surfel's ball meets, less those off its plane: it is heard on
 * points with n.m > 1/2 and |d.(n+m)| small, which lie within half of the radius
 * of its plane, and the plane's own tolerance.
 */
struct cells_of {
	int32_t low[3], high[3];
	float position[3], normal[3], radius, slab;
};

static void cells_of(const struct surfel_set *set, size_t i, struct cells_of *out)
{
	const struct surfel_grid *grid = &set->grid;

	out->radius = set->radius_m;
	out->slab = 0.5f * set->radius_m + SURFEL_PLANE * set->spacing_m * 2;
	surfel_normal_unpack(set->surfels[i].normal, out->normal);
	for (int k = 0; k < 3; k++) {
		float at = set->surfels[i].position[k] - grid->origin[k];

		out->position[k] = set->surfels[i].position[k];
		out->low[k] = (int32_t)fmaxf(floorf((at - out->radius) / grid->cell_m), 0);
		out->high[k] = (int32_t)fminf(floorf((at + out->radius) / grid->cell_m),
					      (float)(grid->size[k] - 1));
	}
}

static int meets(const struct surfel_grid *grid, const struct cells_of *c, const int32_t cell[3])
{
	float away = 0, off = 0, half = 0;

	for (int k = 0; k < 3; k++) {
		/* a little larger than it is: rounding may put a point into the neighbour */
		float side = 0.501f * grid->cell_m;
		float middle = grid->origin[k] + ((float)cell[k] + 0.5f) * grid->cell_m -
			       c->position[k];
		float beyond = fmaxf(fabsf(middle) - side, 0);

		away += beyond * beyond;
		off += middle * c->normal[k];
		half += side * fabsf(c->normal[k]);
	}
	return away < c->radius * c->radius && fabsf(off) - half < c->slab;
}

static uint32_t cell_number(const struct surfel_grid *grid, const int32_t cell[3])
{
	return (uint32_t)cell[0] +
	       (uint32_t)grid->size[0] * ((uint32_t)cell[1] + (uint32_t)grid->size[1] * (uint32_t)cell[2]);
}

/* Slot of a cell; hashed: where it is or where it would be put. */
static uint32_t slot_of(const struct surfel_grid *grid, uint32_t cell)
{
	uint32_t slot;

	if (!grid->slots)
		return cell;
	slot = surfel_grid_slot(cell, grid->slots);
	while (grid->keys[slot] && grid->keys[slot] != cell + 1)
		slot = (slot + 1) & (grid->slots - 1);
	return slot;
}

enum pass { COUNT_ALL, COUNT_EACH, FILL };

/* Returns how many (surfel, cell) pairs there are. */
static size_t visit(struct surfel_set *set, enum pass pass, uint32_t *at)
{
	struct surfel_grid *grid = &set->grid;
	size_t pairs = 0;

	for (size_t i = 0; i < set->count; i++) {
		struct cells_of c;
		int32_t cell[3];

		cells_of(set, i, &c);
		for (cell[2] = c.low[2]; cell[2] <= c.high[2]; cell[2]++)
			for (cell[1] = c.low[1]; cell[1] <= c.high[1]; cell[1]++)
				for (cell[0] = c.low[0]; cell[0] <= c.high[0]; cell[0]++) {
					uint32_t number, slot;

					if (!meets(grid, &c, cell))
						continue;
					pairs++;
					if (pass == COUNT_ALL)
						continue;
					number = cell_number(grid, cell);
					slot = slot_of(grid, number);
					if (pass == COUNT_EACH && grid->slots)
						grid->keys[slot] = number + 1;
					if (pass == COUNT_EACH)
						at[slot]++;
					else
						grid->members[at[slot]++] = (uint32_t)i;
				}
	}
	return pairs;
}

/* Half a radius wide; wider where the scene is so large that cells could not be numbered. */
static uint64_t lay_out(struct surfel_set *set, const float min[3], const float max[3])
{
	struct surfel_grid *grid = &set->grid;
	double cell = 0.5 * (double)set->radius_m, cells;

	for (;; cell *= 2) {
		cells = 1;
		for (int k = 0; k < 3; k++)
			cells *= floor((double)(max[k] - min[k]) / cell) + 3;
		if (cells < 4e9)
			break;
	}
	grid->cell_m = (float)cell;
	for (int k = 0; k < 3; k++) {
		grid->origin[k] = min[k] - grid->cell_m;
		grid->size[k] = (int32_t)(floor((double)(max[k] - min[k]) / cell) + 3);
	}
	return (uint64_t)cells;
}

int surfel_grid_build(struct surfel_set *set, const float min[3], const float max[3])
{
	struct surfel_grid *grid = &set->grid;
	uint64_t cells = lay_out(set, min, max);
	uint64_t slots = cells;
	uint32_t *at;
	size_t pairs;

	pairs = visit(set, COUNT_ALL, NULL);
	if (pairs >= UINT32_MAX / 4)
		return GR_ERR_NOMEM;
	if (cells > DENSE_MOST) {
		for (slots = 1024; slots < 2 * pairs; slots *= 2)
			;
		grid->slots = (uint32_t)slots;
		grid->keys = calloc(slots, sizeof *grid->keys);
		if (!grid->keys)
			return GR_ERR_NOMEM;
	}
	grid->member_count = pairs;
	grid->first = calloc(slots + 1, sizeof *grid->first);
	grid->members = calloc(pairs ? pairs : 1, sizeof *grid->members);
	at = calloc(slots, sizeof *at);
	if (!grid->first || !grid->members || !at) {
		free(at);
		return GR_ERR_NOMEM;
	}
	visit(set, COUNT_EACH, at);
	for (size_t s = 0; s < slots; s++) {
		grid->first[s + 1] = grid->first[s] + at[s];
		at[s] = grid->first[s];
	}
	visit(set, FILL, at);
	free(at);
	return GR_OK;
}

size_t surfel_set_cell(const struct surfel_set *set, const float position[3],
		       const uint32_t **out_members)
{
	const struct surfel_grid *grid = &set->grid;
	int32_t cell[3];
	uint32_t slot;

	*out_members = NULL;
	for (int k = 0; k < 3; k++) {
		float at = floorf((position[k] - grid->origin[k]) / grid->cell_m);

		if (!(at >= 0 && at < (float)grid->size[k]))
			return 0;
		cell[k] = (int32_t)at;
		if (cell[k] >= grid->size[k])
			return 0;
	}
	slot = slot_of(grid, cell_number(grid, cell));
	*out_members = grid->members + grid->first[slot];
	return grid->first[slot + 1] - grid->first[slot];
}
