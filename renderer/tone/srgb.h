/* The sRGB curve (IEC 61966-2-1), between 0 and 1. */
#ifndef GROTTO_RENDERER_TONE_SRGB_H
#define GROTTO_RENDERER_TONE_SRGB_H

#include <math.h>

static inline double srgb_encode(double linear)
{
	return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

static inline double srgb_decode(double encoded)
{
	return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

#endif
