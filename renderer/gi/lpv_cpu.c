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

struct place {
	int cell[3];   /* whose neighbourhood the mask is about */
	uint32_t mask; /* cells that the surface sees, see struct fronts */
	float at[3], n[3], out[3]; /* surface point in cells, normal, half a cell out */
};

static bool place_of(const struct lpv_cpu *lpv, const float position[3], const float normal[3],
		     struct place *p)
{
	memset(p, 0, sizeof *p);
	for (int i = 0; i < 3; i++) {
		p->at[i] = (position[i] - lpv->lattice.origin[i]) / lpv->lattice.d;
		p->n[i] = normal[i];
		p->out[i] = p->at[i] + 0.5f * normal[i];
	}
	if (lpv->links)
		p->mask = fronts_at(&lpv->links->fronts, &lpv->lattice, p->at, p->n, p->cell);
	if (p->mask)
		return true;
	/* no surface of the scene: the cell half a cell out, and what it sees is not known */
	for (int i = 0; i < 3; i++)
		p->cell[i] = (int)floorf(p->out[i]);
	p->mask = UINT32_MAX;
	return lattice_inside(&lpv->lattice, p->cell[0], p->cell[1], p->cell[2]);
}

static bool counts(const struct lpv_cpu *lpv, const struct place *p, const int cell[3])
{
	static const float middle[3] = { 0.5f, 0.5f, 0.5f };
	const float *point = lpv->links ? lpv->links->point : middle;
	float side = 0;
	int bit = 0;

	for (int i = 2; i >= 0; i--) {
		int o = cell[i] - p->cell[i] + 1;

		if (o < 0 || o > 2)
			return false;
		bit = 3 * bit + o;
		side += p->n[i] * ((float)cell[i] + point[i] - p->at[i]);
	}
	return side > 0 && (p->mask >> bit & 1) &&
	       lattice_inside(&lpv->lattice, cell[0], cell[1], cell[2]);
}

/* Square distance, in cells, of the k-th of the 27 cells around the place. */
static float around(const struct place *p, int k, int cell[3])
{
	const int o[3] = { k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1 };
	float d = 0;

	for (int i = 0; i < 3; i++) {
		cell[i] = p->cell[i] + o[i];
		d += ((float)cell[i] + 0.5f - p->out[i]) * ((float)cell[i] + 0.5f - p->out[i]);
	}
	return d;
}

/* The cell that takes the light of a surface point. */
static bool front_cell(const struct lpv_cpu *lpv, const struct place *p, int cell[3])
{
	float nearest = INFINITY;

	for (int i = 0; i < 3; i++)
		cell[i] = (int)floorf(p->out[i]);
	if (counts(lpv, p, cell))
		return true;
	for (int k = 0; k < 27; k++) {
		int c[3];
		float d = around(p, k, c);

		if (d < nearest && counts(lpv, p, c)) {
			nearest = d;
			memcpy(cell, c, sizeof c);
		}
	}
	return nearest < INFINITY;
}

bool lpv_cpu_inject(struct lpv_cpu *lpv, const float position[3], const float normal[3],
		    const float flux[3])
{
	struct place place;
	int cell[3];

	if (!place_of(lpv, position, normal, &place) || !front_cell(lpv, &place, cell))
		return false;
	for (int c = 0; c < 3; c++)
		add_lobe(lpv->inject +
				 lattice_index(&lpv->lattice, cell[0], cell[1], cell[2]) *
					 LPV_CELL_FLOATS + 4 * c,
			 flux[c], (float)lpv->sectors.lobe, normal);
	return true;
}

static void add_cell(const struct lpv_cpu *lpv, const int cell[3], float w,
		     float sum[LPV_CELL_FLOATS], float *weights)
{
	const float *from = lpv->light + lattice_index(&lpv->lattice, cell[0], cell[1], cell[2]) *
						 LPV_CELL_FLOATS;

	for (int i = 0; i < LPV_CELL_FLOATS; i++)
		sum[i] += w * from[i];
	*weights += w;
}

void lpv_cpu_irradiance(const struct lpv_cpu *lpv, const float position[3],
			const float normal[3], float out[3])
{
	const float few = 0.1f, d = lpv->lattice.d;
	float sum[LPV_CELL_FLOATS] = { 0 }, weights = 0;
	struct place place;

	memset(out, 0, 3 * sizeof *out);
	if (!place_of(lpv, position, normal, &place))
		return;
	for (int k = 0; k < 8; k++) {
		const int o[3] = { k & 1, (k >> 1) & 1, k >> 2 };
		int cell[3];
		float w = 1;

		for (int i = 0; i < 3; i++) {
			float low = floorf(place.out[i] - 0.5f), t = place.out[i] - 0.5f - low;

			cell[i] = (int)low + o[i];
			w *= o[i] ? t : 1 - t;
		}
		if (counts(lpv, &place, cell))
			add_cell(lpv, cell, w, sum, &weights);
	}
	if (weights < few) {
		float share = few - weights;

		for (int k = 0; k < 27; k++) {
			int cell[3];
			float away = around(&place, k, cell) + 0.1f;

			if (counts(lpv, &place, cell))
				add_cell(lpv, cell, share / (away * away), sum, &weights);
		}
	}
	if (!(weights > 0))
		return;
	for (int c = 0; c < 3; c++) {
		const float *fv = sum + 4 * c;
		float along = fv[1] * normal[0] + fv[2] * normal[1] + fv[3] * normal[2];

		out[c] = lpv->calibration / (d * d * weights) *
			 ((float)lpv->sectors.look_f * 0.25f * fv[0] -
			  (float)lpv->sectors.look_v * 0.5f * along);
	}
}
