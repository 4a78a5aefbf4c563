#include "renderer/image/compare.h"

#include "base/result.h"
#include "renderer/tone/srgb.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* One value's relative error and what it weighs. */
struct share {
	double error, weight;
};

static size_t pixels(const struct image *image)
{
	return (size_t)image->width * (size_t)image->height;
}

static bool is_finite(const struct image *image, size_t pixel)
{
	const float *p = image->data + 3 * pixel;

	return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

static double weight_of(const struct image *picture, const struct image *reference,
			const float *weights, size_t pixel)
{
	if (!is_finite(picture, pixel) || !is_finite(reference, pixel))
		return 0;
	return weights ? (double)weights[pixel] : 1;
}

/* Sums over all pixels; band means of the reference for the relative figures. */
static void compare_all(const struct image *picture, const struct image *reference,
			const float *weights, struct compare_figures *out, double band[3])
{
	double sum[3] = { 0 }, of_reference[3] = { 0 }, squares = 0, total = 0;

	for (size_t i = 0; i < pixels(picture); i++) {
		double w = weight_of(picture, reference, weights, i);

		out->nonfinite += !is_finite(picture, i) || !is_finite(reference, i);
		if (!(w > 0))
			continue;
		total += w;
		for (size_t c = 0; c < 3; c++) {
			double a = (double)picture->data[3 * i + c];
			double b = (double)reference->data[3 * i + c];

			sum[c] += w * a;
			of_reference[c] += w * b;
			squares += w * (a - b) * (a - b);
		}
	}
	for (int c = 0; c < 3; c++) {
		band[c] = total > 0 ? of_reference[c] / total : NAN;
		out->mean += sum[c] / (3 * total);
		out->reference_mean += of_reference[c] / (3 * total);
	}
	out->bias = out->mean / out->reference_mean - 1;
	out->nrmse = sqrt(squares / (3 * total)) / out->reference_mean;
}

static int by_error(const void *a, const void *b)
{
	double x = ((const struct share *)a)->error, y = ((const struct share *)b)->error;

	return (x > y) - (x < y);
}

static double percentile(struct share *shares, size_t count, double part)
{
	double total = 0, sum = 0;

	qsort(shares, count, sizeof *shares, by_error);
	for (size_t i = 0; i < count; i++)
		total += shares[i].weight;
	for (size_t i = 0; i < count; i++) {
		sum += shares[i].weight;
		if (sum >= part * total)
			return shares[i].error;
	}
	return NAN;
}

/* Relative errors of what is bright enough; returns their number. */
static size_t relative_errors(const struct image *picture, const struct image *reference,
			      const float *weights, const double band[3], double least,
			      struct share *out)
{
	size_t count = 0;

	for (size_t i = 0; i < pixels(picture); i++) {
		double w = weight_of(picture, reference, weights, i);

		for (size_t c = 0; c < 3 && w > 0; c++) {
			double a = (double)picture->data[3 * i + c];
			double b = (double)reference->data[3 * i + c];

			if (b > least * band[c] && b > 0)
				out[count++] = (struct share){ fabs(a - b) / b, w };
		}
	}
	return count;
}

int compare_block_means(const struct image *picture, const float *weights, int block,
			struct image *out)
{
	int result;

	memset(out, 0, sizeof *out);
	if (block < 1 || picture->channels != 3)
		return GR_ERR_RANGE;
	result = image_create(out, picture->width / block, picture->height / block, 3);
	if (result != GR_OK)
		return result;
	for (int y = 0; y < out->height; y++) {
		for (int x = 0; x < out->width; x++) {
			double sum[3] = { 0 }, total = 0;

			for (int k = 0; k < block * block; k++) {
				size_t i = (size_t)(y * block + k / block) * (size_t)picture->width +
					   (size_t)(x * block + k % block);
				double w = weights ? (double)weights[i] : 1;

				total += w;
				for (size_t c = 0; c < 3 && w > 0; c++)
					sum[c] += w * (double)picture->data[3 * i + c];
			}
			for (int c = 0; c < 3; c++)
				out->data[3 * (y * out->width + x) + c] =
					total > 0 ? (float)(sum[c] / total) : NAN;
		}
	}
	return GR_OK;
}

/* Pixels that are not finite in either weigh nothing in both. */
static int compare_blocks(const struct image *picture, const struct image *reference,
			  const struct compare_params *params, const double band[3],
			  struct compare_figures *out)
{
	float *weights = malloc(pixels(picture) * sizeof *weights);
	struct image a = { 0 }, b = { 0 };
	double sum = 0;
	int result = weights ? GR_OK : GR_ERR_NOMEM;

	for (size_t i = 0; weights && i < pixels(picture); i++)
		weights[i] = (float)weight_of(picture, reference, params->weights, i);
	if (result == GR_OK)
		result = compare_block_means(picture, weights, params->block, &a);
	if (result == GR_OK)
		result = compare_block_means(reference, weights, params->block, &b);
	for (size_t i = 0; result == GR_OK && i < 3 * pixels(&a); i++) {
		double of_b = (double)b.data[i];

		/* NaN, where nothing in the block counts, is no number above another */
		if (!(of_b > params->least * band[i % 3]) || !(of_b > 0))
			continue;
		sum += fabs((double)a.data[i] - of_b) / of_b;
		out->blocks++;
	}
	out->block_error = out->blocks ? sum / (double)out->blocks : NAN;
	image_finish(&a);
	image_finish(&b);
	free(weights);
	/* A picture smaller than a block has none. */
	return result == GR_ERR_RANGE ? GR_OK : result;
}

int compare_shown(const struct image *picture, double exposure, struct image *out)
{
	int result = image_create(out, picture->width, picture->height, picture->channels);

	if (result != GR_OK)
		return result;
	for (size_t i = 0; i < pixels(picture) * (size_t)picture->channels; i++) {
		double v = (double)picture->data[i] * exposure;

		if (isfinite(v))
			v = srgb_encode(v < 0 ? 0 : v > 1 ? 1 : v);
		out->data[i] = (float)v;
	}
	return GR_OK;
}

static int compare_as_shown(const struct image *picture, const struct image *reference,
			    const struct compare_params *params, struct compare_figures *out)
{
	struct image a = { 0 }, b = { 0 }, map = { 0 };
	double sum = 0, total = 0;
	int result = compare_shown(picture, params->exposure, &a);

	if (result == GR_OK)
		result = compare_shown(reference, params->exposure, &b);
	if (result == GR_OK)
		result = compare_flip(&a, &b, params->pixels_per_degree, &map);
	for (size_t i = 0; result == GR_OK && i < pixels(&map); i++) {
		double w = params->weights ? (double)params->weights[i] : 1;

		sum += w * (double)map.data[i];
		total += w;
	}
	out->flip = sum / total;
	out->ssim = NAN;
	if (result == GR_OK && picture->width >= 11 && picture->height >= 11)
		result = compare_ssim(&a, &b, params->weights, &out->ssim);
	image_finish(&a);
	image_finish(&b);
	image_finish(&map);
	return result;
}

int compare_images(const struct image *picture, const struct image *reference,
		   const struct compare_params *params, struct compare_figures *out)
{
	struct share *shares;
	double band[3];
	size_t count;
	int result;

	memset(out, 0, sizeof *out);
	if (picture->channels != 3 || reference->channels != 3 ||
	    picture->width != reference->width || picture->height != reference->height)
		return GR_ERR_RANGE;
	shares = malloc(3 * pixels(picture) * sizeof *shares);
	if (!shares)
		return GR_ERR_NOMEM;
	compare_all(picture, reference, params->weights, out, band);
	count = relative_errors(picture, reference, params->weights, band, params->least, shares);
	out->p95 = percentile(shares, count, 0.95);
	free(shares);
	result = compare_blocks(picture, reference, params, band, out);
	return result == GR_OK ? compare_as_shown(picture, reference, params, out) : result;
}
