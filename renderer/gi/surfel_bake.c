#include "renderer/gi/surfel_bake_private.h"

#include "base/clock.h"
#include "base/plain.h"
#include "base/result.h"
#include "renderer/gi/surfel_file_private.h"

#include <stdlib.h>

/* Rounds in which points that hear no surfel become some. */
#define REPAIR_ROUNDS 4
/* With a spacing of our own: larger by this until there are few enough. */
#define WIDEN 1.5f

void surfel_bake_params_of(const struct scene_file *file, struct surfel_bake_params *out)
{
	*out = (struct surfel_bake_params)SURFEL_BAKE_PARAMS;
	out->spacing_m = file->gi.spacing_m;
	out->links = file->gi.links;
	out->taps = file->gi.taps;
	out->absorption_per_m = file->absorption_per_m;
	out->scattering_per_m = file->scattering_per_m;
	/* they light what moves, and nothing does; else whoever asks for them */
	out->probes = file->gi.method == SCENE_GI_PROBES ? file->gi.probes : 0;
}

/* --- progress --- */

static double seconds_since(int64_t start_ns)
{
	return (double)(gr_clock_now(&gr_clock_monotonic) - start_ns) * 1e-9;
}

bool bake_told(struct bake *bake, double done)
{
	double all = bake->stage_from + (bake->stage_to - bake->stage_from) * done;
	double seconds = seconds_since(bake->started_ns);

	if (!bake->params.progress)
		return true;
	return bake->params.progress(bake->params.ctx, bake->stage, all,
				     all > 0.02 ? seconds / all - seconds : -1);
}

static bool watch(void *ctx, double done)
{
	return bake_told(ctx, done);
}

int bake_run(struct bake *bake, size_t items, size_t portion, crew_work work, void *ctx)
{
	return crew_run(bake->threads, items, portion, work, ctx, watch, bake);
}

static void begin_stage(struct bake *bake, const char *name, double until)
{
	bake->stage = name;
	bake->stage_from = bake->stage_to;
	bake->stage_to = until;
}

/* --- lengths --- */

void bake_set_spacing(struct bake *bake, float spacing)
{
	bake->spacing = spacing;
	bake->radius = BAKE_RADIUS * spacing;
	bake->lift = BAKE_LIFT * spacing;
	/* well above the rounding of a hit's place, well below what is to be seen */
	bake->offset = fmaxf(1e-4f * spacing, world_lift(v3_of(bake->min), v3_of(bake->max), v3_all(0)));
	bake->set->spacing_m = spacing;
	bake->set->radius_m = bake->radius;
}

static float usual_spacing(const struct bake *bake)
{
	return (float)sqrt(0.7 * bake->area / SURFEL_USUAL);
}

static int check_params(const struct surfel_bake_params *p, struct gr_diag *diag)
{
	if (!(p->spacing_m >= 0 && p->spacing_m <= 1e6f)) {
		gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, "spacing_m",
			    "%s m: 0 (chosen from the scene's area) to 1000000 m are accepted",
			    gr_plain((double)p->spacing_m, 6).text);
		return GR_ERR_RANGE;
	}
	if (p->links < 16 || p->links > 4096) {
		gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, "links", "%d: 16 to 4096 are accepted",
			    p->links);
		return GR_ERR_RANGE;
	}
	if (p->taps < 1 || p->taps > 64) {
		gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, "taps", "%d: 1 to 64 are accepted",
			    p->taps);
		return GR_ERR_RANGE;
	}
	if (p->probes < 0 || p->probes > 64) {
		gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, "probes", "%d: 0 to 64 are accepted",
			    p->probes);
		return GR_ERR_RANGE;
	}
	return GR_OK;
}

static bool fits(const struct bake *bake, double surfels)
{
	return surfels <= (double)SURFEL_MOST &&
	       surfels * bake->params.links <= (double)SURFEL_LINKS_MOST;
}

static int refuse_spacing(const struct bake *bake, double surfels)
{
	double most = fmin((double)SURFEL_MOST,
			   (double)SURFEL_LINKS_MOST / (double)bake->params.links);

	gr_diag_add(bake->diag, GR_DIAG_ERROR, NULL, 0, "spacing_m",
		    "%s m gives more than %.0f surfels with %d links each on %s m^2 of surfaces; "
		    "%s m or more, or 0, would do",
		    gr_plain((double)bake->spacing, 6).text, most, bake->params.links,
		    gr_plain(bake->area, 4).text,
		    gr_plain((double)bake->spacing * fmax(sqrt(surfels / most), 1.05) * 1.05, 2).text);
	return GR_ERR_RANGE;
}

/* --- steps --- */

int bake_place(struct bake *bake)
{
	int result = bake_choose(bake, NULL, 0);

	for (int round = 0; result == GR_OK; round++) {
		uint32_t *unheard = NULL;
		size_t count = 0;

		result = bake_sort_chosen(bake);
		if (result == GR_OK)
			result = bake_reach(bake);
		if (result == GR_OK && round < REPAIR_ROUNDS)
			result = bake_unheard(bake, &unheard, &count);
		if (result == GR_OK && count > 0)
			result = bake_choose(bake, unheard, count);
		free(unheard);
		if (count == 0)
			break;
	}
	return result;
}

static void drop_points(struct bake *bake)
{
	free(bake->points);
	bake->points = NULL;
	bake->point_count = 0;
	bake_cells_finish(&bake->cells);
	bake->chosen_count = 0;
}

/* Points and surfels; where the spacing is ours, one that does not give too many. */
static int place_all(struct bake *bake)
{
	bool ours = bake->params.spacing_m <= 0;
	double to_expect;
	int result;

	bake_set_spacing(bake, ours ? usual_spacing(bake) : bake->params.spacing_m);
	for (;;) {
		to_expect = 0.7 * bake->area / ((double)bake->spacing * (double)bake->spacing);
		begin_stage(bake, "points", 0.1);
		result = fits(bake, to_expect) ? bake_points(bake) : GR_ERR_RANGE;
		begin_stage(bake, "surfels", 0.3);
		if (result == GR_OK)
			result = bake_place(bake);
		if (result == GR_OK && !fits(bake, (double)bake->chosen_count))
			result = GR_ERR_RANGE;
		if (result == GR_OK && ours && bake->chosen_count > 4 * SURFEL_USUAL)
			result = GR_ERR_RANGE;
		if (result != GR_ERR_RANGE)
			return result;
		/* many small pieces: each has a surfel, and few of them lie on one plane */
		if (!ours || bake->spacing > 1e6f)
			return refuse_spacing(bake, fmax(to_expect, (double)bake->chosen_count));
		drop_points(bake);
		bake->stage_to = 0;
		bake_set_spacing(bake, bake->spacing * WIDEN);
	}
}

static int bake_all(struct bake *bake)
{
	int result;

	begin_stage(bake, "surfaces", 0.02);
	result = bake_surface(bake);
	if (result != GR_OK || bake->piece_count == 0)
		return result;
	medium_init(&bake->air, bake->params.absorption_per_m + bake->params.scattering_per_m, 0,
		    bake->scene->min, bake->scene->max);
	bake->set->extinction = bake->air.extinction;
	result = world_init(&bake->world, bake->scene, bake->threads);
	if (result == GR_OK)
		result = place_all(bake);
	if (result == GR_OK)
		result = bake_assign(bake);
	if (result == GR_OK)
		result = bake_patch_data(bake);
	begin_stage(bake, "links", 0.8);
	if (result == GR_OK)
		result = bake_links(bake);
	begin_stage(bake, "fixed light", 0.9);
	if (result == GR_OK)
		result = bake_fixed(bake);
	begin_stage(bake, "probes", 1);
	if (result == GR_OK && bake->params.probes > 0)
		result = bake_probes(bake);
	return result;
}

/* Nothing to light: a set without surfels, whose grid has one empty cell. */
static int make_empty(struct bake *bake)
{
	struct surfel_set *set = bake->set;
	const float origin[3] = { 0, 0, 0 };

	set->spacing_m = set->radius_m = 1;
	set->links_each = (uint32_t)bake->params.links;
	set->taps_each = (uint32_t)bake->params.taps;
	return surfel_grid_build(set, origin, origin);
}

void bake_finish(struct bake *bake)
{
	world_finish(&bake->world);
	drop_points(bake);
	bake_cells_finish(&bake->surfel_cells);
	free(bake->normals);
	free(bake->areas);
	free(bake->two_sided);
	free(bake->piece_order);
	free(bake->piece_first);
	free(bake->chosen);
	free(bake->patch_first);
	free(bake->patch_points);
	free(bake->patch_sums);
	free(bake->near);
	free(bake->sobol);
	bake_map_finish(bake);
	surfel_set_destroy(&bake->set);
}

/* What shaders would take unseen, and no file would bring. */
static int check_set(const struct surfel_set *set, struct gr_diag *diag)
{
	const char *wrong = surfel_check_head(set);

	if (!wrong)
		wrong = surfel_check_arrays(set);
	if (!wrong)
		return GR_OK;
	gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, NULL,
		    "surfels as baked cannot be used: %s; what emits and the environment must be finite",
		    wrong);
	return GR_ERR_RANGE;
}

int surfel_bake(struct surfel_set **out, const struct scene *scene, const struct scene_file *file,
		const struct surfel_bake_params *params, struct gr_diag *diag)
{
	return bake_then(out, scene, file, params, diag, NULL, NULL);
}

int bake_then(struct surfel_set **out, const struct scene *scene, const struct scene_file *file,
	      const struct surfel_bake_params *params, struct gr_diag *diag,
	      void (*then)(struct bake *bake, void *ctx), void *ctx)
{
	struct bake bake = { .scene = scene, .file = file, .params = *params, .diag = diag };
	int result = check_params(params, diag);

	*out = NULL;
	if (result != GR_OK)
		return result;
	bake.started_ns = gr_clock_now(&gr_clock_monotonic);
	bake.threads = crew_threads(params->threads);
	bake.set = calloc(1, sizeof *bake.set);
	bake.chosen = calloc(SURFEL_MOST, sizeof *bake.chosen);
	result = bake.set && bake.chosen ? bake_all(&bake) : GR_ERR_NOMEM;
	if (result == GR_OK && bake.piece_count == 0)
		result = make_empty(&bake);
	if (result == GR_OK)
		result = check_set(bake.set, diag);
	if (result == GR_OK) {
		bake.set->seconds = seconds_since(bake.started_ns);
		bake.set->threads = bake.threads;
		if (then && bake.set->count > 0)
			then(&bake, ctx);
		*out = bake.set;
		bake.set = NULL;
	}
	bake_finish(&bake);
	return result;
}
