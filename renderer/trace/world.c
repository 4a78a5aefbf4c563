#include "renderer/trace/world.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

int world_init(struct world *out, const struct scene *scene, int threads)
{
	size_t triangles = scene->index_count / 3;
	int result;

	memset(out, 0, sizeof *out);
	out->scene = scene;
	texel_curve_init(&out->curve);
	out->material = calloc(triangles ? triangles : 1, sizeof *out->material);
	if (!out->material)
		return GR_ERR_NOMEM;
	for (size_t d = 0; d < scene->draw_count; d++) {
		const struct scene_draw *draw = &scene->draws[d];

		for (uint32_t i = 0; i < draw->index_count / 3; i++)
			out->material[draw->first_index / 3 + i] = draw->material;
	}
	if (triangles > 0)
		out->lift = world_lift(v3_of(scene->min), v3_of(scene->max), v3_all(0.0f));
	result = rays_create_threads(&out->rays, scene, threads);
	if (result != GR_OK)
		world_finish(out);
	return result;
}

void world_finish(struct world *world)
{
	rays_destroy(&world->rays);
	free(world->material);
	world->material = NULL;
}

const struct scene_material *world_material(const struct world *world, unsigned triangle)
{
	return &world->scene->materials[world->material[triangle]];
}

static const struct scene_vertex *vertex_of(const struct world *world, unsigned triangle, int corner)
{
	const struct scene *scene = world->scene;

	return &scene->vertices[scene->indices[3 * (size_t)triangle + (size_t)corner]];
}

struct v3 world_corner(const struct world *world, unsigned triangle, int corner)
{
	return v3_of(vertex_of(world, triangle, corner)->position);
}

static struct v3 between(struct v3 a, struct v3 b, struct v3 c, float u, float v)
{
	return v3_ahead(v3_ahead(v3_scale(a, 1.0f - u - v), b, u), c, v);
}

/* White where the material has no such texture. */
static struct v3 texture_at(const struct world *world, int image, unsigned triangle, float u, float v)
{
	const struct scene_vertex *a, *b, *c;
	float uv[2], texel[3];

	if (image < 0 || (size_t)image >= world->scene->image_count)
		return v3_all(1.0f);
	a = vertex_of(world, triangle, 0);
	b = vertex_of(world, triangle, 1);
	c = vertex_of(world, triangle, 2);
	for (int i = 0; i < 2; i++)
		uv[i] = (1.0f - u - v) * a->uv[i] + u * b->uv[i] + v * c->uv[i];
	texel_at(&world->curve, &world->scene->images[image], uv, texel);
	return v3_of(texel);
}

struct v3 world_emission(const struct world *world, unsigned triangle, float u, float v)
{
	const struct scene_material *m = world_material(world, triangle);
	struct v3 emission = v3_of(m->emission);

	if (v3_black(emission))
		return emission;
	return v3_mul(emission, texture_at(world, m->emission_image, triangle, u, v));
}

/* The interpolated normal; the geometric one where that is none. */
static struct v3 shading_normal(const struct world *world, unsigned triangle, float u, float v,
				struct v3 front)
{
	struct v3 n = between(v3_of(vertex_of(world, triangle, 0)->normal),
			      v3_of(vertex_of(world, triangle, 1)->normal),
			      v3_of(vertex_of(world, triangle, 2)->normal), u, v);
	float length = v3_length(n);

	return length > 1e-6f ? v3_scale(n, 1.0f / length) : front;
}

void world_hit(const struct world *world, const struct ray_hit *hit, struct v3 direction,
	       struct surface_hit *out)
{
	const struct scene_material *m = world_material(world, hit->triangle);
	struct v3 a = world_corner(world, hit->triangle, 0);
	struct v3 b = world_corner(world, hit->triangle, 1);
	struct v3 c = world_corner(world, hit->triangle, 2);
	struct v3 front = v3_of(hit->normal);
	bool back = v3_dot(front, direction) > 0.0f;
	float side = back ? -1.0f : 1.0f;

	out->position = between(a, b, c, hit->u, hit->v);
	out->lift = world_lift(a, b, c);
	out->triangle = hit->triangle;
	out->u = hit->u;
	out->v = hit->v;
	out->facing = v3_scale(front, side);
	out->dark = back && !m->two_sided;
	if (out->dark) {
		out->shading = out->facing;
		out->emission = v3_all(0.0f);
		return;
	}
	out->shading = v3_scale(shading_normal(world, hit->triangle, hit->u, hit->v, front), side);
	out->emission = world_emission(world, hit->triangle, hit->u, hit->v);
}

bool world_at_edge(const struct world *world, const struct surface_hit *hit)
{
	struct v3 corner[3], along, cross;
	float longest = 0.0f, least;

	for (int k = 0; k < 3; k++)
		corner[k] = world_corner(world, hit->triangle, k);
	for (int k = 0; k < 3; k++) {
		along = v3_sub(corner[(k + 1) % 3], corner[k]);
		longest = larger_of(longest, v3_length(along));
	}
	cross = v3_cross(v3_sub(corner[1], corner[0]), v3_sub(corner[2], corner[0]));
	/* of the three heights the least is that on the longest side */
	least = longest > 0.0f ? v3_length(cross) / longest : 0.0f;
	return smaller_of(hit->u, smaller_of(hit->v, 1.0f - hit->u - hit->v)) * least <
	       2.0f * hit->lift;
}

void world_bsdf(const struct world *world, const struct surface_hit *hit, struct v3 viewer,
		struct bsdf *out)
{
	const struct scene_material *m = world_material(world, hit->triangle);
	struct v3 tint = texture_at(world, m->diffuse_image, hit->triangle, hit->u, hit->v);
	struct v3 specular = v3_of(m->specular);

	if (m->tinted_specular)
		specular = v3_mul(specular, tint);
	bsdf_init(out, world->scene, m, v3_mul(v3_of(m->diffuse), tint), specular, hit->facing,
		  hit->shading, viewer);
}
