/* Light from all around: where a picture's pixels are, how they are sampled, what is refused. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/scene/environment.h"
#include "tests/unit/shared.h"

#include <math.h>

static struct environment *from(const struct image *image, const struct scene_environment *said)
{
	struct environment *e;
	struct gr_diag diag = { 0 };

	assert_int_equal(environment_from_image(&e, image, said, "test", &diag), GR_OK);
	gr_diag_finish(&diag);
	return e;
}

static struct environment *constant(float radiance, bool upper_only)
{
	const struct scene_file file = {
		.environment = { .kind = SCENE_ENVIRONMENT_CONSTANT,
				 .radiance = { radiance, 2 * radiance, 3 * radiance },
				 .upper_only = upper_only },
	};
	struct environment *e;

	assert_int_equal(environment_create(&e, &file, NULL), GR_OK);
	return e;
}

static void direction_of(double u, double v, float out[3])
{
	double p = 2 * M_PI * (u - 0.5);

	out[0] = (float)(sin(M_PI * v) * cos(p));
	out[1] = (float)cos(M_PI * v);
	out[2] = (float)(sin(M_PI * v) * sin(p));
}

static void noise(struct image *image, int width, int height)
{
	struct unit_random random = unit_random_start("environment");

	assert_int_equal(image_create(image, width, height, 3), GR_OK);
	for (int i = 0; i < 3 * width * height; i++)
		image->data[i] = (float)exp(unit_random_range(&random, -1, 1));
}

static const struct scene_environment plain = { .kind = SCENE_ENVIRONMENT_IMAGE, .scale = 1 };

/* In the middle of a pixel its own value; half way to the next the mean. */
static void places(void **state)
{
	struct image image;
	struct environment *e;
	float d[3], got[3];

	(void)state;
	noise(&image, 16, 8);
	e = from(&image, &plain);
	for (int y = 0; y < 8; y++) {
		for (int x = 0; x < 16; x++) {
			const float *a = image.data + 3 * (y * 16 + x);
			const float *b = image.data + 3 * (y * 16 + (x + 1) % 16);

			direction_of((x + 0.5) / 16, (y + 0.5) / 8, d);
			environment_radiance(e, d, got);
			assert_true(fabsf(got[1] / a[1] - 1) < 1e-4f);
			direction_of((x + 1.0) / 16, (y + 0.5) / 8, d);
			environment_radiance(e, d, got);
			assert_true(fabsf(got[2] / ((a[2] + b[2]) / 2) - 1) < 1e-4f);
		}
	}
	environment_destroy(&e);
	image_finish(&image);
}

/* A quarter turn counter-clockwise from above takes what was at +X to -Z. */
static void heading(void **state)
{
	static const float x[3] = { 1, 0, 0 }, minus_z[3] = { 0, 0, -1 };
	struct scene_environment said = plain;
	struct image image;
	struct environment *e, *turned;
	float a[3], b[3];

	(void)state;
	said.heading_rad = (float)M_PI / 2;
	said.scale = 3;
	noise(&image, 32, 16);
	e = from(&image, &plain);
	turned = from(&image, &said);
	environment_radiance(e, x, a);
	environment_radiance(turned, minus_z, b);
	for (int c = 0; c < 3; c++)
		assert_true(fabsf(b[c] / a[c] / 3 - 1) < 1e-4f);
	environment_destroy(&e);
	environment_destroy(&turned);
	image_finish(&image);
}

static double radical_inverse(uint32_t i)
{
	double sum = 0, half = 0.5;

	for (; i; i >>= 1, half /= 2)
		sum += i & 1 ? half : 0;
	return sum;
}

/* Density: 1 in all, the same from both functions, and sums by it come out right. */
static void check_sampling(const struct environment *e, const char *what)
{
	static const float up[3] = { 0.36f, 0.48f, 0.8f };
	const int count = 1 << 18;
	double all = 0, worst = 0, sum = 0;
	float want[3];

	for (int i = 0; i < 720; i++) {
		for (int j = 0; j < 1440; j++) {
			double v = (i + 0.5) / 720;
			float d[3];

			direction_of((j + 0.5) / 1440, v, d);
			all += (double)environment_pdf(e, d) * sin(M_PI * v) * M_PI / 720 * 2 * M_PI /
			       1440;
		}
	}
	for (int i = 0; i < count; i++) {
		float d[3], l[3], again[3];
		double u1 = (i + 0.5) / count, u2 = radical_inverse((uint32_t)i);
		float pdf = environment_sample(e, u1, u2, d, l);

		assert_true(pdf > 0 && isfinite(pdf));
		environment_radiance(e, d, again);
		for (int c = 0; c < 3; c++)
			assert_true(fabsf(again[c] - l[c]) <= 2e-3f * l[c] + 2e-2f);
		/* on the edge between two pixels rounding decides */
		if (fabsf(environment_pdf(e, d) / pdf - 1) > 1e-3f)
			worst += 1.0 / count;
		sum += fmax(0, (double)(d[0] * up[0] + d[1] * up[1] + d[2] * up[2])) * (double)l[1] /
		       (double)pdf;
	}
	sum /= count;
	environment_irradiance(e, up, want);
	printf("# %s: densities add up to 1 %+.1e, %.2g of the samples on an edge, irradiance %+.2e\n",
	       what, all - 1, worst, sum / (double)want[1] - 1);
	assert_true(fabs(all - 1) < 2e-3);
	assert_true(worst < 0.002);
	assert_true(fabs(sum / (double)want[1] - 1) < 2e-3);
}

static void sampling(void **state)
{
	struct scene_environment upper = plain;
	struct image image;
	struct environment *e;

	(void)state;
	upper.upper_only = true;
	upper.heading_rad = 1;
	noise(&image, 24, 9);
	image.data[3 * 40] = 1e4f; /* a sun */
	for (int i = 0; i < 3 * 24; i++) /* and a dark row */
		image.data[3 * 24 * 7 + i] = 0;
	e = from(&image, &plain);
	check_sampling(e, "picture");
	environment_destroy(&e);
	e = from(&image, &upper);
	check_sampling(e, "picture, from above only");
	environment_destroy(&e);
	image_finish(&image);
	e = constant(2, false);
	check_sampling(e, "constant");
	environment_destroy(&e);
	e = constant(2, true);
	check_sampling(e, "constant, from above only");
	environment_destroy(&e);
}

static void upper_only(void **state)
{
	static const float along[3] = { 1, 0, 0 }, up[3] = { 0, 1, 0 }, side[3] = { 0, 0, 1 };
	struct environment *e = constant(1, true);
	float got[3];

	(void)state;
	environment_radiance(e, along, got);
	assert_true(got[0] == 0);
	assert_true(environment_pdf(e, along) == 0);
	environment_radiance(e, up, got);
	assert_true(got[2] == 3);
	environment_irradiance(e, up, got);
	assert_true(fabs((double)got[0] - M_PI) < 1e-6);
	environment_irradiance(e, side, got);
	assert_true(fabs((double)got[0] - M_PI / 2) < 1e-6);
	environment_destroy(&e);
}

/* All black, one pixel, one channel. */
static void small(void **state)
{
	struct image image;
	struct environment *e;
	float d[3], l[3];

	(void)state;
	assert_int_equal(image_create(&image, 4, 2, 3), GR_OK);
	e = from(&image, &plain);
	assert_true(environment_sample(e, 0.3, 0.9, d, l) > 0);
	assert_true(l[0] == 0 && l[1] == 0 && l[2] == 0);
	environment_destroy(&e);
	image_finish(&image);
	assert_int_equal(image_create(&image, 1, 1, 1), GR_OK);
	image.data[0] = 5;
	e = from(&image, &plain);
	check_sampling(e, "one pixel");
	environment_sample(e, 0.999999999, 0.999999999, d, l);
	assert_true(l[0] == 5 && l[2] == 5);
	environment_destroy(&e);
	image_finish(&image);
}

static void refused(int width, int height, int channels, float value, float scale,
		    const char *words)
{
	struct scene_environment said = plain;
	struct gr_diag diag = { 0 };
	struct environment *e;
	struct image image;

	said.scale = scale;
	assert_int_equal(image_create(&image, width, height, channels), GR_OK);
	image.data[width * height * channels - 1] = value;
	assert_int_equal(environment_from_image(&e, &image, &said, "sky.exr", &diag),
			 GR_ERR_CONFIG);
	assert_null(e);
	assert_true(diag.errors == 1);
	if (!strstr(diag.items[0].text, words))
		print_message("%s\n", diag.items[0].text);
	assert_non_null(strstr(diag.items[0].text, words));
	assert_non_null(strstr(diag.items[0].text, "sky.exr"));
	gr_diag_finish(&diag);
	image_finish(&image);
}

static void refusals(void **state)
{
	struct gr_diag diag = { 0 };
	struct environment *e;
	struct image image;
	float d[3], l[3];

	(void)state;
	refused(4, 2, 3, NAN, 1, "pixel 3 of row 1 is nan");
	refused(4, 2, 3, INFINITY, 1, "is inf");
	refused(4, 2, 3, -INFINITY, 1, "is -inf");
	refused(4, 2, 3, 1e10f, 1e9f, "more than 1000000000000 W");
	refused(8200, 2, 1, 1, 1, "at most 8192");
	refused(4, 2, 4, 1, 1, "4 channels");
	/* Taken, with a warning each: negative values, and another shape. */
	assert_int_equal(image_create(&image, 3, 3, 1), GR_OK);
	image.data[0] = -1;
	assert_int_equal(environment_from_image(&e, &image, &plain, "sky.exr", &diag), GR_OK);
	assert_true(diag.warnings == 2 && diag.errors == 0);
	environment_sample(e, 0.5, 0.5, d, l);
	assert_true(l[0] == 0);
	environment_destroy(&e);
	gr_diag_finish(&diag);
	image_finish(&image);
}

static void hashes(void **state)
{
	struct scene_environment said = plain;
	struct environment *a, *b;
	struct image image;
	uint8_t of_a[32], of_b[32];

	(void)state;
	noise(&image, 8, 4);
	a = from(&image, &said);
	b = from(&image, &said);
	environment_hash(a, of_a);
	environment_hash(b, of_b);
	assert_memory_equal(of_a, of_b, 32);
	environment_destroy(&b);
	image.data[20] *= 1.001f;
	b = from(&image, &said);
	environment_hash(b, of_b);
	assert_memory_not_equal(of_a, of_b, 32);
	environment_destroy(&a);
	environment_destroy(&b);
	image_finish(&image);
}

/* Published probes: irradiance by a direct sum over pixels, done elsewhere. */
static void probes(void **state)
{
	static const char *const names[] = { "probe_shared", "grace_latlong_512" };

	(void)state;
	for (int i = 0; i < 2; i++) {
		struct gr_diag diag = { 0 };
		struct environment *e;
		struct image image;
		char name[256], path[1024], line[512];
		double worst = 0;
		FILE *csv;

		snprintf(name, sizeof name, "reference/probes/%s.exr", names[i]);
		if (!shared_file(name, path))
			skip();
		assert_int_equal(image_read_exr(path, &image, &diag), GR_OK);
		e = from(&image, &plain);
		snprintf(name, sizeof name, "reference/probes/%s_irradiance.csv", names[i]);
		csv = shared_file(name, path) ? fopen(path, "r") : NULL;
		assert_non_null(csv);
		while (fgets(line, sizeof line, csv)) {
			float n[3], want[3], got[3];

			if (sscanf(line, "%f,%f,%f,%f,%f,%f", &n[0], &n[1], &n[2], &want[0], &want[1],
				   &want[2]) != 6)
				continue;
			environment_irradiance(e, n, got);
			for (int c = 0; c < 3; c++)
				worst = fmax(worst, fabs((double)got[c] / (double)want[c] - 1));
		}
		fclose(csv);
		printf("# %s: worst relative difference of irradiance %.2e\n", names[i], worst);
		assert_true(worst < 6e-5);
		environment_destroy(&e);
		image_finish(&image);
		gr_diag_finish(&diag);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(places),     cmocka_unit_test(heading),  cmocka_unit_test(sampling),
		cmocka_unit_test(upper_only), cmocka_unit_test(small),	  cmocka_unit_test(refusals),
		cmocka_unit_test(hashes),     cmocka_unit_test(probes),
	};

	gr_log_init("test_environment", GR_LOG_WARNING);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
