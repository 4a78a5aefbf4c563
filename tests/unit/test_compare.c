/* Figures of difference between pictures, where they are known. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/image/compare.h"
#include "tests/unit/shared.h"

#include <math.h>

static void fill(struct image *image, int width, int height, float r, float g, float b)
{
	assert_int_equal(image_create(image, width, height, 3), GR_OK);
	for (int i = 0; i < width * height; i++) {
		image->data[3 * i] = r;
		image->data[3 * i + 1] = g;
		image->data[3 * i + 2] = b;
	}
}

static void scale(struct image *image, float by)
{
	for (int i = 0; i < 3 * image->width * image->height; i++)
		image->data[i] *= by;
}

static void noise(struct image *image, int width, int height, uint64_t seed)
{
	struct unit_random random = { 2 * seed + 1 };

	fill(image, width, height, 0, 0, 0);
	for (int i = 0; i < 3 * width * height; i++)
		image->data[i] = (float)unit_random_range(&random, 0.1, 0.9);
}

/* A common factor shows in all linear figures alike. */
static void linear_figures(void **state)
{
	const struct compare_params params = COMPARE_PARAMS;
	struct compare_figures f;
	struct image a, b;

	(void)state;
	noise(&a, 40, 24, 7);
	noise(&b, 40, 24, 7);
	assert_int_equal(compare_images(&a, &b, &params, &f), GR_OK);
	assert_true(f.bias == 0 && f.nrmse == 0 && f.p95 == 0 && f.block_error == 0);
	assert_true(f.flip == 0 && fabs(f.ssim - 1) < 1e-6);
	assert_int_equal(f.blocks, 5 * 3 * 3);
	scale(&a, 1.1f);
	assert_int_equal(compare_images(&a, &b, &params, &f), GR_OK);
	assert_true(fabs(f.bias - 0.1) < 1e-6 && fabs(f.p95 - 0.1) < 1e-6);
	assert_true(fabs(f.block_error - 0.1) < 1e-6);
	/* uniform 0.1..0.9: the root mean square over the mean is sqrt(0.25 + 0.64/12)/0.5 */
	assert_true(fabs(f.nrmse / (0.1 * sqrt(0.25 + 0.64 / 12) / 0.5) - 1) < 0.02);
	assert_true(f.flip > 0 && f.ssim < 1);
	image_finish(&a);
	image_finish(&b);
}

/* One pixel of 1024 twice as bright: everything but it is known. */
static void one_pixel(void **state)
{
	const struct compare_params params = COMPARE_PARAMS;
	struct compare_params masked = COMPARE_PARAMS;
	float weights[1024];
	struct compare_figures f;
	struct image a, b;

	(void)state;
	fill(&a, 32, 32, 2, 4, 6);
	fill(&b, 32, 32, 2, 4, 6);
	for (int c = 0; c < 3; c++)
		a.data[3 * 100 + c] *= 2;
	assert_int_equal(compare_images(&a, &b, &params, &f), GR_OK);
	assert_true(fabs(f.bias - 1.0 / 1024) < 1e-9 && f.p95 == 0);
	assert_true(fabs(f.nrmse - sqrt((4.0 + 16 + 36) / 3 / 1024) / 4) < 1e-9);
	assert_true(fabs(f.block_error - 1.0 / 64 / 16) < 1e-8);
	for (int i = 0; i < 1024; i++)
		weights[i] = i != 100;
	masked.weights = weights;
	assert_int_equal(compare_images(&a, &b, &masked, &f), GR_OK);
	assert_true(f.bias == 0 && f.nrmse == 0 && f.block_error == 0 && f.nonfinite == 0);
	a.data[3 * 100 + 1] = NAN;
	assert_int_equal(compare_images(&a, &b, &params, &f), GR_OK);
	assert_true(f.nonfinite == 1 && f.bias == 0 && f.nrmse == 0 && f.block_error == 0);
	assert_true(f.flip >= 1.0 / 1024 && f.ssim < 1);
	image_finish(&a);
	image_finish(&b);
}

static double flat_flip(const float a[3], const float b[3])
{
	struct image x, y, map;
	double sum = 0;

	fill(&x, 24, 16, a[0], a[1], a[2]);
	fill(&y, 24, 16, b[0], b[1], b[2]);
	assert_int_equal(compare_flip(&x, &y, 67.0206, &map), GR_OK);
	for (int i = 0; i < 24 * 16; i++)
		sum += (double)map.data[i];
	image_finish(&x);
	image_finish(&y);
	image_finish(&map);
	return sum / (24 * 16);
}

/* Without edges it is the colour part alone: values by the paper's formulas, done elsewhere. */
static void flip_of_flat(void **state)
{
	static const float black[3] = { 0, 0, 0 }, white[3] = { 1, 1, 1 }, red[3] = { 1, 0, 0 };
	static const float green[3] = { 0, 1, 0 }, blue[3] = { 0, 0, 1 };
	/* sRGB of linear 0.5 and 0.25 */
	static const float half[3] = { 0.735357f, 0.735357f, 0.735357f };
	static const float quarter[3] = { 0.537099f, 0.537099f, 0.537099f };

	(void)state;
	assert_true(flat_flip(red, red) == 0);
	assert_true(fabs(flat_flip(green, blue) - 1) < 1e-5);
	assert_true(fabs(flat_flip(black, white) - 0.9673798) < 1e-4);
	assert_true(fabs(flat_flip(red, green) - 0.9866623) < 1e-4);
	assert_true(fabs(flat_flip(half, quarter) - 0.4518496) < 1e-4);
}

/* A step of full contrast is the strongest feature there is; seen from afar it fades. */
static void flip_of_edges(void **state)
{
	struct image a, b, near, far;
	double sum[2] = { 0 };

	(void)state;
	fill(&a, 64, 64, 0.5f, 0.5f, 0.5f);
	fill(&b, 64, 64, 0.5f, 0.5f, 0.5f);
	for (int i = 0; i < 3 * 64 * 64; i++)
		a.data[i] = i / 3 % 2 ? 0.7f : 0.1f;
	assert_int_equal(compare_flip(&a, &b, 20, &near), GR_OK);
	assert_int_equal(compare_flip(&a, &b, 200, &far), GR_OK);
	for (int i = 0; i < 64 * 64; i++) {
		sum[0] += (double)near.data[i];
		sum[1] += (double)far.data[i];
		assert_true(near.data[i] >= 0 && near.data[i] <= 1);
	}
	printf("# stripes of one pixel at 20 and 200 pixels a degree: %.3f, %.3f\n", sum[0] / 4096,
	       sum[1] / 4096);
	assert_true(sum[0] > 1.5 * sum[1]);
	image_finish(&a);
	image_finish(&b);
	image_finish(&near);
	image_finish(&far);
}

/* Between constants only the means count: (2ab + C1)/(a^2 + b^2 + C1). */
static void ssim_of_flat(void **state)
{
	struct image a, b;
	double got;

	(void)state;
	fill(&a, 20, 20, 0.5f, 0.5f, 0.5f);
	fill(&b, 20, 20, 0.25f, 0.25f, 0.25f);
	assert_int_equal(compare_ssim(&a, &b, NULL, &got), GR_OK);
	assert_true(fabs(got - (0.25 + 1e-4) / (0.3125 + 1e-4)) < 1e-5);
	image_finish(&a);
	image_finish(&b);
	/* against its negative the structure is the opposite */
	noise(&a, 64, 64, 3);
	noise(&b, 64, 64, 3);
	for (int i = 0; i < 3 * 64 * 64; i++)
		b.data[i] = 1 - b.data[i];
	assert_int_equal(compare_ssim(&a, &b, NULL, &got), GR_OK);
	printf("# noise against its negative: SSIM %.3f\n", got);
	assert_true(got < -0.8);
	image_finish(&a);
	image_finish(&b);
}

static void sizes(void **state)
{
	const struct compare_params params = COMPARE_PARAMS;
	struct compare_figures f;
	struct image a, b, c;

	(void)state;
	fill(&a, 5, 3, 1, 1, 1);
	fill(&b, 3, 5, 1, 1, 1);
	assert_int_equal(compare_images(&a, &b, &params, &f), GR_ERR_RANGE);
	assert_int_equal(image_create(&c, 5, 3, 1), GR_OK);
	assert_int_equal(compare_images(&a, &c, &params, &f), GR_ERR_RANGE);
	assert_int_equal(compare_images(&a, &a, &params, &f), GR_OK);
	assert_true(isnan(f.ssim) && isnan(f.block_error) && f.flip == 0 && f.blocks == 0);
	scale(&a, NAN);
	assert_int_equal(compare_images(&a, &a, &params, &f), GR_OK);
	assert_true(f.nonfinite == 15 && f.flip == 1);
	image_finish(&a);
	image_finish(&b);
	image_finish(&c);
}

/* The reference pictures' own block means. */
static void published_means(void **state)
{
	struct gr_diag diag = { 0 };
	struct image picture, want, got;
	char path[1024];
	double worst = 0;

	(void)state;
	if (!shared_file("reference/renders/a_cornell/camA.exr", path))
		skip();
	assert_int_equal(image_read_exr(path, &picture, &diag), GR_OK);
	assert_non_null(shared_file("reference/renders/a_cornell/camA_mean8.exr", path));
	assert_int_equal(image_read_exr(path, &want, &diag), GR_OK);
	assert_int_equal(compare_block_means(&picture, NULL, 8, &got), GR_OK);
	for (int i = 0; i < 3 * 32 * 32; i++)
		worst = fmax(worst, fabs((double)got.data[i] - (double)want.data[i]) /
					    ((double)want.data[i] + 1e-3));
	printf("# block means: worst relative difference %.1e\n", worst);
	assert_true(worst < 1e-4);
	image_finish(&picture);
	image_finish(&want);
	image_finish(&got);
	gr_diag_finish(&diag);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(linear_figures), cmocka_unit_test(one_pixel),
		cmocka_unit_test(flip_of_flat),	  cmocka_unit_test(flip_of_edges),
		cmocka_unit_test(ssim_of_flat),	  cmocka_unit_test(sizes),
		cmocka_unit_test(published_means),
	};

	gr_log_init("test_compare", GR_LOG_WARNING);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
