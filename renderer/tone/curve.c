#include "renderer/tone/curve.h"

#include "base/photometry.h"

#include <math.h>
#include <string.h>

/* Pattanaik 2000: the receptors' exponent; of the display the level of who looks at it. */
#define EXPONENT 0.73
#define DISPLAY_LEVEL 25.0
/* Of a level: what looks white, and what black. */
#define WHITE 5.0
#define BLACK (5.0 / 32)
/* Brighter than this many times its white the display's inverse is not followed. */
#define DISPLAY_MOST 1e4

static bool above_0(double value)
{
	return value > 0 && isfinite(value);
}

static bool share_valid(double share)
{
	return share >= 0 && share <= 1;
}

bool tone_look_valid(const struct tone_look *look)
{
	return above_0(look->exposure) && above_0(look->eye.cone) && above_0(look->eye.rod) &&
	       share_valid(look->eye.cone_pigment) && share_valid(look->eye.rod_pigment) &&
	       above_0(look->eye.cone_pigment + look->eye.rod_pigment) &&
	       above_0(look->luminance_max) && look->bias > 0 && look->bias < 1;
}

struct tone_look tone_look_of_scene(const struct scene_tone *tone)
{
	struct tone_look look = {
		.curve = tone->curve,
		.exposure = (double)tone->exposure,
		.luminance_max = (double)tone->luminance_max,
		.bias = (double)tone->bias,
	};

	adapt_settle(&look.eye, (double)tone->adaptation);
	return look;
}

const char *tone_curve_name(enum scene_curve curve)
{
	static const char *const names[SCENE_CURVES] = { "linear", "L/(1+L)", "Drago 2003",
							 "Pattanaik 2000" };

	return (unsigned)curve < SCENE_CURVES ? names[curve] : "unknown";
}

/* Luminance of half the largest response: sections 4.1 and 4.2, after Hunt. */
static double cone_sigma(double level)
{
	double k4 = pow(1 / (5 * level + 1), 4);

	return 12.9223 * level / (k4 * level + 0.171 * pow(1 - k4, 2) * cbrt(level));
}

static double rod_sigma(double level)
{
	double j2 = pow(1 / (5e5 * level + 1), 2);

	return 2.5874 * level / (19000 * j2 * level + 0.2615 * pow(1 - j2, 4) * pow(level, 1.0 / 6));
}

static double response(double luminance, double sigma)
{
	double x = pow(luminance / sigma, EXPONENT);

	return x / (1 + x);
}

/* Of cones and rods together, at that share of each one's level. */
static double scene_response(const struct adapt_state *eye, double share)
{
	return eye->cone_pigment * response(share * eye->cone, cone_sigma(eye->cone)) +
	       eye->rod_pigment * response(share * eye->rod, rod_sigma(eye->rod));
}

static void drago_factors(const struct tone_look *look, double a[4])
{
	a[0] = GR_LUMENS_PER_WATT / look->eye.cone;
	a[1] = GR_LUMENS_PER_WATT / look->luminance_max;
	a[2] = log(look->bias) / log(0.5);
	a[3] = log(10) / log1p(look->luminance_max / look->eye.cone);
}

static void pattanaik_factors(const struct tone_look *look, double a[4], double b[4])
{
	const struct adapt_state *eye = &look->eye;
	const double sigma = cone_sigma(DISPLAY_LEVEL);
	const double white = response(WHITE * DISPLAY_LEVEL, sigma);
	const double black = response(BLACK * DISPLAY_LEVEL, sigma);
	const double scene_white = scene_response(eye, WHITE), scene_black = scene_response(eye, BLACK);
	const double slope = fmin((white - black) / (scene_white - scene_black), 1);

	a[0] = pow(GR_LUMENS_PER_WATT / cone_sigma(eye->cone), EXPONENT);
	a[1] = pow(GR_LUMENS_PER_WATT / rod_sigma(eye->rod), EXPONENT);
	a[2] = eye->cone_pigment;
	a[3] = eye->rod_pigment;
	/* Section 5: white onto white where the scene's is above the display's, else black onto black. */
	b[0] = 1;
	b[1] = 0;
	if (scene_white > white) {
		b[0] = slope;
		b[1] = white - slope * scene_white;
	} else if (scene_black < black) {
		b[0] = slope;
		b[1] = black - slope * scene_black;
	}
	b[2] = EXPONENT * log10(WHITE / BLACK) / (white - black);
	b[3] = sigma / (WHITE * DISPLAY_LEVEL);
}

void tone_factors(const struct tone_look *look, struct tone_factors *out)
{
	memset(out, 0, sizeof *out);
	out->curve = look->curve;
	out->exposure = look->exposure;
	if (look->curve == SCENE_CURVE_DRAGO)
		drago_factors(look, out->a);
	else if (look->curve == SCENE_CURVE_PATTANAIK)
		pattanaik_factors(look, out->a, out->b);
}

static double drago(const double a[4], double grey)
{
	/* Equation 4 falls beyond the maximum, and the sooner the larger that is. */
	const double within = fmin(1, 1 / (grey * a[1]));
	const double x = within * grey * a[0];
	const double slope = x > 0 ? log1p(x) / x : 1;

	return within * slope * a[0] * a[3] / log(2 + 8 * pow(within * grey * a[1], a[2]));
}

static void pattanaik(const double a[4], const double b[4], double grey, double l[3])
{
	const double most = 1 / (1 + pow(b[3] / DISPLAY_MOST, EXPONENT));
	const double x = pow(grey, EXPONENT);
	/* Responses over x, so that their shares are there in the dark, too. */
	const double cone = a[2] * a[0] / (1 + x * a[0]), rod = a[3] * a[1] / (1 + x * a[1]);
	const double saturation = fmax(b[2] * cone * x / (1 + x * a[0]), 1e-6);
	const double seen = fmin(fmax((cone + rod) * x * b[0] + b[1], 0), most);
	const double shown = b[3] * pow(seen / (1 - seen), 1 / EXPONENT);
	const double share = cone / (cone + rod);

	for (int c = 0; c < 3; c++) {
		double colour = grey > 0 ? pow(l[c] / grey, saturation) : 1;

		l[c] = shown * (share * colour + 1 - share);
	}
}

void tone_curve(const struct tone_factors *factors, const double radiance[3], double out[3])
{
	double grey, scale;

	for (int c = 0; c < 3; c++)
		out[c] = fmax(radiance[c] * factors->exposure, 0);
	grey = gr_grey(out);
	switch (factors->curve) {
	case SCENE_CURVE_LINEAR:
		return;
	case SCENE_CURVE_REINHARD:
		for (int c = 0; c < 3; c++)
			out[c] /= 1 + out[c];
		return;
	case SCENE_CURVE_DRAGO:
		scale = drago(factors->a, grey);
		for (int c = 0; c < 3; c++)
			out[c] *= scale;
		return;
	case SCENE_CURVE_PATTANAIK:
		pattanaik(factors->a, factors->b, grey, out);
		return;
	}
}
