/* EXR and PNG: what is written comes back, what is damaged is refused. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/image/image.h"
#include "tests/unit/shared.h"

#include <math.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static char exr_path[64], png_path[64];

static int set_up(void **state)
{
	(void)state;
	snprintf(exr_path, sizeof exr_path, "test_image.%ld.exr", (long)getpid());
	snprintf(png_path, sizeof png_path, "test_image.%ld.png", (long)getpid());
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	remove(exr_path);
	remove(png_path);
	return 0;
}

static uint8_t *load(const char *path, size_t *len)
{
	FILE *file = fopen(path, "rb");
	uint8_t *bytes;
	long size;

	assert_non_null(file);
	fseek(file, 0, SEEK_END);
	size = ftell(file);
	rewind(file);
	bytes = malloc((size_t)size);
	assert_int_equal(fread(bytes, 1, (size_t)size, file), size);
	fclose(file);
	*len = (size_t)size;
	return bytes;
}

static void fill(struct image *image, struct unit_random *random)
{
	size_t count = (size_t)image->width * (size_t)image->height * (size_t)image->channels;

	for (size_t i = 0; i < count; i++)
		image->data[i] = (float)exp(unit_random_range(random, -20, 20));
	image->data[0] = NAN;
	image->data[count - 1] = INFINITY;
	image->data[count / 2] = -INFINITY;
	image->data[count / 3] = -0.0f;
}

static void read_back(struct image *out, struct gr_diag *diag)
{
	int result = image_read_exr(exr_path, out, diag);

	gr_diag_log(diag);
	assert_int_equal(result, GR_OK);
}

/* Bit for bit, so that NaN and the sign of zero count. */
static void test_exr_round_trip(void **state)
{
	static const int sizes[][3] = {
		{ 7, 5, 3 }, { 64, 33, 3 }, { 1, 17, 1 }, { 16, 16, 4 }, { 129, 1, 3 }, { 4, 1, 1 },
	};
	struct unit_random random = unit_random_start("exr round trip");

	(void)state;
	for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
		struct image in, out;
		struct gr_diag diag = { 0 };
		int kept = sizes[s][2] == 4 ? 3 : sizes[s][2]; /* alpha is written, not read */

		assert_int_equal(image_create(&in, sizes[s][0], sizes[s][1], sizes[s][2]), GR_OK);
		fill(&in, &random);
		assert_int_equal(image_write_exr(exr_path, &in, NULL), GR_OK);
		read_back(&out, &diag);
		assert_int_equal(out.width, in.width);
		assert_int_equal(out.height, in.height);
		assert_int_equal(out.channels, kept);
		for (size_t p = 0; p < (size_t)in.width * (size_t)in.height; p++)
			assert_memory_equal(out.data + p * (size_t)kept,
					    in.data + p * (size_t)in.channels,
					    (size_t)kept * sizeof(float));
		assert_int_equal(diag.count, 0);
		gr_diag_finish(&diag);
		image_finish(&out);
		image_finish(&in);
	}
}

static void test_exr_named(void **state)
{
	static const char *const depth[] = { "Z" };
	static const char *const motion[] = { "motion.x", "motion.y", "motion.z" };
	struct image in, out;
	struct gr_diag diag = { 0 };

	(void)state;
	assert_int_equal(image_create(&in, 3, 2, 1), GR_OK);
	in.data[5] = 12.5f;
	assert_int_equal(image_write_exr(exr_path, &in, depth), GR_OK);
	read_back(&out, &diag);
	assert_int_equal(out.channels, 1);
	assert_true(out.data[5] == 12.5f);
	image_finish(&out);
	image_finish(&in);
	assert_int_equal(image_create(&in, 3, 2, 3), GR_OK);
	assert_int_equal(image_write_exr(exr_path, &in, motion), GR_OK);
	assert_int_equal(image_read_exr(exr_path, &out, &diag), GR_ERR_CONFIG);
	assert_int_equal(diag.errors, 1);
	assert_non_null(strstr(diag.items[0].text, "R G B"));
	gr_diag_finish(&diag);
	image_finish(&in);
}

/* Every file that is cut off anywhere is refused with one line that names it. */
static void test_exr_cut(void **state)
{
	struct unit_random random = unit_random_start("exr cut off");
	struct image image;
	uint8_t *bytes;
	size_t len, step;

	(void)state;
	assert_int_equal(image_create(&image, 23, 40, 3), GR_OK);
	fill(&image, &random);
	assert_int_equal(image_write_exr(exr_path, &image, NULL), GR_OK);
	image_finish(&image);
	bytes = load(exr_path, &len);
	step = getenv("GROTTO_LONG") ? 1 : 7;
	for (size_t cut = 0; cut < len; cut += cut < 400 || cut + 40 > len ? 1 : step) {
		uint8_t *copy = unit_copy(bytes, cut);
		struct gr_diag diag = { 0 };

		assert_int_equal(image_decode_exr(copy, cut, "cut.exr", &image, &diag),
				 GR_ERR_CONFIG);
		assert_null(image.data);
		assert_int_equal(diag.errors, 1);
		assert_non_null(strstr(diag.items[0].text, "cut.exr"));
		gr_diag_finish(&diag);
		free(copy);
	}
	printf("# %zu bytes, refused at every length tried\n", len);
	free(bytes);
}

/* Changed bytes may give another picture or a refusal, never a fault. */
static void test_exr_changed(void **state)
{
	struct unit_random random = unit_random_start("exr changed");
	struct image image;
	int rounds = getenv("GROTTO_LONG") ? 20000 : 1000, accepted = 0;
	uint8_t *bytes;
	size_t len;

	(void)state;
	assert_int_equal(image_create(&image, 9, 20, 3), GR_OK);
	assert_int_equal(image_write_exr(exr_path, &image, NULL), GR_OK);
	image_finish(&image);
	bytes = load(exr_path, &len);
	for (int i = 0; i < rounds; i++) {
		uint8_t *copy = unit_copy(bytes, len);
		struct gr_diag diag = { 0 };

		for (uint32_t k = unit_random_u32(&random) % 4; k < 4; k++)
			copy[unit_random_u32(&random) % len] = (uint8_t)unit_random_u32(&random);
		if (image_decode_exr(copy, len, "changed.exr", &image, &diag) == GR_OK)
			accepted++;
		else
			assert_true(diag.errors > 0);
		image_finish(&image);
		gr_diag_finish(&diag);
		free(copy);
	}
	printf("# %d changed files: %d still read\n", rounds, accepted);
	free(bytes);
}

static void test_missing(void **state)
{
	struct gr_diag diag = { 0 };
	struct image image;
	uint8_t *rgb;
	int width, height;

	(void)state;
	assert_int_equal(image_read_exr("nowhere/none.exr", &image, &diag), GR_ERR_CONFIG);
	assert_int_equal(image_read_png("nowhere/none.png", &width, &height, &rgb, &diag),
			 GR_ERR_CONFIG);
	assert_int_equal(image_read_exr(".", &image, &diag), GR_ERR_CONFIG);
	assert_int_equal(diag.errors, 3);
	assert_non_null(strstr(diag.items[0].text, "nowhere/none.exr"));
	assert_non_null(strstr(diag.items[1].text, "No such file"));
	gr_diag_finish(&diag);
	assert_int_equal(image_create(&image, 0, 1, 1), GR_ERR_RANGE);
	assert_int_equal(image_create(&image, 32768, 32768, 3), GR_ERR_RANGE);
	assert_int_equal(image_create(&image, 8, 8, 1), GR_OK);
	assert_int_equal(image_write_exr("nowhere/none.exr", &image, NULL), GR_ERR_IO);
	image_finish(&image);
}

static void test_png(void **state)
{
	struct unit_random random = unit_random_start("png");
	struct gr_diag diag = { 0 };
	uint8_t in[31 * 17 * 3], *out, *bytes;
	int width, height;
	size_t len;

	(void)state;
	for (size_t i = 0; i < sizeof in; i++)
		in[i] = (uint8_t)unit_random_u32(&random);
	assert_int_equal(image_write_png(png_path, 31, 17, in), GR_OK);
	assert_int_equal(image_read_png(png_path, &width, &height, &out, &diag), GR_OK);
	assert_int_equal(width, 31);
	assert_int_equal(height, 17);
	assert_memory_equal(in, out, sizeof in);
	free(out);
	bytes = load(png_path, &len);
	/* libpng forgives the 12 bytes of the end mark, and nothing before it. */
	for (size_t cut = 1; cut < len - 12; cut += 13) {
		FILE *file = fopen(png_path, "wb");

		fwrite(bytes, 1, cut, file);
		fclose(file);
		assert_int_equal(image_read_png(png_path, &width, &height, &out, &diag),
				 GR_ERR_CONFIG);
		assert_null(out);
	}
	gr_diag_finish(&diag);
	free(bytes);
}

/* Files of other programs: Blender (float and half, ZIP), pfstools, mmp's probe. */
static void test_foreign(void **state)
{
	static const struct {
		const char *name;
		int width, height, channels;
	} files[] = {
		{ "reference/renders/a_cornell/camA.exr", 256, 256, 3 },
		{ "reference/renders/a_cornell/camA_indirect.exr", 256, 256, 3 },
		{ "reference/renders/a_cornell/camA_depth.exr", 256, 256, 0 },
		{ "reference/renders/a_cornell/camA_mean8.exr", 32, 32, 3 },
		{ "reference/probes/grace_latlong_512.exr", 512, 256, 3 },
		{ "reference/probes/probe_shared.exr", 512, 256, 3 },
		{ "reference/tonemap/ramp_in.exr", 0, 0, 3 },
		{ "reference/sky/sky_T3_e40.exr", 256, 128, 3 },
	};
	char path[1024];

	(void)state;
	if (!shared_file(files[0].name, path))
		skip();
	for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
		struct gr_diag diag = { 0 };
		struct image image;
		double sum[4] = { 0 };
		int result;

		if (!shared_file(files[i].name, path))
			continue;
		result = image_read_exr(path, &image, &diag);
		gr_diag_log(&diag);
		assert_int_equal(result, GR_OK);
		for (size_t k = 0; k < (size_t)image.width * (size_t)image.height *
					       (size_t)image.channels; k++)
			sum[k % (size_t)image.channels] += (double)image.data[k];
		printf("# %s: %d x %d x %d, mean %.5g %.5g %.5g\n", files[i].name, image.width,
		       image.height, image.channels, sum[0] / (image.width * image.height),
		       sum[1] / (image.width * image.height), sum[2] / (image.width * image.height));
		if (files[i].width)
			assert_int_equal(image.width, files[i].width);
		if (files[i].height)
			assert_int_equal(image.height, files[i].height);
		if (files[i].channels)
			assert_int_equal(image.channels, files[i].channels);
		assert_true(isfinite(sum[0]) && sum[0] > 0);
		image_finish(&image);
	}
}

/*
 * A full disk, at every place in the file: an error with its reason, and no wait
 * (OpenEXR tells of some while it holds its own lock).
 */
static void test_full(void **state)
{
	struct rlimit usual, least;
	struct image image;
	struct stat there;
	int result;

	(void)state;
	assert_int_equal(image_create(&image, 16, 16, 3), GR_OK);
	remove(exr_path);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &usual), 0);
	signal(SIGXFSZ, SIG_IGN);
	for (rlim_t bytes = 0; bytes < 600; bytes += 8) {
		least = (struct rlimit){ bytes, usual.rlim_max };
		assert_int_equal(setrlimit(RLIMIT_FSIZE, &least), 0);
		alarm(20);
		result = image_write_exr(exr_path, &image, NULL);
		alarm(0);
		setrlimit(RLIMIT_FSIZE, &usual);
		if (result == GR_OK) {
			assert_true(bytes > 300);
			break;
		}
		assert_int_equal(result, GR_ERR_IO);
		assert_int_not_equal(stat(exr_path, &there), 0);
	}
	signal(SIGXFSZ, SIG_DFL);
	remove(exr_path);
	assert_int_equal(mkfifo(exr_path, 0600), 0);
	assert_int_equal(image_write_exr(exr_path, &image, NULL), GR_ERR_IO);
	assert_int_equal(stat(exr_path, &there), 0);
	assert_true(S_ISFIFO(there.st_mode));
	image_finish(&image);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_exr_round_trip), cmocka_unit_test(test_exr_named),
		cmocka_unit_test(test_exr_cut),        cmocka_unit_test(test_exr_changed),
		cmocka_unit_test(test_missing),        cmocka_unit_test(test_png),
		cmocka_unit_test(test_foreign),         cmocka_unit_test(test_full),
	};

	gr_log_init("test_image", GR_LOG_INFO);
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
