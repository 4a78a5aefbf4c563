/* Structural similarity: Wang, Bovik, Sheikh and Simoncelli 2004, K 0.01 and 0.03. */
#include "base/result.h"
#include "renderer/image/compare.h"
#include "renderer/image/convolve.h"

#include <math.h>
#include <stdlib.h>

#define RADIUS 5
#define SIGMA 1.5
#define C1 (0.01 * 0.01)
#define C2 (0.03 * 0.03)

enum { OF_A, OF_B, OF_AA, OF_BB, OF_AB, SPARE, RAW, PLANES };

/* What is not finite is as far from the other as can be: a is 0, b 1. */
static void products(const struct image *a, const struct image *b, size_t i, double out[5])
{
	const float *p = a->data + 3 * i, *q = b->data + 3 * i;
	double x = 0.2126 * (double)p[0] + 0.7152 * (double)p[1] + 0.0722 * (double)p[2];
	double y = 0.2126 * (double)q[0] + 0.7152 * (double)q[1] + 0.0722 * (double)q[2];

	if (!isfinite(x) || !isfinite(y)) {
		x = 0;
		y = 1;
	}
	out[OF_A] = x;
	out[OF_B] = y;
	out[OF_AA] = x * x;
	out[OF_BB] = y * y;
	out[OF_AB] = x * y;
}

static double similarity(float *const planes[PLANES], size_t i)
{
	double a = (double)planes[OF_A][i], b = (double)planes[OF_B][i];
	double aa = (double)planes[OF_AA][i] - a * a, bb = (double)planes[OF_BB][i] - b * b;
	double ab = (double)planes[OF_AB][i] - a * b;

	return (2 * a * b + C1) * (2 * ab + C2) / ((a * a + b * b + C1) * (aa + bb + C2));
}

static double weighted_mean(float *const planes[PLANES], const struct image *size,
			    const float *weights)
{
	double sum = 0, total = 0;

	for (int y = RADIUS; y < size->height - RADIUS; y++) {
		for (int x = RADIUS; x < size->width - RADIUS; x++) {
			size_t i = (size_t)y * (size_t)size->width + (size_t)x;
			double w = weights ? (double)weights[i] : 1;

			sum += w * similarity(planes, i);
			total += w;
		}
	}
	return sum / total;
}

int compare_ssim(const struct image *shown, const struct image *reference, const float *weights,
		 double *out)
{
	size_t count = (size_t)shown->width * (size_t)shown->height;
	float *planes[PLANES], *memory;
	struct kernel kernel;
	double sum = 0;

	if (shown->width < 2 * RADIUS + 1 || shown->height < 2 * RADIUS + 1 ||
	    shown->width != reference->width || shown->height != reference->height ||
	    shown->channels != 3 || reference->channels != 3)
		return GR_ERR_RANGE;
	memory = malloc(PLANES * count * sizeof *memory);
	if (!memory)
		return GR_ERR_NOMEM;
	for (int p = 0; p < PLANES; p++)
		planes[p] = memory + (size_t)p * count;
	kernel_gaussian(&kernel, SIGMA, RADIUS);
	for (int i = 0; i <= 2 * RADIUS; i++)
		sum += kernel.at[i];
	for (int i = 0; i <= 2 * RADIUS; i++)
		kernel.at[i] /= sum;
	for (int p = 0; p < SPARE; p++) {
		for (size_t i = 0; i < count; i++) {
			double all[5];

			products(shown, reference, i, all);
			planes[RAW][i] = (float)all[p];
		}
		convolve(planes[RAW], shown->width, shown->height, &kernel, &kernel, planes[SPARE],
			 planes[p]);
	}
	*out = weighted_mean(planes, shown, weights);
	free(memory);
	return GR_OK;
}
