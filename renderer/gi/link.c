#include "renderer/gi/link.h"

#include "base/result.h"
#include "renderer/gi/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_RAYS 128

/*
 * Cells' points stand off the middle by an odd thousandth of a cell: walls on
 * dyadic positions, the usual case in models, must not run through them.
 */
static const float point_offset[3] = { 0.5f + 0.00137f, 0.5f + 0.00191f, 0.5f + 0.00167f };

struct build {
	struct links *links;
	const struct scene *scene;
	const struct rays *rays;
	struct surface_lookup *lookup;
	float albedo_override[3];
	int rays_per_link;
	uint8_t *occupied; /* cells that a triangle may touch, with a border of one cell */
	int grid[3];
	size_t block_room;
};

void links_point(const struct links *links, const int cell[3], float out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = links->lattice.origin[i] +
			 ((float)cell[i] + links->point[i]) * links->lattice.d;
}

static size_t grid_index(const struct build *b, int x, int y, int z)
{
	return (size_t)(x + 1) + (size_t)b->grid[0] * ((size_t)(y + 1) +
						       (size_t)b->grid[1] * (size_t)(z + 1));
}

/* Marks the cells whose box the triangle's plane crosses within the triangle's own box. */
static void mark_triangle(struct build *b, const uint32_t *t)
{
	const struct lattice *l = &b->links->lattice;
	const float *p[3];
	float low[3], high[3], e1[3], e2[3], n[3];
	int from[3], to[3];
	const float slack = 1e-3f; /* cells */

	for (int k = 0; k < 3; k++)
		p[k] = b->scene->vertices[t[k]].position;
	for (int i = 0; i < 3; i++) {
		float c[3];

		for (int k = 0; k < 3; k++)
			c[k] = (p[k][i] - l->origin[i]) / l->d;
		low[i] = fminf(c[0], fminf(c[1], c[2])) - slack;
		high[i] = fmaxf(c[0], fmaxf(c[1], c[2])) + slack;
		from[i] = (int)fmaxf(floorf(low[i]), -1.0f);
		to[i] = (int)fminf(floorf(high[i]), (float)l->size[i]);
		e1[i] = c[1] - c[0];
		e2[i] = c[2] - c[0];
	}
	n[0] = e1[1] * e2[2] - e1[2] * e2[1];
	n[1] = e1[2] * e2[0] - e1[0] * e2[2];
	n[2] = e1[0] * e2[1] - e1[1] * e2[0];
	float reach = 0.5f * (fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2])) * (1 + 4 * slack);
	for (int z = from[2]; z <= to[2]; z++)
		for (int y = from[1]; y <= to[1]; y++)
			for (int x = from[0]; x <= to[0]; x++) {
				float at[3] = { (float)x + 0.5f, (float)y + 0.5f, (float)z + 0.5f };
				float side = 0;

				for (int i = 0; i < 3; i++)
					side += n[i] * (at[i] - (p[0][i] - l->origin[i]) / l->d);
				if (fabsf(side) <= reach)
					b->occupied[grid_index(b, x, y, z)] = 1;
			}
}

static int mark_occupied(struct build *b)
{
	size_t cells = 1;

	for (int i = 0; i < 3; i++) {
		b->grid[i] = b->links->lattice.size[i] + 2;
		cells *= (size_t)b->grid[i];
	}
	b->occupied = calloc(cells, 1);
	if (!b->occupied)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i + 2 < b->scene->index_count; i += 3)
		mark_triangle(b, b->scene->indices + i);
	return GR_OK;
}

/* Whether something may stand in the box that holds both cells of a link. */
static bool link_crowded(const struct build *b, const int cell[3], const signed char *o)
{
	int low[3], high[3];

	for (int i = 0; i < 3; i++) {
		low[i] = cell[i] + (o[i] < 0 ? -1 : 0);
		high[i] = cell[i] + (o[i] > 0 ? 1 : 0);
	}
	for (int z = low[2]; z <= high[2]; z++)
		for (int y = low[1]; y <= high[1]; y++)
			for (int x = low[0]; x <= high[0]; x++)
				if (b->occupied[grid_index(b, x, y, z)])
					return true;
	return false;
}

/*
 * Where the k-th path of a link bends: the link's middle, spread over the
 * face, edge or corner that the two cells share by a Hammersley set (k = 0:
 * straight). It never leaves the box of the two cells.
 */
static void path_bend(const struct build *b, const float from[3], const float to[3],
		      const signed char *o, int k, float out[3])
{
	float r[3] = { 0, 0, 0 };

	if (k > 0) {
		unsigned bits = (unsigned)k, reversed = 0;
		float third = 0, scale = 1.0f / 3.0f;

		for (int i = 0; i < 16; i++)
			reversed |= ((bits >> i) & 1u) << (15 - i);
		for (unsigned n = (unsigned)k; n; n /= 3, scale /= 3.0f)
			third += (float)(n % 3) * scale;
		r[0] = (float)k / (float)b->rays_per_link - 0.5f;
		r[1] = (float)reversed / 65536.0f - 0.5f;
		r[2] = third - 0.5f;
	}
	int axis = 0;
	for (int i = 0; i < 3; i++) {
		out[i] = 0.5f * (from[i] + to[i]);
		/* along an axis on which the cells do not differ, the whole cell is shared */
		if (o[i] == 0)
			out[i] += 0.98f * b->links->lattice.d * r[axis++];
	}
}

/* One path: true when it gets through; else what it met. */
static bool path_free(const struct build *b, const float from[3], const float bend[3],
		      const float to[3], struct ray_hit *hit, float direction[3])
{
	const float *points[3] = { from, bend, to };

	for (int s = 0; s < 2; s++) {
		float length;

		for (int i = 0; i < 3; i++)
			direction[i] = points[s + 1][i] - points[s][i];
		length = sqrtf(direction[0] * direction[0] + direction[1] * direction[1] +
			       direction[2] * direction[2]);
		for (int i = 0; i < 3; i++)
			direction[i] /= length;
		/* a little further than the bend, so that nothing fits between the segments */
		if (rays_nearest_front(b->rays, points[s], direction, length * 1.0001f, hit))
			return false;
	}
	return true;
}

struct sampled {
	int free;
	struct link_block block;
};

/* Traces all paths of a link as seen from cell. */
static void sample_link(struct build *b, const int cell[3], int j, struct sampled *out)
{
	const signed char *o = sector_offset[j];
	int other[3] = { cell[0] + o[0], cell[1] + o[1], cell[2] + o[2] };
	float from[3], to[3], weight = 0;

	memset(out, 0, sizeof *out);
	out->block.j = (uint32_t)j;
	links_point(b->links, cell, from);
	links_point(b->links, other, to);
	for (int k = 0; k < b->rays_per_link; k++) {
		struct ray_hit hit;
		struct surface_point at;
		float bend[3], direction[3], mean;

		path_bend(b, from, to, o, k, bend);
		b->links->rays += 2;
		if (path_free(b, from, bend, to, &hit, direction)) {
			out->free++;
			continue;
		}
		surface_at(b->lookup, &hit, direction, b->albedo_override, &at);
		mean = (at.albedo[0] + at.albedo[1] + at.albedo[2]) / 3.0f;
		for (int i = 0; i < 3; i++) {
			out->block.reflect[i] += at.albedo[i];
			out->block.facing[i] += mean * at.facing[i];
		}
		weight += mean;
	}
	for (int i = 0; i < 3; i++) {
		out->block.reflect[i] /= (float)b->rays_per_link;
		if (weight > 0)
			out->block.facing[i] /= weight;
	}
}

/*
 * A link has one transmittance, both ways: the end that was sampled first
 * decides, so that rounding in the rays cannot part them.
 */
static uint8_t link_through(const struct build *b, const int cell[3], int j,
			    const struct sampled *mine)
{
	const struct lattice *l = &b->links->lattice;
	const signed char *o = sector_offset[j];
	int x = cell[0] + o[0], y = cell[1] + o[1], z = cell[2] + o[2];
	uint32_t surface;

	if (j < SECTOR_COUNT / 2 && lattice_inside(l, x, y, z)) {
		surface = b->links->surface_of[lattice_index(l, x, y, z)];
		return surface ? b->links->surfaces[surface - 1].through[SECTOR_COUNT - 1 - j] : LINK_OPEN;
	}
	return (uint8_t)((mine->free * LINK_OPEN + b->rays_per_link / 2) / b->rays_per_link);
}

static int push_block(struct build *b, const struct link_block *block)
{
	struct links *links = b->links;

	if (links->block_count == b->block_room) {
		size_t room = b->block_room ? b->block_room * 2 : 4096;
		struct link_block *grown = realloc(links->blocks, room * sizeof *grown);

		if (!grown)
			return GR_ERR_NOMEM;
		links->blocks = grown;
		b->block_room = room;
	}
	links->blocks[links->block_count++] = *block;
	return GR_OK;
}

/* Samples all links of a cell; *out_any when one is not open. */
static int build_cell(struct build *b, const int cell[3], struct link_surface *out, bool *out_any)
{
	memset(out, 0, sizeof *out);
	out->first = (uint32_t)b->links->block_count;
	*out_any = false;
	for (int j = 0; j < SECTOR_COUNT; j++) {
		struct sampled s;
		float scale;
		int result;

		out->through[j] = LINK_OPEN;
		if (!link_crowded(b, cell, sector_offset[j]))
			continue;
		sample_link(b, cell, j, &s);
		out->through[j] = link_through(b, cell, j, &s);
		if (out->through[j] == LINK_OPEN)
			continue;
		*out_any = true;
		s.block.blocked = 1.0f - (float)out->through[j] / (float)LINK_OPEN;
		/* the reflected share follows the rounded transmittance: nothing is made or lost */
		scale = s.free == b->rays_per_link ? 0.0f :
			s.block.blocked * (float)b->rays_per_link / (float)(b->rays_per_link - s.free);
		for (int i = 0; i < 3; i++)
			s.block.reflect[i] *= scale;
		result = push_block(b, &s.block);
		if (result != GR_OK)
			return result;
		out->count++;
	}
	return GR_OK;
}

static int build_cells(struct build *b)
{
	struct links *links = b->links;
	const struct lattice *l = &links->lattice;
	size_t room = 0;

	for (int z = 0; z < l->size[2]; z++)
		for (int y = 0; y < l->size[1]; y++)
			for (int x = 0; x < l->size[0]; x++) {
				struct link_surface surface;
				bool any;
				int result = build_cell(b, (int[3]){ x, y, z }, &surface, &any);

				if (result != GR_OK)
					return result;
				if (!any)
					continue;
				if (links->surface_count == room) {
					size_t more = room ? room * 2 : 1024;
					void *grown = realloc(links->surfaces,
							      more * sizeof surface);

					if (!grown)
						return GR_ERR_NOMEM;
					links->surfaces = grown;
					room = more;
				}
				links->surfaces[links->surface_count++] = surface;
				links->surface_of[lattice_index(l, x, y, z)] =
					(uint32_t)links->surface_count;
			}
	return GR_OK;
}

/*
 * An even field in the open cells meets a surface with the mean of `blocked`
 * over the sphere, and keeps the mean of `reflect`. Cells that are shut on all
 * sides (inside of solids) hold no light and do not count.
 */
static void derive_settling(struct links *links, const struct sectors *s)
{
	const int *size = links->lattice.size;
	double open = (double)lattice_cells(&links->lattice), met = 0, kept[3] = { 0 };
	int longest = size[0] > size[1] ? size[0] : size[1];

	if (size[2] > longest)
		longest = size[2];
	for (size_t i = 0; i < links->surface_count; i++) {
		const struct link_surface *surface = &links->surfaces[i];
		double blocked = 0, reflect[3] = { 0 };

		for (uint32_t k = 0; k < surface->count; k++) {
			const struct link_block *block = &links->blocks[surface->first + k];
			double a = s->a[sector_kind((int)block->j)];

			blocked += a * (double)block->blocked;
			for (int c = 0; c < 3; c++)
				reflect[c] += a * (double)block->reflect[c];
		}
		if (blocked > 0.999) {
			open -= 1;
			continue;
		}
		met += blocked;
		for (int c = 0; c < 3; c++)
			kept[c] += reflect[c];
	}
	links->hops_per_bounce = met > 0 ? open / met : 4.0 * longest;
	links->reflectance = met > 0 ? fmax(kept[0], fmax(kept[1], kept[2])) / met : 0;
	double bounces = log(1e-4) / log(fmin(fmax(links->reflectance, 1e-4), 0.95));
	double steps = 4.0 * longest + bounces * links->hops_per_bounce;
	links->settle_steps = (int)fmin(ceil(steps), 64.0 * longest);
}

/* Numbers the cells that light can pass between; a group's score is what its surfaces reflect. */
static void group_cells(const struct links *links, const struct sectors *s, uint32_t *group,
		       float *score, uint32_t *stack)
{
	const struct lattice *l = &links->lattice;
	size_t cells = lattice_cells(l), depth = 0;
	uint32_t groups = 0;

	memset(group, 0xff, cells * sizeof *group);
	for (size_t first = 0; first < cells; first++) {
		if (group[first] != UINT32_MAX)
			continue;
		score[groups] = 0;
		group[first] = groups;
		stack[depth++] = (uint32_t)first;
		while (depth > 0) {
			size_t at = stack[--depth];
			int x = (int)(at % (size_t)l->size[0]);
			int y = (int)(at / (size_t)l->size[0] % (size_t)l->size[1]);
			int z = (int)(at / (size_t)l->size[0] / (size_t)l->size[1]);
			const struct link_surface *surface = NULL;

			if (links->surface_of[at])
				surface = &links->surfaces[links->surface_of[at] - 1];
			for (uint32_t k = 0; surface && k < surface->count; k++) {
				const struct link_block *block = &links->blocks[surface->first + k];

				score[groups] += (float)s->a[sector_kind((int)block->j)] *
					(block->reflect[0] + block->reflect[1] + block->reflect[2]);
			}
			for (int j = 0; j < SECTOR_COUNT; j++) {
				int cx = x + sector_offset[j][0], cy = y + sector_offset[j][1];
				int cz = z + sector_offset[j][2];
				size_t to;

				if (!lattice_inside(l, cx, cy, cz) || (surface && !surface->through[j]))
					continue;
				to = lattice_index(l, cx, cy, cz);
				if (group[to] != UINT32_MAX)
					continue;
				group[to] = groups;
				stack[depth++] = (uint32_t)to;
			}
		}
		groups++;
	}
}

static int create_fronts(struct build *b, const struct sectors *s)
{
	struct links *links = b->links;
	size_t cells = lattice_cells(&links->lattice);
	uint32_t *group = calloc(cells, sizeof *group), *stack = calloc(cells, sizeof *stack);
	float *score = calloc(cells, sizeof *score);
	int result = GR_ERR_NOMEM;

	if (group && stack && score) {
		group_cells(links, s, group, score, stack);
		result = fronts_create(&links->fronts, b->scene, b->rays, &links->lattice,
				       links->point, group, score);
		links->rays += links->fronts.rays;
	}
	free(group);
	free(stack);
	free(score);
	return result;
}

int links_create(struct links **out, const struct scene *scene, const struct rays *rays,
		 const struct lattice *lattice, int rays_per_link, const float albedo_override[3])
{
	struct build b = { .scene = scene, .rays = rays };
	struct links *links = calloc(1, sizeof *links);
	struct sectors sectors;
	int result = GR_ERR_NOMEM;

	*out = NULL;
	if (!links)
		return result;
	links->lattice = *lattice;
	memcpy(links->point, point_offset, sizeof links->point);
	b.links = links;
	b.rays_per_link = rays_per_link < 1 ? 1 : (rays_per_link > MAX_RAYS ? MAX_RAYS : rays_per_link);
	memcpy(b.albedo_override, albedo_override, sizeof b.albedo_override);
	links->surface_of = calloc(lattice_cells(lattice), sizeof *links->surface_of);
	if (!links->surface_of)
		goto out;
	result = surface_lookup_create(&b.lookup, scene);
	if (result != GR_OK)
		goto out;
	result = mark_occupied(&b);
	if (result != GR_OK)
		goto out;
	result = build_cells(&b);
	if (result != GR_OK)
		goto out;
	sectors_init(&sectors);
	derive_settling(links, &sectors);
	result = create_fronts(&b, &sectors);
	if (result != GR_OK)
		goto out;
	*out = links;
	links = NULL;
out:
	free(b.occupied);
	surface_lookup_destroy(&b.lookup);
	links_destroy(&links);
	return result;
}

void links_destroy(struct links **links)
{
	if (!*links)
		return;
	free((*links)->surface_of);
	free((*links)->surfaces);
	free((*links)->blocks);
	fronts_finish(&(*links)->fronts);
	free(*links);
	*links = NULL;
}
