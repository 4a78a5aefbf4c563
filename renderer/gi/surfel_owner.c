/* To which surfel a place on a surface belongs: that of the nearest point that is in sight. */
#include "renderer/gi/surfel_bake_private.h"

/*
 * A point of another triangle is on the same surface when it is no more than this
 * off the plane, of its distance: what bends is, the other face of a thin wall is
 * not. And those on the plane come first.
 */
#define OFF_PLANE 0.4f
#define OFF_WEIGHT 32.0f

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

/* Whether nothing stands between a place and a point nearby. */
static bool in_sight(const struct bake *bake, const struct bake_near *near, struct v3 position,
		     uint32_t side)
{
	const struct bake_point *q = &bake->points[bake->cells.items[near - bake->near]];
	struct bake_point p = { .position = position, .side = side, .lift = q->lift };

	return bake_sees(bake, &p, q);
}

bool bake_reaches(const struct bake *bake, uint32_t surfel, struct v3 position)
{
	float at[3];

	v3_put(position, at);
	/* in a cavity reach says nothing */
	return bake->set->surfels[surfel].reach[0] == 1 || surfel_sight(bake->set, surfel, at) <= 1;
}

/* Whether a point's surfel is seen from a place near the point: as reach has it, or by way of the
 * point. */
static bool belongs(const struct bake *bake, const struct bake_near *near, struct v3 position,
		    uint32_t side, float square)
{
	if (square <= near->clear_m * near->clear_m && near->clear_m > 0)
		return true;
	return bake_reaches(bake, near->patch, position) || in_sight(bake, near, position, side);
}

static const struct bake_near *nearest_here(const struct bake *bake, struct v3 position,
					    uint32_t side, float *square)
{
	static const int here[3] = { 0, 0, 0 };
	const uint32_t *items;
	size_t n = bake_cells_at(&bake->cells, position, here, &items);

	*square = INFINITY;
	return nearest_in(bake, crowd_of(bake, items, n), position, side, square);
}

static uint32_t search(const struct bake *bake, struct v3 position, uint32_t side,
		       const struct bake_near *nearest, float square)
{
	struct bake_point p = { .position = position, .side = side, .lift = bake->lift };
	const struct bake_near *found = nearest;
	uint32_t surfel;

	for (int k = 0; k < 27; k++) {
		const int step[3] = { k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1 };
		const struct bake_near *other;
		const uint32_t *items;
		size_t n;

		/* the middle one is known, and most of the others are farther than what is found */
		if (k == 13 || bake_cells_square(&bake->cells, position, step) > square)
			continue;
		n = bake_cells_at(&bake->cells, position, step, &items);
		other = nearest_in(bake, crowd_of(bake, items, n), position, side, &square);
		found = other ? other : found;
	}
	if (found && found != nearest && found->patch != SURFEL_NONE &&
	    belongs(bake, found, position, side, square))
		return found->patch;
	/* Beside a wall: the point may belong to what is on its other side. */
	if (found)
		p.lift = bake->points[bake->cells.items[found - bake->near]].lift;
	surfel = bake_nearest_surfel(bake, &p);
	return surfel == SURFEL_NONE && found ? found->patch : surfel;
}

uint32_t bake_surfel_at(const struct bake *bake, struct v3 position, uint32_t side)
{
	float square;
	const struct bake_near *near = nearest_here(bake, position, side, &square);

	if (near && near->patch != SURFEL_NONE && belongs(bake, near, position, side, square))
		return near->patch;
	return search(bake, position, side, near, square);
}

uint32_t bake_surfel_around(const struct bake *bake, struct v3 position, uint32_t side,
			    const struct v3 *rim, int rim_count, bool *out_whole)
{
	float square;
	const struct bake_near *near = nearest_here(bake, position, side, &square);

	*out_whole = false;
	if (!near || near->patch == SURFEL_NONE || !belongs(bake, near, position, side, square))
		return search(bake, position, side, near, square);
	*out_whole = true;
	for (int k = 0; k < rim_count && *out_whole; k++) {
		struct v3 d = v3_sub(rim[k], near->position);

		*out_whole = belongs(bake, near, rim[k], side, v3_dot(d, d));
	}
	return near->patch;
}
