/*
 * The last pass: exposure, tone curve (curve.h) and encoding of an eye's radiance
 * into the target (seed 004 section 3.3.6). Counts pixels that are not finite and
 * paints them magenta.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_TONE_TONE_H
#define GROTTO_RENDERER_TONE_TONE_H

#include "renderer/tone/curve.h"

#include <stdbool.h>
#include <stdint.h>

struct tone_values {
	struct tone_factors factors;
	float gamma_encode; /* l^gamma_encode, unless */
	bool srgb;          /* IEC 61966-2-1 */
};
bool tone_values_same(const struct tone_values *a, const struct tone_values *b);

struct tone_stage;
/*
 * map: 3 * PROJECTOR_MAP floats (projector.h), NULL when the display is the scene's.
 * dither_bits: of a band, 0 for none; the pattern is the target's, fixed, so that it
 * neither flickers nor differs between the eyes.
 */
int tone_create(struct tone_stage **out, const float (*map)[3], int dither_bits);
void tone_destroy(struct tone_stage **stage);
/* x, y: lower left corner of the picture in the framebuffer. */
void tone_draw(struct tone_stage *stage, const struct tone_values *values, unsigned radiance,
	       unsigned framebuffer, int x, int y, int width, int height);
/* Copies the count to where the CPU will find it; once a frame, after the passes. */
void tone_frame(struct tone_stage *stage);
/* Pixels that were not finite, since create, as of the last finished frame. Never waits. */
uint64_t tone_nonfinite(struct tone_stage *stage);

#endif
