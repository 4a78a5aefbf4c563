/* Inside of the map of surfels (surfel_map.c): cells of triangles (surfel_map_cells.c). Pure. */
#ifndef GROTTO_RENDERER_GI_SURFEL_MAP_H
#define GROTTO_RENDERER_GI_SURFEL_MAP_H

#include "renderer/gi/surfel_bake_private.h"

/* Cells of a width, m; count: of all sides. */
struct map_division {
	struct bake *bake;
	float width;
	size_t count;
};

struct map_extent {
	struct v3 middle, rim[4];
	int rim_count;
};

/* Fills bake->faces and the count. GR_OK, GR_NOTHING (stopped). */
int map_divide(struct map_division *d);
/* Which of bake->faces a side's is. */
size_t map_face(const struct bake *bake, uint32_t side);
/* The cell of a place in a triangle, as struct ray_met's; of a face that has cells. */
unsigned map_cell(const struct bake_face *face, float u, float v);
/* false: it is wider than cells should be. */
bool map_extent(const struct bake *bake, uint32_t side, const struct bake_face *face, unsigned cell,
		struct map_extent *out);

#endif
