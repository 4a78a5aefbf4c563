#include "renderer/scene/texel.h"

#include "renderer/tone/srgb.h"

#include <math.h>

void texel_curve_init(struct texel_curve *out)
{
	for (int code = 0; code < 256; code++) {
		out->plain[code] = (float)code / 255.0f;
		out->srgb[code] = (float)srgb_decode(code / 255.0);
	}
}

/* The two texels around a coordinate along one axis, and the share of the second. */
static float neighbours(float at, int size, int out[2])
{
	float place = (at - floorf(at)) * (float)size - 0.5f;
	float below = floorf(place);
	int first = (int)below;

	out[0] = first < 0 ? size - 1 : first < size ? first : 0;
	out[1] = out[0] + 1 < size ? out[0] + 1 : 0;
	return place - below;
}

void texel_at(const struct texel_curve *curve, const struct scene_image *image, const float uv[2],
	      float out[3])
{
	const float *linear = image->srgb ? curve->srgb : curve->plain;
	int x[2], y[2];
	float along = neighbours(isfinite(uv[0]) ? uv[0] : 0.0f, image->width, x);
	float down = neighbours(isfinite(uv[1]) ? uv[1] : 0.0f, image->height, y);
	const float weights[4] = { (1 - along) * (1 - down), along * (1 - down), (1 - along) * down,
				   along * down };

	out[0] = out[1] = out[2] = 0.0f;
	for (int k = 0; k < 4; k++) {
		const uint8_t *texel = image->rgba + 4 * ((size_t)y[k >> 1] * (size_t)image->width +
							  (size_t)x[k & 1]);

		for (int c = 0; c < 3; c++)
			out[c] += weights[k] * linear[texel[c]];
	}
}
