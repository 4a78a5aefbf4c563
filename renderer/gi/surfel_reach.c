/* How far one sees along the surface from each surfel. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

/* A curved surface is followed over so many steps. */
#define WALK_STEPS 6
/* Heard less than this, a point is not heard: a weight at the rim of all that counts. */
#define HEARD_LEAST 2e-3f

/* On |x| + |y| = 1, as surfel_set.h says. */
static void sector_direction(int k, float *x, float *y)
{
	float f = (float)(k % 4) / 4;

	switch (k / 4) {
	case 0: *x = 1 - f, *y = f; break;
	case 1: *x = -f, *y = 1 - f; break;
	case 2: *x = f - 1, *y = -f; break;
	default: *x = f, *y = f - 1; break;
	}
}

static struct v3 across(struct v3 w, struct v3 n)
{
	return v3_ahead(w, n, -v3_dot(w, n));
}

/*
 * Metres seen along unit `way` in the plane of a point, no more than `most`.
 * Where the surface itself rises before the ray, as in a barrel, it goes on
 * along it.
 */
static float look(const struct bake *bake, const struct bake_point *p, struct v3 way, float most)
{
	struct v3 normal = bake_normal(bake, p->side), n = normal, d = way;
	struct v3 from = v3_ahead(p->position, n, p->lift);

	for (int step = 0; step < WALK_STEPS; step++) {
		float seen = v3_dot(v3_sub(from, p->position), way), left, at[3], to[3];
		float slope = v3_dot(d, way);
		struct ray_hit hit;
		struct v3 facing;

		if (seen >= most || slope < 0.1f)
			return fminf(fmaxf(seen, 0), most);
		left = (most - seen) / slope;
		v3_put(from, at);
		v3_put(d, to);
		if (!rays_nearest(bake->world.rays, at, to, left, &hit))
			return most;
		facing = v3_of(hit.normal);
		if (v3_dot(facing, d) > 0)
			facing = v3_scale(facing, -1);
		from = v3_ahead(from, d, hit.distance);
		if (v3_dot(facing, n) < BAKE_SAME_SIDE)
			return fminf(fmaxf(v3_dot(v3_sub(from, p->position), way), 0), most);
		n = facing;
		d = v3_unit(across(d, n));
		from = v3_ahead(from, n, p->lift);
	}
	return fminf(fmaxf(v3_dot(v3_sub(from, p->position), way), 0), most);
}

static void look_around(void *ctx, size_t begin, size_t end, int thread)
{
	struct bake *bake = ctx;
	const float whole = 1.41421356f * bake->radius; /* |x| + |y| that 255 stands for */

	(void)thread;
	for (size_t i = begin; i < end; i++) {
		const struct bake_point *p = &bake->points[bake->chosen[i]];
		struct surfel *surfel = &bake->set->surfels[i];
		float normal[3], u[3], v[3];

		v3_put(p->position, surfel->position);
		v3_put(bake_normal(bake, p->side), normal);
		surfel->normal = surfel_normal_pack(normal);
		/* the frame that readers compute, from the normal as they know it */
		surfel_normal_unpack(surfel->normal, normal);
		surfel_frame(normal, u, v);
		for (int k = 0; k < SURFEL_SECTORS; k++) {
			float x, y, length, most, seen;

			sector_direction(k, &x, &y);
			length = sqrtf(x * x + y * y);
			most = whole * length;
			struct v3 way = v3_add(v3_scale(v3_of(u), x / length),
					       v3_scale(v3_of(v), y / length));
			seen = p->covered ? 0 : look(bake, p, way, most);
			surfel->reach[k] = (uint8_t)fmaxf(floorf(255 * seen / most), p->covered ? 1 : 2);
		}
	}
}

int bake_reach(struct bake *bake)
{
	struct surfel_set *set = bake->set;
	int result;

	free(set->surfels);
	free(set->grid.keys);
	free(set->grid.first);
	free(set->grid.members);
	memset(&set->grid, 0, sizeof set->grid);
	set->count = bake->chosen_count;
	set->surfels = calloc(set->count + 1, sizeof *set->surfels);
	if (!set->surfels)
		return GR_ERR_NOMEM;
	result = bake_run(bake, set->count, 16, look_around, bake);
	if (result == GR_OK)
		result = surfel_grid_build(set, bake->min, bake->max);
	return result;
}

struct hearing {
	struct bake *bake;
	bool *unheard;
};

static void listen(void *ctx, size_t begin, size_t end, int thread)
{
	struct hearing *h = ctx;
	const struct bake *bake = h->bake;

	(void)thread;
	for (size_t i = begin; i < end; i++) {
		const struct bake_point *p = &bake->points[i];
		const uint32_t *members;
		float position[3], normal[3], sum = 0;
		size_t n;

		v3_put(p->position, position);
		v3_put(bake_normal(bake, p->side), normal);
		n = surfel_set_cell(bake->set, position, &members);
		for (size_t k = 0; k < n && sum < HEARD_LEAST; k++)
			sum += surfel_weight(bake->set, members[k], position, normal);
		h->unheard[i] = sum < HEARD_LEAST && !p->covered;
	}
}

int bake_unheard(struct bake *bake, uint32_t **out, size_t *out_count)
{
	struct hearing h = { bake, calloc(bake->point_count + 1, sizeof *h.unheard) };
	int result = GR_ERR_NOMEM;
	size_t count = 0;

	*out = NULL;
	*out_count = 0;
	if (!h.unheard)
		return result;
	result = bake_run(bake, bake->point_count, 256, listen, &h);
	for (size_t i = 0; i < bake->point_count; i++)
		count += h.unheard[i];
	*out = malloc((count + 1) * sizeof **out);
	if (!*out)
		result = GR_ERR_NOMEM;
	for (size_t i = 0; i < bake->point_count && result == GR_OK; i++)
		if (h.unheard[i])
			(*out)[(*out_count)++] = (uint32_t)i;
	free(h.unheard);
	return result;
}
