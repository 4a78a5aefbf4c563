#include "tools/unfold.h"

#include "base/result.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/*
 * Edges of two walls are one edge when they part by less than this share of
 * the room's shortest side (the far side of a narrow wall is no neighbour) ...
 */
#define EDGE_TOLERANCE 0.05
/* ... run against each other within this cosine (about 5 degrees) ... */
#define EDGE_COSINE 0.996
/* ... and overlap by this share of the shorter edge. */
#define EDGE_OVERLAP 0.5
/* Inward normals of neighbours are at most 135 degrees apart. */
#define FACING_COSINE -0.7072

/* A wall in double precision: corners counter-clockwise from the lower left, seen from inside. */
struct flat {
	double corner[4][3];
	double width, height;
	double normal[3]; /* unit, points into the room */
};

/* Directions of quarter turns 0..3: right, up, left, down. */
static const double turn_x[4] = { 1, 0, -1, 0 };
static const double turn_y[4] = { 0, 1, 0, -1 };

static void sub3(const double a[3], const double b[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] - b[i];
}

static double dot3(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool flatten(const struct unfold_wall *wall, struct flat *out)
{
	double right[3], up[3];
	double area;

	for (int i = 0; i < 3; i++) {
		double ll = wall->lower_left[i], lr = wall->lower_right[i];
		double ul = wall->upper_left[i];

		out->corner[0][i] = ll;
		out->corner[1][i] = lr;
		out->corner[2][i] = lr + ul - ll;
		out->corner[3][i] = ul;
	}
	sub3(out->corner[1], out->corner[0], right);
	sub3(out->corner[3], out->corner[0], up);
	out->width = sqrt(dot3(right, right));
	out->height = sqrt(dot3(up, up));
	area = out->width * out->height;
	if (!isfinite(area) || area <= 0)
		return false;
	for (int i = 0; i < 3; i++)
		out->normal[i] = (right[(i + 1) % 3] * up[(i + 2) % 3] -
				  right[(i + 2) % 3] * up[(i + 1) % 3]) / area;
	return true;
}

static double edge_length(const struct flat *wall, int edge)
{
	return edge & 1 ? wall->height : wall->width;
}

/*
 * Does edge j of b run along edge i of a? Edges are counter-clockwise on both,
 * so that shared ones run against each other. *out_start is how far from the
 * start of a's edge the end of b's lies.
 */
static bool edges_meet(const struct flat *a, int i, const struct flat *b, int j, double slack,
		       double *out_start)
{
	const double *a0 = a->corner[i], *a1 = a->corner[(i + 1) & 3];
	const double *b0 = b->corner[j], *b1 = b->corner[(j + 1) & 3];
	double length_a = edge_length(a, i), length_b = edge_length(b, j);
	double shorter = fmin(length_a, length_b);
	double along_a[3], along_b[3], offset[3];
	double low, high;

	sub3(a1, a0, along_a);
	sub3(b0, b1, along_b);
	if (dot3(along_a, along_b) < EDGE_COSINE * length_a * length_b)
		return false;
	/* Two walls that face each other across a narrow room share no edge. */
	if (dot3(a->normal, b->normal) < FACING_COSINE)
		return false;
	for (int end = 0; end < 2; end++) {
		double s, distance2;

		sub3(end ? b0 : b1, a0, offset);
		s = dot3(offset, along_a) / length_a;
		distance2 = dot3(offset, offset) - s * s;
		if (distance2 > slack * slack)
			return false;
		if (end == 0)
			*out_start = s;
	}
	low = fmax(*out_start, 0);
	high = fmin(*out_start + length_b, length_a);
	return high - low >= EDGE_OVERLAP * shorter;
}

void unfold_point(const struct unfold_place *place, double u, double v, double out[2])
{
	int right = place->turns & 3, up = (place->turns + 1) & 3;
	double s = u * place->width, t = v * place->height;

	out[0] = place->x + s * turn_x[right] + t * turn_x[up];
	out[1] = place->y + s * turn_y[right] + t * turn_y[up];
}

void unfold_wall_point(const struct unfold_place *place, const double point[2], double *out_u,
		       double *out_v)
{
	int right = place->turns & 3, up = (place->turns + 1) & 3;
	double dx = point[0] - place->x, dy = point[1] - place->y;

	*out_u = (dx * turn_x[right] + dy * turn_y[right]) / place->width;
	*out_v = (dx * turn_x[up] + dy * turn_y[up]) / place->height;
}

struct unfold_box unfold_place_box(const struct unfold_place *place)
{
	double a[2], b[2];

	unfold_point(place, 0, 0, a);
	unfold_point(place, 1, 1, b);
	return (struct unfold_box){ fmin(a[0], b[0]), fmin(a[1], b[1]), fmax(a[0], b[0]),
				    fmax(a[1], b[1]) };
}

static bool overlaps(const struct unfold_place *a, const struct unfold_place *b, double slack)
{
	struct unfold_box p = unfold_place_box(a), q = unfold_place_box(b);

	return fmin(p.x1, q.x1) - fmax(p.x0, q.x0) > slack &&
	       fmin(p.y1, q.y1) - fmax(p.y0, q.y0) > slack;
}

struct unfolding {
	const struct flat *walls;
	struct unfold_place *places;
	bool *placed;
	size_t *queue;
	size_t count, queued;
	double slack; /* metres that edges may part */
};

static bool is_free(const struct unfolding *u, const struct unfold_place *place)
{
	for (size_t i = 0; i < u->count; i++)
		if (u->placed[i] && overlaps(place, &u->places[i], u->slack))
			return false;
	return true;
}

static void put(struct unfolding *u, size_t wall, const struct unfold_place *place)
{
	u->places[wall] = *place;
	u->placed[wall] = true;
	u->queue[u->queued++] = wall;
}

/* Folds b out over the edge of a; false when they share none there or the place is taken. */
static bool fold_out(struct unfolding *u, size_t a, int edge_a, size_t b)
{
	const struct unfold_place *from = &u->places[a];
	static const double corner_u[4] = { 0, 1, 1, 0 }, corner_v[4] = { 0, 0, 1, 1 };

	for (int edge_b = 0; edge_b < 4; edge_b++) {
		struct unfold_place place = { .width = u->walls[b].width,
					      .height = u->walls[b].height, .parent = a };
		int direction = (from->turns + edge_a) & 3;
		int end_b = (edge_b + 1) & 3;
		double start, meet[2], end[2];

		if (!edges_meet(&u->walls[a], edge_a, &u->walls[b], edge_b, u->slack, &start))
			continue;
		/* Edge k of a wall points k quarter turns from its right; b's against a's. */
		place.turns = (direction + 2 - edge_b + 4) & 3;
		unfold_point(from, corner_u[edge_a], corner_v[edge_a], meet);
		meet[0] += start * turn_x[direction];
		meet[1] += start * turn_y[direction];
		unfold_point(&place, corner_u[end_b], corner_v[end_b], end);
		place.x = meet[0] - end[0];
		place.y = meet[1] - end[1];
		if (!is_free(u, &place))
			continue;
		put(u, b, &place);
		return true;
	}
	return false;
}

/* All walls that can be reached from those in the queue. */
static void fold_all(struct unfolding *u, size_t first)
{
	static const int outward[4] = { 0, 2, 1, 3 }; /* right, left, above, below */

	for (size_t next = first; next < u->queued; next++) {
		size_t a = u->queue[next];

		for (int k = 0; k < 4; k++) {
			/* Edge i of a wall turned by t faces quarter turn t + i - 1. */
			int edge = (outward[k] - u->places[a].turns + 1 + 4) & 3;

			for (size_t b = 0; b < u->count; b++)
				if (!u->placed[b])
					fold_out(u, a, edge, b);
		}
	}
}

/* The wall not yet placed that faces +Z most squarely; of equals the most central. */
static size_t most_frontal(const struct unfolding *u)
{
	size_t best = u->count;

	for (size_t i = 0; i < u->count; i++) {
		const struct flat *wall = &u->walls[i];
		double better;

		if (u->placed[i])
			continue;
		if (best == u->count) {
			best = i;
			continue;
		}
		better = wall->normal[2] - u->walls[best].normal[2];
		if (better > 1e-3 ||
		    (better > -1e-3 &&
		     fabs(wall->corner[0][0] + wall->corner[2][0]) + 1e-6 <
			     fabs(u->walls[best].corner[0][0] + u->walls[best].corner[2][0])))
			best = i;
	}
	return best;
}

static void right_end(const struct unfolding *u, double *x)
{
	*x = 0;
	for (size_t i = 0; i < u->queued; i++)
		*x = fmax(*x, unfold_place_box(&u->places[u->queue[i]]).x1);
}

static void move_to_origin(struct unfold_place *places, size_t count, double size[2])
{
	struct unfold_box all = unfold_place_box(&places[0]);

	for (size_t i = 1; i < count; i++) {
		struct unfold_box box = unfold_place_box(&places[i]);

		all.x0 = fmin(all.x0, box.x0);
		all.y0 = fmin(all.y0, box.y0);
		all.x1 = fmax(all.x1, box.x1);
		all.y1 = fmax(all.y1, box.y1);
	}
	for (size_t i = 0; i < count; i++) {
		places[i].x -= all.x0;
		places[i].y -= all.y0;
	}
	size[0] = all.x1 - all.x0;
	size[1] = all.y1 - all.y0;
}

int unfold_room(const struct unfold_wall *walls, size_t count, struct unfold_place *places,
		double size[2])
{
	struct flat *flats = calloc(count ? count : 1, sizeof *flats);
	bool *placed = calloc(count ? count : 1, sizeof *placed);
	size_t *queue = calloc(count ? count : 1, sizeof *queue);
	struct unfolding u = { flats, places, placed, queue, count, 0, INFINITY };
	int result = GR_ERR_NOMEM;

	if (!flats || !placed || !queue)
		goto out;
	result = GR_ERR_RANGE;
	if (count == 0)
		goto out;
	for (size_t i = 0; i < count; i++) {
		if (!flatten(&walls[i], &flats[i]))
			goto out;
		u.slack = fmin(u.slack,
			       EDGE_TOLERANCE * fmin(flats[i].width, flats[i].height));
	}
	while (u.queued < count) {
		size_t first = most_frontal(&u);
		struct unfold_place place = { .width = flats[first].width,
					      .height = flats[first].height,
					      .parent = UNFOLD_NO_PARENT };

		if (u.queued > 0) {
			right_end(&u, &place.x);
			place.x += 0.1 * place.width; /* a gap shows that it touches nothing */
		}
		put(&u, first, &place);
		fold_all(&u, u.queued - 1);
	}
	move_to_origin(places, count, size);
	result = GR_OK;
out:
	free(flats);
	free(placed);
	free(queue);
	return result;
}
