/* How the sides of triangles are divided into the cells of the map. */
#include "renderer/gi/surfel_map.h"

#include "base/result.h"

/* How far a cell may reach from its middle, of the distance between points. */
#define CELL_REACH 1.8f
/* Its rim is looked at a little inside: what ends at a wall is not behind it. */
#define RIM 0.95f
#define CELLS_MOST 0x3fffu /* along an edge */
/* Of the rays that may be expected in a cell; fewer do not pay for filling it. */
#define RAYS_LEAST 3.0f

size_t map_face(const struct bake *bake, uint32_t side)
{
	/* fronts together: backs are seldom seen */
	return (side & 1) * bake->triangle_count + side / 2;
}

static struct v3 corner(const struct bake *bake, size_t triangle, unsigned k)
{
	const struct scene *scene = bake->scene;

	return v3_of(scene->vertices[scene->indices[3 * triangle + k % 3]].position);
}

/* From the corner that cells are counted from. */
static struct v3 edge(const struct bake *bake, size_t triangle, const struct bake_face *face,
		      unsigned k)
{
	return v3_sub(corner(bake, triangle, face->corner + 1 + k),
		      corner(bake, triangle, face->corner));
}

/* The corner opposite the longest edge: nowhere do edges meet less askew. */
static unsigned widest_corner(const struct bake *bake, size_t triangle)
{
	unsigned found = 0;
	float longest = 0;

	for (unsigned k = 0; k < 3; k++) {
		struct v3 e = v3_sub(corner(bake, triangle, k + 2), corner(bake, triangle, k + 1));

		if (v3_dot(e, e) > longest) {
			longest = v3_dot(e, e);
			found = k;
		}
	}
	return found;
}

static unsigned cells_along(float n)
{
	return n > (float)CELLS_MOST ? CELLS_MOST : n > 1 ? (unsigned)n : 1;
}

static float rays_in(const struct bake *bake, size_t triangle, size_t cells)
{
	double rays = (double)bake->set->count * (double)bake->set->links_each;

	return (float)(rays * (double)bake->areas[triangle] / bake->area) / (float)cells;
}

/* Cells of a side of a triangle; none where they do not pay. */
static void divide(const struct bake *bake, size_t triangle, float width, struct bake_face *face)
{
	float n[2], most, shrink;

	face->corner = widest_corner(bake, triangle) & 3u;
	for (unsigned k = 0; k < 2; k++)
		n[k] = fmaxf(roundf(v3_length(edge(bake, triangle, face, k)) / width), 1);
	/* all that its area and its rim meet: a sliver's edges would make more */
	most = 2 * (bake->areas[triangle] / (width * width) + n[0] + n[1]);
	shrink = n[0] * n[1] > most ? sqrtf(most / (n[0] * n[1])) : 1;
	face->across = cells_along(shrink * n[0]) & CELLS_MOST;
	face->along = cells_along(shrink * n[1]) & CELLS_MOST;
	if (rays_in(bake, triangle, (size_t)face->across * face->along) < RAYS_LEAST)
		face->across = face->along = 0;
}

static void divide_some(void *ctx, size_t begin, size_t end, int thread)
{
	const struct map_division *d = ctx;

	(void)thread;
	for (size_t t = begin; t < end; t++) {
		struct bake_face *front = &d->bake->faces[t],
				 *back = front + d->bake->triangle_count;

		front->meets = bake_meets(d->bake, 2 * (uint32_t)t) & 3u;
		back->meets = bake_meets(d->bake, 2 * (uint32_t)t + 1) & 3u;
		if (front->meets == BAKE_PLAIN)
			divide(d->bake, t, d->width, front);
		back->corner = front->corner;
		back->across = front->across;
		back->along = front->along;
	}
}

int map_divide(struct map_division *d)
{
	struct bake *bake = d->bake;
	int result = bake_run(bake, bake->triangle_count, 4096, divide_some, d);

	d->count = 0;
	for (size_t f = 0; f < 2 * bake->triangle_count && result == GR_OK; f++) {
		struct bake_face *face = &bake->faces[f];

		if (face->meets != BAKE_PLAIN)
			continue;
		face->first = (uint32_t)d->count;
		d->count += (size_t)face->across * face->along;
	}
	return result;
}

static unsigned cell_at(float share, unsigned count)
{
	float at = share * (float)count;

	/* what is a little outside by rounding, too */
	return at >= (float)count ? count - 1 : at > 0 ? (unsigned)at : 0;
}

unsigned map_cell(const struct bake_face *face, float u, float v)
{
	const float shares[3] = { 1 - u - v, u, v };

	return cell_at(shares[(face->corner + 1) % 3], face->across) +
	       face->across * cell_at(shares[(face->corner + 2) % 3], face->along);
}

bool map_extent(const struct bake *bake, uint32_t side, const struct bake_face *face, unsigned cell,
		struct map_extent *out)
{
	float share[2] = { 1 / (float)face->across, 1 / (float)face->along };
	struct v3 a = v3_scale(edge(bake, side / 2, face, 0), share[0]);
	struct v3 b = v3_scale(edge(bake, side / 2, face, 1), share[1]);
	float i = (float)(cell % face->across), j = (float)(cell / face->across);
	float room = larger_of(1 - i * share[0] - j * share[1], 0);
	/* of a cell that the third edge cuts, the middle of what is left */
	float s = smaller_of(0.5f, 2.0f / 3.0f * room / (share[0] + share[1]));
	float most = CELL_REACH * CELL_REACH * bake->point_area;
	const float rim[4][2] = { { -s, -s }, { -s, 1 - s }, { 1 - s, -s }, { 1 - s, 1 - s } };
	bool fits = true;

	out->middle = v3_ahead(v3_ahead(corner(bake, side / 2, face->corner), a, i + s), b, j + s);
	out->rim_count = s < 0.5f ? 3 : 4;
	for (int k = 0; k < out->rim_count; k++) {
		struct v3 d = v3_ahead(v3_scale(a, RIM * rim[k][0]), b, RIM * rim[k][1]);

		fits = fits && v3_dot(d, d) <= most;
		out->rim[k] = v3_add(out->middle, d);
	}
	return fits;
}
