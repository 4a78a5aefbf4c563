/*
 * `grotto bench SCENE...`: measures every case of every scene and reports.
 */
#ifndef GROTTO_TOOLS_BENCH_SCENES_H
#define GROTTO_TOOLS_BENCH_SCENES_H

#include "tools/bench/report.h"

struct bench_options {
	const char *methods;   /* names with commas between */
	const char *settings;  /* see settings.h; NULL: the usual sweeps */
	const char *camera;    /* NULL: the first */
	int pixels[2];         /* 0: a square of 256 */
	int frames, points;
	int samples;           /* of the truth, a pixel; a point has BENCH_POINT_SAMPLES times as many */
	float until_error_percent; /* 0: all samples */
	const char *out;       /* folder, made when it is not there */
	const char *json;      /* NULL: bench.json in it */
	const char *svg;       /* NULL: SCENE.svg in it */
	bool fit;              /* lines for the planner's model, too */
	int gpu;
};
#define BENCH_POINT_SAMPLES 128
#define BENCH_OPTIONS \
	{ .methods = "lpv,surfels,probes", .frames = 24, .points = 600, .samples = 128, \
	  .out = "grotto-bench", .gpu = -1 }

/* GR_OK; GR_ERR_CONFIG for what is wrong with the arguments, said on stderr; other results. */
int bench_scenes(const struct bench_options *options, char *const *paths, size_t count);

#endif
