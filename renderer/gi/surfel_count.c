#include "renderer/gi/surfel_count.h"

#include "base/clock.h"
#include "base/result.h"
#include "renderer/gi/surfel_bake_private.h"

#include <stdlib.h>

static int count(struct bake *bake, float spacing_m)
{
	int result = bake_surface(bake);

	if (result != GR_OK || bake->piece_count == 0)
		return result;
	result = world_init(&bake->world, bake->scene, bake->threads);
	if (result != GR_OK)
		return result;
	bake_set_spacing(bake, spacing_m);
	if (0.7 * bake->area > (double)SURFEL_MOST * (double)spacing_m * (double)spacing_m)
		return GR_ERR_RANGE;
	result = bake_points(bake);
	return result == GR_OK ? bake_place(bake) : result;
}

int surfel_count(const struct scene *scene, float spacing_m, int threads, size_t *out)
{
	struct bake bake = { .scene = scene, .params = SURFEL_BAKE_PARAMS };
	int result = GR_ERR_NOMEM;

	*out = 0;
	bake.started_ns = gr_clock_now(&gr_clock_monotonic);
	bake.threads = crew_threads(threads);
	bake.set = calloc(1, sizeof *bake.set);
	bake.chosen = calloc(SURFEL_MOST, sizeof *bake.chosen);
	if (bake.set && bake.chosen)
		result = count(&bake, spacing_m);
	if (result == GR_OK)
		*out = bake.chosen_count;
	bake_finish(&bake);
	return result;
}
