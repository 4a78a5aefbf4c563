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

/*
 * Goes on from sums->samples as params say. GR_OK, GR_NOTHING when progress
 * stopped it, GR_ERR_NOMEM.
 */
int estimate_run(struct estimate_sums *sums, const struct path_scene *scene,
		 const struct reference_params *params, estimate_sample sample, const void *ctx);
/* Standard error of the mean of one value; 0 before two sets. */
double estimate_error(double total, double squares, int samples);
/* rms standard error over the mean, of all; negative: not known, with fewer than two sets or all black. */
double estimate_relative_error(const struct estimate_sums *sums);

#endif
