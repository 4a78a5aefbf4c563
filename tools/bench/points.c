#include "tools/bench/points.h"

#include "base/result.h"
#include "renderer/trace/rays.h"

#include <cglm/cglm.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OPEN_RAYS 24 /* that tell whether a point lies inside of something */

struct sampler {
	const struct scene *scene;
	const struct rays *rays;
	const bool *one_sided; /* of each triangle */
	uint64_t state;
	float margin;
};

/* SplitMix64 (Steele et al. 2014), to [0, 1). */
static double uniform(uint64_t *state)
{
	uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));

	z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
	return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static bool reflects_diffusely(const struct scene_material *m)
{
	if (m->kind == MATERIAL_MIRROR || m->kind == MATERIAL_CONDUCTOR)
		return false;
	return m->diffuse[0] > 0 || m->diffuse[1] > 0 || m->diffuse[2] > 0;
}

static float *corner(const struct scene *scene, size_t index)
{
	return scene->vertices[scene->indices[index]].position;
}

/* Area and unit front normal of the triangle whose first index is that. */
static double triangle(const struct scene *scene, size_t index, vec3 normal)
{
	vec3 a, b;
	float length;

	glm_vec3_sub(corner(scene, index + 1), corner(scene, index), a);
	glm_vec3_sub(corner(scene, index + 2), corner(scene, index), b);
	glm_vec3_cross(a, b, normal);
	length = glm_vec3_norm(normal);
	if (!(length > 0) || !isfinite(length))
		return 0;
	glm_vec3_scale(normal, 1 / length, normal);
	return 0.5 * (double)length;
}

/* Nothing else within the margin in front of and around the point. */
static bool stands_clear(const struct sampler *s, const struct renderer_point *p)
{
	vec3 from;

	for (int i = 0; i < 3; i++)
		from[i] = p->position[i] + 0.05f * s->margin * p->normal[i];
	for (int k = 0; k < 27; k++) {
		vec3 way = { (float)(k % 3 - 1), (float)(k / 3 % 3 - 1), (float)(k / 9 - 1) };
		struct ray_hit hit;

		if (k == 13)
			continue;
		glm_vec3_normalize(way);
		if (way[0] * p->normal[0] + way[1] * p->normal[1] + way[2] * p->normal[2] < -1e-3f)
			continue;
		if (rays_nearest(s->rays, from, way, s->margin, &hit))
			return false;
	}
	return true;
}

/*
 * Not enclosed by a solid thing that stands on it (the floor under a box): most
 * of what it sees is not the unlit back of a surface.
 */
static bool is_open(struct sampler *s, const struct renderer_point *p)
{
	int backs = 0;
	vec3 from;

	for (int i = 0; i < 3; i++)
		from[i] = p->position[i] + 0.05f * s->margin * p->normal[i];
	for (int k = 0; k < OPEN_RAYS; k++) {
		double z = 2 * uniform(&s->state) - 1, turn = 2 * M_PI * uniform(&s->state);
		double r = sqrt(1 - z * z);
		vec3 way = { (float)(r * cos(turn)), (float)(r * sin(turn)), (float)z };
		struct ray_hit hit;

		/* the sphere's points about the normal's tip: cosine-distributed */
		glm_vec3_add(way, (float *)p->normal, way);
		glm_vec3_normalize(way);
		backs += rays_nearest(s->rays, from, way, INFINITY, &hit) && s->one_sided[hit.triangle] &&
			 glm_vec3_dot(hit.normal, way) > 0;
	}
	return 2 * backs < OPEN_RAYS;
}

static void place(struct sampler *s, size_t index, const vec3 normal, bool back,
		  struct renderer_point *out)
{
	double u = sqrt(uniform(&s->state)), v = uniform(&s->state);
	const double weights[3] = { 1 - u, u * (1 - v), u * v };

	memset(out, 0, sizeof *out);
	for (size_t c = 0; c < 3; c++)
		for (int i = 0; i < 3; i++)
			out->position[i] += (float)weights[c] * corner(s->scene, index + c)[i];
	for (int i = 0; i < 3; i++)
		out->normal[i] = back ? -normal[i] : normal[i];
}

static double lit_area(const struct scene *scene)
{
	double sum = 0;
	vec3 normal;

	for (size_t d = 0; d < scene->draw_count; d++) {
		const struct scene_draw *draw = &scene->draws[d];
		const struct scene_material *m = &scene->materials[draw->material];

		for (size_t i = 0; reflects_diffusely(m) && i < draw->index_count; i += 3)
			sum += triangle(scene, draw->first_index + i, normal) * (m->two_sided ? 2 : 1);
	}
	return sum;
}

/* Walks along the sides' areas; a point each `step`, at a random place within it. */
static size_t spread(struct sampler *s, double step, size_t wanted, struct renderer_point *out)
{
	const struct scene *scene = s->scene;
	double at = 0, next = uniform(&s->state) * step;
	size_t taken = 0, tried = 0;

	for (size_t d = 0; d < scene->draw_count; d++) {
		const struct scene_draw *draw = &scene->draws[d];
		const struct scene_material *m = &scene->materials[draw->material];

		if (!reflects_diffusely(m))
			continue;
		for (size_t i = 0; i < draw->index_count; i += 3) {
			size_t index = draw->first_index + i;
			vec3 normal;
			double area = triangle(scene, index, normal);

			for (int side = 0; side < (m->two_sided ? 2 : 1); side++) {
				for (at += area; next < at && tried < wanted; tried++) {
					place(s, index, normal, side, &out[taken]);
					taken += stands_clear(s, &out[taken]) && is_open(s, &out[taken]);
					next = ((double)(tried + 1) + uniform(&s->state)) * step;
				}
			}
		}
	}
	return taken;
}

static bool *find_one_sided(const struct scene *scene)
{
	bool *one_sided = calloc(scene->index_count / 3 + 1, sizeof *one_sided);

	for (size_t d = 0; one_sided && d < scene->draw_count; d++)
		for (size_t i = 0; i < scene->draws[d].index_count; i += 3)
			one_sided[(scene->draws[d].first_index + i) / 3] =
				!scene->materials[scene->draws[d].material].two_sided;
	return one_sided;
}

int bench_points_create(struct bench_points *out, const struct scene *scene, size_t wanted,
			uint64_t seed)
{
	double area = lit_area(scene);
	struct sampler s = { .scene = scene, .state = seed };
	struct rays *rays = NULL;
	bool *one_sided;
	int result = GR_ERR_NOMEM;

	*out = (struct bench_points){ 0 };
	if (!(area > 0) || !wanted)
		return GR_NOTHING;
	for (int i = 0; i < 3; i++)
		s.margin = fmaxf(s.margin, (float)POINTS_MARGIN * (scene->max[i] - scene->min[i]));
	out->points = calloc(wanted, sizeof *out->points);
	s.one_sided = one_sided = find_one_sided(scene);
	if (out->points && one_sided)
		result = rays_create(&rays, scene);
	if (result == GR_OK) {
		s.rays = rays;
		out->area = area / (double)wanted;
		out->count = spread(&s, out->area, wanted, out->points);
		result = out->count ? GR_OK : GR_NOTHING;
	}
	rays_destroy(&rays);
	free(one_sided);
	if (result != GR_OK)
		bench_points_finish(out);
	return result;
}

void bench_points_finish(struct bench_points *points)
{
	free(points->points);
	*points = (struct bench_points){ 0 };
}
