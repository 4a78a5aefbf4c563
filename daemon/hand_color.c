#include "daemon/hand_color.h"

#include <math.h>

/* 0 <= turn < 1, also where rounding makes the fraction of a tiny negative number 1. */
static float wrap(float turn)
{
	const float part = turn - floorf(turn);

	return part < 1 ? part : 0;
}

void hand_color_of(const float rgb[3], float hue, struct hand_color *out)
{
	const float most = fmaxf(fmaxf(rgb[0], rgb[1]), rgb[2]);
	const float chroma = most - fminf(fminf(rgb[0], rgb[1]), rgb[2]);
	float sixth;

	*out = (struct hand_color){ wrap(hue), 0, most };
	if (!(chroma > 0))
		return;
	if (most == rgb[0])
		sixth = (rgb[1] - rgb[2]) / chroma;
	else if (most == rgb[1])
		sixth = 2 + (rgb[2] - rgb[0]) / chroma;
	else
		sixth = 4 + (rgb[0] - rgb[1]) / chroma;
	out->hue = wrap(sixth / 6);
	out->saturation = chroma / most;
}

void hand_color_rgb(const struct hand_color *color, float rgb[3])
{
	const float sixth = 6 * wrap(color->hue);

	/* Each band is full for a third of the turn, none for a third, and goes straight between. */
	for (int i = 0; i < 3; i++) {
		float at = fabsf(sixth - 2 * (float)i);
		float strength;

		at = at > 3 ? 6 - at : at;
		strength = fminf(fmaxf(2 - at, 0), 1);
		rgb[i] = color->value * (1 - color->saturation * (1 - strength));
	}
}
