/*
 * The daylight model of Preetham, Shirley and Smits 1999 ("A Practical Analytic
 * Model for Daylight", appendix), without the sun's disc, as a latitude-longitude
 * picture (renderer/scene/environment.h): linear Rec.709, in units of 16.667
 * kcd/m^2, which are those of the sky texture of Blender 3.4.1.
 */
#ifndef GROTTO_TESTS_FOLDER_PREETHAM_H
#define GROTTO_TESTS_FOLDER_PREETHAM_H

#include "renderer/image/image.h"

/* To the sun, unit, y >= 0; turbidity 1.7 to 10. Below the horizon its colour goes on. */
int preetham_picture(struct image *out, int width, int height, double turbidity,
		     const double sun[3]);
/* Of one direction. */
void preetham_radiance(double turbidity, const double sun[3], const double direction[3],
		       double rgb[3]);

#endif
