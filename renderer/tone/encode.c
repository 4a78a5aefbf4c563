#include "renderer/tone/encode.h"

#include "renderer/tone/curve.h"
#include "renderer/tone/srgb.h"

#include <math.h>

static float encode(bool srgb, double gamma, double linear)
{
	double l = fmin(linear, 1);

	if (srgb)
		return (float)srgb_encode(l);
	return l > 0 ? (float)pow(l, gamma) : 0.0f;
}

/* With what all pixels of a picture have in common. */
static void encode_pixel(const struct scene_tone *tone, const struct tone_factors *factors,
			 const float radiance[3], float out[3])
{
	double gamma = (double)scene_tone_gamma_encode(tone), l[3];

	if (!isfinite(radiance[0]) || !isfinite(radiance[1]) || !isfinite(radiance[2])) {
		out[0] = out[2] = 1.0f;
		out[1] = 0.0f;
		return;
	}
	for (int c = 0; c < 3; c++)
		l[c] = (double)radiance[c];
	tone_curve(factors, l, l);
	for (int c = 0; c < 3; c++)
		out[c] = encode(tone->srgb, gamma, l[c]);
}

void tone_encode(const struct scene_tone *tone, const float radiance[3], float out[3])
{
	const struct tone_look look = tone_look_of_scene(tone);
	struct tone_factors factors;

	tone_factors(&look, &factors);
	encode_pixel(tone, &factors, radiance, out);
}

void tone_encode_bytes(const struct scene_tone *tone, const float *radiance, size_t count,
		       uint8_t *out)
{
	const struct tone_look look = tone_look_of_scene(tone);
	struct tone_factors factors;

	tone_factors(&look, &factors);
	for (size_t i = 0; i < count; i++) {
		float shown[3];

		encode_pixel(tone, &factors, radiance + 3 * i, shown);
		for (size_t c = 0; c < 3; c++)
			out[3 * i + c] = (uint8_t)lroundf(255.0f * shown[c]);
	}
}
