/* The baker's view of a scene: triangles with sides, sorted by connected piece. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

static struct v3 corner(const struct scene *scene, size_t triangle, int k)
{
	return v3_of(scene->vertices[scene->indices[3 * triangle + (size_t)k]].position);
}

/* In double: the sides of a sliver of a large scene cancel in float. */
static void measure(struct bake *bake, size_t t)
{
	struct v3 p = corner(bake->scene, t, 0);
	struct v3 e1 = v3_sub(corner(bake->scene, t, 1), p);
	struct v3 e2 = v3_sub(corner(bake->scene, t, 2), p);
	double x = (double)e1.y * (double)e2.z - (double)e1.z * (double)e2.y;
	double y = (double)e1.z * (double)e2.x - (double)e1.x * (double)e2.z;
	double z = (double)e1.x * (double)e2.y - (double)e1.y * (double)e2.x;
	double twice = sqrt(x * x + y * y + z * z);
	float area = (float)(0.5 * twice);

	/* what is not a number is no triangle, either */
	if (!(area > 0) || !isfinite(area))
		return;
	bake->areas[t] = area;
	bake->normals[t] = (struct v3){ (float)(x / twice), (float)(y / twice), (float)(z / twice) };
	for (int k = 0; k < 3; k++) {
		struct v3 c = corner(bake->scene, t, k);
		float at[3];

		v3_put(c, at);
		for (int i = 0; i < 3; i++) {
			bake->min[i] = fminf(bake->min[i], at[i]);
			bake->max[i] = fmaxf(bake->max[i], at[i]);
		}
	}
	bake->area += (double)area * (bake->two_sided[t] ? 2 : 1);
}

static uint32_t position_hash(const float position[3])
{
	uint64_t x = 0;

	for (int i = 0; i < 3; i++) {
		float at = position[i] + 0.0f; /* -0 is 0 */
		uint32_t bits;

		memcpy(&bits, &at, sizeof bits);
		x = (x ^ bits) * UINT64_C(0x9e3779b97f4a7c15);
		x ^= x >> 29;
	}
	return (uint32_t)(x >> 20);
}

static bool same_place(const float a[3], const float b[3])
{
	return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* For each vertex the first one at its place. */
static int weld(const struct scene *scene, uint32_t *out)
{
	size_t slots = 1024;
	uint32_t *table;

	while (slots < 2 * scene->vertex_count)
		slots *= 2;
	table = malloc(slots * sizeof *table);
	if (!table)
		return GR_ERR_NOMEM;
	memset(table, 0xff, slots * sizeof *table);
	for (size_t i = 0; i < scene->vertex_count; i++) {
		const float *at = scene->vertices[i].position;
		size_t slot = position_hash(at) & (slots - 1);

		while (table[slot] != UINT32_MAX &&
		       !same_place(scene->vertices[table[slot]].position, at))
			slot = (slot + 1) & (slots - 1);
		if (table[slot] == UINT32_MAX)
			table[slot] = (uint32_t)i;
		out[i] = table[slot];
	}
	free(table);
	return GR_OK;
}

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i) {
		parent[i] = parent[parent[i]];
		i = parent[i];
	}
	return i;
}

static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
	a = root_of(parent, a);
	b = root_of(parent, b);
	/* the lower wins: the same whatever the order */
	if (a < b)
		parent[b] = a;
	else
		parent[a] = b;
}

/* Sorts the triangles by piece; pieces in the order of their first triangle. */
static int sort_pieces(struct bake *bake, uint32_t *parent)
{
	const struct scene *scene = bake->scene;
	uint32_t *piece = malloc((scene->vertex_count + 1) * sizeof *piece);
	uint32_t *at = NULL;

	if (!piece)
		return GR_ERR_NOMEM;
	memset(piece, 0xff, scene->vertex_count * sizeof *piece);
	for (size_t t = 0; t < bake->triangle_count; t++) {
		uint32_t root;

		if (bake->areas[t] <= 0)
			continue;
		root = root_of(parent, scene->indices[3 * t]);
		if (piece[root] == UINT32_MAX)
			piece[root] = (uint32_t)bake->piece_count++;
		bake->piece_first[piece[root] + 1]++;
	}
	for (size_t p = 0; p < bake->piece_count; p++)
		bake->piece_first[p + 1] += bake->piece_first[p];
	at = malloc((bake->piece_count + 1) * sizeof *at);
	if (!at) {
		free(piece);
		return GR_ERR_NOMEM;
	}
	memcpy(at, bake->piece_first, (bake->piece_count + 1) * sizeof *at);
	for (size_t t = 0; t < bake->triangle_count; t++)
		if (bake->areas[t] > 0)
			bake->piece_order[at[piece[root_of(parent, scene->indices[3 * t])]]++] =
				(uint32_t)t;
	free(piece);
	free(at);
	return GR_OK;
}

static int find_pieces(struct bake *bake)
{
	const struct scene *scene = bake->scene;
	uint32_t *parent = malloc((scene->vertex_count + 1) * sizeof *parent);
	int result;

	if (!parent)
		return GR_ERR_NOMEM;
	result = weld(scene, parent);
	if (result == GR_OK) {
		/* a welded vertex points at an earlier one: a forest already */
		for (size_t t = 0; t < bake->triangle_count; t++) {
			const uint32_t *v = scene->indices + 3 * t;

			if (bake->areas[t] <= 0)
				continue;
			join(parent, v[0], v[1]);
			join(parent, v[0], v[2]);
		}
		result = sort_pieces(bake, parent);
	}
	free(parent);
	return result;
}

int bake_surface(struct bake *bake)
{
	const struct scene *scene = bake->scene;
	size_t n = scene->index_count / 3;

	bake->triangle_count = n;
	bake->normals = calloc(n + 1, sizeof *bake->normals);
	bake->areas = calloc(n + 1, sizeof *bake->areas);
	bake->two_sided = calloc(n + 1, sizeof *bake->two_sided);
	bake->piece_order = calloc(n + 1, sizeof *bake->piece_order);
	bake->piece_first = calloc(n + 2, sizeof *bake->piece_first);
	if (!bake->normals || !bake->areas || !bake->two_sided || !bake->piece_order ||
	    !bake->piece_first)
		return GR_ERR_NOMEM;
	for (int i = 0; i < 3; i++) {
		bake->min[i] = INFINITY;
		bake->max[i] = -INFINITY;
	}
	for (size_t d = 0; d < scene->draw_count; d++) {
		const struct scene_draw *draw = &scene->draws[d];

		for (size_t t = draw->first_index / 3;
		     t < (draw->first_index + draw->index_count) / 3; t++)
			bake->two_sided[t] = scene->materials[draw->material].two_sided;
	}
	for (size_t t = 0; t < n; t++)
		measure(bake, t);
	return find_pieces(bake);
}
