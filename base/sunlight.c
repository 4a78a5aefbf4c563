#include "base/sunlight.h"

#include "base/photometry.h"

#include <math.h>

#define PI 3.14159265358979323846
#define FIRST_NM 380
#define STEP_NM 10
#define STEPS 38

/* Radiance of the disc, 100 W/(m^2 nm sr): Preetham 1999, table 2. */
static const double disc[STEPS] = {
	165.5, 162.3, 211.2, 258.8, 258.2, 242.3, 267.6, 296.6, 305.4, 300.6, 306.6, 288.3, 287.1,
	278.2, 271.0, 272.3, 263.6, 255.0, 250.6, 253.1, 253.5, 251.3, 246.3, 241.7, 236.8, 232.1,
	228.2, 223.4, 219.7, 215.3, 211.0, 207.3, 202.4, 198.7, 194.3, 190.7, 186.3, 182.6,
};

/* Absorption of ozone, 1/cm, and of water vapour, the same table. */
static const double ozone[STEPS] = {
	0, 0, 0, 0, 0, 0, 0, 0.003, 0.006, 0.009, 0.014, 0.021, 0.030, 0.040, 0.048, 0.063, 0.075,
	0.085, 0.103, 0.120, 0.120, 0.115, 0.125, 0.120, 0.105, 0.090, 0.079, 0.067, 0.057, 0.048,
	0.036, 0.028, 0.023, 0.018, 0.014, 0.011, 0.010, 0.009,
};
static const double water[STEPS] = {
	[31] = 0.016, [32] = 0.024, [33] = 0.0125, [34] = 1.0, [35] = 0.87, [36] = 0.061, [37] = 0.001,
};

/* Colour matching functions of the CIE 1931 standard observer. */
static const double observer[3][STEPS] = {
	{ 0.001368, 0.004243, 0.01431, 0.04351, 0.13438, 0.2839, 0.34828, 0.3362, 0.2908, 0.19536,
	  0.09564, 0.03201, 0.0049, 0.0093, 0.06327, 0.1655, 0.2904, 0.43345, 0.5945, 0.7621, 0.9163,
	  1.0263, 1.0622, 1.0026, 0.85445, 0.6424, 0.4479, 0.2835, 0.1649, 0.0874, 0.04677, 0.0227,
	  0.011359, 0.00579, 0.002899, 0.00144, 0.00069, 0.000332 },
	{ 0.000039, 0.00012, 0.000396, 0.00121, 0.004, 0.0116, 0.023, 0.038, 0.06, 0.09098, 0.13902,
	  0.20802, 0.323, 0.503, 0.71, 0.862, 0.954, 0.99495, 0.995, 0.952, 0.87, 0.757, 0.631, 0.503,
	  0.381, 0.265, 0.175, 0.107, 0.061, 0.032, 0.017, 0.00821, 0.004102, 0.002091, 0.001047,
	  0.00052, 0.000249, 0.00012 },
	{ 0.00645, 0.02005, 0.06785, 0.2074, 0.6456, 1.3856, 1.74706, 1.77211, 1.6692, 1.28764, 0.81295,
	  0.46518, 0.272, 0.1582, 0.07825, 0.04216, 0.0203, 0.00875, 0.0039, 0.0021, 0.00165, 0.0011,
	  0.0008, 0.00034, 0.00019, 0.00005, 0.00002 },
};

/* What a band of the spectrum keeps on its way through that many atmospheres. */
static double transmittance(int step, double turbidity, double mass)
{
	const double micron = (FIRST_NM + STEP_NM * step) / 1000.0;
	const double beta = 0.04608 * turbidity - 0.04586;
	const double vapour = water[step] * 2 * mass;
	const double optical = 0.008735 * pow(micron, -4.08) * mass + beta * pow(micron, -1.3) * mass +
			       ozone[step] * 0.35 * mass +
			       0.2385 * vapour / pow(1 + 20.07 * vapour, 0.45);

	return exp(-optical);
}

static void integrate(double turbidity, double mass, double rgb[3])
{
	/* solid angle of the disc, and its table's unit */
	const double scale = 2 * PI * (1 - cos(SUNLIGHT_ANGLE / 2)) * 100 * STEP_NM;
	double xyz[3] = { 0, 0, 0 };

	for (int i = 0; i < STEPS; i++) {
		double irradiance = disc[i] * scale * (mass > 0 ? transmittance(i, turbidity, mass) : 1);

		for (int c = 0; c < 3; c++)
			xyz[c] += GR_LUMENS_PER_WATT * observer[c][i] * irradiance;
	}
	sunlight_from_xyz(xyz, rgb);
}

void sunlight_irradiance(double turbidity, double elevation, double rgb[3])
{
	const double deg = elevation * 180 / PI;

	if (!(deg > 0)) {
		rgb[0] = rgb[1] = rgb[2] = 0;
		return;
	}
	/* relative optical mass: Kasten 1966, as the paper has it */
	integrate(turbidity, 1 / (sin(elevation) + 0.15 * pow(3.885 + deg, -1.253)), rgb);
}

void sunlight_outside(double rgb[3])
{
	integrate(1, 0, rgb);
}

void sunlight_from_xyz(const double xyz[3], double rgb[3])
{
	/* Rec. ITU-R BT.709 primaries, D65. */
	static const double matrix[3][3] = {
		{ 3.2404542, -1.5371385, -0.4985314 },
		{ -0.9692660, 1.8760108, 0.0415560 },
		{ 0.0556434, -0.2040259, 1.0572252 },
	};

	for (int i = 0; i < 3; i++) {
		double value = matrix[i][0] * xyz[0] + matrix[i][1] * xyz[1] + matrix[i][2] * xyz[2];

		rgb[i] = value > 0 ? value / GR_LUMENS_PER_WATT : 0;
	}
}
