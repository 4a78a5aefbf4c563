/* What lights a surfel: rays from its patch to the surfels that they meet. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/clock.h"
#include "base/result.h"
#include "renderer/gi/surfel_random.h"

#include <stdlib.h>

/*
 * A point of another triangle is on the same surface when it is no more than this
 * off the plane, of its distance: what bends is, the other face of a thin wall is
 * not. And those on the plane come first.
 */
#define OFF_PLANE 0.4f
#define OFF_WEIGHT 32.0f
#define LINKS_AT_ONCE 64

/* The nearest point of a side among those of one cell; NULL: there is none nearer than *square. */
static const struct bake_near *nearest_in(const struct bake *bake, struct v3 position,
					  uint32_t side, const int step[3], float *square)
{
	const uint32_t *items;
	size_t n = bake_cells_at(&bake->cells, position, step, &items);
	const struct bake_near *near = bake->near + (items - bake->cells.items), *found = NULL;

	for (size_t k = 0; k < n; k++) {
		struct v3 d = v3_sub(near[k].position, position);
		float s = v3_dot(d, d);

		if (s >= *square)
			continue;
		if (near[k].side != side) {
			struct v3 m = bake_normal(bake, side);
			float off = v3_dot(d, m);

			if (v3_dot(bake_normal(bake, near[k].side), m) < BAKE_SAME_SIDE ||
			    off * off > OFF_PLANE * OFF_PLANE * s)
				continue;
			s += OFF_WEIGHT * off * off;
			if (s >= *square)
				continue;
		}
		*square = s;
		found = &near[k];
	}
	return found;
}

/* Seen from the surfel, as reach knows it. */
static bool in_sight(const struct bake *bake, const struct bake_near *near, struct v3 position)
{
	float at[3];

	if (!near || near->patch == SURFEL_NONE)
		return false;
	v3_put(position, at);
	/* in a cavity reach says nothing */
	return bake->set->surfels[near->patch].reach[0] == 1 ||
	       surfel_sight(bake->set, near->patch, at) <= 1;
}

uint32_t bake_surfel_at(const struct bake *bake, struct v3 position, uint32_t side)
{
	static const int here[3] = { 0, 0, 0 };
	float square = INFINITY;
	const struct bake_near *found = nearest_in(bake, position, side, here, &square);
	struct bake_point p = { .position = position, .side = side, .lift = bake->lift };
	uint32_t surfel;

	if (in_sight(bake, found, position))
		return found->patch;
	for (int k = 0; k < 27; k++) {
		const int step[3] = { k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1 };
		const struct bake_near *other = nearest_in(bake, position, side, step, &square);

		found = other ? other : found;
	}
	if (in_sight(bake, found, position))
		return found->patch;
	/* Beside a wall: the point may belong to what is on its other side. */
	if (found)
		p.lift = bake->points[bake->cells.items[found - bake->near]].lift;
	surfel = bake_nearest_surfel(bake, &p);
	return surfel == SURFEL_NONE && found ? found->patch : surfel;
}

struct v3 bake_cosine(struct v3 normal, const float u[2])
{
	struct v3_frame frame = v3_frame_of(normal);
	float r = sqrtf(u[0]), phi = 2 * TRACE_PI * u[1];

	return v3_from_local(&frame, (struct v3){ r * cosf(phi), r * sinf(phi),
						  sqrtf(fmaxf(1 - u[0], 0)) });
}

void bake_link_ray(const struct bake *bake, size_t i, uint32_t j, struct v3 *from, struct v3 *way)
{
	const struct bake_point *p;
	struct v3 n;
	float u[3];

	sobol_point(random_start(bake->params.seed, i), j, u);
	p = &bake->points[bake_patch_point(bake, i, u[2])];
	n = bake_normal(bake, p->side);
	*from = v3_ahead(p->position, n, bake->offset);
	*way = bake_cosine(n, u);
}

/* Links whose ray has met a plain surface, and where. */
struct batch {
	uint32_t link[LINKS_AT_ONCE], side[LINKS_AT_ONCE];
	struct v3 position[LINKS_AT_ONCE];
	uint32_t count;
};

/*
 * Which surfels the hits belong to. They lie all over the scene, and memory
 * answers late: all are asked for before the first is read.
 */
static void look_up(const struct bake *bake, struct batch *batch, uint32_t *links)
{
	static const int here[3] = { 0, 0, 0 };

	for (uint32_t k = 0; k < batch->count; k++)
		bake_cells_expect(&bake->cells, batch->position[k]);
	for (uint32_t k = 0; k < batch->count; k++) {
		const uint32_t *items;
		size_t n = bake_cells_at(&bake->cells, batch->position[k], here, &items);
		const char *near = (const char *)(bake->near + (items - bake->cells.items));

		for (size_t at = 0; at < n * sizeof *bake->near && at < 512; at += 64)
			__builtin_prefetch(near + at);
	}
	for (uint32_t k = 0; k < batch->count; k++)
		links[batch->link[k]] = bake_surfel_at(bake, batch->position[k], batch->side[k]);
	batch->count = 0;
}

void bake_link_surfel(const struct bake *bake, size_t i, uint32_t *links, float light[3])
{
	const uint32_t count = bake->set->links_each;
	const float share = TRACE_PI / (float)count;
	uint64_t key = random_start(bake->params.seed, i);
	struct batch batch;

	batch.count = 0;
	for (uint32_t j = 0; j < count; j++) {
		struct bake_end found;
		struct v3 from, way;

		bake_link_ray(bake, i, j, &from, &way);
		switch (bake_meets(bake, from, way, &batch.position[batch.count],
				   &batch.side[batch.count])) {
		case BAKE_NOTHING:
			links[j] = SURFEL_NONE;
			break;
		case BAKE_PLAIN:
			batch.link[batch.count++] = j;
			if (batch.count == LINKS_AT_ONCE)
				look_up(bake, &batch, links);
			break;
		case BAKE_GLOSSY:
			bake_follow(bake, from, way, random_mix(key + j), &found);
			links[j] = found.surfel;
			for (int c = 0; c < 3; c++)
				light[c] += share * found.light[c];
			break;
		}
	}
	look_up(bake, &batch, links);
}

static void link_all(void *ctx, size_t begin, size_t end, int thread)
{
	struct bake *bake = ctx;
	struct surfel_set *set = bake->set;

	(void)thread;
	for (size_t i = begin; i < end; i++)
		bake_link_surfel(bake, i, set->links + i * set->links_each, set->fixed_other[i]);
}

int bake_links(struct bake *bake)
{
	struct surfel_set *set = bake->set;
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	int result;

	set->links_each = (uint32_t)bake->params.links;
	set->links = malloc((set->count * set->links_each + 1) * sizeof *set->links);
	set->fixed_other = calloc(set->count + 1, sizeof *set->fixed_other);
	if (!set->links || !set->fixed_other)
		return GR_ERR_NOMEM;
	set->rays += set->count * set->links_each;
	result = bake_run(bake, set->count, 8, link_all, bake);
	set->ray_seconds = (double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9;
	return result;
}
