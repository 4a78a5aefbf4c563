/*
 * Sums of samples for many items (pixels, or points of surfaces), set by set
 * on several threads. What comes out depends on nothing but seed and samples.
 */
#ifndef GROTTO_RENDERER_TRACE_ESTIMATE_H
#define GROTTO_RENDERER_TRACE_ESTIMATE_H

#include "renderer/trace/path.h"
#include "renderer/trace/reference.h"

/* 3 values an item each; see struct reference_film. */
struct estimate_sums {
	size_t items;
	int samples;
	double *total, *squares, *indirect, *indirect_squares;
	uint64_t nonfinite;
	uint64_t rays; /* of the last run, those of an unfinished pass included */
};

/* One sample of an item. Any thread. */
typedef struct path_light (*estimate_sample)(const void *ctx, const struct path_scene *scene,
					     size_t item, const struct sampler *sampler);

struct estimate_work {
	estimate_sample sample;
	const void *ctx;
	/* Calling thread, when every item has the same samples; may be NULL. */
	void (*after_pass)(void *ctx, const struct estimate_sums *sums);
	void *after_ctx;
};

/*
 * Goes on from sums->samples as params say. GR_OK, GR_NOTHING when progress
 * stopped it, GR_ERR_NOMEM.
 */
int estimate_run(struct estimate_sums *sums, const struct path_scene *scene,
		 const struct reference_params *params, const struct estimate_work *todo);
/* Standard error of the mean of one value; 0 before two sets. */
double estimate_error(double total, double squares, int samples);
/*
 * rms standard error over the mean, of all; negative: not known, with fewer than
 * two sets. All black: 0 once so many samples of all items together found
 * nothing (what more than one in 20,000 would find is then seen with 95 %), not
 * known before, nor where a sample was not finite.
 */
#define ESTIMATE_BLACK_SAMPLES 65536
double estimate_relative_error(const struct estimate_sums *sums);

#endif
