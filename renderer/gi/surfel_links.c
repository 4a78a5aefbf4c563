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
#define LOOK_UPS 32 /* at once */

/* Points of a cell. */
struct crowd {
	const struct bake_near *near;
	size_t count;
};

static struct crowd crowd_of(const struct bake *bake, const uint32_t *items, size_t count)
{
	return (struct crowd){ bake->near + (items - bake->cells.items), count };
}

/* The nearest point of a side in a crowd; NULL: there is none nearer than *square. */
static const struct bake_near *nearest_in(const struct bake *bake, struct crowd crowd,
					  struct v3 position, uint32_t side, float *square)
{
	const struct bake_near *near = crowd.near, *found = NULL;
	const struct v3 m = bake_normal(bake, side);

	for (size_t k = 0; k < crowd.count; k++) {
		struct v3 d = v3_sub(near[k].position, position);
		float s = v3_dot(d, d);

		if (s >= *square)
			continue;
		if (near[k].side != side) {
			float off = v3_dot(d, m);

			if (v3_dot(near[k].normal, m) < BAKE_SAME_SIDE ||
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

/* bake_surfel_at, of a position whose cell's points are known. */
static uint32_t surfel_among(const struct bake *bake, struct crowd here, struct v3 position,
			     uint32_t side)
{
	float square = INFINITY;
	const struct bake_near *found = nearest_in(bake, here, position, side, &square);
	struct bake_point p = { .position = position, .side = side, .lift = bake->lift };
	uint32_t surfel;

	if (found && (square <= found->clear || in_sight(bake, found, position)))
		return found->patch;
	for (int k = 0; k < 27; k++) {
		const int step[3] = { k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1 };
		const uint32_t *items;
		size_t n = bake_cells_at(&bake->cells, position, step, &items);
		const struct bake_near *other =
			nearest_in(bake, crowd_of(bake, items, n), position, side, &square);

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

uint32_t bake_surfel_at(const struct bake *bake, struct v3 position, uint32_t side)
{
	static const int here[3] = { 0, 0, 0 };
	const uint32_t *items;
	size_t n = bake_cells_at(&bake->cells, position, here, &items);

	return surfel_among(bake, crowd_of(bake, items, n), position, side);
}

/* Links whose ray has met a plain surface, and where. */
struct batch {
	uint32_t link[BAKE_LINKS_AT_ONCE], side[BAKE_LINKS_AT_ONCE];
	struct v3 position[BAKE_LINKS_AT_ONCE];
	uint32_t count;
};

/*
 * Which surfels the hits belong to, of at most LOOK_UPS from `from` on. They lie all
 * over the scene, and memory answers late: all are asked for before the first is read.
 */
static void look_up(const struct bake *bake, const struct batch *batch, uint32_t from,
		    uint32_t end, uint32_t *links)
{
	uint64_t cells[LOOK_UPS];
	struct crowd crowds[LOOK_UPS];

	for (uint32_t k = from; k < end; k++)
		cells[k - from] = bake_cells_expect(&bake->cells, batch->position[k]);
	for (uint32_t k = from; k < end; k++) {
		const uint32_t *items;
		size_t n = bake_cells_of(&bake->cells, cells[k - from], &items);
		const char *near;

		crowds[k - from] = crowd_of(bake, items, n);
		near = (const char *)crowds[k - from].near;
		for (size_t at = 0; at < n * sizeof *bake->near && at < 512; at += 64)
			__builtin_prefetch(near + at);
		__builtin_prefetch(&bake->normals[batch->side[k] / 2]);
	}
	for (uint32_t k = from; k < end; k++)
		links[batch->link[k]] = surfel_among(bake, crowds[k - from], batch->position[k],
						     batch->side[k]);
}

/* A link that meets a glossy surface goes on. */
static uint32_t link_glossy(const struct bake *bake, const struct ray_start *ray, uint64_t key,
			    float light[3])
{
	const float share = TRACE_PI / (float)bake->set->links_each;
	struct bake_end found;

	bake_follow(bake, v3_of(ray->origin), v3_of(ray->direction), key, &found);
	for (int c = 0; c < 3; c++)
		light[c] += share * found.light[c];
	return found.surfel;
}

void bake_link_surfel(const struct bake *bake, size_t i, uint32_t *links, float light[3])
{
	uint64_t key = random_start(bake->params.seed, i);
	struct ray_met met[BAKE_LINKS_AT_ONCE];
	struct bake_links_rays rays;
	struct batch batch;

	for (uint32_t first = 0; first < bake->set->links_each; first += rays.count) {
		bake_link_rays(bake, i, first, &rays);
		rays_nearest_many(bake->world.rays, rays.count, rays.ray, met);
		batch.count = 0;
		for (uint32_t k = 0; k < rays.count; k++) {
			const struct ray_start *ray = &rays.ray[k];
			uint32_t j = first + k, side = 2 * met[k].triangle + met[k].back;
			enum bake_meets meets = met[k].triangle == RAYS_NONE ? BAKE_NOTHING :
									       bake->meets[side];

			links[j] = SURFEL_NONE;
			if (meets == BAKE_GLOSSY)
				links[j] = link_glossy(bake, ray, random_mix(key + j), light);
			if (meets != BAKE_PLAIN)
				continue;
			batch.link[batch.count] = j;
			batch.side[batch.count] = side;
			batch.position[batch.count++] =
				v3_ahead(v3_of(ray->origin), v3_of(ray->direction), met[k].distance);
		}
		for (uint32_t from = 0; from < batch.count; from += LOOK_UPS)
			look_up(bake, &batch, from,
				from + LOOK_UPS < batch.count ? from + LOOK_UPS : batch.count, links);
	}
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
	result = bake_link_tables(bake);
	if (result == GR_OK)
		result = bake_run(bake, set->count, 8, link_all, bake);
	set->ray_seconds = (double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9;
	return result;
}
