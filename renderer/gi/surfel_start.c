/* Where links start: cosine-distributed rays from the points of a patch. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"
#include "renderer/gi/surfel_random.h"

#include <stdlib.h>

/* Places in a patch's area from where to look for a point (Chen and Asau 1974). */
#define GUIDES 64
/* Points of a patch that memory is asked for beforehand. */
#define POINTS_EXPECTED (2 * BAKE_POINTS_EACH)
int bake_link_tables(struct bake *bake)
{
	uint32_t count = bake->set->links_each;

	bake->sobol = calloc(count, sizeof *bake->sobol);
	bake->meets = calloc(2 * bake->triangle_count + 1, sizeof *bake->meets);
	if (!bake->sobol || !bake->meets)
		return GR_ERR_NOMEM;
	for (uint32_t j = 0; j < count; j++)
		sobol_raw(j, bake->sobol[j]);
	for (size_t side = 0; side < 2 * bake->triangle_count; side++)
		bake->meets[side] = (uint8_t)bake_meets(bake, (uint32_t)side);
	return GR_OK;
}

struct v3 bake_cosine(struct v3 normal, const float u[2])
{
	struct v3_frame frame = v3_frame_of(normal);
	float r = sqrtf(u[0]), phi = 2 * TRACE_PI * u[1];

	return v3_from_local(&frame, (struct v3){ r * cosf(phi), r * sinf(phi),
						  sqrtf(fmaxf(1 - u[0], 0)) });
}

/* For each share k / GUIDES of the area, what bake_patch_point finds. Its points are asked for. */
static void guide(const struct bake *bake, size_t i, uint32_t guides[GUIDES])
{
	uint32_t k = bake->patch_first[i], last = bake->patch_first[i + 1] - 1;

	for (uint32_t at = k; at <= last && at < k + POINTS_EXPECTED; at++)
		__builtin_prefetch(&bake->points[bake->patch_points[at]]);
	for (int g = 0; g < GUIDES; g++) {
		float at = (float)g / GUIDES * bake->set->area[i];

		while (k < last && bake->patch_sums[k] <= at)
			k++;
		guides[g] = k;
	}
}

/* As bake_patch_point. */
static uint32_t guided_point(const struct bake *bake, size_t i, const uint32_t guides[GUIDES],
			     float share)
{
	uint32_t k = guides[(int)(share * GUIDES)], last = bake->patch_first[i + 1] - 1;
	float at = share * bake->set->area[i];

	while (k < last && bake->patch_sums[k] <= at)
		k++;
	return bake->patch_points[k];
}

void bake_link_rays(const struct bake *bake, size_t i, uint32_t first, struct bake_links_rays *out)
{
	uint32_t left = bake->set->links_each - first;
	uint32_t guides[GUIDES], seeds[3];

	out->count = left < BAKE_LINKS_AT_ONCE ? left : BAKE_LINKS_AT_ONCE;
	guide(bake, i, guides);
	sobol_seeds(random_start(bake->params.seed, i), seeds);
	for (uint32_t k = 0; k < out->count; k++) {
		const struct bake_point *p;
		struct v3 n;
		float u[3];

		sobol_owen(bake->sobol[first + k], seeds, u);
		p = &bake->points[guided_point(bake, i, guides, u[2])];
		n = bake_normal(bake, p->side);
		v3_put(v3_ahead(p->position, n, bake->offset), out->ray[k].origin);
		v3_put(bake_cosine(n, u), out->ray[k].direction);
	}
}
