/* What lights a surfel: rays from its patch to the surfels that they meet. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/clock.h"
#include "base/result.h"
#include "renderer/gi/surfel_random.h"

#include <stdlib.h>

/* A link that meets a glossy surface goes on. */
static uint32_t link_glossy(const struct bake *bake, const struct ray_start *ray, uint64_t key,
			    float light[3], float way[4])
{
	const float share = TRACE_PI / (float)bake->set->links_each;
	struct bake_end found;

	bake_follow(bake, v3_of(ray->origin), v3_of(ray->direction), key, &found);
	for (int c = 0; c < 3; c++)
		light[c] += share * found.light[c];
	way[2] += share * found.way;
	way[3] += share * found.way2;
	return found.surfel;
}

/* Links first..first+count-1 of those of a surfel, whose rays have met something. */
static void look_up(const struct bake *bake, uint32_t count, const struct ray_start *rays,
		    const struct ray_met *met, uint64_t key, uint32_t first, uint32_t *links,
		    float light[3], float way[4])
{
	struct bake_place places[BAKE_PLACES];

	bake_map_expect(bake, count, rays, met, places);
	for (uint32_t k = 0; k < count; k++) {
		uint32_t j = first + k;

		links[j] = SURFEL_NONE;
		if (places[k].meets == BAKE_PLAIN)
			links[j] = bake_map_read(bake, &rays[k], &met[k], &places[k]);
		else if (places[k].meets == BAKE_GLOSSY)
			links[j] = link_glossy(bake, &rays[k], random_mix(key + j), light, way);
	}
}

static void link_surfel(const struct bake *bake, size_t i, uint32_t *links, float light[3],
			float way[4])
{
	uint64_t key = random_start(bake->params.seed, i);
	struct ray_met met[BAKE_LINKS_AT_ONCE];
	struct bake_links_rays rays;

	for (uint32_t first = 0; first < bake->set->links_each; first += rays.count) {
		bake_link_rays(bake, i, first, &rays);
		rays_nearest_many(bake->world.rays, rays.count, rays.ray, met);
		for (uint32_t k = 0; k < rays.count; k += BAKE_PLACES)
			look_up(bake, rays.count - k < BAKE_PLACES ? rays.count - k : BAKE_PLACES,
				rays.ray + k, met + k, key, first + k, links, light, way);
	}
}

static void link_all(void *ctx, size_t begin, size_t end, int thread)
{
	struct bake *bake = ctx;
	struct surfel_set *set = bake->set;

	(void)thread;
	for (size_t i = begin; i < end; i++)
		link_surfel(bake, i, set->links + i * set->links_each, set->fixed_other[i],
			    set->fixed_way[i]);
}

int bake_links(struct bake *bake)
{
	struct surfel_set *set = bake->set;
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	int result;

	/* again, when its speed is measured */
	free(set->links);
	free(set->fixed_other);
	free(set->fixed_way);
	set->links_each = (uint32_t)bake->params.links;
	set->links = malloc((set->count * set->links_each + 1) * sizeof *set->links);
	set->fixed_other = calloc(set->count + 1, sizeof *set->fixed_other);
	set->fixed_way = calloc(set->count + 1, sizeof *set->fixed_way);
	if (!set->links || !set->fixed_other || !set->fixed_way)
		return GR_ERR_NOMEM;
	set->rays += set->count * set->links_each;
	result = bake_link_tables(bake);
	if (result == GR_OK)
		result = bake_run(bake, set->count, 8, link_all, bake);
	set->ray_seconds = (double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9;
	return result;
}
