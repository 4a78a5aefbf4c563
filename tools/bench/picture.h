/* A rendered picture against the true one. */
#ifndef GROTTO_TOOLS_BENCH_PICTURE_H
#define GROTTO_TOOLS_BENCH_PICTURE_H

#include "tools/bench/measure.h"

/*
 * Both of 3 channels, W/(m^2 sr), of one size, at least a block a side. Errors
 * are of the means of blocks of BENCH_BLOCK pixels a side, so that the truth's
 * noise counts little; SSIM and FLIP are of the pictures as shown, pixel by
 * pixel. GR_OK, GR_ERR_RANGE for sizes that differ, GR_ERR_NOMEM.
 */
int bench_picture_compare(const struct image *found, const struct image *truth,
			  const struct scene_tone *tone, struct bench_picture_error *out);
/* With the scene's exposure and curve, on a display that is sRGB; 0..1. Caller finishes out. */
int bench_picture_show(const struct image *picture, const struct scene_tone *tone,
		       struct image *out);

#endif
