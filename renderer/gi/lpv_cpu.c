#include "renderer/gi/lpv_cpu.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int lpv_cpu_init(struct lpv_cpu *lpv, const struct links *links, const struct lattice *lattice)
{
	size_t floats;

	memset(lpv, 0, sizeof *lpv);
	lpv->links = links;
	lpv->lattice = links ? links->lattice : *lattice;
	lpv->calibration = 1;
	sectors_init(&lpv->sectors);
	sectors_medium(&lpv->sectors, 0, 0, (double)lpv->lattice.d, &lpv->medium);
	floats = lattice_cells(&lpv->lattice) * LPV_CELL_FLOATS;
	lpv->inject = calloc(floats, sizeof(float));
	lpv->light = calloc(floats, sizeof(float));
	lpv->next = calloc(floats, sizeof(float));
	if (!lpv->inject || !lpv->light || !lpv->next) {
		lpv_cpu_finish(lpv);
		return GR_ERR_NOMEM;
	}
	return GR_OK;
}

void lpv_cpu_finish(struct lpv_cpu *lpv)
{
	free(lpv->inject);
	free(lpv->light);
	free(lpv->next);
	lpv->inject = lpv->light = lpv->next = NULL;
}

/* Unit vector towards neighbour j. */
static void axis_of(int j, float out[3])
{
	static const float inverse[SECTOR_KINDS] = { 1.0f, 0.70710678f, 0.57735027f };
	int kind = sector_kind(j);

	for (int i = 0; i < 3; i++)
		out[i] = (float)sector_offset[j][i] * inverse[kind];
}

/* Flux towards neighbour j of one band's F, V. */
static float sector_flux(const struct lpv_cpu *lpv, const float *fv, int j)
{
	int kind = sector_kind(j);
	float axis[3];

	axis_of(j, axis);
	return (float)lpv->medium.a[kind] * fv[0] +
	       (float)lpv->medium.b[kind] * (axis[0] * fv[1] + axis[1] * fv[2] + axis[2] * fv[3]);
}

/* Fluxes to all neighbours, clamped when asked to. */
static void cell_fluxes(const struct lpv_cpu *lpv, const float *fv, float out[SECTOR_COUNT])
{
	float sum = 0, positive = 0;

	for (int j = 0; j < SECTOR_COUNT; j++) {
		out[j] = sector_flux(lpv, fv, j);
		sum += out[j];
		positive += out[j] > 0 ? out[j] : 0;
	}
	if (!lpv->clamp)
		return;
	for (int j = 0; j < SECTOR_COUNT; j++)
		out[j] = out[j] > 0 ? out[j] * (sum / positive) : 0;
}

static void add_lobe(float *fv, float flux, float length, const float axis[3])
{
	fv[0] += flux;
	for (int i = 0; i < 3; i++)
		fv[1 + i] += flux * length * axis[i];
}

/* Pushes one cell's light to its neighbours (the shader gathers; the sum is the same). */
static void spread_cell(struct lpv_cpu *lpv, int x, int y, int z)
{
	const struct lattice *l = &lpv->lattice;
	size_t index = lattice_index(l, x, y, z);
	const struct link_surface *surface = NULL;

	if (lpv->links && lpv->links->surface_of[index])
		surface = &lpv->links->surfaces[lpv->links->surface_of[index] - 1];
	for (int c = 0; c < 3; c++) {
		const float *from = lpv->light + index * LPV_CELL_FLOATS + 4 * c;
		float *back = lpv->next + index * LPV_CELL_FLOATS + 4 * c;
		float flux[SECTOR_COUNT];

		cell_fluxes(lpv, from, flux);
		for (int j = 0; j < SECTOR_COUNT; j++) {
			int to[3] = { x + sector_offset[j][0], y + sector_offset[j][1],
				      z + sector_offset[j][2] };
			float through = surface ? (float)surface->through[j] / (float)LINK_OPEN : 1.0f;
			float axis[3];

			if (lpv->periodic)
				for (int i = 0; i < 3; i++)
					to[i] = (to[i] + l->size[i]) % l->size[i];
			if (!lattice_inside(l, to[0], to[1], to[2])) {
				lpv->escaped[c] += (double)(through * flux[j]);
				continue;
			}
			axis_of(j, axis);
			add_lobe(lpv->next + lattice_index(l, to[0], to[1], to[2]) * LPV_CELL_FLOATS +
					 4 * c,
				 through * flux[j], (float)lpv->sectors.mu[sector_kind(j)], axis);
		}
		for (uint32_t k = 0; surface && k < surface->count; k++) {
			const struct link_block *block = &lpv->links->blocks[surface->first + k];

			add_lobe(back, block->reflect[c] * flux[block->j],
				 (float)lpv->sectors.lobe, block->facing);
		}
	}
}

void lpv_cpu_step(struct lpv_cpu *lpv)
{
	const struct lattice *l = &lpv->lattice;
	float *swap;

	memcpy(lpv->next, lpv->inject, lattice_cells(l) * LPV_CELL_FLOATS * sizeof(float));
	memset(lpv->escaped, 0, sizeof lpv->escaped);
	for (int z = 0; z < l->size[2]; z++)
		for (int y = 0; y < l->size[1]; y++)
			for (int x = 0; x < l->size[0]; x++)
				spread_cell(lpv, x, y, z);
	swap = lpv->light;
	lpv->light = lpv->next;
	lpv->next = swap;
}

/* Whether the cell's point lies in front of the surface. */
static bool in_front(const struct lpv_cpu *lpv, const int cell[3], const float position[3],
		     const float normal[3])
{
	static const float middle[3] = { 0.5f, 0.5f, 0.5f };
	const float *point = lpv->links ? lpv->links->point : middle;
	float side = 0;

	for (int i = 0; i < 3; i++)
		side += normal[i] * (lpv->lattice.origin[i] +
				     ((float)cell[i] + point[i]) * lpv->lattice.d - position[i]);
	return side > 0;
}

/* The cell that stands for the space in front of a surface point. */
static bool front_cell(const struct lpv_cpu *lpv, const float position[3], const float normal[3],
		       int cell[3])
{
	for (int step = 1; step <= 2; step++) {
		for (int i = 0; i < 3; i++)
			cell[i] = (int)floorf((position[i] - lpv->lattice.origin[i]) / lpv->lattice.d +
					      0.5f * (float)step * normal[i]);
		if (lattice_inside(&lpv->lattice, cell[0], cell[1], cell[2]) &&
		    in_front(lpv, cell, position, normal))
			return true;
	}
	return false;
}

bool lpv_cpu_inject(struct lpv_cpu *lpv, const float position[3], const float normal[3],
		    const float flux[3])
{
	int cell[3];

	if (!front_cell(lpv, position, normal, cell))
		return false;
	for (int c = 0; c < 3; c++)
		add_lobe(lpv->inject +
				 lattice_index(&lpv->lattice, cell[0], cell[1], cell[2]) *
					 LPV_CELL_FLOATS + 4 * c,
			 flux[c], (float)lpv->sectors.lobe, normal);
	return true;
}

static int direction_index(int x, int y, int z)
{
	int n = (x + 1) + 3 * (y + 1) + 9 * (z + 1);

	return n > 13 ? n - 1 : n;
}

void lpv_cpu_irradiance(const struct lpv_cpu *lpv, const float position[3],
			const float normal[3], float out[3])
{
	const struct lattice *l = &lpv->lattice;
	const struct link_surface *surface = NULL;
	int base[3], low[3];
	float t[3], sum[LPV_CELL_FLOATS] = { 0 }, weights = 0;

	memset(out, 0, 3 * sizeof *out);
	if (!front_cell(lpv, position, normal, base))
		return;
	size_t base_index = lattice_index(l, base[0], base[1], base[2]);
	if (lpv->links && lpv->links->surface_of[base_index])
		surface = &lpv->links->surfaces[lpv->links->surface_of[base_index] - 1];
	for (int i = 0; i < 3; i++) {
		/* half a cell out, within the base cell */
		float at = (position[i] - l->origin[i]) / l->d + 0.5f * normal[i];

		at = fminf(fmaxf(at, (float)base[i]), (float)base[i] + 1.0f) - 0.5f;
		low[i] = (int)floorf(at);
		t[i] = at - (float)low[i];
	}
	for (int k = 0; k < 8; k++) {
		int o[3] = { k & 1, (k >> 1) & 1, k >> 2 };
		int cell[3] = { low[0] + o[0], low[1] + o[1], low[2] + o[2] };
		int step[3] = { cell[0] - base[0], cell[1] - base[1], cell[2] - base[2] };
		bool self = !step[0] && !step[1] && !step[2];
		float w = 1;

		if (!lattice_inside(l, cell[0], cell[1], cell[2]))
			continue;
		for (int i = 0; i < 3; i++)
			w *= o[i] ? t[i] : 1 - t[i];
		if (!self && surface)
			w *= (float)surface->through[direction_index(step[0], step[1], step[2])] / (float)LINK_OPEN;
		if (!self && !in_front(lpv, cell, position, normal))
			w = 0;
		weights += w;
		for (int i = 0; i < LPV_CELL_FLOATS; i++)
			sum[i] += w * lpv->light[lattice_index(l, cell[0], cell[1], cell[2]) *
							 LPV_CELL_FLOATS + (size_t)i];
	}
	if (!(weights > 0))
		return;
	for (int c = 0; c < 3; c++) {
		const float *fv = sum + 4 * c;
		float along = fv[1] * normal[0] + fv[2] * normal[1] + fv[3] * normal[2];

		out[c] = lpv->calibration / (l->d * l->d * weights) *
			 ((float)lpv->sectors.look_f * 0.25f * fv[0] -
			  (float)lpv->sectors.look_v * 0.5f * along);
	}
}
