/*
 * Textures read on the CPU as GL reads their finest level: bilinear between the
 * middles of texels, repeating, sRGB made linear before the mean.
 *
 * Thread safety: reads only.
 */
#ifndef GROTTO_RENDERER_SCENE_TEXEL_H
#define GROTTO_RENDERER_SCENE_TEXEL_H

#include "renderer/scene/scene.h"

/* Linear values of the 256 codes, so that no power is taken per texel. */
struct texel_curve {
	float srgb[256], plain[256];
};
void texel_curve_init(struct texel_curve *out);

/* uv that is not finite counts as 0. out: 0..1 per band. */
void texel_at(const struct texel_curve *curve, const struct scene_image *image, const float uv[2],
	      float out[3]);

#endif
