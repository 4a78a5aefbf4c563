/*
 * A map of the surfels on each side, for the many rays that meet it: its triangle
 * is divided into cells which hold two points or so. A cell whose points belong to
 * one surfel, and whose rim that surfel reaches, is that surfel's. Of the others,
 * those with a wall in them and those without points, a cell is filled when a ray
 * first meets it, whichever that is: what it holds depends on its place alone.
 * Triangles so small that few rays meet them have no cells; there each ray is
 * looked up by itself.
 */
#include "renderer/gi/surfel_map.h"

#include "base/result.h"

#include <stdlib.h>

/* Width of a cell, of the distance between points. */
#define CELL_WIDTH 1.5f
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

/* What a cell holds whose points belong to one surfel: where a wall may part it, rays will tell. */
static uint32_t settle(const struct bake *bake, uint32_t side, const struct bake_face *face,
		       unsigned cell, uint32_t surfel)
{
	struct map_extent e;

	if (surfel == SURFEL_NONE || !map_extent(bake, side, face, cell, &e))
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
	const struct bake_face *face = &bake->faces[map_face(bake, side)];

	if (face->meets != BAKE_PLAIN || face->across == 0)
		return;
	/* a point for now */
	for (size_t i = begin; i < end; i++) {
		const struct bake_point *p = &bake->points[i];
		_Atomic uint32_t *cell = &bake->map[face->first + map_cell(face, p->u, p->v)];
		uint32_t holds = atomic_load_explicit(cell, memory_order_relaxed);

		if (holds == UNKNOWN)
			holds = (uint32_t)i | POINT;
		else if (holds != SEVERAL && p->patch != bake->points[holds & ~POINT].patch)
			holds = SEVERAL;
		atomic_store_explicit(cell, holds, memory_order_relaxed);
	}
	for (size_t i = begin; i < end; i++) {
		const struct bake_point *p = &bake->points[i];
		unsigned k = map_cell(face, p->u, p->v);
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
	struct map_division d = { bake, CELL_WIDTH * sqrtf(bake->point_area), 0 };
	int result;

	bake_map_finish(bake);
	bake->faces = calloc(2 * bake->triangle_count + 1, sizeof *bake->faces);
	if (!bake->faces)
		return GR_ERR_NOMEM;
	while ((result = map_divide(&d)) == GR_OK && d.count > most)
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
	struct map_extent e;
	uint32_t surfel;
	bool whole;

	if (!map_extent(bake, side, face, cell, &e))
		return EACH;
	surfel = bake_surfel_around(bake, e.middle, side, e.rim, e.rim_count, &whole);
	return surfel == SURFEL_NONE ? EACH : (surfel + FIRST_SURFEL) | (whole ? 0 : IN_PART);
}

/* In a cell that a wall parts: the surfel of the first place on its rim that another one does
 * not reach. */
static uint32_t ask_beyond(const struct bake *bake, uint32_t side, const struct bake_face *face,
			   unsigned cell, uint32_t surfel)
{
	struct map_extent e;

	map_extent(bake, side, face, cell, &e);
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
	out->cell = map_cell(face, met->u, met->v);
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
			__builtin_prefetch(&bake->faces[map_face(bake, out[k].side)]);
	}
	for (size_t k = 0; k < count; k++) {
		const struct bake_face *face;

		out[k].meets = BAKE_NOTHING;
		if (out[k].side == SURFEL_NONE)
			continue;
		face = &bake->faces[map_face(bake, out[k].side)];
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
		holds = ask_beyond(bake, place->side, &bake->faces[map_face(bake, place->side)],
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
		holds = ask(bake, place->side, &bake->faces[map_face(bake, place->side)],
			    place->cell);
		atomic_store_explicit(&bake->map[place->at], holds, memory_order_relaxed);
	}
	if (holds == EACH)
		return bake_surfel_at(bake, met_at(ray, met), place->side);
	if (holds & IN_PART)
		return read_part(bake, met_at(ray, met), place, (holds & ~IN_PART) - FIRST_SURFEL);
	return holds - FIRST_SURFEL;
}
