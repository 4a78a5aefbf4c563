/* What a surface does with a link that meets it. */
#include "renderer/gi/surfel_bake_private.h"

#include "renderer/scene/environment.h"
#include "renderer/trace/sampler.h"

/* Mirrors that a link may meet; beyond, two that face each other hold it for ever. */
#define MIRRORS_MOST 64

static bool is_glossy(const struct scene_material *m)
{
	const float *s = m->specular;

	return m->kind != MATERIAL_MEASURED && (s[0] > 0 || s[1] > 0 || s[2] > 0);
}

static struct v3 diffuse_of(const struct bsdf *bsdf)
{
	bool has = bsdf->kind == MATERIAL_PHONG || bsdf->kind == MATERIAL_MEASURED;

	return has ? bsdf->diffuse : v3_all(0);
}

/*
 * The chance that a link goes on at a surface: as much as the lobe's weights can
 * be, (m + 8) / (m + 2) of its reflectance (bsdf.c), but no more than leaves room
 * for the diffuse part. Links have no weight, so colours of a lobe count as their mean.
 */
static float chance_of(const struct bsdf *bsdf)
{
	float chance = v3_mean(bsdf->specular);

	if (bsdf->kind == MATERIAL_MEASURED)
		return 0;
	if (bsdf->kind == MATERIAL_PHONG)
		chance *= (bsdf->shininess + 8) / (bsdf->shininess + 2);
	return fminf(chance, 1 - fminf(v3_most(diffuse_of(bsdf)), 1));
}

static void surface_of(const struct bake *bake, const struct ray_hit *hit, struct v3 way,
		       struct surface_hit *surface, struct bsdf *bsdf)
{
	world_hit(&bake->world, hit, way, surface);
	world_bsdf(&bake->world, surface, v3_scale(way, -1), bsdf);
}

void bake_albedo(const struct bake *bake, const struct bake_point *point, float out[3])
{
	struct ray_hit hit = { .triangle = point->side / 2, .u = point->u, .v = point->v };
	struct v3 toward = v3_scale(bake_normal(bake, point->side), -1), albedo;
	struct surface_hit surface;
	struct bsdf bsdf;
	float left;

	v3_put(bake->normals[hit.triangle], hit.normal);
	surface_of(bake, &hit, toward, &surface, &bsdf);
	left = 1 - chance_of(&bsdf);
	albedo = left > 0 ? v3_scale(diffuse_of(&bsdf), 1 / left) : v3_all(0);
	v3_put(albedo, out);
	for (int c = 0; c < 3; c++)
		out[c] = fminf(fmaxf(out[c], 0), 1);
}

/*
 * Whether a link goes on from a glossy surface, and then where to. Either the
 * lobe's direction is taken with the share of the chance that its weight is, or
 * the link is lost there.
 */
enum fate { ENDS, GOES_ON, LOST };
static enum fate bounce(const struct bake *bake, const struct ray_hit *hit,
			const struct sampler *sampler, uint32_t pair, struct v3 *from, struct v3 *way)
{
	struct surface_hit surface;
	struct bsdf bsdf;
	struct v3 weight, next;
	float u[2], v[2], chance, pdf;

	surface_of(bake, hit, *way, &surface, &bsdf);
	chance = chance_of(&bsdf);
	sampler_pair(sampler, pair, u);
	sampler_pair(sampler, pair + 1, v);
	if (u[0] >= chance)
		return ENDS;
	/* the lobe alone */
	bsdf.diffuse = v3_all(0);
	bsdf.lambert = 0;
	if (!bsdf_sample(&bsdf, v3_scale(*way, -1), 1, v, &next, &weight, &pdf) ||
	    u[1] * chance >= v3_mean(weight))
		return LOST;
	*from = v3_ahead(surface.position, surface.facing, surface.lift);
	*way = next;
	return GOES_ON;
}

/* What a mirror shows beside reflected light. */
static void add_light(const struct bake *bake, const struct ray_hit *hit, struct v3 from,
		      struct v3 way, float metres, struct bake_end *out)
{
	float radiance[3] = { 0 }, passes, mean;

	if (hit) {
		if (v3_dot(v3_of(hit->normal), way) < 0 || bake->two_sided[hit->triangle])
			v3_put(world_emission(&bake->world, hit->triangle, hit->u, hit->v), radiance);
	} else if (bake->scene->environment) {
		float to[3];

		v3_put(way, to);
		environment_radiance(bake->scene->environment, to, radiance);
	}
	metres += hit ? hit->distance : medium_exit(&bake->air, from, way);
	passes = expf(-bake->air.extinction * metres);
	for (int c = 0; c < 3; c++)
		out->light[c] += passes * radiance[c];
	mean = passes * v3_mean(v3_of(radiance));
	out->way += mean * metres;
	out->way2 += mean * metres * metres;
}

enum bake_meets bake_meets(const struct bake *bake, uint32_t side)
{
	uint32_t triangle = side / 2;

	if ((side & 1) && !bake->two_sided[triangle])
		return BAKE_NOTHING;
	return is_glossy(world_material(&bake->world, triangle)) ? BAKE_GLOSSY : BAKE_PLAIN;
}

void bake_follow(const struct bake *bake, struct v3 from, struct v3 way, uint64_t key,
		 struct bake_end *out)
{
	struct sampler sampler = { .key = key };
	float metres = 0; /* to where the ray begins now */

	*out = (struct bake_end){ .surfel = SURFEL_NONE };
	for (uint32_t bounces = 0; bounces <= MIRRORS_MOST; bounces++) {
		float at[3], to[3];
		struct ray_hit hit;
		enum fate fate;
		bool back;

		v3_put(from, at);
		v3_put(way, to);
		bool met = rays_nearest_front(bake->world.rays, at, to, INFINITY, &hit);
		if (bounces > 0)
			add_light(bake, met ? &hit : NULL, from, way, metres, out);
		if (!met)
			return;
		back = v3_dot(v3_of(hit.normal), way) > 0;
		if (back && !bake->two_sided[hit.triangle]) {
			out->back = bounces == 0;
			return;
		}
		fate = ENDS;
		metres += hit.distance;
		if (is_glossy(world_material(&bake->world, hit.triangle)))
			fate = bounce(bake, &hit, &sampler, 2 * bounces, &from, &way);
		if (fate == ENDS)
			out->surfel = bake_surfel_at(bake, v3_ahead(from, way, hit.distance),
						     2 * hit.triangle + back);
		if (fate != GOES_ON)
			return;
	}
}
