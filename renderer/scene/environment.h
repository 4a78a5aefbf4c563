/*
 * What lights a scene from all around, and is seen where no surface is: one
 * radiance, or a latitude-longitude picture. Directions are the scene's, unit.
 *
 * A picture's column u in 0..1 and row v in 0..1 from the top show the direction
 * (sin(pi v) cos p, cos(pi v), sin(pi v) sin p), p = 2 pi (u - 1/2): the middle
 * is +X, three quarters along +Z, the top row +Y. Between the middles of its
 * pixels radiance is linear in u and v, around in u, held above and below the
 * outermost rows.
 *
 * Thread safety: everything but create and destroy reads only.
 */
#ifndef GROTTO_RENDERER_SCENE_ENVIRONMENT_H
#define GROTTO_RENDERER_SCENE_ENVIRONMENT_H

#include "base/diag.h"
#include "config/scene_file.h"
#include "renderer/image/image.h"

#include <stdbool.h>
#include <stdint.h>

/* Longest side of a picture; larger ones are refused. */
#define ENVIRONMENT_MAX_SIDE 8192
/* Brightest that a picture may become with its scale, W/(m^2 sr). */
#define ENVIRONMENT_MAX_RADIANCE 1e12f

struct environment;

/*
 * As the scene file says: GR_NOTHING with *out NULL where it has none. A picture
 * that is missing, damaged, too large, or holds NaN or infinite values is named
 * in diag: GR_ERR_CONFIG. Negative values become 0 with a warning that counts
 * them; a picture not twice as wide as high is taken, with a warning.
 */
int environment_create(struct environment **out, const struct scene_file *file,
		       struct gr_diag *diag);
/*
 * The same from pixels (1 or 3 channels, copied); name stands in diag. Of what
 * is said, scale, heading_rad and upper_only count.
 */
int environment_from_image(struct environment **out, const struct image *image,
			   const struct scene_environment *said, const char *name,
			   struct gr_diag *diag);
void environment_destroy(struct environment **environment);

/* W/(m^2 sr) per band from there. */
void environment_radiance(const struct environment *environment, const float direction[3],
			  float out[3]);

/*
 * A direction from which light comes, for two numbers in [0, 1): by luminance
 * times solid angle, pixel by pixel, and evenly within a pixel. Returns its
 * density per steradian, which is above 0; in the dark all directions are alike.
 */
float environment_sample(const struct environment *environment, double u1, double u2,
			 float direction[3], float radiance[3]);
/* The density of that; 0 only where no light comes from. */
float environment_pdf(const struct environment *environment, const float direction[3]);

/* Irradiance of a surface that sees nothing else, W/m^2: a sum over all pixels, so slow. */
void environment_irradiance(const struct environment *environment, const float normal[3],
			    float out[3]);

/* For the GPU. rgb NULL: constant, the values are in `constant`. */
struct environment_pixels {
	const float *rgb; /* width x height x 3, row 0 the top; scale applied */
	int width, height;
	float constant[3];
	float heading_rad;
	bool upper_only;
};
void environment_pixels(const struct environment *environment, struct environment_pixels *out);
/* A line for people. */
void environment_describe(const struct environment *environment, char *text, size_t size);
/* BLAKE2b-256 of all that counts. */
void environment_hash(const struct environment *environment, uint8_t out[32]);

#endif
