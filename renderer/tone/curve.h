/*
 * Tone curves: radiance to the linear light that a display shows, 1 its white.
 *
 *     linear     E L
 *     reinhard   E L / (1 + E L) per band: seed 004, equation 3.3
 *     drago      Drago, Myszkowski, Annen and Chiba 2003, "Adaptive Logarithmic
 *                Mapping For Displaying High Contrast Scenes", equation 4, of
 *                luminance over the level that the eye is used to; above the
 *                luminance that becomes white all is white
 *     pattanaik  Pattanaik et al. 2000 (renderer/tone/adapt.h), sections 4 and 5:
 *                response of cones and rods, appearance between reference white
 *                (5 times the level) and black (a 32nd of that), and the inverse
 *                for an eye used to a display's 25 cd/m^2; colours fade as rods
 *                take over
 *
 * E is the exposure, L the radiance; the last two take luminance, 683 E L of the
 * bands' weighted sum (base/photometry.h). What is finite stays finite, brighter is
 * never darker on a display (of 1 and above all is its white), and nothing is clamped
 * above 1.
 *
 * Pure; any thread. In double here; shaders/tone.frag is the same in float.
 */
#ifndef GROTTO_RENDERER_TONE_CURVE_H
#define GROTTO_RENDERER_TONE_CURVE_H

#include "config/scene_file.h"
#include "renderer/tone/adapt.h"

#include <stdbool.h>

/* How a frame is to be shown; the same on all walls. */
struct tone_look {
	enum scene_curve curve;
	double exposure;          /* above 0 */
	struct adapt_state eye;   /* drago takes the cones' level, pattanaik all */
	double luminance_max;     /* drago: what becomes white, cd/m^2, above 0 */
	double bias;              /* drago: 0.5..0.9, the larger the darker the middle; 0.85 */
};

/* Above 0 and finite, the bias and the pigments within their ranges. */
bool tone_look_valid(const struct tone_look *look);
/* As a scene file says, the eye used to its `adaptation`. */
struct tone_look tone_look_of_scene(const struct scene_tone *tone);

/*
 * What all pixels of a frame have in common, as the shader's uniforms take it.
 *     drago:     a: 683/level, 683/max, ln(bias)/ln(1/2), 1/log10(max/level + 1)
 *     pattanaik: a: (683/sigma)^n of cones and rods, pigment of cones and rods;
 *                b: slope and shift of the appearance, n over the display's
 *                saturation, the display's sigma over its white
 */
struct tone_factors {
	enum scene_curve curve;
	double exposure;
	double a[4], b[4];
};
/* For the log. */
const char *tone_curve_name(enum scene_curve curve);
void tone_factors(const struct tone_look *look, struct tone_factors *out);
/* Radiance, finite, per band; below 0 counts as 0. */
void tone_curve(const struct tone_factors *factors, const double radiance[3], double out[3]);

#endif
