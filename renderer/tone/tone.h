/*
 * The last pass: exposure, tone curve and encoding of an eye's radiance into
 * the target (seed 004 section 3.3.6). Counts pixels that are not finite and
 * paints them magenta.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_TONE_TONE_H
#define GROTTO_RENDERER_TONE_TONE_H

#include "config/scene_file.h"

#include <stdbool.h>
#include <stdint.h>

struct tone_values {
	float exposure;
	enum scene_curve curve; /* Reinhard is L / (1 + L) per band, equation 3.3 */
	float gamma_encode;     /* L^gamma_encode, unless */
	bool srgb;              /* IEC 61966-2-1 */
};

struct tone_stage;
int tone_create(struct tone_stage **out);
void tone_destroy(struct tone_stage **stage);
/* x, y: lower left corner of the picture in the framebuffer. */
void tone_draw(struct tone_stage *stage, const struct tone_values *values, unsigned radiance,
	       unsigned framebuffer, int x, int y, int width, int height);
/* Copies the count to where the CPU will find it; once a frame, after the passes. */
void tone_frame(struct tone_stage *stage);
/* Pixels that were not finite, since create, as of the last finished frame. Never waits. */
uint64_t tone_nonfinite(struct tone_stage *stage);

#endif
