/*
 * A map of the surfels on each side, for the many rays that meet it: its triangle
 * is divided into cells which hold two points or so. A cell whose points belong to
 * one surfel, and whose rim that surfel reaches, is that surfel's. Of the others,
 * those with a wall in them and those without points, a cell is filled when a ray
 * first meets it, whichever that is: what it holds depends on its place alone.
 * Triangles so small that few rays meet them have no cells; there each ray is
 * looked up by itself.
 */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"

#include <stdlib.h>

/* Width of a cell, and how far it may reach from its middle, of the distance between points. */
#define CELL_WIDTH 1.5f
#define CELL_REACH 1.8f
/* Its rim is looked at a little inside: what ends at a wall is not behind it. */
#define RIM 0.95f
#define CELLS_MOST 0x3fffu /* along an edge */
/* Of the rays that may be expected in a cell; fewer do not pay for filling it. */
#define RAYS_LEAST 3.0f
#define FETCH_MOST 512 /* bytes of points that are asked for; those of a flat wall */

/* In a cell: nothing yet; that each place must be looked up; else a surfel + FIRST_SURFEL. */
enum { UNKNOWN, EACH, FIRST_SURFEL };
/* A wall parts the cell: its surfel is that of places that it reaches. */
#define IN_PART (1u << 31)
/* While points are sown: the only one, or the first of those that belong to one surfel; else
 * several. */
#define POINT (1u << 31)
#define SEVERAL EACH
/* The cell of a place on a triangle that has none. */
#define NOWHERE UINT32_MAX
static size_t face_of(const struct bake *bake, uint32_t side)
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

struct division {
	struct bake *bake;
	float width;
	size_t count;
};

static void divide_some(void *ctx, size_t begin, size_t end, int thread)
{
	const struct division *d = ctx;

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

static int divide_all(struct division *d)
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

static unsigned cell_of(const struct bake_face *face, float u, float v)
{
	const float shares[3] = { 1 - u - v, u, v };

	return cell_at(shares[(face->corner + 1) % 3], face->across) +
	       face->across * cell_at(shares[(face->corner + 2) % 3], face->along);
}

struct extent {
	struct v3 middle, rim[4];
	int rim_count;
};

/* false: it is wider than cells should be. */
static bool extent_of(const struct bake *bake, uint32_t side, const struct bake_face *face,
		      unsigned cell, struct extent *out)
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

/* What a cell holds whose points belong to one surfel: where a wall may part it, rays will tell. */
static uint32_t settle(const struct bake *bake, uint32_t side, const struct bake_face *face,
		       unsigned cell, uint32_t surfel)
{
	struct extent e;

	if (surfel == SURFEL_NONE || !extent_of(bake, side, face, cell, &e))
		return EACH;
	for (int k = 0; k < e.rim_count; k++)
		if (!bake_reaches(bake, surfel, e.rim[k]))
			return UNKNOWN;
	return surfel + FIRST_SURFEL;
}

/* Points begin..end-1, all of one side: what their cells hold. */
static void sow_side(const struct bake *bake, size_t begin, size_t end)
{
	uint32_t side = bake->points[begin].side;
	const struct bake_face *face = &bake->faces[face_of(bake, side)];

	if (face->meets != BAKE_PLAIN || face->across == 0)
		return;
	/* a point for now */
	for (size_t i = begin; i < end; i++) {
		const struct bake_point *p = &bake->points[i];
		_Atomic uint32_t *cell = &bake->map[face->first + cell_of(face, p->u, p->v)];
		uint32_t holds = atomic_load_explicit(cell, memory_order_relaxed);

		if (holds == UNKNOWN)
			holds = (uint32_t)i | POINT;
		else if (holds != SEVERAL && p->patch != bake->points[holds & ~POINT].patch)
			holds = SEVERAL;
		atomic_store_explicit(cell, holds, memory_order_relaxed);
	}
	for (size_t i = begin; i < end; i++) {
		const struct bake_point *p = &bake->points[i];
		unsigned k = cell_of(face, p->u, p->v);
		_Atomic uint32_t *cell = &bake->map[face->first + k];

		uint32_t holds = atomic_load_explicit(cell, memory_order_relaxed);

		if (holds == SEVERAL)
			atomic_store_explicit(cell, UNKNOWN, memory_order_relaxed);
		else if (holds == ((uint32_t)i | POINT))
			atomic_store_explicit(cell, settle(bake, side, face, k, p->patch),
					      memory_order_relaxed);
	}
}

/* Points of a side stand together; who has the first of them does all. */
static void sow(void *ctx, size_t begin, size_t end, int thread)
{
	const struct bake *bake = ctx;
	const struct bake_point *points = bake->points;

	(void)thread;
	while (begin > 0 && begin < end && points[begin].side == points[begin - 1].side)
		begin++;
	while (begin < end) {
		size_t next = begin + 1;

		while (next < bake->point_count && points[next].side == points[begin].side)
			next++;
		sow_side(bake, begin, next);
		begin = next;
	}
}

int bake_map(struct bake *bake)
{
	size_t most = 8 * (bake->point_count + bake->triangle_count);
	struct division d = { bake, CELL_WIDTH * sqrtf(bake->point_area), 0 };
	int result;

	bake_map_finish(bake);
	bake->faces = calloc(2 * bake->triangle_count + 1, sizeof *bake->faces);
	if (!bake->faces)
		return GR_ERR_NOMEM;
	while ((result = divide_all(&d)) == GR_OK && d.count > most)
		d.width *= 2;
	if (result != GR_OK)
		return result;
	bake->map = calloc(d.count + 1, sizeof *bake->map);
	/* few are touched, and memory is taken for those only */
	bake->map_beyond = calloc(d.count + 1, sizeof *bake->map_beyond);
	if (!bake->map || !bake->map_beyond)
		return GR_ERR_NOMEM;
	return bake_run(bake, bake->point_count, 4096, sow, bake);
}

void bake_map_finish(struct bake *bake)
{
	free(bake->faces);
	free(bake->map);
	free(bake->map_beyond);
	bake->faces = NULL;
	bake->map = NULL;
	bake->map_beyond = NULL;
}

/*
 * What a cell without points holds, and one whose rim may be behind a wall: the
 * surfel of its middle; all of it where nothing stands between that and the rim.
 */
static uint32_t ask(const struct bake *bake, uint32_t side, const struct bake_face *face,
		    unsigned cell)
{
	struct extent e;
	uint32_t surfel;
	bool whole;

	if (!extent_of(bake, side, face, cell, &e))
		return EACH;
	surfel = bake_surfel_around(bake, e.middle, side, e.rim, e.rim_count, &whole);
	return surfel == SURFEL_NONE ? EACH : (surfel + FIRST_SURFEL) | (whole ? 0 : IN_PART);
}

/* In a cell that a wall parts: the surfel of the first place on its rim that another one does
 * not reach. */
static uint32_t ask_beyond(const struct bake *bake, uint32_t side, const struct bake_face *face,
			   unsigned cell, uint32_t surfel)
{
	struct extent e;

	extent_of(bake, side, face, cell, &e);
	for (int k = 0; k < e.rim_count; k++)
		if (!bake_reaches(bake, surfel, e.rim[k])) {
			surfel = bake_surfel_at(bake, e.rim[k], side);
			return surfel == SURFEL_NONE ? EACH : surfel + FIRST_SURFEL;
		}
	return EACH;
}

static struct v3 met_at(const struct ray_start *ray, const struct ray_met *met)
{
	return v3_ahead(v3_of(ray->origin), v3_of(ray->direction), met->distance);
}

/* Of a hit on a side that is plain: which cell, and that it will be read. */
static void find_cell(const struct bake *bake, const struct bake_face *face,
		      const struct ray_met *met, struct bake_place *out)
{
	out->at = NOWHERE;
	if (face->across == 0)
		return;
	out->cell = cell_of(face, met->u, met->v);
	out->at = face->first + out->cell;
	__builtin_prefetch(&bake->map[out->at]);
}

static bool must_look_up(const struct bake *bake, const struct bake_place *place)
{
	uint32_t holds;

	if (place->meets != BAKE_PLAIN || place->at == NOWHERE)
		return place->meets == BAKE_PLAIN;
	holds = atomic_load_explicit(&bake->map[place->at], memory_order_relaxed);
	return holds == UNKNOWN || holds == EACH;
}

/* Memory is asked for what bake_surfel_at reads. */
static void expect_points(const struct bake *bake, size_t count, const struct ray_start *rays,
			  const struct ray_met *met, struct bake_place *out)
{
	for (size_t k = 0; k < count; k++) {
		out[k].looks_up = must_look_up(bake, &out[k]);
		if (!out[k].looks_up)
			continue;
		out[k].slot = bake_cells_expect(&bake->cells, met_at(&rays[k], &met[k]));
		__builtin_prefetch(&bake->normals[met[k].triangle]);
	}
	for (size_t k = 0; k < count; k++) {
		const struct bake_cell *cell;
		size_t bytes;

		if (!out[k].looks_up)
			continue;
		cell = &bake->cells.slots[out[k].slot];
		bytes = cell->count * sizeof *bake->near;
		for (size_t at = 0; at < bytes && at < FETCH_MOST; at += 64)
			__builtin_prefetch((const char *)(bake->near + cell->first) + at);
	}
}

void bake_map_expect(const struct bake *bake, size_t count, const struct ray_start *rays,
		     const struct ray_met *met, struct bake_place *out)
{
	for (size_t k = 0; k < count; k++) {
		out[k].side = met[k].triangle == RAYS_NONE ? SURFEL_NONE
							   : 2 * met[k].triangle + met[k].back;
		if (out[k].side != SURFEL_NONE)
			__builtin_prefetch(&bake->faces[face_of(bake, out[k].side)]);
	}
	for (size_t k = 0; k < count; k++) {
		const struct bake_face *face;

		out[k].meets = BAKE_NOTHING;
		if (out[k].side == SURFEL_NONE)
			continue;
		face = &bake->faces[face_of(bake, out[k].side)];
		out[k].meets = (enum bake_meets)face->meets;
		if (face->meets == BAKE_PLAIN)
			find_cell(bake, face, &met[k], &out[k]);
	}
	expect_points(bake, count, rays, met, out);
}

/* In a cell that a wall parts. */
static uint32_t read_part(const struct bake *bake, struct v3 position,
			  const struct bake_place *place, uint32_t surfel)
{
	_Atomic uint32_t *beyond = &bake->map_beyond[place->at];
	uint32_t holds;

	if (bake_reaches(bake, surfel, position))
		return surfel;
	holds = atomic_load_explicit(beyond, memory_order_relaxed);
	if (holds == UNKNOWN) {
		holds = ask_beyond(bake, place->side, &bake->faces[face_of(bake, place->side)],
				   place->cell, surfel);
		atomic_store_explicit(beyond, holds, memory_order_relaxed);
	}
	if (holds != EACH && bake_reaches(bake, holds - FIRST_SURFEL, position))
		return holds - FIRST_SURFEL;
	return bake_surfel_at(bake, position, place->side);
}

uint32_t bake_map_read(const struct bake *bake, const struct ray_start *ray,
		       const struct ray_met *met, const struct bake_place *place)
{
	uint32_t holds = EACH;

	if (place->at != NOWHERE)
		holds = atomic_load_explicit(&bake->map[place->at], memory_order_relaxed);
	if (holds == UNKNOWN) {
		holds = ask(bake, place->side, &bake->faces[face_of(bake, place->side)],
			    place->cell);
		atomic_store_explicit(&bake->map[place->at], holds, memory_order_relaxed);
	}
	if (holds == EACH)
		return bake_surfel_at(bake, met_at(ray, met), place->side);
	if (holds & IN_PART)
		return read_part(bake, met_at(ray, met), place, (holds & ~IN_PART) - FIRST_SURFEL);
	return holds - FIRST_SURFEL;
}
