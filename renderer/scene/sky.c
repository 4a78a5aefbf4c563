#include "renderer/scene/sky.h"

#include "base/result.h"
#include "base/sunlight.h"

#include <math.h>
#include <string.h>

/* Towards the horizon the distribution has a pole; this far from it is as near as one can see. */
#define MOST_THETA (M_PI / 2 - 0.001)

enum { LUMINANCE, CHROMA_X, CHROMA_Y };

/* Coefficients A to E of the distribution: of turbidity, and constant. */
static const double distribution[3][5][2] = {
	{ { 0.1787, -1.4630 }, { -0.3554, 0.4275 }, { -0.0227, 5.3251 }, { 0.1206, -2.5771 },
	  { -0.0670, 0.3703 } },
	{ { -0.0193, -0.2592 }, { -0.0665, 0.0008 }, { -0.0004, 0.2125 }, { -0.0641, -0.8989 },
	  { -0.0033, 0.0452 } },
	{ { -0.0167, -0.2608 }, { -0.0950, 0.0092 }, { -0.0079, 0.2102 }, { -0.0441, -1.6537 },
	  { -0.0109, 0.0529 } },
};

/* Chromaticity of the zenith: rows of turbidity^2, turbidity, 1; columns of theta^3 .. 1. */
static const double zenith_chroma[2][3][4] = {
	{ { 0.00166, -0.00375, 0.00209, 0 },
	  { -0.02903, 0.06377, -0.03202, 0.00394 },
	  { 0.11693, -0.21196, 0.06052, 0.25886 } },
	{ { 0.00275, -0.00610, 0.00317, 0 },
	  { -0.04214, 0.08970, -0.04153, 0.00516 },
	  { 0.15346, -0.26756, 0.06670, 0.26688 } },
};

static double perez(const double k[5], double theta, double gamma)
{
	return (1 + k[0] * exp(k[1] / cos(theta))) *
	       (1 + k[2] * exp(k[3] * gamma) + k[4] * cos(gamma) * cos(gamma));
}

/* kcd/m^2, and chromaticities, with the sun at theta from the zenith. */
static double zenith_of(int what, double turbidity, double theta)
{
	double sum = 0;

	if (what == LUMINANCE) {
		double chi = (4.0 / 9 - turbidity / 120) * (M_PI - 2 * theta);

		return (4.0453 * turbidity - 4.9710) * tan(chi) - 0.2155 * turbidity + 2.4192;
	}
	for (int row = 0; row < 3; row++) {
		const double *c = zenith_chroma[what - CHROMA_X][row];

		sum = sum * turbidity + ((c[0] * theta + c[1]) * theta + c[2]) * theta + c[3];
	}
	return sum;
}

static double angle_of(double cosine)
{
	return acos(fmin(fmax(cosine, -1), 1));
}

void sky_init(struct sky *sky, double turbidity, const double to_sun[3])
{
	const double level = hypot(to_sun[0], to_sun[2]);
	double theta;

	memcpy(sky->sun, to_sun, sizeof sky->sun);
	if (sky->sun[1] < 0 && level > 0) {
		sky->sun[0] /= level;
		sky->sun[1] = 0;
		sky->sun[2] /= level;
	}
	theta = fmin(angle_of(sky->sun[1]), M_PI / 2);
	for (int what = 0; what < 3; what++) {
		for (int i = 0; i < 5; i++)
			sky->coefficient[what][i] = distribution[what][i][0] * turbidity +
						    distribution[what][i][1];
		sky->zenith[what] = zenith_of(what, turbidity, theta) /
				    perez(sky->coefficient[what], 0, theta);
	}
	/* The fit of turbid skies at sunset passes 0. */
	sky->zenith[LUMINANCE] = fmax(sky->zenith[LUMINANCE], 0);
}

void sky_radiance(const struct sky *sky, const double direction[3], double rgb[3])
{
	const double *s = sky->sun, *d = direction;
	const double theta = fmin(angle_of(d[1]), MOST_THETA);
	const double gamma = angle_of(s[0] * d[0] + s[1] * d[1] + s[2] * d[2]);
	double v[3], xyz[3];

	for (int what = 0; what < 3; what++)
		v[what] = sky->zenith[what] * perez(sky->coefficient[what], theta, gamma);
	v[LUMINANCE] *= 1000;
	xyz[0] = v[CHROMA_X] / v[CHROMA_Y] * v[LUMINANCE];
	xyz[1] = v[LUMINANCE];
	xyz[2] = (1 - v[CHROMA_X] - v[CHROMA_Y]) / v[CHROMA_Y] * v[LUMINANCE];
	sunlight_from_xyz(xyz, rgb);
}

int sky_picture(const struct sky *sky, int width, int height, struct image *out)
{
	int result = image_create(out, width, height, 3);

	for (int y = 0; y < height && result == GR_OK; y++) {
		const double v = (y + 0.5) / height;

		for (int x = 0; x < width; x++) {
			const double p = 2 * M_PI * ((x + 0.5) / width - 0.5);
			/* below the horizon the direction on it */
			const double r = sin(M_PI * fmin(v, 0.5));
			const double d[3] = { r * cos(p), cos(M_PI * fmin(v, 0.5)), r * sin(p) };
			double rgb[3];

			sky_radiance(sky, d, rgb);
			for (int c = 0; c < 3; c++)
				out->data[3 * ((size_t)y * (size_t)width + (size_t)x) + (size_t)c] =
					(float)rgb[c];
		}
	}
	return result;
}
