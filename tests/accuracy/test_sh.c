/*
 * Spherical harmonics of light: the basis and its turns against SciPy, light probes
 * against coefficients and irradiance that others computed (reference/README.md).
 */
#include "base/diag.h"
#include "base/result.h"
#include "renderer/image/image.h"
#include "renderer/scene/sh.h"
#include "renderer/scene/sky.h"
#include "renderer/view/env_sh.h"
#include "tests/unit/gl.h"
#include "tests/unit/shared.h"
#include "tests/unit/unit.h"

#include <epoxy/gl.h>

/* Numbers of the next line that begins with one; 0 at the end. */
static int read_numbers(FILE *file, double *out, int most)
{
	char line[4096];

	while (fgets(line, sizeof line, file)) {
		char *at = line, *end;
		int count = 0;

		for (; count < most; count++) {
			out[count] = strtod(at, &end);
			if (end == at)
				break;
			at = end + (*end == ',');
		}
		if (count)
			return count;
	}
	return 0;
}

static FILE *open_shared(const char *name)
{
	char path[1024];
	FILE *file;

	if (!shared_file(name, path))
		return NULL;
	file = fopen(path, "r");
	assert_non_null(file);
	return file;
}

static void basis(void **state)
{
	FILE *file = open_shared("reference/analytic/sh_basis.csv");
	double row[3 + 36], got[SH_COUNT_MAX], worst = 0;
	int rows = 0;

	(void)state;
	if (!file)
		skip();
	for (; read_numbers(file, row, 39) == 39; rows++) {
		sh_basis(6, row, got);
		for (int i = 0; i < 36; i++)
			worst = fmax(worst, fabs(got[i] - row[3 + i]));
	}
	fclose(file);
	printf("# basis, bands 0 to 5 in %d directions: off by %.1e\n", rows, worst);
	assert_int_equal(rows, 17);
	assert_true(worst < 1e-11);
}

static void turns(void **state)
{
	FILE *file = open_shared("reference/analytic/sh_rotation.csv");
	double f[36][3] = { { 0 } }, g[36] = { 0 }, rotation[9], row[4], worst = 0;
	char head[1024], *at;
	int rows = 0;

	(void)state;
	if (!file)
		skip();
	assert_non_null(fgets(head, sizeof head, file));
	at = strrchr(head, ')') + 2;
	for (int i = 0; i < 9; i++) {
		rotation[i] = strtod(at, &at);
		at += *at == ',';
	}
	for (; read_numbers(file, row, 4) == 4; rows++) {
		int i = (int)(row[0] * row[0] + row[0] + row[1]);

		f[i][0] = row[2];
		g[i] = row[3];
	}
	fclose(file);
	assert_int_equal(rows, 36);
	sh_rotate(6, rotation, (const double (*)[3])f, f);
	for (int i = 0; i < 36; i++)
		worst = fmax(worst, fabs(f[i][0] - g[i]));
	printf("# turned, bands 0 to 5: off by %.1e\n", worst);
	assert_true(worst < 1e-10);
}

/* A picture as an environment has it. */
struct probe {
	struct image image;
	struct environment *environment;
	struct environment_pixels pixels;
};

static bool load(struct probe *probe, const char *name, const struct scene_environment *said)
{
	struct gr_diag diag = { 0 };
	char path[1024];

	if (!shared_file(name, path))
		return false;
	assert_int_equal(image_read_exr(path, &probe->image, &diag), GR_OK);
	assert_int_equal(environment_from_image(&probe->environment, &probe->image, said, name, &diag),
			 GR_OK);
	environment_pixels(probe->environment, &probe->pixels);
	gr_diag_finish(&diag);
	return true;
}

static void unload(struct probe *probe)
{
	environment_destroy(&probe->environment);
	image_finish(&probe->image);
}

static const struct scene_environment plain = { .kind = SCENE_ENVIRONMENT_IMAGE, .scale = 1 };

/* Worst difference over the largest coefficient. */
static double against_table(const char *name, const double (*got)[3])
{
	FILE *file = open_shared(name);
	double row[5], worst = 0;
	int rows = 0;

	assert_non_null(file);
	for (; read_numbers(file, row, 5) == 5; rows++)
		for (int k = 0; k < 3; k++)
			worst = fmax(worst, fabs(got[rows][k] - row[2 + k]) / fabs(got[0][k]));
	fclose(file);
	assert_int_equal(rows, 9);
	return worst;
}

/* E of the coefficients against E_sh9 of the table, over the table's. */
static double against_irradiance(const char *name, const double (*got)[3])
{
	FILE *file = open_shared(name);
	double row[9], worst = 0;

	assert_non_null(file);
	while (read_numbers(file, row, 9) == 9) {
		double e[3];

		sh_irradiance(3, got, row, e);
		for (int k = 0; k < 3; k++)
			worst = fmax(worst, fabs(e[k] / row[6 + k] - 1));
	}
	fclose(file);
	return worst;
}

static void probes(void **state)
{
	static const char *const names[] = { "probe_shared", "grace_latlong_512" };

	(void)state;
	for (int i = 0; i < 2; i++) {
		double got[9][3], table, irradiance;
		struct probe probe;
		char name[128];

		snprintf(name, sizeof name, "reference/probes/%s.exr", names[i]);
		if (!load(&probe, name, &plain))
			skip();
		sh_project(&probe.pixels, 3, got);
		snprintf(name, sizeof name, "reference/probes/%s_sh9.csv", names[i]);
		table = against_table(name, (const double (*)[3])got);
		snprintf(name, sizeof name, "reference/probes/%s_irradiance.csv", names[i]);
		irradiance = against_irradiance(name, (const double (*)[3])got);
		printf("# %s: a coefficient off by %.1e of the first, irradiance by %.1e\n", names[i], table,
		       irradiance);
		assert_true(table < 1e-6);
		assert_true(irradiance < 1e-4);
		unload(&probe);
	}
}

/*
 * Grace Cathedral as published with 7 digits, in its own axes, and in a unit that is
 * not given: the one that fits best.
 */
static void published(void **state)
{
	static const double axes[9] = { 0, 0, 1, 0, -1, 0, 1, 0, 0 };
	FILE *file = open_shared("reference/probes/published_sh9.csv");
	double got[9][3], want[9][3], worst = 0, product = 0, square = 0;
	double apart = 0, whole = 0;
	struct probe probe;
	char line[512];
	int rows = 0;

	(void)state;
	if (!file || !load(&probe, "reference/probes/grace_latlong_512.exr", &plain))
		skip();
	sh_project(&probe.pixels, 3, got);
	sh_rotate(3, axes, (const double (*)[3])got, got);
	while (fgets(line, sizeof line, file)) {
		double rgb[3];
		int l, m;

		if (sscanf(line, "grace_cathedral_7digits,%d,%d,%lf,%lf,%lf", &l, &m, &rgb[0], &rgb[1],
			   &rgb[2]) == 5) {
			memcpy(want[l * l + l + m], rgb, sizeof rgb);
			rows++;
		}
	}
	fclose(file);
	unload(&probe);
	assert_int_equal(rows, 9);
	for (int i = 0; i < 27; i++) {
		product += got[i / 3][i % 3] * want[i / 3][i % 3];
		square += got[i / 3][i % 3] * got[i / 3][i % 3];
	}
	for (int i = 0; i < 27; i++) {
		const double d = product / square * got[i / 3][i % 3] - want[i / 3][i % 3];

		apart += d * d;
		whole += want[i / 3][i % 3] * want[i / 3][i % 3];
		worst = fmax(worst, fabs(d) / want[0][0]); /* red's first is the largest */
	}
	printf("# Grace Cathedral as published, times %.3f: root of the squares apart %.2f %%, worst %.2f %% of "
	       "the largest\n", product / square, 100 * sqrt(apart / whole), 100 * worst);
	assert_true(sqrt(apart / whole) < 0.005);
	assert_true(worst < 0.006);
}

/* A heading is a turn about +Y, half of the sky is half of it, and one radiance has one band. */
static void environments(void **state)
{
	const struct scene_environment turned = { .kind = SCENE_ENVIRONMENT_IMAGE, .scale = 1,
						  .heading_rad = 0.7f };
	const double h = (double)0.7f;
	const double rotation[9] = { cos(h), 0, sin(h), 0, 1, 0, -sin(h), 0, cos(h) };
	double a[SH_COUNT_MAX][3], b[SH_COUNT_MAX][3], worst = 0;
	struct environment_pixels sky = { .constant = { 1, 2, 4 } };
	struct probe probe, other;

	(void)state;
	sh_project(&sky, SH_ORDER_MAX, a);
	for (int i = 0; i < SH_COUNT_MAX; i++)
		assert_true(fabs(a[i][2] - (i ? 0 : 4 * sqrt(4 * M_PI))) < 1e-12);
	/* upper half: band 0 halved, band 1 up 3/4 of that of 2 cos */
	sky.upper_only = true;
	sh_project(&sky, SH_ORDER_MAX, a);
	assert_true(fabs(a[0][0] - sqrt(M_PI)) < 1e-12);
	assert_true(fabs(a[1][0] - sqrt(3 / (4 * M_PI)) * M_PI) < 1e-12);
	for (int i = 2; i < 9; i++)
		assert_true(fabs(a[i][0]) < 1e-12); /* band 2 and the rest of band 1: even about the horizon */
	if (!load(&probe, "reference/probes/probe_shared.exr", &plain) ||
	    !load(&other, "reference/probes/probe_shared.exr", &turned))
		skip();
	sh_project(&probe.pixels, 5, a);
	sh_rotate(5, rotation, (const double (*)[3])a, a);
	sh_project(&other.pixels, 5, b);
	for (int i = 0; i < 25; i++)
		worst = fmax(worst, fabs(a[i][0] - b[i][0]));
	printf("# heading against a turn of the coefficients, order 5: off by %.1e\n", worst);
	assert_true(worst < 1e-9);
	unload(&probe);
	unload(&other);
}

/* How many pixels a sky needs. */
static void small_skies(void **state)
{
	static const double to_sun[3] = { 0.8, 0.6, 0 };
	double fine[25][3], coarse[25][3];
	struct image picture;
	struct sky sky;

	(void)state;
	sky_init(&sky, 2.5, to_sun);
	for (int width = 1024; width >= 32; width /= width > 256 ? 8 : 2) {
		double worst = 0;

		assert_int_equal(sky_picture(&sky, width, width / 2, &picture), GR_OK);
		sh_project(&(struct environment_pixels){ .rgb = picture.data, .width = width,
							 .height = width / 2, .upper_only = true },
			   5, width == 1024 ? fine : coarse);
		image_finish(&picture);
		if (width == 1024)
			continue;
		for (int i = 0; i < 25; i++)
			for (int k = 0; k < 3; k++)
				worst = fmax(worst, fabs(coarse[i][k] - fine[i][k]) / fine[0][k]);
		printf("# a sky of %d x %d pixels, order 5: a coefficient off by %.2f %% of the first\n", width,
		       width / 2, 100 * worst);
		if (width == 128)
			assert_true(worst < 6e-4);
	}
}

/* All in one pixel: the coefficients are the basis there; the reconstruction goes below 0. */
static void one_bright_pixel(void **state)
{
	struct environment_pixels sun = { .width = 64, .height = 32 };
	double got[SH_COUNT_MAX][3], want[SH_COUNT_MAX], lowest = 0, worst = 0;
	const double v = 5.5 / 32, p = 2 * M_PI * (40.5 / 64 - 0.5);
	const double d[3] = { sin(M_PI * v) * cos(p), cos(M_PI * v), sin(M_PI * v) * sin(p) };
	const double solid = (cos(M_PI * 5 / 32) - cos(M_PI * 6 / 32)) * 2 * M_PI / 64;
	float *rgb = calloc(64 * 32 * 3, sizeof *rgb);

	(void)state;
	for (int k = 0; k < 3; k++)
		rgb[3 * (5 * 64 + 40) + k] = 1e6f;
	sun.rgb = rgb;
	sh_project(&sun, SH_ORDER_MAX, got);
	sh_basis(SH_ORDER_MAX, d, want);
	for (int i = 0; i < SH_COUNT_MAX; i++)
		worst = fmax(worst, fabs(got[i][0] / (1e6 * solid) - want[i]));
	for (double deg = 0; deg < 360; deg++) {
		const double to[3] = { cos(deg * M_PI / 180), sin(deg * M_PI / 180), 0 };
		double l[3];

		sh_radiance(SH_ORDER_MAX, (const double (*)[3])got, to, l);
		lowest = fmin(lowest, l[0]);
	}
	assert_true(worst < 1e-9);
	assert_true(lowest < 0);
	free(rgb);
}

/* The texture that the backdrop has, too. */
static unsigned texture_of(const struct environment_pixels *pixels)
{
	unsigned texture;

	glCreateTextures(GL_TEXTURE_2D, 1, &texture);
	glTextureStorage2D(texture, 1, GL_RGBA32F, pixels->width, pixels->height);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glTextureSubImage2D(texture, 0, 0, 0, pixels->width, pixels->height, GL_RGB, GL_FLOAT, pixels->rgb);
	return texture;
}

/* Worst difference of the GPU's coefficients from the CPU's, over the first. */
static double gpu_against_cpu(const struct environment_pixels *pixels, int order, const double *rotation)
{
	double want[SH_COUNT_MAX][3], got[SH_COUNT_MAX][3], worst = 0;
	unsigned texture = texture_of(pixels);
	struct env_sh *gpu;

	assert_int_equal(env_sh_create(&gpu, pixels, order), GR_OK);
	/* before the picture, or after it */
	if (rotation && order > 5)
		env_sh_turn(gpu, rotation);
	env_sh_project(gpu, texture);
	if (rotation)
		env_sh_turn(gpu, rotation);
	env_sh_read(gpu, got);
	sh_project(pixels, order, want);
	if (rotation)
		sh_rotate(order, rotation, (const double (*)[3])want, want);
	for (int i = 0; i < order * order; i++)
		for (int k = 0; k < 3; k++)
			worst = fmax(worst, fabs(got[i][k] - want[i][k]) / want[0][k]);
	env_sh_destroy(&gpu);
	glDeleteTextures(1, &texture);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	return worst;
}

static void on_the_gpu(void **state)
{
	static const double turn[9] = { 0.36, 0.48, -0.8, -0.8, 0.6, 0, 0.48, 0.64, 0.6 };
	const struct scene_environment turned = { .kind = SCENE_ENVIRONMENT_IMAGE, .scale = 1,
						  .heading_rad = 0.7f, .upper_only = true };
	struct probe probe;
	double worst = 0;

	(void)state;
	if (!load(&probe, "reference/probes/grace_latlong_512.exr", &turned))
		skip();
	for (int order = 2; order <= SH_ORDER_MAX; order += 3)
		worst = fmax(worst, gpu_against_cpu(&probe.pixels, order, order > 2 ? turn : NULL));
	unload(&probe);
	printf("# Grace Cathedral on the GPU, orders 2, 5, 8, turned: a coefficient off by %.1e of the first\n",
	       worst);
	assert_true(worst < 3e-6);
}

/* Sides that no group divides, a horizon within a row, and a sun in one pixel. */
static void odd_pictures(void **state)
{
	static const int sizes[][2] = { { 1, 1 }, { 7, 5 }, { 33, 17 }, { 130, 65 } };
	struct unit_random random = unit_random_start("odd pictures");
	double worst = 0;

	(void)state;
	for (int s = 0; s < 4; s++)
		for (int upper = 0; upper < 2; upper++) {
			struct environment_pixels pixels = { .width = sizes[s][0], .height = sizes[s][1],
							     .upper_only = upper };
			const int count = 3 * pixels.width * pixels.height;
			float *rgb = malloc(sizeof *rgb * (size_t)count);

			for (int i = 0; i < count; i++)
				rgb[i] = (float)unit_random_range(&random, 0, 1);
			for (int k = 0; k < 3; k++) /* in the upper half */
				rgb[3 * (pixels.height / 4 * pixels.width + pixels.width / 2) + k] = 1e6f;
			pixels.rgb = rgb;
			worst = fmax(worst, gpu_against_cpu(&pixels, SH_ORDER_MAX, NULL));
			free(rgb);
		}
	printf("# odd pictures on the GPU: a coefficient off by %.1e of the first\n", worst);
	assert_true(worst < 1e-5);
}

/* Milliseconds of all cores together, which others may want, too: a figure, and no test of it. */
static double cost(int width, int order)
{
	struct environment_pixels pixels = { .width = width, .height = width / 2 };
	float *rgb = calloc(3 * (size_t)(width * width / 2), sizeof *rgb);
	struct timespec from, to;
	struct env_sh *gpu;
	unsigned texture;

	pixels.rgb = rgb;
	texture = texture_of(&pixels);
	assert_int_equal(env_sh_create(&gpu, &pixels, order), GR_OK);
	for (int i = 0; i < 12; i++) {
		if (i == 2) {
			glFinish();
			clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
		}
		env_sh_project(gpu, texture);
	}
	glFinish();
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
	env_sh_destroy(&gpu);
	glDeleteTextures(1, &texture);
	free(rgb);
	return ((double)(to.tv_sec - from.tv_sec) * 1e3 + (double)(to.tv_nsec - from.tv_nsec) / 1e6) / 10;
}

static void speed(void **state)
{
	(void)state;
	printf("# order 5, processor time where that is the GPU: 1024 x 512 %.2f ms, 512 x 256 %.2f ms, "
	       "128 x 64 %.2f ms\n", cost(1024, 5), cost(512, 5), cost(128, 5));
}

int main(void)
{
	const struct CMUnitTest gpu[] = {
		cmocka_unit_test(on_the_gpu), cmocka_unit_test(odd_pictures), cmocka_unit_test(speed),
	};
	struct target *target;
	int failed;
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(basis),	cmocka_unit_test(turns),     cmocka_unit_test(probes),
		cmocka_unit_test(published),    cmocka_unit_test(environments), cmocka_unit_test(one_bright_pixel),
		cmocka_unit_test(small_skies),
	};

	failed = cmocka_run_group_tests(tests, NULL, NULL);
	if (failed)
		return failed;
	target = gl_target_or_skip(16, 16);
	failed = cmocka_run_group_tests(gpu, NULL, NULL);
	target_destroy(&target);
	return failed;
}
