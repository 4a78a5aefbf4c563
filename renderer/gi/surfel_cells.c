/* A spatial hash of items that do not move. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"

#include <stdlib.h>

/*
 * Off the origin, so that walls at round numbers do not lie on the border of two
 * cells, where rounding decides.
 */
#define SHIFT 0.3819660

/* 21 bits an axis, around the origin; what is farther wraps, which only costs time. */
static uint64_t cell_key(float cell_m, struct v3 p, const int step[3])
{
	const double inverse = 1 / (double)cell_m;
	const double at[3] = { (double)p.x, (double)p.y, (double)p.z };
	uint64_t key = 0;

	for (int i = 0; i < 3; i++) {
		/* floor() is a call */
		double x = at[i] * inverse + SHIFT;
		int64_t whole = (int64_t)x;

		whole -= x < (double)whole;
		key = key << 21 | ((uint64_t)(whole + step[i]) & 0x1fffff);
	}
	return key + 1;
}

static size_t home_of(const struct bake_cells *cells, uint64_t key)
{
	return (size_t)(key * UINT64_C(0x9e3779b97f4a7c15) >> 32) & (cells->slot_count - 1);
}

static size_t find(const struct bake_cells *cells, uint64_t key)
{
	size_t slot = home_of(cells, key);

	while (cells->slots[slot].key && cells->slots[slot].key != key)
		slot = (slot + 1) & (cells->slot_count - 1);
	return slot;
}

/* A table for `wanted` cells; filled with those of all items. Returns how many there are. */
static size_t enter(struct bake_cells *out, size_t wanted, size_t count,
		    struct v3 (*position)(const void *ctx, size_t i), const void *ctx)
{
	static const int here[3] = { 0, 0, 0 };
	size_t used = 0;

	out->slot_count = 1024;
	while (out->slot_count < 2 * wanted)
		out->slot_count *= 2;
	free(out->slots);
	out->slots = calloc(out->slot_count, sizeof *out->slots);
	for (size_t i = 0; out->slots && i < count; i++) {
		uint64_t key = cell_key(out->cell_m, position(ctx, i), here);
		struct bake_cell *cell = &out->slots[find(out, key)];

		used += cell->key == 0;
		cell->key = key;
		cell->count++;
	}
	return used;
}

int bake_cells_build(struct bake_cells *out, float cell_m, size_t count,
		     struct v3 (*position)(const void *ctx, size_t i), const void *ctx)
{
	static const int here[3] = { 0, 0, 0 };
	size_t used;
	uint32_t at = 0;

	*out = (struct bake_cells){ .cell_m = cell_m };
	out->items = calloc(count + 1, sizeof *out->items);
	/* again for the cells that there are: a small table stays in the caches */
	used = enter(out, count, count, position, ctx);
	if (out->slots && 4 * used < out->slot_count)
		enter(out, used, count, position, ctx);
	if (!out->slots || !out->items) {
		bake_cells_finish(out);
		return GR_ERR_NOMEM;
	}
	/* ends, and then each item moves its cell's down: rising order within a cell */
	for (size_t s = 0; s < out->slot_count; s++) {
		at += out->slots[s].count;
		out->slots[s].first = at;
	}
	for (size_t i = count; i-- > 0;) {
		size_t slot = find(out, cell_key(cell_m, position(ctx, i), here));

		out->items[--out->slots[slot].first] = (uint32_t)i;
	}
	return GR_OK;
}

void bake_cells_finish(struct bake_cells *cells)
{
	free(cells->slots);
	free(cells->items);
	*cells = (struct bake_cells){ 0 };
}

size_t bake_cells_at(const struct bake_cells *cells, struct v3 position, const int step[3],
		     const uint32_t **out_items)
{
	const struct bake_cell *cell =
		&cells->slots[find(cells, cell_key(cells->cell_m, position, step))];

	*out_items = cells->items + cell->first;
	return cell->count;
}

size_t bake_cells_expect(const struct bake_cells *cells, struct v3 position)
{
	static const int here[3] = { 0, 0, 0 };
	size_t slot = home_of(cells, cell_key(cells->cell_m, position, here));

	__builtin_prefetch(&cells->slots[slot]);
	return slot;
}

float bake_cells_square(const struct bake_cells *cells, struct v3 position, const int step[3])
{
	const float at[3] = { position.x, position.y, position.z };
	double sum = 0;

	for (int i = 0; i < 3; i++) {
		double x = (double)at[i] / (double)cells->cell_m + SHIFT;
		double past = x - (double)(int64_t)x, inside = past < 0 ? past + 1 : past;
		double away = step[i] > 0 ? 1 - inside : step[i] < 0 ? inside : 0;

		sum += away * away;
	}
	return (float)(sum * (double)cells->cell_m * (double)cells->cell_m);
}
