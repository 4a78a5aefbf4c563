/*
 * Truth by the path tracer (renderer/trace/reference.h). The light field's part
 * is what lamps and emissive surfaces do not send straight: all light that was
 * reflected, and the environment's.
 */
#ifndef GROTTO_TOOLS_BENCH_TRUTH_TRACED_H
#define GROTTO_TOOLS_BENCH_TRUTH_TRACED_H

#include "tools/bench/truth_store.h"

struct bench_traced {
	const struct scene_file *file;
	const struct scene *scene;
	struct render_frame frame;
	struct scene_camera camera;
	uint64_t seed;
	int point_samples, picture_samples;
	float until_error; /* as a share; 0: all samples */
	bool progress;     /* said on stderr */
};
/* A source for bench_truth_get; the argument must outlive it. */
struct bench_truth_source bench_traced_source(struct bench_traced *traced);
/* Of all that its answers depend on, the points included. */
void bench_traced_key(const struct bench_traced *traced, const struct bench_points *points,
		      uint8_t out[32]);

#endif
