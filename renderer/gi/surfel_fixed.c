/* Light that does not change: of emissive surfaces and of the environment. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"
#include "renderer/gi/surfel_random.h"
#include "renderer/scene/environment.h"
#include "renderer/trace/path.h"

#include <stdatomic.h>
#include <stdlib.h>

/* Points of a patch for it; each has so many samples that all are about as many as links. */
#define POINTS_EACH 16

struct fixed {
	struct bake *bake;
	struct scene dark;        /* the scene without what surrounds it */
	struct path_scene emissive;
	int sets;                 /* of SAMPLER_SET samples a point */
	atomic_size_t rays;
};

static struct v3 point_start(const struct bake *bake, const struct bake_point *p)
{
	return v3_ahead(p->position, bake_normal(bake, p->side), bake->offset);
}

/* Mean over the patch of what the emissive surfaces send straight. */
static void light_emissive(struct fixed *f, size_t i)
{
	const struct bake *bake = f->bake;
	double sum[3] = { 0 }, way = 0, way2 = 0;
	size_t rays = 0;

	for (int k = 0; k < POINTS_EACH; k++) {
		uint32_t point = bake_patch_point(bake, i, ((float)k + 0.5f) / POINTS_EACH);
		const struct bake_point *p = &bake->points[point];

		for (int s = 0; s < f->sets; s++) {
			struct sampler sampler = sampler_start(bake->params.seed,
							       i * POINTS_EACH + (size_t)k,
							       (uint64_t)s);

			for (uint32_t j = 0; j < SAMPLER_SET; j++) {
				struct path_light light;
				float e[3];

				sampler_point(&sampler, j);
				light = path_irradiance(&f->emissive, &sampler, p->position,
							bake_normal(bake, p->side));
				rays += light.rays;
				way += (double)light.way;
				way2 += (double)light.way2;
				v3_put(light.total, e);
				for (int c = 0; c < 3; c++)
					sum[c] += (double)e[c];
			}
		}
	}
	for (int c = 0; c < 3; c++)
		bake->set->fixed_emissive[i][c] = (float)(sum[c] / (POINTS_EACH * f->sets * SAMPLER_SET));
	surfel_way_of((sum[0] + sum[1] + sum[2]) / 3, way, way2, bake->set->fixed_way[i]);
	atomic_fetch_add(&f->rays, rays);
}

static bool is_open(const struct bake *bake, struct v3 from, const float way[3])
{
	float at[3];

	v3_put(from, at);
	return !rays_blocked_along(bake->world.rays, at, way, INFINITY);
}

static float power_weight(float a, float b)
{
	return a * a / (a * a + b * b);
}

/* Light from outside of everything enters the air where the bounds begin. */
static void add_sky(const struct bake *bake, struct v3 from, struct v3 way, float weight,
		    const float radiance[3], double sum[5])
{
	const float metres = medium_exit(&bake->air, from, way);
	const double passes = (double)(weight * expf(-bake->air.extinction * metres));
	double mean = 0;

	for (int c = 0; c < 3; c++) {
		sum[c] += passes * (double)radiance[c];
		mean += passes * (double)radiance[c] / 3;
	}
	sum[3] += mean * (double)metres;
	sum[4] += mean * (double)metres * (double)metres;
}

/*
 * The environment, by its own density and by the cosine, weighed by the power
 * heuristic (Veach 1997): a sun is small, a sky is not.
 */
static void light_environment(const struct fixed *f, size_t i)
{
	const struct bake *bake = f->bake;
	const struct environment *environment = bake->scene->environment;
	uint64_t key = random_start(bake->params.seed ^ UINT64_C(0x736b79), i);
	uint32_t count = bake->set->links_each;
	double sum[5] = { 0 }; /* of three bands; times the way, and its square */

	for (uint32_t j = 0; j < count; j++) {
		float u[3], v[3], way[3], radiance[3];
		const struct bake_point *p;
		struct v3 n, from;

		sobol_point(key, j, u);
		sobol_point(~key, j, v);
		p = &bake->points[bake_patch_point(bake, i, u[2])];
		n = bake_normal(bake, p->side);
		from = point_start(bake, p);
		float pdf = environment_sample(environment, (double)v[0], (double)v[1], way, radiance);
		float cosine = v3_dot(v3_of(way), n);
		if (cosine > 0 && is_open(bake, from, way))
			add_sky(bake, from, v3_of(way), power_weight(pdf, cosine / TRACE_PI) * cosine / pdf,
				radiance, sum);
		v3_put(bake_cosine(n, u), way);
		cosine = v3_dot(v3_of(way), n);
		environment_radiance(environment, way, radiance);
		if (cosine > 0 && radiance[0] + radiance[1] + radiance[2] > 0 &&
		    is_open(bake, from, way))
			add_sky(bake, from, v3_of(way),
				power_weight(cosine / TRACE_PI, environment_pdf(environment, way)) * TRACE_PI,
				radiance, sum);
	}
	for (int c = 0; c < 3; c++)
		bake->set->fixed_other[i][c] += (float)(sum[c] / count);
	bake->set->fixed_way[i][2] += (float)(sum[3] / count);
	bake->set->fixed_way[i][3] += (float)(sum[4] / count);
}

/* What was summed so far. */
static void settle_way(struct surfel_set *set, size_t i)
{
	const float *light = set->fixed_other[i];
	float *way = set->fixed_way[i];

	surfel_way_of(((double)light[0] + (double)light[1] + (double)light[2]) / 3, (double)way[2],
		      (double)way[3], way + 2);
}

static void light_all(void *ctx, size_t begin, size_t end, int thread)
{
	struct fixed *f = ctx;

	(void)thread;
	for (size_t i = begin; i < end; i++) {
		if (f->emissive.emitters.count > 0)
			light_emissive(f, i);
		if (f->bake->scene->environment)
			light_environment(f, i);
	}
}

int bake_fixed(struct bake *bake)
{
	struct fixed f = { .bake = bake, .dark = *bake->scene };
	struct surfel_set *set = bake->set;
	int result;

	set->fixed_emissive = calloc(set->count + 1, sizeof *set->fixed_emissive);
	if (!set->fixed_emissive)
		return GR_ERR_NOMEM;
	f.dark.environment = NULL;
	f.emissive.world = bake->world;
	f.emissive.world.scene = &f.dark;
	f.emissive.medium = bake->air;
	f.sets = (bake->params.links + POINTS_EACH * SAMPLER_SET - 1) / (POINTS_EACH * SAMPLER_SET);
	result = emitters_init(&f.emissive.emitters, &f.emissive.world);
	if (result == GR_ERR_RANGE)
		gr_diag_add(bake->diag, GR_DIAG_ERROR, NULL, 0, NULL,
			    "a material's emission is not finite; a scene's import would have refused it");
	if (result == GR_OK && f.emissive.emitters.count + (bake->scene->environment != NULL) > 0)
		result = bake_run(bake, set->count, 4, light_all, &f);
	for (size_t i = 0; i < set->count; i++)
		settle_way(set, i);
	set->rays += atomic_load(&f.rays);
	if (bake->scene->environment)
		set->rays += set->count * set->links_each * 2;
	emitters_finish(&f.emissive.emitters);
	return result;
}
