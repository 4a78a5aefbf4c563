/*
 * What moves while a scene is measured: its first lamp that shines, on a
 * straight level line through where it stands, BENCH_STEP_M a frame; light that
 * is parallel turns by as many radians as that is at LEVER metres. Without a
 * lamp the air absorbs a little more in every second frame, so that all light
 * is computed anew.
 */
#ifndef GROTTO_TOOLS_BENCH_MOTION_H
#define GROTTO_TOOLS_BENCH_MOTION_H

#include "renderer/frame.h"

#define MOTION_LEVER_M 8.0f

struct bench_motion {
	const struct scene_file *file;
	struct render_frame rest; /* as the scene file says */
	int lamp;                 /* -1: none */
	vec3 way;                 /* unit, level, across the lamp's direction */
};
void bench_motion_init(struct bench_motion *motion, const struct scene_file *file);
/* The frame with the lamp so many steps from its place (either way); step 0: at rest. */
void bench_motion_frame(const struct bench_motion *motion, double step, struct render_frame *out);
/* All lamps off. */
void bench_motion_dark(const struct bench_motion *motion, struct render_frame *out);

#endif
