/* Which points become surfels, and to which surfel each point belongs. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"
#include "renderer/gi/surfel_random.h"

#include <stdlib.h>
#include <string.h>

/* How far apart the planes of a patch's points may be, of a surfel's tolerance. */
#define SAME_PLANE 0.6f

static bool close_enough(const struct bake *bake, const struct bake_point *a,
			 const struct bake_point *b, float most_m, float *out_square)
{
	struct v3 d = v3_sub(a->position, b->position);
	struct v3 n = bake_normal(bake, a->side), m = bake_normal(bake, b->side);
	float square = v3_dot(d, d);
	float off = 0.5f * fabsf(v3_dot(d, n) + v3_dot(d, m));

	*out_square = square;
	return square < most_m * most_m && v3_dot(n, m) > BAKE_SAME_SIDE &&
	       off < SAME_PLANE * SURFEL_PLANE * bake->spacing;
}

bool bake_sees(const struct bake *bake, const struct bake_point *a, const struct bake_point *b)
{
	float from[3], to[3];

	v3_put(v3_ahead(a->position, bake_normal(bake, a->side), a->lift), from);
	v3_put(v3_ahead(b->position, bake_normal(bake, b->side), b->lift), to);
	return !rays_blocked(bake->world.rays, from, to);
}

static bool same_surface(const struct bake *bake, const struct bake_point *a,
			 const struct bake_point *b, float most_m)
{
	float square;

	return close_enough(bake, a, b, most_m, &square) && bake_sees(bake, a, b);
}

/* Chains of chosen points in hashed cells of the spacing's size; grows. */
struct chains {
	float cell_m;
	size_t slots;
	uint32_t *head; /* of each slot; UINT32_MAX: none */
	uint32_t *next; /* of each chosen one */
};

static uint32_t chain_slot(const struct chains *c, struct v3 p, int x, int y, int z)
{
	uint64_t key = (uint64_t)((int64_t)floorf(p.x / c->cell_m) + x);

	key = key * UINT64_C(0x9e3779b97f4a7c15) + (uint64_t)((int64_t)floorf(p.y / c->cell_m) + y);
	key = key * UINT64_C(0x9e3779b97f4a7c15) + (uint64_t)((int64_t)floorf(p.z / c->cell_m) + z);
	return (uint32_t)(random_mix(key) & (c->slots - 1));
}

static int chains_init(struct chains *c, const struct bake *bake)
{
	c->cell_m = bake->spacing;
	c->slots = 1 << 16;
	c->head = malloc(c->slots * sizeof *c->head);
	c->next = malloc(SURFEL_MOST * sizeof *c->next);
	if (!c->head || !c->next)
		return GR_ERR_NOMEM;
	memset(c->head, 0xff, c->slots * sizeof *c->head);
	return GR_OK;
}

static void chains_finish(struct chains *c)
{
	free(c->head);
	free(c->next);
}

static bool is_covered(const struct bake *bake, const struct chains *c, const struct bake_point *p)
{
	/* its own cell first */
	for (int j = 13; j < 40; j++) {
		int k = j % 27;
		uint32_t i = c->head[chain_slot(c, p->position, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)];

		for (; i != UINT32_MAX; i = c->next[i])
			if (same_surface(bake, p, &bake->points[bake->chosen[i]], bake->spacing))
				return true;
	}
	return false;
}

static int choose(struct bake *bake, struct chains *c, uint32_t point)
{
	uint32_t i = (uint32_t)bake->chosen_count;
	uint32_t slot;

	if (bake->chosen_count == SURFEL_MOST)
		return GR_ERR_RANGE;
	slot = chain_slot(c, bake->points[point].position, 0, 0, 0);
	bake->chosen[i] = point;
	c->next[i] = c->head[slot];
	c->head[slot] = i;
	bake->chosen_count++;
	return GR_OK;
}

int bake_choose(struct bake *bake, const uint32_t *only, size_t only_count)
{
	size_t count = only ? only_count : bake->point_count;
	uint32_t *order = malloc((count + 1) * sizeof *order);
	uint64_t state = random_start(bake->params.seed, UINT64_MAX);
	struct chains chains = { 0 };
	int result = chains_init(&chains, bake);

	if (!order)
		result = GR_ERR_NOMEM;
	for (size_t i = 0; i < count && result == GR_OK; i++)
		order[i] = only ? only[i] : (uint32_t)i;
	for (size_t i = 0; i < count && result == GR_OK; i++) {
		size_t j = i + (size_t)(random_uniform(&state) * (double)(count - i));
		uint32_t point = order[j];

		order[j] = order[i];
		if (!is_covered(bake, &chains, &bake->points[point]))
			result = choose(bake, &chains, point);
		if ((i & 0xffff) == 0 && !bake_told(bake, (double)i / (double)count))
			result = GR_NOTHING;
	}
	chains_finish(&chains);
	free(order);
	return result;
}

/* Order along a space-filling curve: neighbours lie together in memory. */
struct placed {
	uint64_t code;
	uint32_t point;
};

static int by_code(const void *a, const void *b)
{
	const struct placed *p = a, *q = b;

	if (p->code != q->code)
		return p->code < q->code ? -1 : 1;
	return p->point < q->point ? -1 : p->point > q->point;
}

static uint64_t spread_bits(uint64_t x)
{
	x &= 0x1fffff;
	x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
	x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
	x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
	x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
	return (x | x << 2) & UINT64_C(0x1249249249249249);
}

static uint64_t morton(const struct bake *bake, struct v3 p)
{
	const float at[3] = { p.x, p.y, p.z };
	uint64_t code = 0;
	float side = 0;

	for (int i = 0; i < 3; i++)
		side = fmaxf(side, bake->max[i] - bake->min[i]);
	for (int i = 0; i < 3; i++) {
		float share = side > 0 ? (at[i] - bake->min[i]) / side : 0;

		code |= spread_bits((uint64_t)(fminf(fmaxf(share, 0), 0.99999f) * 0x1p21f)) << i;
	}
	return code;
}

int bake_sort_chosen(struct bake *bake)
{
	struct placed *placed = malloc((bake->chosen_count + 1) * sizeof *placed);

	if (!placed)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < bake->chosen_count; i++)
		placed[i] = (struct placed){ morton(bake, bake->points[bake->chosen[i]].position),
					     bake->chosen[i] };
	qsort(placed, bake->chosen_count, sizeof *placed, by_code);
	for (size_t i = 0; i < bake->chosen_count; i++)
		bake->chosen[i] = placed[i].point;
	free(placed);
	return GR_OK;
}

static struct v3 chosen_position(const void *ctx, size_t i)
{
	const struct bake *bake = ctx;

	return bake->points[bake->chosen[i]].position;
}

#define CANDIDATES 64

struct candidate {
	uint32_t surfel;
	float square;
};

static int gather_candidates(const struct bake *bake, const struct bake_point *p,
			     struct candidate out[CANDIDATES])
{
	int count = 0;

	for (int k = 0; k < 27; k++) {
		const int step[3] = { k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1 };
		const uint32_t *items;
		size_t n = bake_cells_at(&bake->surfel_cells, p->position, step, &items);

		for (size_t j = 0; j < n && count < CANDIDATES; j++) {
			struct candidate c = { .surfel = items[j] };

			if (close_enough(bake, p, &bake->points[bake->chosen[c.surfel]],
					 bake->spacing, &c.square))
				out[count++] = c;
		}
	}
	return count;
}

uint32_t bake_nearest_surfel(const struct bake *bake, const struct bake_point *p)
{
	struct candidate candidates[CANDIDATES];
	int count = gather_candidates(bake, p, candidates);

	while (count > 0) {
		int best = 0;

		for (int i = 1; i < count; i++)
			if (candidates[i].square < candidates[best].square)
				best = i;
		if (bake_sees(bake, p, &bake->points[bake->chosen[candidates[best].surfel]]))
			return candidates[best].surfel;
		candidates[best] = candidates[--count];
	}
	return SURFEL_NONE;
}

static void assign(void *ctx, size_t begin, size_t end, int thread)
{
	struct bake *bake = ctx;

	(void)thread;
	for (size_t i = begin; i < end; i++)
		bake->points[i].patch = bake_nearest_surfel(bake, &bake->points[i]);
}

/*
 * Sight along a surface from a surfel is at least the shortest of its reaches, in
 * radii; as far as that is from it, no one need compute it.
 */
static float clear_around(const struct bake *bake, const struct bake_point *p)
{
	const struct surfel *surfel;
	float least = 255, left;
	struct v3 d;

	if (p->patch == SURFEL_NONE)
		return -1;
	surfel = &bake->set->surfels[p->patch];
	if (surfel->reach[0] == 1)
		return INFINITY; /* in a cavity reach says nothing */
	for (int k = 0; k < SURFEL_SECTORS; k++)
		least = fminf(least, surfel->reach[k]);
	d = v3_sub(p->position, v3_of(surfel->position));
	left = 0.999f * least / 255 * bake->radius - sqrtf(v3_dot(d, d));
	return left > 0 ? left : -1;
}

static void describe_near(void *ctx, size_t begin, size_t end, int thread)
{
	struct bake *bake = ctx;

	(void)thread;
	for (size_t k = begin; k < end; k++) {
		const struct bake_point *p = &bake->points[bake->cells.items[k]];

		bake->near[k] = (struct bake_near){
			.position = p->position,
			.normal = bake_normal(bake, p->side),
			.side = p->side,
			.patch = p->patch,
			.clear_m = clear_around(bake, p),
		};
	}
}

int bake_assign(struct bake *bake)
{
	int result = bake_cells_build(&bake->surfel_cells, bake->spacing, bake->chosen_count,
				      chosen_position, bake);

	if (result == GR_OK)
		result = bake_run(bake, bake->point_count, 256, assign, bake);
	/* A surfel's own point is its own, whatever stands nearby. */
	for (size_t i = 0; i < bake->chosen_count && result == GR_OK; i++)
		bake->points[bake->chosen[i]].patch = (uint32_t)i;
	if (result != GR_OK)
		return result;
	bake->near = calloc(bake->point_count + 1, sizeof *bake->near);
	if (!bake->near)
		return GR_ERR_NOMEM;
	return bake_run(bake, bake->point_count, 1024, describe_near, bake);
}
