#include "tools/bench/picture.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double srgb(double v)
{
	return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

void bench_picture_encode(struct image *image, const struct scene_tone *tone)
{
	size_t count = (size_t)image->width * (size_t)image->height * (size_t)image->channels;
	double gamma = (double)scene_tone_gamma_encode(tone);

	for (size_t i = 0; i < count; i++) {
		double v = fmax(0, (double)(image->data[i] * tone->exposure));

		if (tone->curve == SCENE_CURVE_REINHARD)
			v = v / (1 + v);
		v = fmin(v, 1);
		image->data[i] = (float)(tone->srgb ? srgb(v) : pow(v, gamma));
	}
}

/* Means of blocks: 3 values each. Returns how many blocks. */
static size_t block_means(const struct image *image, double *out)
{
	size_t across = (size_t)image->width / BENCH_BLOCK, down = (size_t)image->height / BENCH_BLOCK;

	for (size_t b = 0; b < across * down; b++) {
		const float *first = image->data + 3 * BENCH_BLOCK * (b / across * (size_t)image->width +
								      b % across);

		memset(out + 3 * b, 0, 3 * sizeof *out);
		for (size_t k = 0; k < BENCH_BLOCK * BENCH_BLOCK; k++)
			for (size_t c = 0; c < 3; c++)
				out[3 * b + c] += (double)first[3 * (k / BENCH_BLOCK * (size_t)image->width +
								     k % BENCH_BLOCK) + c] /
						  (BENCH_BLOCK * BENCH_BLOCK);
	}
	return across * down;
}

int bench_picture_compare(const struct image *found, const struct image *truth,
			  const struct scene_tone *tone, struct bench_picture_error *out)
{
	size_t most = (size_t)(truth->width / BENCH_BLOCK) * (size_t)(truth->height / BENCH_BLOCK);
	double *blocks = NULL, *scratch = NULL;
	float *means = NULL;
	int result = GR_ERR_NOMEM;

	*out = (struct bench_picture_error){ .ssim = NAN, .flip = NAN };
	if (found->width != truth->width || found->height != truth->height ||
	    found->channels != 3 || truth->channels != 3 || !most)
		return GR_ERR_RANGE;
	blocks = calloc(most, 6 * sizeof *blocks);
	scratch = calloc(most, sizeof *scratch);
	means = calloc(most, 3 * sizeof *means);
	if (blocks && scratch && means) {
		size_t count = block_means(found, blocks + 3 * most);

		for (size_t i = 0; i < 3 * count; i++)
			means[i] = (float)blocks[3 * most + i];
		block_means(truth, blocks);
		result = stats_compare(means, blocks, NULL, count, 3, scratch, &out->blocks);
	}
	free(blocks);
	free(scratch);
	free(means);
	(void)tone;
	return result < 0 ? result : GR_OK;
}
