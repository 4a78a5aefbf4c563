/*
 * One method with its settings in one scene, measured on this machine's
 * OpenGL: what a frame costs while a lamp moves and while nothing does, how far
 * its light is from the truth, how it flickers, how fast it follows a switch.
 *
 * GL thread only.
 */
#ifndef GROTTO_TOOLS_BENCH_MEASURE_H
#define GROTTO_TOOLS_BENCH_MEASURE_H

#include "renderer/renderer.h"
#include "tools/bench/settings.h"
#include "tools/bench/stats.h"
#include "tools/bench/truth_store.h"

#define BENCH_STEP_M 0.008    /* a moving lamp's way a frame: 0.5 m/s at 60 Hz */
#define BENCH_SWITCH_FRAMES 64 /* that convergence is looked at for */
#define BENCH_BLOCK 8         /* side of the blocks of pixels whose means are compared */

/* What stays the same for all cases of a scene. */
struct bench_view {
	struct target *target;
	const struct scene_file *file;
	const struct scene *scene;
	struct scene_camera camera; /* with the pixels that are drawn */
	const struct bench_points *points;
	const struct bench_truth *truth;
	int frames; /* that are timed, and that flicker is looked for in */
};

struct bench_stage {
	const char *name; /* NULL: none */
	struct stats_spread ms;
};

struct bench_picture_error {
	struct stats_error blocks;   /* of means of blocks of pixels */
	double ssim, flip;           /* of the tone-mapped picture; NaN: unknown */
};

struct bench_result {
	struct bench_case used;  /* what ran; for auto: what it chose */
	double create_s;         /* renderer with all that it computes once; tracing and baking included */
	uint64_t gpu_bytes;      /* the light field's */
	size_t surfels;          /* 0: another method */
	struct bench_stage stages[TIMER_STAGES]; /* while a lamp moves */
	double frame_ms;         /* sum of the stages' medians */
	bool moves;              /* the scene has a lamp to move; false: the air changed a little instead */
	int still_frames;        /* frames until nothing was computed any more; -1: it did not stop */
	struct stats_error irradiance; /* its nrmse without the truth's noise */
	double nrmse_raw;              /* with it */
	double leak;             /* mean where the truth is dark, over the mean elsewhere; NaN: nowhere is dark */
	struct bench_picture_error total, indirect;
	struct stats_flicker flicker;     /* NaN without a lamp */
	size_t frames_to_10, frames_to_1; /* after a switch, to 10 % and 1 %; 0: not within, or no lamp */
	uint64_t nonfinite, gl_errors;
};
/* GR_OK or a negative result, said in the log. */
int bench_measure(struct bench_result *out, const struct bench_view *view,
		  const struct bench_case *c);

#endif
