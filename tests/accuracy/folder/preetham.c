#include "tests/accuracy/folder/preetham.h"

#include <math.h>

#define BLENDER_PER_KCD 0.06
/* Towards the horizon the distribution has a pole. */
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

static double perez(int what, double turbidity, double theta, double gamma)
{
	double k[5];

	for (int i = 0; i < 5; i++)
		k[i] = distribution[what][i][0] * turbidity + distribution[what][i][1];
	return (1 + k[0] * exp(k[1] / cos(theta))) *
	       (1 + k[2] * exp(k[3] * gamma) + k[4] * cos(gamma) * cos(gamma));
}

/* kcd/m^2, and chromaticities. */
static double zenith(int what, double turbidity, double theta)
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

static double angle(double cosine)
{
	return acos(cosine < -1 ? -1 : cosine > 1 ? 1 : cosine);
}

void preetham_radiance(double turbidity, const double sun[3], const double direction[3],
		       double rgb[3])
{
	static const double to_rgb[3][3] = {
		{ 3.2404542, -1.5371385, -0.4985314 },
		{ -0.9692660, 1.8760108, 0.0415560 },
		{ 0.0556434, -0.2040259, 1.0572252 },
	};
	double theta = fmin(angle(direction[1]), MOST_THETA), of_sun = angle(sun[1]);
	double gamma = angle(sun[0] * direction[0] + sun[1] * direction[1] + sun[2] * direction[2]);
	double v[3], xyz[3];

	for (int what = 0; what < 3; what++)
		v[what] = zenith(what, turbidity, of_sun) * perez(what, turbidity, theta, gamma) /
			  perez(what, turbidity, 0, of_sun);
	v[LUMINANCE] *= BLENDER_PER_KCD;
	xyz[0] = v[CHROMA_X] / v[CHROMA_Y] * v[LUMINANCE];
	xyz[1] = v[LUMINANCE];
	xyz[2] = (1 - v[CHROMA_X] - v[CHROMA_Y]) / v[CHROMA_Y] * v[LUMINANCE];
	for (int i = 0; i < 3; i++)
		rgb[i] = to_rgb[i][0] * xyz[0] + to_rgb[i][1] * xyz[1] + to_rgb[i][2] * xyz[2];
}

int preetham_picture(struct image *out, int width, int height, double turbidity,
		     const double sun[3])
{
	int result = image_create(out, width, height, 3);

	for (int y = 0; y < height && result == 0; y++) {
		/* below the horizon: the direction on it */
		double v = fmin((y + 0.5) / height, 0.5);

		for (int x = 0; x < width; x++) {
			double p = 2 * M_PI * ((x + 0.5) / width - 0.5), rgb[3];
			const double d[3] = { sin(M_PI * v) * cos(p), cos(M_PI * v),
					      sin(M_PI * v) * sin(p) };

			preetham_radiance(turbidity, sun, d, rgb);
			for (int c = 0; c < 3; c++)
				out->data[3 * (y * width + x) + c] = (float)rgb[c];
		}
	}
	return result;
}
