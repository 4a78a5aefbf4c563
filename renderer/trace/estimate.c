#include "renderer/trace/estimate.h"

#include "base/clock.h"
#include "base/result.h"
#include "renderer/trace/crew.h"
#include "renderer/trace/reference_private.h"

#include <stdatomic.h>
#include <stdlib.h>

/* Pieces of work in a pass when there are few items, and the most sets of one pass. */
#define PIECES_WANTED 512
#define SETS_MOST 64
#define PORTION 16

/* A pass takes `sets` sets of every item; nothing counts before all of them are there. */
struct pass {
	struct estimate_sums *sums;
	const struct path_scene *scene;
	const struct reference_params *params;
	const struct estimate_work *todo;
	uint64_t first_set;
	size_t sets;
	double (*results)[6]; /* a set of an item: sums of total and indirect */
	atomic_uint_fast64_t nonfinite, rays;
	/* progress */
	int first_samples, samples; /* at the start of this run, and wanted */
	int64_t start_ns;
	double error;
};

double estimate_error(double total, double squares, int samples)
{
	int sets = samples / SAMPLER_SET;
	double mean = total / samples;

	return sets < 2 ? 0.0 : sqrt(fmax(squares / samples - mean * mean, 0.0) / (sets - 1));
}

double estimate_relative_error(const struct estimate_sums *sums)
{
	double variance = 0.0, mean = 0.0;

	if (sums->samples < 2 * SAMPLER_SET || sums->items == 0)
		return -1.0;
	for (size_t i = 0; i < 3 * sums->items; i++) {
		double e = estimate_error(sums->total[i], sums->squares[i], sums->samples);

		variance += e * e;
		mean += sums->total[i] / sums->samples;
	}
	/* every sample was black: nothing says that there is light, and nothing is missing */
	if (mean == 0.0 && variance == 0.0 && sums->nonfinite == 0)
		return (double)sums->samples * (double)sums->items >= ESTIMATE_BLACK_SAMPLES ? 0.0 : -1.0;
	if (!(mean > 0.0))
		return -1.0;
	/* root of the mean variance over the mean; a mean that is a denormal is not divided first */
	return sqrt(variance * 3.0 * (double)sums->items) / mean;
}

/* One set of one item. */
static void take_set(struct pass *pass, size_t piece)
{
	size_t item = piece % pass->sums->items;
	struct sampler sampler = sampler_start(pass->params->seed, item,
					       pass->first_set + piece / pass->sums->items);
	double sum[6] = { 0 };
	unsigned rays = 0;

	for (uint32_t i = 0; i < SAMPLER_SET; i++) {
		struct path_light light;

		sampler_point(&sampler, i);
		light = pass->todo->sample(pass->todo->ctx, pass->scene, item, &sampler);
		rays += light.rays;
		if (!v3_finite(light.total) || !v3_finite(light.indirect)) {
			atomic_fetch_add(&pass->nonfinite, 1);
			continue;
		}
		sum[0] += (double)light.total.x;
		sum[1] += (double)light.total.y;
		sum[2] += (double)light.total.z;
		sum[3] += (double)light.indirect.x;
		sum[4] += (double)light.indirect.y;
		sum[5] += (double)light.indirect.z;
	}
	atomic_fetch_add_explicit(&pass->rays, rays, memory_order_relaxed);
	for (int c = 0; c < 6; c++)
		pass->results[piece][c] = sum[c];
}

static void work(void *ctx, size_t begin, size_t end, int thread)
{
	(void)thread;
	for (size_t piece = begin; piece < end; piece++)
		take_set(ctx, piece);
}

/* done: 0..1 of the pass. */
static bool tell(void *ctx, double done)
{
	struct pass *pass = ctx;
	const struct reference_params *params = pass->params;
	double now = pass->sums->samples + done * (double)pass->sets * SAMPLER_SET;
	double wanted = pass->samples, share, seconds;

	if (!params->progress)
		return true;
	if (params->until_error > 0.0 && pass->error > 0.0) {
		/* errors fall with the root of the samples */
		double ratio = pass->error / params->until_error;

		wanted = fmin(wanted, pass->sums->samples * ratio * ratio);
	}
	share = wanted > 0.0 ? fmin(now / wanted, 1.0) : 1.0;
	seconds = (double)(gr_clock_now(&gr_clock_monotonic) - pass->start_ns) * 1e-9;
	return params->progress(params->ctx, share,
				now > pass->first_samples
					? seconds / (now - pass->first_samples) * fmax(wanted - now, 0.0)
					: -1.0,
				pass->error);
}

/* In the order of the sets, so that a sum never depends on how they were shared out. */
static void add_up(struct pass *pass)
{
	struct estimate_sums *sums = pass->sums;

	for (size_t piece = 0; piece < pass->sets * sums->items; piece++) {
		size_t at = 3 * (piece % sums->items);
		const double *r = pass->results[piece];

		for (size_t c = 0; c < 3; c++) {
			sums->total[at + c] += r[c];
			sums->squares[at + c] += r[c] * r[c] / SAMPLER_SET;
			sums->indirect[at + c] += r[3 + c];
			sums->indirect_squares[at + c] += r[3 + c] * r[3 + c] / SAMPLER_SET;
		}
	}
	sums->samples += (int)pass->sets * SAMPLER_SET;
	sums->nonfinite += atomic_load(&pass->nonfinite);
	atomic_store(&pass->nonfinite, 0);
}

static int run_pass(struct pass *pass, size_t most_sets)
{
	size_t left = (size_t)(pass->samples - pass->sums->samples) / SAMPLER_SET, pieces;
	int result;

	pass->first_set = (uint64_t)pass->sums->samples / SAMPLER_SET;
	pass->sets = left < most_sets ? left : most_sets;
	pieces = pass->sets * pass->sums->items;
	result = crew_run(crew_threads(pass->params->threads), pieces,
			  pieces < PIECES_WANTED ? 1 : PORTION, work, pass, tell, pass);
	if (result == GR_OK)
		add_up(pass);
	pass->sets = 0;
	return result;
}

int estimate_run(struct estimate_sums *sums, const struct path_scene *scene,
		 const struct reference_params *params, const struct estimate_work *todo)
{
	struct pass pass = { .sums = sums, .scene = scene, .params = params, .todo = todo };
	size_t sets;
	int result = GR_OK;

	if (sums->items == 0)
		return GR_OK;
	sets = (PIECES_WANTED + sums->items - 1) / sums->items;
	sets = sets < SETS_MOST ? sets : SETS_MOST;
	pass.samples = (params->samples + SAMPLER_SET - 1) / SAMPLER_SET * SAMPLER_SET;
	if (pass.samples < 2 * SAMPLER_SET)
		pass.samples = 2 * SAMPLER_SET;
	pass.first_samples = sums->samples;
	pass.start_ns = gr_clock_now(&gr_clock_monotonic);
	pass.results = malloc(sets * sums->items * sizeof *pass.results);
	if (!pass.results)
		return GR_ERR_NOMEM;
	pass.error = estimate_relative_error(sums);
	while (result == GR_OK && sums->samples < pass.samples) {
		if (params->until_error > 0.0 && pass.error >= 0.0 &&
		    pass.error < params->until_error &&
		    sums->samples >= REFERENCE_LEAST_SETS * SAMPLER_SET)
			break;
		result = run_pass(&pass, sets);
		pass.error = estimate_relative_error(sums);
		if (result == GR_OK && todo->after_pass)
			todo->after_pass(todo->after_ctx, sums);
		if (result == GR_OK && !tell(&pass, 0.0) && sums->samples < pass.samples)
			result = GR_NOTHING;
	}
	sums->rays = atomic_load(&pass.rays);
	free(pass.results);
	return result;
}
