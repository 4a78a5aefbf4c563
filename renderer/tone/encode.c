#include "renderer/tone/encode.h"

#include "renderer/tone/srgb.h"

#include <math.h>

static float encode(const struct scene_tone *tone, float radiance, float gamma)
{
	float l = fmaxf(radiance * tone->exposure, 0.0f);

	if (tone->curve == SCENE_CURVE_REINHARD)
		l = l / (1.0f + l);
	l = fminf(l, 1.0f);
	if (tone->srgb)
		return (float)srgb_encode((double)l);
	return l > 0.0f ? powf(l, gamma) : 0.0f;
}

void tone_encode(const struct scene_tone *tone, const float radiance[3], float out[3])
{
	float gamma = scene_tone_gamma_encode(tone);

	if (!isfinite(radiance[0]) || !isfinite(radiance[1]) || !isfinite(radiance[2])) {
		out[0] = out[2] = 1.0f;
		out[1] = 0.0f;
		return;
	}
	for (int c = 0; c < 3; c++)
		out[c] = encode(tone, radiance[c], gamma);
}

void tone_encode_bytes(const struct scene_tone *tone, const float *radiance, size_t count,
		       uint8_t *out)
{
	for (size_t i = 0; i < count; i++) {
		float shown[3];

		tone_encode(tone, radiance + 3 * i, shown);
		for (size_t c = 0; c < 3; c++)
			out[3 * i + c] = (uint8_t)lroundf(255.0f * shown[c]);
	}
}
