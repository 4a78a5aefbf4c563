#include "base/result.h"
#include "renderer/scene/brdf_read.h"

#include <math.h>

/* CIE D65 every 10 nm from 380 to 730 (CIE 15). */
#define D65_FIRST 380
#define D65_STEP 10
static const double d65[] = {
	49.9755, 54.6482, 82.7549, 91.486,	93.4318, 86.6823, 104.865, 117.008, 117.812,
	114.861, 115.923, 108.811, 109.354, 107.802, 104.79,  107.689, 104.405, 104.046,
	100.0,	 96.3342, 95.788,  88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992,
	80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349,  61.604,	69.8856,
};
#define D65_COUNT (sizeof d65 / sizeof d65[0])

static double d65_at(double nm)
{
	double at = (nm - D65_FIRST) / D65_STEP;
	size_t i;

	if (at <= 0)
		return d65[0];
	if (at >= D65_COUNT - 1)
		return d65[D65_COUNT - 1];
	i = (size_t)at;
	return d65[i] + (at - (double)i) * (d65[i + 1] - d65[i]);
}

static double lobe(double nm, double height, double middle, double below, double above)
{
	double t = (nm - middle) * (nm < middle ? below : above);

	return height * exp(-0.5 * t * t);
}

/* Wyman, Sloan, Shirley 2013, listing 1. */
static void observer(double nm, double xyz[3])
{
	xyz[0] = lobe(nm, 0.362, 442.0, 0.0624, 0.0374) + lobe(nm, 1.056, 599.8, 0.0264, 0.0323) +
		 lobe(nm, -0.065, 501.1, 0.0490, 0.0382);
	xyz[1] = lobe(nm, 0.821, 568.8, 0.0213, 0.0247) + lobe(nm, 0.286, 530.9, 0.0613, 0.0322);
	xyz[2] = lobe(nm, 1.217, 437.0, 0.0845, 0.0278) + lobe(nm, 0.681, 459.0, 0.0385, 0.0725);
}

/* Half the way to both neighbours. */
static double width_of(const double *nm, size_t count, size_t i)
{
	double low = i > 0 ? nm[i - 1] : nm[i];
	double high = i + 1 < count ? nm[i + 1] : nm[i];

	return count > 1 ? (high - low) / 2 : 1;
}

int brdf_color_weights(const double *nm, size_t count, double (*out)[3])
{
	/* XYZ to linear Rec.709 (ITU-R BT.709-6, D65). */
	static const double rgb[3][3] = {
		{ 3.2404542, -1.5371385, -0.4985314 },
		{ -0.9692660, 1.8760108, 0.0415560 },
		{ 0.0556434, -0.2040259, 1.0572252 },
	};
	double sum[3] = { 0 };

	for (size_t i = 0; i < count; i++) {
		double light = d65_at(nm[i]) * width_of(nm, count, i), xyz[3];

		observer(nm[i], xyz);
		for (int c = 0; c < 3; c++) {
			out[i][c] = light * (rgb[c][0] * xyz[0] + rgb[c][1] * xyz[1] + rgb[c][2] * xyz[2]);
			sum[c] += out[i][c];
		}
	}
	for (int c = 0; c < 3; c++) {
		if (!(sum[c] > 1))
			return GR_ERR_RANGE;
		for (size_t i = 0; i < count; i++)
			out[i][c] /= sum[c];
	}
	return GR_OK;
}
