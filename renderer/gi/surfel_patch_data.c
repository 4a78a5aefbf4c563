/* What a patch is like: its points, its area, its reflectance, and points for the lamps' light. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

/* Along a Hilbert curve of 2^8 x 2^8 cells: any stretch of it is a compact piece. */
static uint32_t hilbert(uint32_t x, uint32_t y)
{
	uint32_t d = 0;

	for (uint32_t s = 128; s > 0; s /= 2) {
		uint32_t rx = (x & s) > 0, ry = (y & s) > 0;

		d += s * s * ((3 * rx) ^ ry);
		if (!ry) {
			uint32_t t = x;

			x = rx ? 255 - y : y;
			y = rx ? 255 - t : t;
		}
	}
	return d;
}

struct placed {
	uint32_t code, point;
};

static int by_code(const void *a, const void *b)
{
	const struct placed *p = a, *q = b;

	if (p->code != q->code)
		return p->code < q->code ? -1 : 1;
	return p->point < q->point ? -1 : p->point > q->point;
}

static void sort_patch(const struct bake *bake, size_t i, struct placed *placed)
{
	const struct surfel *surfel = &bake->set->surfels[i];
	uint32_t first = bake->patch_first[i], count = bake->patch_first[i + 1] - first;
	float normal[3], u[3], v[3];

	surfel_normal_unpack(surfel->normal, normal);
	surfel_frame(normal, u, v);
	for (uint32_t k = 0; k < count; k++) {
		uint32_t point = bake->patch_points[first + k];
		struct v3 d = v3_sub(bake->points[point].position, v3_of(surfel->position));
		float x = 0.5f + 0.5f * v3_dot(d, v3_of(u)) / bake->spacing;
		float y = 0.5f + 0.5f * v3_dot(d, v3_of(v)) / bake->spacing;

		placed[k].code = hilbert((uint32_t)(255 * fminf(fmaxf(x, 0), 1)),
					 (uint32_t)(255 * fminf(fmaxf(y, 0), 1)));
		placed[k].point = point;
	}
	qsort(placed, count, sizeof *placed, by_code);
	for (uint32_t k = 0; k < count; k++)
		bake->patch_points[first + k] = placed[k].point;
}

/* Points that belong to no patch (too few to matter; see bake_assign) are left out. */
static int collect(struct bake *bake)
{
	size_t count = bake->set->count;
	uint32_t *at = calloc(count + 2, sizeof *at);

	bake->patch_first = calloc(count + 1, sizeof *bake->patch_first);
	bake->patch_points = calloc(bake->point_count + 1, sizeof *bake->patch_points);
	bake->patch_sums = calloc(bake->point_count + 1, sizeof *bake->patch_sums);
	if (!at || !bake->patch_first || !bake->patch_points || !bake->patch_sums) {
		free(at);
		return GR_ERR_NOMEM;
	}
	for (size_t i = 0; i < bake->point_count; i++)
		if (bake->points[i].patch != SURFEL_NONE)
			at[bake->points[i].patch + 1]++;
	for (size_t i = 0; i < count; i++) {
		at[i + 1] += at[i];
		bake->patch_first[i + 1] = at[i + 1];
	}
	for (size_t i = 0; i < bake->point_count; i++)
		if (bake->points[i].patch != SURFEL_NONE)
			bake->patch_points[at[bake->points[i].patch]++] = (uint32_t)i;
	free(at);
	return GR_OK;
}

uint32_t bake_patch_point(const struct bake *bake, size_t i, float share)
{
	uint32_t low = bake->patch_first[i], high = bake->patch_first[i + 1] - 1;
	float at = share * bake->set->area[i];

	while (low < high) {
		uint32_t middle = low + (high - low) / 2;

		if (bake->patch_sums[middle] > at)
			high = middle;
		else
			low = middle + 1;
	}
	return bake->patch_points[low];
}

static void describe(struct bake *bake, size_t i)
{
	struct surfel_set *set = bake->set;
	double area = 0, sum[3] = { 0 };

	for (uint32_t k = bake->patch_first[i]; k < bake->patch_first[i + 1]; k++) {
		const struct bake_point *p = &bake->points[bake->patch_points[k]];
		float albedo[3];

		bake_albedo(bake, p, albedo);
		area += (double)p->area;
		bake->patch_sums[k] = (float)area;
		for (int c = 0; c < 3; c++)
			sum[c] += (double)p->area * (double)albedo[c];
	}
	set->area[i] = (float)area;
	for (int c = 0; c < 3; c++)
		set->albedo[i][c] = area > 0 ? (float)(sum[c] / area) : 0;
	for (uint32_t j = 0; j < set->taps_each; j++) {
		const struct bake_point *p = &bake->points[bake_patch_point(
			bake, i, ((float)j + 0.5f) / (float)set->taps_each)];
		struct surfel_tap *tap = &set->taps[i * set->taps_each + j];
		float normal[3];

		v3_put(p->position, tap->position);
		v3_put(bake_normal(bake, p->side), normal);
		tap->normal = surfel_normal_pack(normal);
	}
}

static void describe_all(void *ctx, size_t begin, size_t end, int thread)
{
	struct bake *bake = ctx;

	(void)thread;
	for (size_t i = begin; i < end; i++)
		describe(bake, i);
}

int bake_patch_data(struct bake *bake)
{
	struct surfel_set *set = bake->set;
	struct placed *placed;
	uint32_t most = 0;
	int result = collect(bake);

	if (result != GR_OK)
		return result;
	for (size_t i = 0; i < set->count; i++) {
		uint32_t n = bake->patch_first[i + 1] - bake->patch_first[i];

		most = n > most ? n : most;
	}
	set->taps_each = (uint32_t)bake->params.taps;
	set->area = calloc(set->count + 1, sizeof *set->area);
	set->albedo = calloc(set->count + 1, sizeof *set->albedo);
	set->taps = calloc(set->count * set->taps_each + 1, sizeof *set->taps);
	placed = calloc(most + 1, sizeof *placed);
	if (!set->area || !set->albedo || !set->taps || !placed) {
		free(placed);
		return GR_ERR_NOMEM;
	}
	for (size_t i = 0; i < set->count; i++)
		sort_patch(bake, i, placed);
	free(placed);
	return bake_run(bake, set->count, 64, describe_all, bake);
}
