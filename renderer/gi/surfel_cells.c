/* A spatial hash of items that do not move. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"

#include <stdlib.h>

/* 21 bits an axis, around the origin; what is farther wraps, which only costs time. */
static uint64_t cell_key(float cell_m, struct v3 p, const int step[3])
{
	const double inverse = 1 / (double)cell_m;
	const double at[3] = { (double)p.x, (double)p.y, (double)p.z };
	uint64_t key = 0;

	for (int i = 0; i < 3; i++)
		key = key << 21 | ((uint64_t)((int64_t)floor(at[i] * inverse) + step[i]) & 0x1fffff);
	return key + 1;
}

static size_t find(const struct bake_cells *cells, uint64_t key)
{
	uint64_t x = key * UINT64_C(0x9e3779b97f4a7c15);
	size_t slot = (size_t)(x >> 32) & (cells->slots - 1);

	while (cells->keys[slot] && cells->keys[slot] != key)
		slot = (slot + 1) & (cells->slots - 1);
	return slot;
}

int bake_cells_build(struct bake_cells *out, float cell_m, size_t count,
		     struct v3 (*position)(const void *ctx, size_t i), const void *ctx)
{
	static const int here[3] = { 0, 0, 0 };
	uint32_t *slot_of;

	*out = (struct bake_cells){ .cell_m = cell_m, .slots = 1024 };
	while (out->slots < 2 * count)
		out->slots *= 2;
	out->keys = calloc(out->slots, sizeof *out->keys);
	out->first = calloc(out->slots + 1, sizeof *out->first);
	out->items = calloc(count + 1, sizeof *out->items);
	slot_of = calloc(count + 1, sizeof *slot_of);
	if (!out->keys || !out->first || !out->items || !slot_of) {
		free(slot_of);
		bake_cells_finish(out);
		return GR_ERR_NOMEM;
	}
	for (size_t i = 0; i < count; i++) {
		uint64_t key = cell_key(cell_m, position(ctx, i), here);
		size_t slot = find(out, key);

		out->keys[slot] = key;
		slot_of[i] = (uint32_t)slot;
		out->first[slot]++;
	}
	/* ends, and then each item moves its cell's down: rising order within a cell */
	for (size_t s = 0; s < out->slots; s++)
		out->first[s + 1] += out->first[s];
	for (size_t i = count; i-- > 0;)
		out->items[--out->first[slot_of[i]]] = (uint32_t)i;
	free(slot_of);
	return GR_OK;
}

void bake_cells_finish(struct bake_cells *cells)
{
	free(cells->keys);
	free(cells->first);
	free(cells->items);
	*cells = (struct bake_cells){ 0 };
}

size_t bake_cells_at(const struct bake_cells *cells, struct v3 position, const int step[3],
		     const uint32_t **out_items)
{
	size_t slot = find(cells, cell_key(cells->cell_m, position, step));

	*out_items = cells->items + cells->first[slot];
	return cells->first[slot + 1] - cells->first[slot];
}
