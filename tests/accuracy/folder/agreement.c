#include "tests/accuracy/folder/agreement.h"

#include "base/result.h"

#include <math.h>
#include <string.h>

#define LEAST 0.01 /* of the band's mean: what is darker says nothing relative to itself */

/* Means of variances over blocks: over a block's pixels that is the variance of its mean. */
static int variance_blocks(const struct image *error, const struct image *like, int block,
			   struct image *out)
{
	struct image squares;
	int result = image_create(&squares, like->width, like->height, 3);

	if (result != GR_OK)
		return result;
	for (size_t i = 0; error->data && i < 3 * (size_t)like->width * (size_t)like->height; i++)
		squares.data[i] = error->data[i] * error->data[i];
	result = compare_block_means(&squares, NULL, block, out);
	image_finish(&squares);
	return result;
}

static double variance_at(const struct image *error, size_t i)
{
	return error->data ? (double)error->data[i] * (double)error->data[i] : 0;
}

static void agree_pixels(const struct image *ours, const struct image *error,
			 const struct image *theirs, const struct image *their_error,
			 struct agreement *out)
{
	size_t count = 3 * (size_t)ours->width * (size_t)ours->height, within = 0, judged = 0;
	double variance = 0, sum = 0;

	for (size_t i = 0; i < count; i++) {
		double v = variance_at(error, i) + variance_at(their_error, i);
		double d = (double)ours->data[i] - (double)theirs->data[i];

		variance += v;
		sum += (double)theirs->data[i];
		if (!(v > 0))
			continue;
		judged++;
		within += fabs(d) <= 3 * sqrt(v);
	}
	out->ratio_error = sqrt(variance) / sum;
	out->within_pixels = judged ? (double)within / (double)judged : NAN;
}

struct blocks {
	int side;
	struct image ours, theirs, variance, their_variance;
};

static void agree_blocks(const struct blocks *b, const double band[3], struct agreement *out)
{
	size_t count = 3 * (size_t)b->ours.width * (size_t)b->ours.height, used = 0, judged = 0,
	       within = 0;
	const double mean_of_normal = sqrt(2 / M_PI); /* E|x| of a standard normal x */

	for (size_t i = 0; i < count; i++) {
		double of = (double)b->theirs.data[i], d = fabs((double)b->ours.data[i] - of);
		double theirs = (double)b->their_variance.data[i] / (b->side * b->side);
		double v = (double)b->variance.data[i] / (b->side * b->side) + theirs;

		if (!(of > LEAST * band[i % 3]))
			continue;
		used++;
		out->blocks += d / of;
		out->noise += mean_of_normal * sqrt(v) / of;
		out->their_noise += mean_of_normal * sqrt(theirs) / of;
		if (v > 0) {
			judged++;
			within += d <= 3 * sqrt(v);
			out->chi2 += d * d / v;
		}
	}
	out->blocks /= (double)used;
	out->noise /= (double)used;
	out->their_noise /= (double)used;
	out->within_blocks = judged ? (double)within / (double)judged : NAN;
	out->chi2 = judged ? out->chi2 / (double)judged : NAN;
}

int agreement_of(const struct image *ours, const struct image *error, const struct image *theirs,
		 const struct image *their_error, int block, struct agreement *out)
{
	const struct compare_params params = COMPARE_PARAMS;
	struct compare_figures figures;
	struct blocks b = { .side = block };
	double band[3] = { 0 };
	int result = compare_images(ours, theirs, &params, &figures);

	memset(out, 0, sizeof *out);
	if (result != GR_OK)
		return result;
	out->ratio = figures.mean / figures.reference_mean;
	out->nrmse = figures.nrmse;
	out->nonfinite = figures.nonfinite;
	agree_pixels(ours, error, theirs, their_error, out);
	result = compare_block_means(ours, NULL, block, &b.ours);
	if (result == GR_OK)
		result = compare_block_means(theirs, NULL, block, &b.theirs);
	if (result == GR_OK)
		result = variance_blocks(error, ours, block, &b.variance);
	if (result == GR_OK)
		result = variance_blocks(their_error, ours, block, &b.their_variance);
	if (result == GR_OK) {
		size_t count = (size_t)b.theirs.width * (size_t)b.theirs.height;

		for (size_t i = 0; i < 3 * count; i++)
			band[i % 3] += (double)b.theirs.data[i] / (double)count;
		agree_blocks(&b, band, out);
	}
	image_finish(&b.ours);
	image_finish(&b.theirs);
	image_finish(&b.variance);
	image_finish(&b.their_variance);
	return result;
}

int agreement_coarse_error(const struct image *error, int side, struct image *out)
{
	int result = variance_blocks(error, error, side, out);

	for (size_t i = 0; result == GR_OK && i < 3 * (size_t)out->width * (size_t)out->height; i++)
		out->data[i] = sqrtf(out->data[i]) / (float)side;
	return result;
}
