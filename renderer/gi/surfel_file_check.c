/* Whether a set that came from a file can be used: by shaders, too, which check nothing. */
#include "renderer/gi/surfel_file_private.h"

#include "renderer/gi/surfel_bake.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

#define CELLS_MOST (UINT32_MAX - 1)
#define DENSE_CELLS_MOST ((uint64_t)1 << 21)
#define SLOTS_MOST ((uint32_t)1 << 30)

static bool is_length(float v)
{
	return isfinite(v) && v > 0;
}

static bool all_finite(const float *v, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (!isfinite(v[i]))
			return false;
	return true;
}

static bool all_within(const float *v, size_t count, float low, float high)
{
	for (size_t i = 0; i < count; i++)
		if (!(v[i] >= low && v[i] <= high))
			return false;
	return true;
}

/* x size y size z, 0 when one is not positive or the product is larger than most. */
static uint64_t volume(const int32_t size[3], uint64_t most)
{
	uint64_t cells = 1;

	for (int i = 0; i < 3; i++) {
		if (size[i] < 1 || (uint64_t)size[i] > most / cells)
			return 0;
		cells *= (uint64_t)size[i];
	}
	return cells;
}

static bool grid_head_fits(const struct surfel_grid *grid)
{
	uint64_t cells = volume(grid->size, CELLS_MOST);

	if (cells == 0 || !is_length(grid->cell_m) || !all_finite(grid->origin, 3))
		return false;
	if (grid->member_count > UINT32_MAX / 4)
		return false;
	if (grid->slots == 0)
		return cells <= DENSE_CELLS_MOST;
	return grid->slots <= SLOTS_MOST && (grid->slots & (grid->slots - 1)) == 0;
}

static bool probes_head_fits(const struct surfel_probes *probes)
{
	if (probes->count == 0)
		return true;
	return probes->count <= SURFEL_LINKS_MOST &&
	       volume(probes->size, SURFEL_LINKS_MOST) == probes->count &&
	       probes->links_each >= 1 && probes->links_each <= 4096 &&
	       probes->count * probes->links_each <= SURFEL_LINKS_MOST &&
	       is_length(probes->cell_m) && all_finite(probes->origin, 3);
}

const char *surfel_check_head(const struct surfel_set *set)
{
	if (!is_length(set->spacing_m) || !is_length(set->radius_m))
		return "its spacing is not a length";
	if (set->count > SURFEL_MOST || set->links_each < 1 || set->links_each > 4096 ||
	    set->count * set->links_each > SURFEL_LINKS_MOST || set->taps_each < 1 ||
	    set->taps_each > 64)
		return "it says more surfels or links than there can be";
	if (!(set->extinction >= 0 && isfinite(set->extinction)))
		return "its air is none";
	if (!grid_head_fits(&set->grid))
		return "its grid is not one";
	if (!probes_head_fits(&set->probes))
		return "its probes do not stand in a grid";
	return NULL;
}

static bool links_fit(const uint32_t *links, size_t count, size_t surfels)
{
	for (size_t i = 0; i < count; i++)
		if (links[i] >= surfels && links[i] != SURFEL_NONE)
			return false;
	return true;
}

/* Half of a hash table is empty, so that every search ends. */
static bool keys_fit(const struct surfel_grid *grid)
{
	uint64_t cells = volume(grid->size, CELLS_MOST);
	size_t used = 0;

	for (uint32_t s = 0; s < grid->slots; s++) {
		if (grid->keys[s] > cells)
			return false;
		used += grid->keys[s] != 0;
	}
	return used <= grid->slots / 2;
}

static bool members_fit(const struct surfel_grid *grid, size_t surfels)
{
	uint64_t slots = grid->slots ? grid->slots : volume(grid->size, CELLS_MOST);

	if (grid->first[0] != 0 || grid->first[slots] != grid->member_count)
		return false;
	for (uint64_t s = 0; s < slots; s++)
		if (grid->first[s + 1] < grid->first[s])
			return false;
	for (size_t i = 0; i < grid->member_count; i++)
		if (grid->members[i] >= surfels)
			return false;
	return true;
}

static const char *check_surfels(const struct surfel_set *set)
{
	if (set->count == 0)
		return NULL; /* and no arrays */
	for (size_t i = 0; i < set->count; i++) {
		if (!all_finite(set->surfels[i].position, 3))
			return "a surfel is nowhere";
		for (int k = 0; k < SURFEL_SECTORS; k++)
			if (set->surfels[i].reach[k] == 0)
				return "a surfel has no reach";
	}
	for (size_t i = 0; i < set->count * set->taps_each; i++)
		if (!all_finite(set->taps[i].position, 3))
			return "a point of a surfel is nowhere";
	if (!all_within(set->area, set->count, 0, INFINITY) ||
	    !all_within(&set->albedo[0][0], 3 * set->count, 0, 1))
		return "a surfel's area or reflectance is out of range";
	if (!all_finite(&set->fixed_emissive[0][0], 3 * set->count) ||
	    !all_finite(&set->fixed_other[0][0], 3 * set->count))
		return "a surfel's light is not finite";
	if (!all_within(&set->fixed_way[0][0], 4 * set->count, 0, FLT_MAX))
		return "a surfel's light has come from nowhere";
	return NULL;
}

static const char *check_probes(const struct surfel_probes *probes, size_t surfels)
{
	if (probes->count == 0)
		return NULL;
	if (!links_fit(probes->links, probes->count * probes->links_each, surfels))
		return "a probe is linked to a surfel that is not there";
	if (!all_within(&probes->directions[0][0], 3 * (size_t)probes->links_each, -1.001f, 1.001f))
		return "a direction of its probes is none";
	if (!all_finite(&probes->fixed[0][0][0], probes->count * SURFEL_SH * 3) ||
	    !all_within(&probes->distance[0][0][0],
			probes->count * SURFEL_PROBE_SIDE * SURFEL_PROBE_SIDE * 2, 0, INFINITY) ||
	    !all_finite(&probes->distance[0][0][0],
			probes->count * SURFEL_PROBE_SIDE * SURFEL_PROBE_SIDE * 2))
		return "a probe's light or distances are not finite";
	if (!all_within(&probes->fixed_way[0][0], 2 * probes->count, 0, FLT_MAX))
		return "a probe's light has come from nowhere";
	for (size_t i = 0; i < probes->count; i++)
		if (probes->alive[i] > 1)
			return "a probe is neither alive nor dead";
	return NULL;
}

const char *surfel_check_arrays(const struct surfel_set *set)
{
	const char *wrong = check_surfels(set);

	if (!wrong && !links_fit(set->links, set->count * set->links_each, set->count))
		wrong = "a surfel is linked to one that is not there";
	if (!wrong && !(keys_fit(&set->grid) && members_fit(&set->grid, set->count)))
		wrong = "its grid is not one";
	return wrong ? wrong : check_probes(&set->probes, set->count);
}
