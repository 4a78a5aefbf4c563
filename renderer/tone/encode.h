/*
 * The tone pass (shaders/tone.frag) on the CPU: exposure, curve, encoding.
 * Pure; any thread.
 */
#ifndef GROTTO_RENDERER_TONE_ENCODE_H
#define GROTTO_RENDERER_TONE_ENCODE_H

#include "config/scene_file.h"

#include <stdint.h>

/* Radiance to what the display takes, 0..1; what is not finite becomes magenta. */
void tone_encode(const struct scene_tone *tone, const float radiance[3], float out[3]);
/* The same in bytes, of count pixels of 3 values. */
void tone_encode_bytes(const struct scene_tone *tone, const float *radiance, size_t count,
		       uint8_t *out);

#endif
