/* Radiance pictures in all their codings, damaged ones, and cubes laid out as pictures. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/image/image.h"
#include "renderer/scene/environment.h"
#include "renderer/scene/environment_cube.h"
#include "tests/unit/shared.h"

#include <unistd.h>

#define WIDTH 300
#define HEIGHT 5

static int decode(const uint8_t *bytes, size_t len, struct image *out)
{
	struct gr_diag diag = { 0 };
	uint8_t *exact = unit_copy(bytes, len);
	int r = image_decode_light(exact, len, "test.hdr", out, &diag);

	free(exact);
	assert_true(r == GR_OK ? out->data && !diag.count : !out->data && diag.count == 1);
	gr_diag_finish(&diag);
	return r;
}

static size_t start_file(uint8_t *bytes, const char *more)
{
	return (size_t)sprintf((char *)bytes, "#?RADIANCE\n# by hand\n%sFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n",
			       more, HEIGHT, WIDTH);
}

/* Runs and steps: exponents that stay, bands that change. */
static void pixel_of(int x, int y, uint8_t out[4])
{
	out[0] = (uint8_t)(128 + x / 40);
	out[1] = (uint8_t)(x * 7 + y);
	out[2] = (uint8_t)(x < 150 ? 9 : x);
	out[3] = (uint8_t)(x % 100 < 60 ? 130 : 120 + y);
}

static size_t write_flat(uint8_t *bytes, const char *more)
{
	size_t len = start_file(bytes, more);

	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++, len += 4)
			pixel_of(x, y, bytes + len);
	return len;
}

/* Every pixel that is like the one before it goes into the count. */
static size_t write_old(uint8_t *bytes)
{
	size_t len = start_file(bytes, "");

	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH;) {
			uint8_t p[4], next[4];
			int run = 0;

			pixel_of(x++, y, p);
			p[1] = 50; /* so that there are runs */
			memcpy(bytes + len, p, 4);
			len += 4;
			for (; x < WIDTH; x++, run++) {
				pixel_of(x, y, next);
				next[1] = 50;
				if (memcmp(next, p, 4))
					break;
			}
			for (; run; run >>= 8, len += 4)
				memcpy(bytes + len, (uint8_t[4]){ 1, 1, 1, (uint8_t)run }, 4);
		}
	return len;
}

static size_t write_planes(uint8_t *bytes)
{
	size_t len = start_file(bytes, "");

	for (int y = 0; y < HEIGHT; y++) {
		memcpy(bytes + len, (uint8_t[4]){ 2, 2, WIDTH >> 8, WIDTH & 255 }, 4);
		len += 4;
		for (int plane = 0; plane < 4; plane++)
			for (int x = 0; x < WIDTH;) {
				uint8_t p[4], next[4];
				int run = 1;

				pixel_of(x, y, p);
				for (; x + run < WIDTH && run < 127; run++) {
					pixel_of(x + run, y, next);
					if (next[plane] != p[plane])
						break;
				}
				bytes[len++] = (uint8_t)(run > 1 ? 128 + run : 1);
				bytes[len++] = p[plane];
				x += run;
			}
	}
	return len;
}

static void codings(void **state)
{
	static uint8_t bytes[1 << 16];
	struct image flat, other;

	(void)state;
	assert_int_equal(decode(bytes, write_flat(bytes, ""), &flat), GR_OK);
	assert_int_equal(flat.width, WIDTH);
	/* 128.5 / 256 * 2^(130 - 128) */
	assert_true(flat.data[0] == 128.5f / 64);
	assert_int_equal(decode(bytes, write_planes(bytes), &other), GR_OK);
	assert_memory_equal(flat.data, other.data, sizeof(float) * 3 * WIDTH * HEIGHT);
	image_finish(&other);
	assert_int_equal(decode(bytes, write_old(bytes), &other), GR_OK);
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		assert_true(flat.data[3 * i] == other.data[3 * i]);
		assert_true(flat.data[3 * i + 2] == other.data[3 * i + 2]);
	}
	image_finish(&other);
	assert_int_equal(decode(bytes, write_flat(bytes, "EXPOSURE=2\nVIEW=-vta\nEXPOSURE=4.0\n"), &other), GR_OK);
	for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
		assert_true(flat.data[i] == 8 * other.data[i]);
	image_finish(&other);
	image_finish(&flat);
}

static void damaged(void **state)
{
	static const char *const heads[] = {
		"", "#", "#?", "#?RADIANCE\n", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n-Y 1 +X 1\n\1\1\1\1",
		"#?RADIANCE\n\n-Y 1 +X 1\n\1\2\3\4", "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\1\2\3\4",
		"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n+X 1 -Y 1\n\1\2\3\4",
		"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 1\n\1\2\3\4",
		"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 99999999999 +X 1\n\1\2\3\4",
		"#?RADIANCE\nEXPOSURE=0\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\1\2\3\4",
		"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\1\1\1\2\1\2\3\4",
		"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 3\n\5\5\5\5\1\1\1\4",
	};
	size_t (*const writers[])(uint8_t *) = { write_old, write_planes };
	struct unit_random random = unit_random_start("hdr");
	static uint8_t bytes[1 << 16];
	struct image image;

	(void)state;
	for (size_t i = 0; i < sizeof heads / sizeof *heads; i++)
		assert_int_equal(decode((const uint8_t *)heads[i], strlen(heads[i]), &image), GR_ERR_CONFIG);
	for (int w = 0; w < 2; w++) {
		size_t len = writers[w](bytes);

		for (size_t cut = 0; cut < len; cut += 1 + unit_random_u32(&random) % 7)
			assert_int_equal(decode(bytes, cut, &image), GR_ERR_CONFIG);
		for (int k = 0; k < 2000; k++) {
			size_t at = unit_random_u32(&random) % len;
			uint8_t was = bytes[at];

			bytes[at] = (uint8_t)unit_random_u32(&random);
			decode(bytes, len, &image);
			image_finish(&image);
			bytes[at] = was;
		}
	}
}

/* The probe that is there in both formats: within a 256th of the largest band. */
static void probe(void **state)
{
	struct gr_diag diag = { 0 };
	struct image hdr, exr;
	char path[1024];
	double worst = 0, sum[2] = { 0 };

	(void)state;
	if (!shared_file("reference/probes/probe_shared.hdr", path))
		skip();
	assert_int_equal(image_read_light(path, &hdr, &diag), GR_OK);
	assert_non_null(shared_file("reference/probes/probe_shared.exr", path));
	assert_int_equal(image_read_light(path, &exr, &diag), GR_OK);
	assert_int_equal(hdr.width, exr.width);
	for (int i = 0; i < hdr.width * hdr.height; i++) {
		const float *a = hdr.data + 3 * i, *b = exr.data + 3 * i;
		double most = fmax((double)b[0], fmax((double)b[1], (double)b[2]));

		for (int c = 0; c < 3 && most > 1e-4; c++) {
			worst = fmax(worst, fabs((double)a[c] - (double)b[c]) / most);
			sum[0] += (double)a[c];
			sum[1] += (double)b[c];
		}
	}
	printf("# probe_shared as RGBE: a band off by %.2e of the largest, all light by %.1e\n", worst,
	       sum[0] / sum[1] - 1);
	assert_true(worst < 1.0 / 128);
	assert_true(fabs(sum[0] / sum[1] - 1) < 2e-3);
	image_finish(&hdr);
	image_finish(&exr);
}

/* Smooth, and different in all directions. */
static void light_of(const double d[3], float out[3])
{
	out[0] = (float)(2 + d[0] + 0.5 * d[1] * d[2]);
	out[1] = (float)(2 + d[1] - 0.5 * d[0] * d[2]);
	out[2] = (float)(2 + d[2] + 0.5 * d[0] * d[1]);
}

/* Right, down and middle of each square, written out as the header has them. */
static void make_faces(struct image faces[6], int side)
{
	static const double right[6][3] = { { 0, 0, 1 }, { 0, 0, -1 }, { 1, 0, 0 },
					    { 1, 0, 0 }, { -1, 0, 0 }, { 1, 0, 0 } };
	static const double down[6][3] = { { 0, -1, 0 }, { 0, -1, 0 }, { 0, 0, -1 },
					   { 0, 0, 1 },	 { 0, -1, 0 }, { 0, -1, 0 } };
	static const double middle[6][3] = { { 1, 0, 0 },  { -1, 0, 0 }, { 0, 1, 0 },
					     { 0, -1, 0 }, { 0, 0, 1 },	 { 0, 0, -1 } };

	for (int f = 0; f < 6; f++) {
		assert_int_equal(image_create(&faces[f], side, side, 3), GR_OK);
		for (int y = 0; y < side; y++)
			for (int x = 0; x < side; x++) {
				double s = (2 * x + 1.0) / side - 1, t = (2 * y + 1.0) / side - 1;
				double n = sqrt(1 + s * s + t * t), d[3];

				for (int k = 0; k < 3; k++)
					d[k] = (middle[f][k] + s * right[f][k] + t * down[f][k]) / n;
				light_of(d, faces[f].data + 3 * (y * side + x));
			}
	}
}

static void paste(struct image *cross, const struct image *face, int column, int row, bool turned)
{
	const int n = face->width;

	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++)
			memcpy(cross->data + 3 * ((row * n + y) * cross->width + column * n + x),
			       face->data + 3 * (turned ? (n - 1 - y) * n + n - 1 - x : y * n + x),
			       3 * sizeof(float));
}

static void cubes(void **state)
{
	static const int lying[6][2] = { { 2, 1 }, { 0, 1 }, { 1, 0 }, { 1, 2 }, { 3, 1 }, { 1, 1 } };
	struct image faces[6], all, cross, other;
	struct gr_diag diag = { 0 };
	const int side = 32;
	double worst = 0;

	(void)state;
	make_faces(faces, side);
	assert_int_equal(cube_unfold(faces, "test", &all, &diag), GR_OK);
	assert_int_equal(all.width, 4 * side);
	for (int y = 0; y < all.height; y++)
		for (int x = 0; x < all.width; x++) {
			double v = (y + 0.5) / all.height, p = 2 * M_PI * ((x + 0.5) / all.width - 0.5);
			const double d[3] = { sin(M_PI * v) * cos(p), cos(M_PI * v), sin(M_PI * v) * sin(p) };
			float want[3];

			light_of(d, want);
			for (int c = 0; c < 3; c++)
				worst = fmax(worst, fabs((double)all.data[3 * (y * all.width + x) + c] -
							 (double)want[c]));
		}
	printf("# a cube of %d pixels a side: light of 0.5 to 3.5 off by %.1e\n", side, worst);
	assert_true(worst < 0.003);
	for (int stands = 0; stands < 2; stands++) {
		assert_int_equal(image_create(&cross, (stands ? 3 : 4) * side, (stands ? 4 : 3) * side, 3), GR_OK);
		for (int f = 0; f < 6; f++)
			if (stands && f == CUBE_PZ)
				paste(&cross, &faces[f], 1, 3, true);
			else
				paste(&cross, &faces[f], lying[f][0], lying[f][1], false);
		assert_int_equal(cube_unfold_cross(&cross, "test", &other, &diag), GR_OK);
		assert_memory_equal(all.data, other.data, sizeof(float) * 3 * (size_t)(all.width * all.height));
		image_finish(&other);
		cross.width--;
		assert_int_equal(cube_unfold_cross(&cross, "test", &other, &diag), GR_ERR_CONFIG);
		image_finish(&cross);
	}
	faces[3].width = faces[3].height = side - 1;
	image_finish(&all);
	assert_int_equal(cube_unfold(faces, "test", &all, &diag), GR_ERR_CONFIG);
	for (int f = 0; f < 6; f++)
		image_finish(&faces[f]);
	gr_diag_finish(&diag);
}

/* Six files by one name, as a scene file has it. */
static void six_files(void **state)
{
	static const char *const names[] = { "px", "nx", "py", "ny", "pz", "nz" };
	char folder[] = "/tmp/grotto-cube-XXXXXX", path[64], text[256];
	struct environment *e;
	struct scene_file *file;
	struct gr_diag diag = { 0 };
	struct image faces[6];

	(void)state;
	assert_non_null(mkdtemp(folder));
	make_faces(faces, 16);
	for (int f = 0; f < 6; f++) {
		snprintf(path, sizeof path, "%s/sky_%s.exr", folder, names[f]);
		assert_int_equal(image_write_exr(path, &faces[f], NULL), GR_OK);
		image_finish(&faces[f]);
	}
	snprintf(text, sizeof text, "model = \"m.obj\"; environment = { kind = \"image\"; projection = \"faces\"; "
		 "file = \"%s/sky_*.exr\"; };", folder);
	assert_int_equal(scene_file_parse(text, strlen(text), "test.cfg", &file, &diag), GR_OK);
	assert_int_equal(environment_create(&e, file, &diag), GR_OK);
	for (int k = 0; k < 6; k++) {
		float d[3] = { 0 }, got[3], want[3];

		d[k / 2] = k % 2 ? -1 : 1;
		environment_radiance(e, d, got);
		light_of((const double[3]){ (double)d[0], (double)d[1], (double)d[2] }, want);
		for (int c = 0; c < 3; c++)
			assert_true(fabsf(got[c] - want[c]) < 0.1f);
	}
	environment_destroy(&e);
	snprintf(path, sizeof path, "%s/sky_py.exr", folder);
	assert_int_equal(unlink(path), 0);
	assert_int_equal(environment_create(&e, file, &diag), GR_ERR_CONFIG);
	assert_non_null(strstr(diag.items[diag.count - 1].text, "sky_py.exr"));
	for (int f = 0; f < 6; f++) {
		snprintf(path, sizeof path, "%s/sky_%s.exr", folder, names[f]);
		unlink(path);
	}
	rmdir(folder);
	scene_file_destroy(&file);
	gr_diag_finish(&diag);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(codings), cmocka_unit_test(damaged), cmocka_unit_test(probe),
		cmocka_unit_test(cubes),   cmocka_unit_test(six_files),
	};

	gr_log_init("test_light_pictures", GR_LOG_WARNING);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
