#include "renderer/gi/front.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_CORNERS 10 /* of a triangle cut by six planes: nine */
#define SLACK 0.04f    /* half cells: neighbours overlap, so that rounding leaves no gap */
#define LIFT 0.01f     /* cells: rays start so far in front of the surface */

struct build {
	struct fronts *out;
	const struct scene *scene;
	const struct rays *rays;
	const struct lattice *lattice;
	const float *point;
	size_t room;
};

struct polygon {
	float corner[MAX_CORNERS][3];
	int count;
};

/* Keeps the part with sign * (x[axis] - at) <= 0. */
static void cut(struct polygon *p, int axis, float at, float sign)
{
	struct polygon kept = { .count = 0 };

	for (int k = 0; k < p->count; k++) {
		const float *a = p->corner[k], *b = p->corner[(k + 1) % p->count];
		float da = sign * (a[axis] - at), db = sign * (b[axis] - at);

		if (da <= 0 && kept.count < MAX_CORNERS)
			memcpy(kept.corner[kept.count++], a, sizeof kept.corner[0]);
		if ((da < 0) != (db < 0) && da != 0 && db != 0 && kept.count < MAX_CORNERS) {
			float t = da / (da - db);

			for (int i = 0; i < 3; i++)
				kept.corner[kept.count][i] = a[i] + t * (b[i] - a[i]);
			kept.count++;
		}
	}
	*p = kept;
}

static uint32_t *record_of(struct build *b, const int cell[3])
{
	struct fronts *f = b->out;
	uint32_t *index = &f->of[lattice_index(b->lattice, cell[0], cell[1], cell[2])];

	if (*index == 0) {
		if (f->count == b->room) {
			size_t room = b->room ? b->room * 2 : 1024;
			uint32_t *grown = realloc(f->masks, room * FRONT_MASKS * sizeof *grown);

			if (!grown)
				return NULL;
			f->masks = grown;
			b->room = room;
		}
		memset(f->masks + f->count * FRONT_MASKS, 0, FRONT_MASKS * sizeof *f->masks);
		*index = (uint32_t)++f->count;
	}
	return f->masks + (size_t)(*index - 1) * FRONT_MASKS;
}

/* Whether masks of this axis hold surfaces of normal n: a smooth surface's shading normal may lean. */
static bool follows(const float n[3], int axis6)
{
	float most = fmaxf(fabsf(n[0]), fmaxf(fabsf(n[1]), fabsf(n[2])));

	return (axis6 & 1 ? -n[axis6 / 2] : n[axis6 / 2]) > 0.6f * most;
}

/* Cells around `cell` that a point on the surface (cells) sees, but for those already known. */
static uint32_t seen_from(struct build *b, const int cell[3], const float at[3], const float n[3],
			  uint32_t known)
{
	const struct lattice *l = b->lattice;
	uint32_t seen = 0;
	float from[3];

	for (int i = 0; i < 3; i++)
		from[i] = l->origin[i] + (at[i] + LIFT * n[i]) * l->d;
	for (int k = 0; k < 27; k++) {
		int c[3] = { cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1 };
		float to[3], side = 0;

		if (known >> k & 1 || !lattice_inside(l, c[0], c[1], c[2]))
			continue;
		for (int i = 0; i < 3; i++) {
			float p = (float)c[i] + b->point[i];

			to[i] = l->origin[i] + p * l->d;
			side += n[i] * (p - at[i]);
		}
		if (side <= 0)
			continue;
		b->out->rays++;
		if (!rays_blocked(b->rays, from, to))
			seen |= UINT32_C(1) << k;
	}
	return seen;
}

/* One piece of a triangle, in half cells and moved out along n. */
static int add_piece(struct build *b, const int half[3], const struct polygon *piece,
		     const float n[3])
{
	const int cell[3] = { half[0] >> 1, half[1] >> 1, half[2] >> 1 };
	int octant = (half[0] & 1) + 2 * (half[1] & 1) + 4 * (half[2] & 1);
	float middle[3] = { 0, 0, 0 };
	uint32_t known = UINT32_MAX;
	uint32_t *masks = record_of(b, cell);

	if (!masks)
		return GR_ERR_NOMEM;
	masks += 6 * octant;
	for (int a = 0; a < 6; a++)
		if (follows(n, a))
			known &= masks[a];
	for (int k = 0; k < piece->count; k++)
		for (int i = 0; i < 3; i++)
			middle[i] += piece->corner[k][i] / (float)piece->count;
	/* the middle first: it mostly sees all that the corners see */
	for (int k = -1; k < piece->count; k++) {
		float at[3];

		for (int i = 0; i < 3; i++) {
			float c = k < 0 ? middle[i] : 0.9f * piece->corner[k][i] + 0.1f * middle[i];

			at[i] = 0.5f * c - FRONT_OUT * n[i];
		}
		known |= seen_from(b, cell, at, n, known);
	}
	for (int a = 0; a < 6; a++)
		if (follows(n, a))
			masks[a] |= known;
	return GR_OK;
}

/* One side of a triangle; corners in half cells. */
static int add_side(struct build *b, const float corners[3][3], const float n[3])
{
	int from[3], to[3], half[3];
	float reach = (0.5f + SLACK) * (fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]));
	struct polygon moved = { .count = 3 };

	for (int i = 0; i < 3; i++) {
		float low = INFINITY, high = -INFINITY;

		for (int k = 0; k < 3; k++) {
			float c = corners[k][i] + 2 * FRONT_OUT * n[i];

			moved.corner[k][i] = c;
			low = fminf(low, c);
			high = fmaxf(high, c);
		}
		from[i] = (int)fmaxf(floorf(low - SLACK), 0);
		to[i] = (int)fminf(floorf(high + SLACK), (float)(2 * b->lattice->size[i] - 1));
	}
	for (half[2] = from[2]; half[2] <= to[2]; half[2]++)
		for (half[1] = from[1]; half[1] <= to[1]; half[1]++)
			for (half[0] = from[0]; half[0] <= to[0]; half[0]++) {
				struct polygon piece = moved;
				float side = 0;
				int result;

				for (int i = 0; i < 3; i++)
					side += n[i] * ((float)half[i] + 0.5f - moved.corner[0][i]);
				if (fabsf(side) > reach)
					continue;
				for (int i = 0; i < 3 && piece.count > 0; i++) {
					cut(&piece, i, (float)half[i] + 1 + SLACK, 1);
					cut(&piece, i, (float)half[i] - SLACK, -1);
				}
				if (piece.count == 0)
					continue;
				result = add_piece(b, half, &piece, n);
				if (result != GR_OK)
					return result;
			}
	return GR_OK;
}

static int add_triangle(struct build *b, const uint32_t *t, bool two_sided)
{
	const struct lattice *l = b->lattice;
	float c[3][3], n[3], length;
	int result = GR_OK;

	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			c[k][i] = (b->scene->vertices[t[k]].position[i] - l->origin[i]) / l->d * 2;
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		n[i] = (c[1][j] - c[0][j]) * (c[2][k] - c[0][k]) -
		       (c[1][k] - c[0][k]) * (c[2][j] - c[0][j]);
	}
	length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	if (!(length > 0))
		return GR_OK; /* too small for a float's square: no pixel either */
	for (int side = 0; side < (two_sided ? 2 : 1) && result == GR_OK; side++) {
		float sign = (side ? -1.0f : 1.0f) / length;

		result = add_side(b, (const float (*)[3])c,
				  (const float[3]){ sign * n[0], sign * n[1], sign * n[2] });
	}
	return result;
}

/* Of the cells in the mask those of the group that reflects most. */
static uint32_t one_group(const struct build *b, const int cell[3], uint32_t mask,
			  const uint32_t *group, const float *score)
{
	uint32_t best = 0, kept = 0;
	bool any = false;

	for (int pass = 0; pass < 2; pass++)
		for (int k = 0; k < 27; k++) {
			uint32_t g;

			if (!(mask >> k & 1))
				continue;
			g = group[lattice_index(b->lattice, cell[0] + k % 3 - 1,
						cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1)];
			if (pass == 1)
				kept |= g == best ? UINT32_C(1) << k : 0;
			else if (!any || score[g] > score[best])
				best = g;
			any = true;
		}
	return kept;
}

/* Groups, then what no piece fell into: from the rest of the cell, that axis first. */
static void finish_record(const struct build *b, const int cell[3], uint32_t *masks,
			  const uint32_t *group, const float *score)
{
	uint32_t axis[6] = { 0 }, sides[6] = { 0 };

	for (int m = 0; m < FRONT_MASKS; m++) {
		masks[m] = one_group(b, cell, masks[m], group, score);
		axis[m % 6] |= masks[m];
	}
	for (int a = 0; a < 6; a++)
		for (int o = 0; o < 6; o++)
			sides[a] |= o != (a ^ 1) ? axis[o] : 0;
	for (int m = 0; m < FRONT_MASKS; m++) {
		int a = m % 6;

		if (!masks[m])
			masks[m] = one_group(b, cell, axis[a] ? axis[a] : sides[a], group, score);
	}
}

int fronts_create(struct fronts *out, const struct scene *scene, const struct rays *rays,
		  const struct lattice *lattice, const float point[3], const uint32_t *group,
		  const float *score)
{
	struct build b = { out, scene, rays, lattice, point, 0 };
	int cell[3];

	memset(out, 0, sizeof *out);
	out->of = calloc(lattice_cells(lattice), sizeof *out->of);
	if (!out->of)
		return GR_ERR_NOMEM;
	for (size_t d = 0; d < scene->draw_count; d++) {
		const struct scene_draw *draw = &scene->draws[d];
		bool two_sided = scene->materials[draw->material].two_sided;

		for (uint32_t i = 0; i + 2 < draw->index_count; i += 3) {
			int result = add_triangle(&b, scene->indices + draw->first_index + i, two_sided);

			if (result != GR_OK) {
				fronts_finish(out);
				return result;
			}
		}
	}
	for (cell[2] = 0; cell[2] < lattice->size[2]; cell[2]++)
		for (cell[1] = 0; cell[1] < lattice->size[1]; cell[1]++)
			for (cell[0] = 0; cell[0] < lattice->size[0]; cell[0]++) {
				uint32_t of = out->of[lattice_index(lattice, cell[0], cell[1], cell[2])];

				if (of)
					finish_record(&b, cell, out->masks + (size_t)(of - 1) * FRONT_MASKS,
						      group, score);
			}
	return GR_OK;
}

void fronts_finish(struct fronts *fronts)
{
	free(fronts->of);
	free(fronts->masks);
	memset(fronts, 0, sizeof *fronts);
}

uint32_t fronts_at(const struct fronts *fronts, const struct lattice *lattice, const float at[3],
		   const float n[3], int cell[3])
{
	int octant = 0, axis = 0;
	uint32_t of;

	for (int i = 0; i < 3; i++) {
		int half = (int)floorf(2 * (at[i] + FRONT_OUT * n[i]));

		cell[i] = half >> 1;
		octant |= (half & 1) << i;
		if (fabsf(n[i]) > fabsf(n[axis]))
			axis = i;
	}
	if (!lattice_inside(lattice, cell[0], cell[1], cell[2]))
		return 0;
	of = fronts->of[lattice_index(lattice, cell[0], cell[1], cell[2])];
	if (!of)
		return 0;
	return fronts->masks[(size_t)(of - 1) * FRONT_MASKS + (size_t)(6 * octant + 2 * axis) +
			     (n[axis] < 0 ? 1 : 0)];
}
