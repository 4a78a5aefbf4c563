#include "tools/bench/picture.h"

#include "base/result.h"
#include "renderer/image/compare.h"
#include "renderer/tone/srgb.h"

#include <math.h>
#include <stdlib.h>

int bench_picture_show(const struct image *picture, const struct scene_tone *tone, struct image *out)
{
	size_t count = (size_t)picture->width * (size_t)picture->height * (size_t)picture->channels;
	int result = image_create(out, picture->width, picture->height, picture->channels);

	for (size_t i = 0; i < count && result == GR_OK; i++) {
		double v = fmax(0, (double)(picture->data[i] * tone->exposure));

		if (tone->curve == SCENE_CURVE_REINHARD)
			v = v / (1 + v);
		out->data[i] = (float)srgb_encode(fmin(v, 1));
	}
	return result;
}

static int compare_blocks(const struct image *found, const struct image *truth,
			  struct stats_error *out)
{
	struct image f = { 0 }, t = { 0 };
	double *true_values = NULL, *scratch = NULL;
	int result = compare_block_means(found, NULL, BENCH_BLOCK, &f);

	if (result == GR_OK)
		result = compare_block_means(truth, NULL, BENCH_BLOCK, &t);
	if (result == GR_OK) {
		size_t count = (size_t)t.width * (size_t)t.height;

		true_values = calloc(count, 3 * sizeof *true_values);
		scratch = calloc(count, sizeof *scratch);
		result = true_values && scratch ? GR_OK : GR_ERR_NOMEM;
		for (size_t i = 0; result == GR_OK && i < 3 * count; i++)
			true_values[i] = (double)t.data[i];
		if (result == GR_OK)
			result = stats_compare(f.data, true_values, NULL, count, 3, scratch, out);
	}
	free(true_values);
	free(scratch);
	image_finish(&f);
	image_finish(&t);
	return result < 0 ? result : GR_OK;
}

static int compare_shown_pictures(const struct image *found, const struct image *truth,
				  const struct scene_tone *tone, struct bench_picture_error *out)
{
	const struct compare_params params = COMPARE_PARAMS;
	struct image f = { 0 }, t = { 0 }, map = { 0 };
	int result = bench_picture_show(found, tone, &f);

	if (result == GR_OK)
		result = bench_picture_show(truth, tone, &t);
	if (result == GR_OK && compare_ssim(&f, &t, NULL, &out->ssim) != GR_OK)
		out->ssim = NAN;
	if (result == GR_OK)
		result = compare_flip(&f, &t, params.pixels_per_degree, &map);
	if (result == GR_OK) {
		size_t count = (size_t)map.width * (size_t)map.height;

		out->flip = 0;
		for (size_t i = 0; i < count; i++)
			out->flip += (double)map.data[i] / (double)count;
	}
	image_finish(&f);
	image_finish(&t);
	image_finish(&map);
	return result;
}

int bench_picture_compare(const struct image *found, const struct image *truth,
			  const struct scene_tone *tone, struct bench_picture_error *out)
{
	int result;

	*out = (struct bench_picture_error){ .ssim = NAN, .flip = NAN };
	if (found->width != truth->width || found->height != truth->height ||
	    found->channels != 3 || truth->channels != 3 || truth->width < BENCH_BLOCK ||
	    truth->height < BENCH_BLOCK)
		return GR_ERR_RANGE;
	result = compare_blocks(found, truth, &out->blocks);
	if (result == GR_OK)
		result = compare_shown_pictures(found, truth, tone, out);
	return result;
}
