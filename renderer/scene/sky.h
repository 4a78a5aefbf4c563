/*
 * The clear and hazy sky of Preetham, Shirley and Smits 1999 ("A Practical
 * Analytic Model for Daylight", appendix A.2), without the sun's disc, which is
 * a lamp (config/scene_file.h). Luminance is the paper's, in kcd/m^2, so 1,000 /
 * 683 W/(m^2 sr) of grey; colours by CIE xyY.
 *
 * Directions are unit, +Y up. Pure; any thread.
 */
#ifndef GROTTO_RENDERER_SCENE_SKY_H
#define GROTTO_RENDERER_SCENE_SKY_H

#include "renderer/image/image.h"

/* Haze over air: below, the paper's distribution grows without bound to the horizon. */
#define SKY_TURBIDITY_MIN 1.7
#define SKY_TURBIDITY_MAX 10.0

struct sky {
	double coefficient[3][5]; /* A to E of luminance, x, y */
	double zenith[3];         /* over the distribution's value there; kcd/m^2 */
	double sun[3];
};

/*
 * turbidity within the range above. A sun at or below the horizon is taken as on
 * it, where the paper's measurements end: night is not in the model.
 */
void sky_init(struct sky *sky, double turbidity, const double to_sun[3]);
/* W/(m^2 sr) per band; at and below the horizon that of the horizon. Never below 0. */
void sky_radiance(const struct sky *sky, const double direction[3], double rgb[3]);
/* Latitude-longitude, as environment.h has it. GR_ERR_RANGE or GR_ERR_NOMEM. */
int sky_picture(const struct sky *sky, int width, int height, struct image *out);

#endif
