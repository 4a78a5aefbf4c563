/* Points spread evenly by area over all sides. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"
#include "renderer/gi/surfel_random.h"

#include <stdlib.h>

#define POINTS_MOST ((size_t)1 << 25)
/* That lie on each other within a plane's tolerance. */
#define SHEETS_MOST 8

/* Heitz 2019, "A Low-Distortion Map Between Triangle and Square". */
static void put_in(const struct scene *scene, size_t triangle, float x, float y,
		   struct bake_point *out)
{
	const uint32_t *v = scene->indices + 3 * triangle;
	struct v3 a = v3_of(scene->vertices[v[0]].position);
	struct v3 b = v3_of(scene->vertices[v[1]].position);
	struct v3 c = v3_of(scene->vertices[v[2]].position);

	if (y > x) {
		x *= 0.5f;
		y -= x;
	} else {
		y *= 0.5f;
		x -= y;
	}
	out->u = x;
	out->v = y;
	out->position = v3_add(v3_scale(a, 1 - x - y), v3_add(v3_scale(b, x), v3_scale(c, y)));
}

static size_t count_of(double area, double each)
{
	double n = floor(area / each + 0.5);

	return n < 1 ? 1 : (size_t)fmin(n, 1e12);
}

static double side_area(const struct bake *bake, size_t piece, int side)
{
	double area = 0;

	for (uint32_t k = bake->piece_first[piece]; k < bake->piece_first[piece + 1]; k++) {
		uint32_t t = bake->piece_order[k];

		if (side == 0 || bake->two_sided[t])
			area += (double)bake->areas[t];
	}
	return area;
}

/*
 * One side of a piece: equal steps of area along its triangles, places in a
 * triangle by Roberts' R2 sequence, which is even over any number of them.
 */
static void scatter(struct bake *bake, size_t piece, int side, double area, size_t count)
{
	double step = area / (double)count, sum = 0;
	uint64_t state = random_start(bake->params.seed, 2 * piece + (size_t)side);
	double next = random_uniform(&state) * step;
	double x = random_uniform(&state), y = random_uniform(&state);
	size_t made = 0;
	uint32_t last = bake->piece_first[piece + 1] - 1;

	for (uint32_t k = bake->piece_first[piece]; k <= last && made < count; k++) {
		uint32_t t = bake->piece_order[k];

		if (side == 1 && !bake->two_sided[t])
			continue;
		sum += (double)bake->areas[t];
		while (made < count && next < sum) {
			x += 0.75487766624669276;
			y += 0.56984029099805327;
			x -= floor(x);
			y -= floor(y);
			bake->points[bake->point_count] = (struct bake_point){
				.side = 2 * t + (uint32_t)side,
				.area = (float)step,
			};
			put_in(bake->scene, t, (float)x, (float)y,
			       &bake->points[bake->point_count++]);
			made++;
			next += step;
		}
	}
	/* rounding of the sum may leave the last one out */
	if (made < count && made > 0) {
		bake->points[bake->point_count] = bake->points[bake->point_count - 1];
		bake->point_count++;
	}
}

static struct v3 position_of(const void *ctx, size_t i)
{
	return ((const struct bake *)ctx)->points[i].position;
}

/*
 * Whether a sheet closely above a point has beyond it another surface of the
 * point's side, which is free: then the point is inside of a thin wall, and
 * what lights it must not be heard on that surface.
 */
static bool is_covered(const struct bake *bake, const struct bake_point *p)
{
	const float tolerance = SURFEL_PLANE * bake->spacing;
	struct v3 n = bake_normal(bake, p->side);
	float gone = bake->offset, to[3];

	v3_put(n, to);
	for (int sheets = 0; sheets < SHEETS_MOST; sheets++) {
		float from[3], along;
		struct ray_hit hit;

		v3_put(v3_ahead(p->position, n, gone), from);
		if (!rays_nearest(bake->world.rays, from, to, 2 * tolerance, &hit))
			return sheets > 0;
		if (sheets > 0 && hit.distance > tolerance)
			return true;
		along = v3_dot(v3_of(hit.normal), n);
		if (gone + hit.distance > tolerance ||
		    !(bake->two_sided[hit.triangle] ? fabsf(along) > 0.5f : along > 0.5f))
			return false;
		gone += hit.distance + bake->offset;
	}
	return false;
}

/* Sight is looked for below what covers a point closely: a panel on a wall. */
static void find_lifts(void *ctx, size_t begin, size_t end, int thread)
{
	struct bake *bake = ctx;

	(void)thread;
	for (size_t i = begin; i < end; i++) {
		struct bake_point *p = &bake->points[i];
		struct v3 n = bake_normal(bake, p->side);
		float from[3], to[3];
		struct ray_hit hit;

		v3_put(v3_ahead(p->position, n, bake->offset), from);
		v3_put(n, to);
		p->lift = bake->lift;
		if (rays_nearest(bake->world.rays, from, to, 2 * bake->lift, &hit))
			p->lift = fmaxf(0.5f * hit.distance, bake->offset);
		p->covered = p->lift < bake->lift && is_covered(bake, p);
	}
}

int bake_points(struct bake *bake)
{
	/* Poisson discs at random fill about 0.7 of spacing^2 each. */
	double each = (double)bake->spacing * (double)bake->spacing / 0.7 / BAKE_POINTS_EACH;
	size_t total = 0;
	int result;

	for (size_t p = 0; p < bake->piece_count; p++)
		for (int side = 0; side < 2; side++) {
			double area = side_area(bake, p, side);

			if (area > 0)
				total += count_of(area, each);
		}
	if (total > POINTS_MOST)
		return GR_ERR_RANGE;
	bake->points = calloc(total + 1, sizeof *bake->points);
	if (!bake->points)
		return GR_ERR_NOMEM;
	for (size_t p = 0; p < bake->piece_count; p++)
		for (int side = 0; side < 2; side++) {
			double area = side_area(bake, p, side);

			if (area > 0)
				scatter(bake, p, side, area, count_of(area, each));
		}
	bake->point_area = (float)each;
	result = bake_cells_build(&bake->cells, 3 * sqrtf(bake->point_area), bake->point_count,
				  position_of, bake);
	if (result != GR_OK)
		return result;
	return bake_run(bake, bake->point_count, 1024, find_lifts, bake);
}
