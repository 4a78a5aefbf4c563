/* Where links start: cosine-distributed rays from the points of a patch. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"
#include "renderer/gi/surfel_random.h"

#include <stdlib.h>

/* Places in a patch's area from where to look for a point (Chen and Asau 1974). */
#define GUIDES 64
/* Points of a patch of which more than one link starts about: they are made ready once. */
#define READY (2 * BAKE_POINTS_EACH)

int bake_link_tables(struct bake *bake)
{
	uint32_t count = bake->set->links_each;

	free(bake->sobol);
	bake->sobol = calloc(count, sizeof *bake->sobol);
	if (!bake->sobol)
		return GR_ERR_NOMEM;
	for (uint32_t j = 0; j < count; j++)
		sobol_raw(j, bake->sobol[j]);
	return bake_map(bake);
}

/*
 * Cosine and sine of a share 0..1 of a full turn, within 2e-7: the quarter turn that is
 * nearest, and Cephes' polynomials (Moshier) for what is left. Sooner than libm's,
 * and equal on every machine.
 */
static void turn(float share, float *out_cos, float *out_sin)
{
	int quarter = (int)(4 * share + 0.5f);
	float x = 2 * TRACE_PI * (share - 0.25f * (float)quarter), z = x * x;
	float s = x + x * z * (-1.6666654611e-1f + z * (8.3321608736e-3f - z * 1.9515295891e-4f));
	float c = 1 - 0.5f * z +
		  z * z *
			  (4.166664568298827e-2f +
			   z * (-1.388731625493765e-3f + z * 2.443315711809948e-5f));
	float along = quarter & 1 ? s : c, across = quarter & 1 ? c : s;

	*out_cos = (quarter + 1) & 2 ? -along : along;
	*out_sin = quarter & 2 ? -across : across;
}

static struct v3 about(const struct v3_frame *frame, const float u[2])
{
	float r = sqrtf(u[0]), c, s;

	turn(u[1], &c, &s);
	return v3_from_local(frame, (struct v3){ r * c, r * s, sqrtf(larger_of(1 - u[0], 0)) });
}

struct v3 bake_cosine(struct v3 normal, const float u[2])
{
	struct v3_frame frame = v3_frame_of(normal);

	return about(&frame, u);
}

struct start {
	struct v3 origin;
	struct v3_frame frame;
};

static struct start start_at(const struct bake *bake, uint32_t place)
{
	const struct bake_point *p = &bake->points[bake->patch_points[place]];
	struct v3 n = bake_normal(bake, p->side);

	return (struct start){ v3_ahead(p->position, n, bake->offset), v3_frame_of(n) };
}

struct patch {
	uint32_t first, last;	    /* places in patch_points */
	uint32_t guides[GUIDES];    /* for each share k / GUIDES of the area, what bake_patch_point
				       finds */
	struct start starts[READY]; /* of the first of its points */
};

static void make_ready(const struct bake *bake, size_t i, struct patch *out)
{
	uint32_t k = out->first = bake->patch_first[i];
	uint32_t last = out->last = bake->patch_first[i + 1] - 1;

	for (uint32_t at = k; at <= last && at < k + READY; at++)
		__builtin_prefetch(&bake->points[bake->patch_points[at]]);
	for (int g = 0; g < GUIDES; g++) {
		float at = (float)g / GUIDES * bake->set->area[i];

		while (k < last && bake->patch_sums[k] <= at)
			k++;
		out->guides[g] = k;
	}
	for (k = out->first; k <= last && k < out->first + READY; k++)
		__builtin_prefetch(&bake->normals[bake->points[bake->patch_points[k]].side / 2]);
	for (k = out->first; k <= last && k < out->first + READY; k++)
		out->starts[k - out->first] = start_at(bake, k);
}

/* As bake_patch_point. */
static uint32_t guided_place(const struct bake *bake, const struct patch *patch, float area,
			     float share)
{
	uint32_t k = patch->guides[(int)(share * GUIDES)];
	float at = share * area;

	while (k < patch->last && bake->patch_sums[k] <= at)
		k++;
	return k;
}

void bake_link_rays(const struct bake *bake, size_t i, uint32_t first, struct bake_links_rays *out)
{
	uint32_t left = bake->set->links_each - first, seeds[3];
	struct patch patch;

	out->count = left < BAKE_LINKS_AT_ONCE ? left : BAKE_LINKS_AT_ONCE;
	make_ready(bake, i, &patch);
	sobol_seeds(random_start(bake->params.seed, i), seeds);
	for (uint32_t k = 0; k < out->count; k++) {
		struct start other;
		const struct start *start = &other;
		uint32_t place;
		float u[3];

		sobol_owen(bake->sobol[first + k], seeds, u);
		place = guided_place(bake, &patch, bake->set->area[i], u[2]);
		if (place - patch.first < READY)
			start = &patch.starts[place - patch.first];
		else
			other = start_at(bake, place);
		v3_put(start->origin, out->ray[k].origin);
		v3_put(about(&start->frame, u), out->ray[k].direction);
	}
}
