/* Probes for what moves: links over the whole sphere, and distances all around. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"
#include "renderer/gi/surfel_random.h"
#include "renderer/scene/environment.h"

#include <stdlib.h>

#define PROBES_MOST ((size_t)1 << 17)
/* More of the sphere than this shows unlit backs: inside of something. */
#define BACKS_MOST 0.25f
/* Rays that a texel of the distances has for itself, in a square. */
#define DISTANCE_RAYS 2
#define TEXELS (SURFEL_PROBE_SIDE * SURFEL_PROBE_SIDE)

static struct v3 probe_position(const struct surfel_probes *probes, size_t i)
{
	size_t x = i % (size_t)probes->size[0];
	size_t y = i / (size_t)probes->size[0] % (size_t)probes->size[1];
	size_t z = i / (size_t)probes->size[0] / (size_t)probes->size[1];
	struct v3 at = { (float)x, (float)y, (float)z };

	return v3_ahead(v3_of(probes->origin), at, probes->cell_m);
}

static int lay_out(struct bake *bake)
{
	struct surfel_probes *probes = &bake->set->probes;
	double longest = 0, count = 1;

	for (int k = 0; k < 3; k++)
		longest = fmax(longest, (double)(bake->max[k] - bake->min[k]));
	probes->cell_m = (float)(longest / bake->params.probes);
	for (int k = 0; k < 3; k++) {
		double side = (double)(bake->max[k] - bake->min[k]);
		double cells = fmax(ceil(side / (double)probes->cell_m - 0.01), 1);

		probes->size[k] = (int32_t)cells;
		/* in the middle of the bounds */
		probes->origin[k] = (float)(0.5 * ((double)bake->min[k] + (double)bake->max[k]) -
					    0.5 * (cells - 1) * (double)probes->cell_m);
		count *= cells;
	}
	if (count > (double)PROBES_MOST || count * bake->params.links > (double)SURFEL_LINKS_MOST) {
		gr_diag_add(bake->diag, GR_DIAG_ERROR, NULL, 0, "probes",
			    "%d cells along the longest side are %.0f probes of %d links; at most %zu, "
			    "and %zu links, are accepted",
			    bake->params.probes, count, bake->params.links, PROBES_MOST,
			    SURFEL_LINKS_MOST);
		return GR_ERR_RANGE;
	}
	probes->count = (size_t)count;
	probes->links_each = (uint32_t)bake->params.links;
	return GR_OK;
}

static int reserve(struct surfel_probes *probes)
{
	probes->directions = calloc(probes->links_each, sizeof *probes->directions);
	probes->links = calloc(probes->count * probes->links_each, sizeof *probes->links);
	probes->fixed = calloc(probes->count, sizeof *probes->fixed);
	probes->fixed_way = calloc(probes->count, sizeof *probes->fixed_way);
	probes->distance = calloc(probes->count, sizeof *probes->distance);
	probes->alive = calloc(probes->count, sizeof *probes->alive);
	return probes->directions && probes->links && probes->fixed && probes->fixed_way &&
			       probes->distance && probes->alive
		       ? GR_OK
		       : GR_ERR_NOMEM;
}

/* A spherical Fibonacci lattice (Marques et al. 2013). */
static void spread_directions(struct surfel_probes *probes)
{
	const double golden = 2.3999632297286533;

	for (uint32_t k = 0; k < probes->links_each; k++) {
		double z = 1 - (2 * (double)k + 1) / (double)probes->links_each;
		double r = sqrt(1 - z * z), phi = golden * (double)k;

		probes->directions[k][0] = (float)(r * cos(phi));
		probes->directions[k][1] = (float)(r * sin(phi));
		probes->directions[k][2] = (float)z;
	}
}

/* Of x and y in 0..1 (Cigolle et al. 2014). */
static struct v3 octahedral(float x, float y)
{
	float a = 2 * x - 1, b = 2 * y - 1;
	float z = 1 - fabsf(a) - fabsf(b), fold = fmaxf(-z, 0);

	return v3_unit((struct v3){ a - copysignf(fold, a), b - copysignf(fold, b), z });
}

/* Farther than a cell's diagonal no one asks. */
static void look_around(const struct bake *bake, size_t i)
{
	struct surfel_probes *probes = &bake->set->probes;
	const float most = 2 * probes->cell_m;
	float from[3];

	v3_put(probe_position(probes, i), from);
	for (int t = 0; t < TEXELS; t++) {
		double sum = 0, square = 0;

		for (int k = 0; k < DISTANCE_RAYS * DISTANCE_RAYS; k++) {
			float x = (float)(t % SURFEL_PROBE_SIDE) +
				  ((float)(k % DISTANCE_RAYS) + 0.5f) / DISTANCE_RAYS;
			float y = (float)(t / SURFEL_PROBE_SIDE) +
				  ((float)(k / DISTANCE_RAYS) + 0.5f) / DISTANCE_RAYS;
			float way[3];
			struct ray_hit hit;
			double d = (double)most;

			v3_put(octahedral(x / SURFEL_PROBE_SIDE, y / SURFEL_PROBE_SIDE), way);
			if (rays_nearest(bake->world.rays, from, way, most, &hit))
				d = (double)hit.distance;
			sum += d / (DISTANCE_RAYS * DISTANCE_RAYS);
			square += d * d / (DISTANCE_RAYS * DISTANCE_RAYS);
		}
		probes->distance[i][t][0] = (float)sum;
		probes->distance[i][t][1] = (float)square;
	}
}

/* Real spherical harmonics of three bands; order l, m from -l to l. */
static void harmonics(const float d[3], float out[SURFEL_SH])
{
	out[0] = 0.282094792f;
	out[1] = 0.488602512f * d[1];
	out[2] = 0.488602512f * d[2];
	out[3] = 0.488602512f * d[0];
	out[4] = 1.092548431f * d[0] * d[1];
	out[5] = 1.092548431f * d[1] * d[2];
	out[6] = 0.315391565f * (3 * d[2] * d[2] - 1);
	out[7] = 1.092548431f * d[0] * d[2];
	out[8] = 0.546274215f * (d[0] * d[0] - d[1] * d[1]);
}

static void add_harmonics(float fixed[SURFEL_SH][3], const float way[3], float share,
			  const float radiance[3])
{
	float sh[SURFEL_SH];

	harmonics(way, sh);
	for (int j = 0; j < SURFEL_SH; j++)
		for (int c = 0; c < 3; c++)
			fixed[j][c] += share * sh[j] * radiance[c];
}

/* Sums until all is there. */
static void add_way(float way[2], float light, float metres)
{
	way[0] += light * metres;
	way[1] += light * metres * metres;
}

/* The environment, by its own density: a sun falls between links. */
static void see_environment(const struct bake *bake, size_t i)
{
	struct surfel_probes *probes = &bake->set->probes;
	uint64_t key = random_start(bake->params.seed ^ UINT64_C(0x736b7970), i);
	float from[3];

	v3_put(probe_position(probes, i), from);
	for (uint32_t k = 0; k < probes->links_each; k++) {
		float u[3], way[3], radiance[3];

		sobol_point(key, k, u);
		float pdf = environment_sample(bake->scene->environment, (double)u[0], (double)u[1],
					       way, radiance);
		if (!rays_blocked_along(bake->world.rays, from, way, INFINITY)) {
			float metres = medium_exit(&bake->air, v3_of(from), v3_of(way));
			float share = expf(-bake->air.extinction * metres) /
				      (pdf * (float)probes->links_each);

			add_harmonics(probes->fixed[i], way, share, radiance);
			add_way(probes->fixed_way[i], share * v3_mean(v3_of(radiance)), metres);
		}
	}
}

/* All light that arrives is the first coefficient over its function. */
static void settle_way(struct surfel_probes *probes, size_t i)
{
	const float *all = probes->fixed[i][0];
	float *way = probes->fixed_way[i];

	surfel_way_of(((double)all[0] + (double)all[1] + (double)all[2]) / (3 * 0.282094792),
		      (double)way[0], (double)way[1], way);
}

static void link_probe(const struct bake *bake, size_t i)
{
	struct surfel_probes *probes = &bake->set->probes;
	struct v3 from = probe_position(probes, i);
	uint64_t key = random_start(bake->params.seed ^ UINT64_C(0x70726f6265), i);
	float share = 4 * TRACE_PI / (float)probes->links_each;
	uint32_t backs = 0;

	for (uint32_t k = 0; k < probes->links_each; k++) {
		struct bake_end end;

		bake_follow(bake, from, v3_of(probes->directions[k]), random_mix(key + k), &end);
		probes->links[i * probes->links_each + k] = end.surfel;
		backs += end.back;
		add_harmonics(probes->fixed[i], probes->directions[k], share, end.light);
		probes->fixed_way[i][0] += share * end.way;
		probes->fixed_way[i][1] += share * end.way2;
	}
	probes->alive[i] = (float)backs <= BACKS_MOST * (float)probes->links_each;
	if (bake->scene->environment)
		see_environment(bake, i);
	settle_way(probes, i);
	look_around(bake, i);
}

static void link_all(void *ctx, size_t begin, size_t end, int thread)
{
	(void)thread;
	for (size_t i = begin; i < end; i++)
		link_probe(ctx, i);
}

int bake_probes(struct bake *bake)
{
	struct surfel_probes *probes = &bake->set->probes;
	int result = lay_out(bake);

	if (result == GR_OK)
		result = reserve(probes);
	if (result != GR_OK) {
		probes->count = 0;
		return result;
	}
	spread_directions(probes);
	bake->set->rays += probes->count * (probes->links_each +
					    TEXELS * DISTANCE_RAYS * DISTANCE_RAYS);
	return bake_run(bake, probes->count, 4, link_all, bake);
}
