/* The tracer's parts: sample points, surfaces, lamps, textures, films' files. */
#include "base/result.h"
#include "renderer/scene/texel.h"
#include "renderer/trace/bsdf.h"
#include "renderer/trace/lamps.h"
#include "renderer/trace/medium.h"
#include "renderer/trace/reference.h"
#include "renderer/trace/sampler.h"
#include "tests/unit/unit.h"

#include <float.h>
#include <unistd.h>

#define PI 3.14159265358979323846

/* --- sample points --- */

static void sampler_same_everywhere(void **state)
{
	struct sampler a = sampler_start(7, 1234, 5), b = sampler_start(7, 1234, 5);
	float pair[2], again[2], other[2];

	(void)state;
	sampler_point(&a, 3);
	sampler_point(&b, 3);
	sampler_pair(&a, 9, pair);
	sampler_pair(&b, 9, again);
	assert_memory_equal(pair, again, sizeof(pair));
	/* fixed for ever: films and baked files go on from them */
	assert_true(fabsf(pair[0] - 0.562033117f) < 1e-7f && fabsf(pair[1] - 0.22259891f) < 1e-7f);
	b = sampler_start(8, 1234, 5);
	sampler_point(&b, 3);
	sampler_pair(&b, 9, other);
	assert_memory_not_equal(pair, other, sizeof(pair));
}

/* Each elementary interval of area 1/16 holds one point of 16. */
static void sampler_is_a_net(void **state)
{
	struct unit_random random = unit_random_start("sampler");

	(void)state;
	for (int k = 0; k < 2000; k++) {
		struct sampler s = sampler_start(unit_random_u32(&random), unit_random_u32(&random), 0);
		uint32_t pair = unit_random_u32(&random) % 1000;

		for (int bits = 0; bits <= SAMPLER_SET_BITS; bits++) {
			unsigned seen = 0;

			for (uint32_t i = 0; i < SAMPLER_SET; i++) {
				float p[2];

				sampler_point(&s, i);
				sampler_pair(&s, pair, p);
				assert_true(p[0] >= 0 && p[0] < 1 && p[1] >= 0 && p[1] < 1);
				seen |= 1u << ((unsigned)(p[0] * (float)(1 << bits)) *
						       (unsigned)(SAMPLER_SET >> bits) +
					       (unsigned)(p[1] * (float)(SAMPLER_SET >> bits)));
			}
			assert_int_equal(seen, (1u << SAMPLER_SET) - 1);
		}
	}
}

/* Over many sets every point is uniform, and pairs do not know of each other. */
static void sampler_is_uniform(void **state)
{
	enum { CELLS = 16, SETS = 100000 };
	static unsigned counts[3][CELLS * CELLS];
	double worst = 0;

	(void)state;
	memset(counts, 0, sizeof(counts));
	for (uint64_t set = 0; set < SETS; set++) {
		struct sampler s = sampler_start(1, 2, set);
		float p[2], q[2];

		sampler_point(&s, (uint32_t)(set % SAMPLER_SET));
		sampler_pair(&s, 4, p);
		sampler_pair(&s, 5, q);
		counts[0][(int)(p[0] * CELLS) * CELLS + (int)(p[1] * CELLS)]++;
		counts[1][(int)(p[0] * CELLS) * CELLS + (int)(q[0] * CELLS)]++;
		counts[2][(int)(p[1] * CELLS) * CELLS + (int)(q[0] * CELLS)]++;
	}
	for (int k = 0; k < 3; k++) {
		double want = (double)SETS / (CELLS * CELLS), chi2 = 0;

		for (int i = 0; i < CELLS * CELLS; i++)
			chi2 += (counts[k][i] - want) * (counts[k][i] - want) / want;
		worst = fmax(worst, chi2);
	}
	/* 255 degrees of freedom: 1e-6 of chance are above 374 */
	printf("# sample points: worst chi-square %.0f of 255 degrees of freedom\n", worst);
	assert_true(worst < 374);
}

/* --- surfaces --- */

struct surface {
	const char *name;
	struct scene_material material;
	float diffuse, specular;
	bool exact; /* no direction is drawn below the horizon */
};

static const struct surface surfaces[] = {
	{ "Lambert", { .kind = MATERIAL_PHONG }, 0.7f, 0, true },
	{ "Blinn-Phong 0", { .kind = MATERIAL_PHONG, .shininess = 0 }, 0.2f, 0.5f, false },
	{ "Blinn-Phong 20", { .kind = MATERIAL_PHONG, .shininess = 20 }, 0.3f, 0.4f, false },
	{ "Blinn-Phong 400", { .kind = MATERIAL_PHONG, .shininess = 400 }, 0, 0.9f, false },
	{ "GGX 0.05", { .kind = MATERIAL_CONDUCTOR, .alpha = 0.05f }, 0, 0.9f, false },
	{ "GGX 0.5", { .kind = MATERIAL_CONDUCTOR, .alpha = 0.5f }, 0, 0.8f, false },
	{ "GGX 1", { .kind = MATERIAL_CONDUCTOR, .alpha = 1 }, 0, 0.8f, false },
};

static void make(const struct surface *s, struct v3 viewer, struct bsdf *out)
{
	const struct scene scene = { 0 };
	const struct v3 up = v3_unit((struct v3){ 0.2f, 0.9f, -0.3f });

	bsdf_init(out, &scene, &s->material, v3_all(s->diffuse), v3_all(s->specular), up, up, viewer);
}

static struct v3 seen_from(float cosine)
{
	const struct v3_frame f = v3_frame_of(v3_unit((struct v3){ 0.2f, 0.9f, -0.3f }));

	return v3_from_local(&f, (struct v3){ 0.6f * sqrtf(1 - cosine * cosine),
					      0.8f * sqrtf(1 - cosine * cosine), cosine });
}

enum { DRAWS = 200000, BINS_Z = 12, BINS_PHI = 16, BINS = BINS_Z * BINS_PHI };

/* The density, summed over the hemisphere in fine cells, and into coarse bins. */
static double integrate(const struct bsdf *b, struct v3 viewer, double bins[BINS])
{
	enum { FINE = 128 };
	const int nz = BINS_Z * FINE, nphi = BINS_PHI * FINE / 4;
	double sum = 0;

	memset(bins, 0, BINS * sizeof(*bins));
	for (int i = 0; i < nz; i++) {
		for (int j = 0; j < nphi; j++) {
			double z = (i + 0.5) / nz, phi = 2 * PI * (j + 0.5) / nphi;
			double r = sqrt(1 - z * z), cell = 2 * PI / nz / nphi;
			float pdf;

			bsdf_eval(b, viewer,
				  v3_from_local(&b->frame, (struct v3){ (float)(r * cos(phi)),
									(float)(r * sin(phi)), (float)z }),
				  &pdf);
			sum += (double)pdf * cell;
			bins[i / FINE * BINS_PHI + j * BINS_PHI / nphi] += (double)pdf * cell;
		}
	}
	return sum;
}

/* Pearson's statistic in standard deviations over its mean; bins that hold too few go together. */
static double excess(const unsigned *counts, const double *bins, double draws)
{
	double chi2 = 0, few_want = 0, few = 0;
	int freedom = 0;

	for (int i = 0; i < BINS; i++) {
		double want = bins[i] * draws;

		if (want < 10) {
			few_want += want;
			few += counts[i];
			continue;
		}
		chi2 += (counts[i] - want) * (counts[i] - want) / want;
		freedom++;
	}
	if (few_want > 5) {
		chi2 += (few - few_want) * (few - few_want) / few_want;
		freedom++;
	}
	return (chi2 - freedom) / sqrt(2.0 * fmax(freedom, 1));
}

/* Directions are drawn with the density that bsdf_eval says, and weights are f cos over it. */
static void surfaces_draw_as_they_say(void **state)
{
	static const float cosines[] = { 0.95f, 0.5f, 0.15f };
	static unsigned counts[BINS];
	static double bins[BINS];
	struct unit_random random = { 99 };

	(void)state;
	for (size_t s = 0; s < sizeof(surfaces) / sizeof(surfaces[0]); s++) {
		for (size_t k = 0; k < sizeof(cosines) / sizeof(cosines[0]); k++) {
			struct v3 viewer = seen_from(cosines[k]);
			double sum, off, drawn = 0;
			struct bsdf b;

			make(&surfaces[s], viewer, &b);
			sum = integrate(&b, viewer, bins);
			memset(counts, 0, sizeof(counts));
			for (int i = 0; i < DRAWS; i++) {
				float u[2] = { (float)unit_random_range(&random, 0, 1),
					       (float)unit_random_range(&random, 0, 1) };
				struct v3 light, weight, l, f;
				float pdf, again;
				double phi;

				u[0] = fminf(u[0], 1 - 0x1p-24f);
				u[1] = fminf(u[1], 1 - 0x1p-24f);
				if (!bsdf_sample(&b, viewer, (float)unit_random_range(&random, 0, 0.9999),
						 u, &light, &weight, &pdf))
					continue;
				drawn++;
				assert_true(v3_finite(weight) && pdf > 0);
				f = bsdf_eval(&b, viewer, light, &again);
				assert_true(fabsf(again - pdf) <= 0.02f * pdf);
				assert_true(fabsf(f.y - weight.y * pdf) <= 0.02f * f.y + 1e-4f);
				l = v3_to_local(&b.frame, light);
				phi = atan2((double)l.y, (double)l.x);
				phi = phi < 0 ? phi + 2 * PI : phi;
				counts[(int)fmin(l.z * BINS_Z, BINS_Z - 1) * BINS_PHI +
				       (int)fmin(phi / (2 * PI) * BINS_PHI, BINS_PHI - 1)]++;
			}
			off = excess(counts, bins, DRAWS);
			printf("# %-15s cos %.2f: density sums to %.4f, drawn %.4f; chi-square %+.1f sd\n",
			       surfaces[s].name, (double)cosines[k], sum, drawn / DRAWS, off);
			assert_true(fabs(sum - drawn / DRAWS) < 0.006);
			assert_true(!surfaces[s].exact || fabs(sum - 1) < 1e-3);
			assert_true(off < 6);
		}
	}
}

/* The same both ways: f(v, l) cos l / cos l. */
static void surfaces_are_reciprocal(void **state)
{
	struct unit_random random = unit_random_start("reciprocal");

	(void)state;
	for (int i = 0; i < 20000; i++) {
		const struct surface *s = &surfaces[unit_random_u32(&random) % 7];
		float cv = (float)unit_random_range(&random, 0.05, 1), pdf;
		struct v3 v = seen_from(cv), l, there, back;
		struct bsdf b;

		make(s, v, &b);
		float z = (float)unit_random_range(&random, 0.05, 1), r = sqrtf(1 - z * z);
		float phi = (float)unit_random_range(&random, 0, 2 * PI);

		l = v3_from_local(&b.frame, (struct v3){ r * cosf(phi), r * sinf(phi), z });
		there = v3_scale(bsdf_eval(&b, v, l, &pdf), 1 / z);
		make(s, l, &b);
		back = v3_scale(bsdf_eval(&b, l, v, &pdf), 1 / v3_to_local(&b.frame, v).z);
		assert_true(fabsf(there.x - back.x) <= 1e-3f * (there.x + back.x) + 1e-6f);
	}
}

static void no_light_from_behind(void **state)
{
	const struct v3 facing = { 0, 1, 0 }, leaning = v3_unit((struct v3){ 0.8f, 0.6f, 0 });
	const struct v3 below = v3_unit((struct v3){ 1, -0.2f, 0 }), viewer = { 0, 1, 0 };
	const struct scene scene = { 0 };
	struct bsdf b;
	float pdf;

	(void)state;
	for (size_t s = 0; s < sizeof(surfaces) / sizeof(surfaces[0]); s++) {
		bsdf_init(&b, &scene, &surfaces[s].material, v3_all(surfaces[s].diffuse),
			  v3_all(surfaces[s].specular), facing, leaning, viewer);
		assert_true(v3_black(bsdf_eval(&b, viewer, below, &pdf)));
		assert_float_equal(pdf, 0, 0);
	}
}

/* --- lamps, medium, textures --- */

static void lamp_cone_as_shaders(void **state)
{
	struct scene_lamp lamp = { .kind = SCENE_LAMP_SPOT, .on = true, .direction = { 0, -1, 0 },
				   .intensity = { 2, 2, 2 }, .cone_rad = 1.2f, .penumbra_rad = 0.2f };
	struct scene_file file = { .lamps = &lamp, .lamp_count = 1 };
	struct render_frame frame = { 0 };
	struct lamps lamps;

	(void)state;
	frame.lamps[0] = (struct frame_lamp){ .on = true, .direction = { 0, -1, 0 },
					      .position = { 0, 3, 0 }, .intensity = { 2, 2, 2 } };
	lamps_init(&lamps, &file, &frame, false);
	assert_int_equal(lamps.count, 1);
	for (float angle = 0; angle < 0.7f; angle += 0.05f) {
		struct v3 p = { 3 * tanf(angle), 0, 0 };
		struct lamp_light light = lamp_light(&lamps.lamps[0], p, NULL);
		float umbra = cosf(0.6f), soft = cosf(0.4f), d2 = p.x * p.x + 9;
		float want = fminf(fmaxf((cosf(angle) - umbra) / (soft - umbra), 0), 1) * 2 / d2;

		assert_float_equal(light.irradiance.y, want, 2e-6);
		assert_float_equal(light.distance, sqrtf(d2), 1e-5);
	}
	frame.lamps[0].on = false;
	lamps_init(&lamps, &file, &frame, false);
	assert_int_equal(lamps.count, 0);
	frame.lamps[0].on = true;
	frame.lamps[0].intensity[1] = NAN;
	lamps_init(&lamps, &file, &frame, false);
	assert_int_equal(lamps.count, 0);
}

/* Drawn and met agree: radiance, density, distance. */
static void soft_lamps_are_met(void **state)
{
	struct scene_lamp lamp = { .kind = SCENE_LAMP_POINT, .radius_m = 0.3f };
	struct scene_file file = { .lamps = &lamp, .lamp_count = 1 };
	struct unit_random random = { 3 };
	struct render_frame frame = { 0 };
	struct lamps lamps;
	double sum = 0;

	(void)state;
	frame.lamps[0] = (struct frame_lamp){ .on = true, .direction = { 0, -1, 0 },
					      .position = { 0, 2, 0 }, .intensity = { 5, 5, 5 } };
	lamps_init(&lamps, &file, &frame, true);
	assert_int_equal(lamps.extended, 1);
	for (int i = 0; i < 1000; i++) {
		float u[2] = { (float)unit_random_range(&random, 0, 0.999),
			       (float)unit_random_range(&random, 0, 0.999) };
		struct lamp_light light = lamp_light(&lamps.lamps[0], v3_all(0), u);
		struct v3 radiance;
		float pdf;

		assert_true(lamp_met(&lamps.lamps[0], v3_all(0), light.direction, INFINITY, &radiance,
				     &pdf));
		assert_float_equal(pdf, light.pdf, 1e-3f * pdf);
		assert_float_equal(radiance.x / pdf, light.irradiance.x, 1e-3f * light.irradiance.x);
		assert_false(lamp_met(&lamps.lamps[0], v3_all(0), light.direction,
				      light.distance - 1e-3f, &radiance, &pdf));
		sum += (double)(light.irradiance.x * light.direction.y) / 1000;
	}
	/* a sphere of radiance I/(pi r^2) gives what its point would: I/d^2 */
	assert_float_equal((float)sum, 1.25f, 0.002f);
}

static void medium_as_shaders(void **state)
{
	const float min[3] = { -1, -1, -1 }, max[3] = { 1, 1, 1 };
	struct medium m;

	(void)state;
	medium_init(&m, 0.1f, 0, min, max);
	assert_float_equal(medium_passes(&m, v3_all(0), (struct v3){ 1, 0, 0 }, 4), 0.6561f, 1e-5f);
	assert_float_equal(medium_passes(&m, v3_all(0), (struct v3){ 1, 0, 0 }, INFINITY), 0.9f, 1e-5f);
	medium_init(&m, 0.06f, 0.04f, min, max);
	assert_float_equal(m.albedo, 0.4f, 1e-6f);
	assert_float_equal(expf(-m.extinction), 0.9f, 1e-6f);
	medium_init(&m, 0, 0, min, max);
	assert_float_equal(medium_passes(&m, v3_all(0), (struct v3){ 1, 0, 0 }, 1e9f), 1, 0);
	medium_init(&m, 60, 60, min, max);
	assert_float_equal(medium_passes(&m, v3_all(0), (struct v3){ 1, 0, 0 }, 1), 0, 0);
}

static void texels_as_gl(void **state)
{
	uint8_t rgba[2 * 2 * 4] = { 0, 0, 0, 255, 255, 0, 0, 255, 0, 255, 0, 255, 255, 255, 0, 255 };
	const struct scene_image image = { .width = 2, .height = 2, .rgba = rgba };
	const struct { float uv[2], want[2]; } cases[] = {
		{ { 0.25f, 0.25f }, { 0, 0 } },	    { { 0.75f, 0.25f }, { 1, 0 } },
		{ { 0.5f, 0.25f }, { 0.5f, 0 } },   { { 0, 0.75f }, { 0.5f, 1 } },
		{ { -0.25f, 1.75f }, { 1, 1 } },    { { NAN, 0.25f }, { 0.5f, 0 } },
		{ { 1e30f, INFINITY }, { 0.5f, 0.5f } },
	};
	struct texel_curve curve;
	float out[3];

	(void)state;
	texel_curve_init(&curve);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		texel_at(&curve, &image, cases[i].uv, out);
		assert_float_equal(out[0], cases[i].want[0], 1e-6f);
		assert_float_equal(out[1], cases[i].want[1], 1e-6f);
	}
	assert_float_equal(curve.srgb[188], 0.5029f, 1e-3f);
}

/* --- films' files --- */

#define FILM_PIXELS 6

static void fill_film(struct reference_film *film)
{
	double **sums[] = { &film->radiance, &film->squares, &film->indirect,
			    &film->indirect_squares };

	memset(film, 0, sizeof(*film));
	film->width = 3;
	film->height = 2;
	film->samples = 48;
	film->seed = 77;
	film->nonfinite = 2;
	memset(film->key, 0xa5, sizeof(film->key));
	for (int s = 0; s < 4; s++) {
		*sums[s] = calloc(3 * FILM_PIXELS, sizeof(double));
		assert_non_null(*sums[s]);
		for (int i = 0; i < 3 * FILM_PIXELS; i++)
			(*sums[s])[i] = 0.1 * (i + 1) + s;
	}
}

static uint8_t *slurp(const char *path, size_t *len)
{
	FILE *f = fopen(path, "rb");
	uint8_t *bytes = malloc(1 << 16);

	assert_true(f && bytes);
	*len = fread(bytes, 1, 1 << 16, f);
	fclose(f);
	return bytes;
}

static int parse(const uint8_t *bytes, size_t len)
{
	struct reference_film film = { 0 };
	struct gr_diag diag = { 0 };
	uint8_t *copy = unit_copy(bytes, len);
	int result = reference_film_parse(&film, copy, len, "film", &diag);

	assert_true((result == GR_OK) == (diag.count == 0));
	assert_true((result == GR_OK) == (film.radiance != NULL));
	reference_film_finish(&film);
	gr_diag_finish(&diag);
	free(copy);
	return result;
}

static void films_come_back(void **state)
{
	struct reference_film film, again = { 0 };
	struct gr_diag diag = { 0 };
	char path[64];
	uint8_t *bytes;
	size_t len;

	(void)state;
	snprintf(path, sizeof(path), "test_trace.%ld.film", (long)getpid());
	fill_film(&film);
	assert_int_equal(reference_film_save(&film, path), GR_OK);
	assert_int_equal(reference_film_load(&again, path, &diag), GR_OK);
	assert_int_equal(diag.count, 0);
	assert_int_equal(again.samples, 48);
	assert_true(again.seed == 77 && again.nonfinite == 2);
	assert_memory_equal(again.key, film.key, sizeof(film.key));
	assert_memory_equal(again.indirect_squares, film.indirect_squares,
			    3 * FILM_PIXELS * sizeof(double));
	reference_film_finish(&again);

	bytes = slurp(path, &len);
	for (size_t cut = 0; cut < len; cut++)
		assert_int_equal(parse(bytes, cut), GR_ERR_FORMAT);
	for (size_t at = 0; at < len; at++) {
		int result;

		bytes[at] ^= 0x10;
		result = parse(bytes, len);
		assert_true(result == GR_ERR_FORMAT || (at >= 8 && at < 12 && result == GR_ERR_VERSION));
		bytes[at] ^= 0x10;
	}
	assert_int_equal(parse(bytes, len), GR_OK);
	free(bytes);
	reference_film_finish(&film);
	remove(path);
	assert_int_equal(reference_film_load(&again, path, &diag), GR_ERR_IO);
	assert_int_equal(diag.errors, 1);
	gr_diag_finish(&diag);
}

/* A film that says `sum`, with a checksum that fits: does it come back? */
static int comes_back_with(double sum, bool alone)
{
	struct reference_film film, again = { 0 };
	struct gr_diag diag = { 0 };
	char path[64];
	int result;

	snprintf(path, sizeof(path), "test_trace.%ld.film", (long)getpid());
	fill_film(&film);
	for (int i = 0; alone && i < 3 * FILM_PIXELS; i++)
		film.radiance[i] = film.squares[i] = 0;
	film.radiance[1] = sum;
	assert_int_equal(reference_film_save(&film, path), GR_OK);
	result = reference_film_load(&again, path, &diag);
	remove(path);
	if (result == GR_OK)
		assert_true(isfinite(reference_film_error(&again)));
	reference_film_finish(&again);
	reference_film_finish(&film);
	gr_diag_finish(&diag);
	return result;
}

/* Sums whose squares would not be finite are none of light: an error from them would be NaN. */
static void sums_of_a_film_have_a_range(void **state)
{
	static const double good[] = { 0.0, 5e-324, 1e-321, (double)FLT_MAX * 0x1p30 };
	static const double bad[] = { 1e300, -1e300, (double)INFINITY, (double)NAN };

	(void)state;
	for (int alone = 0; alone < 2; alone++)
		for (int i = 0; i < 4; i++) {
			assert_int_equal(comes_back_with(good[i], alone), GR_OK);
			assert_int_equal(comes_back_with(bad[i], alone), GR_ERR_FORMAT);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sampler_same_everywhere),
		cmocka_unit_test(sampler_is_a_net),
		cmocka_unit_test(sampler_is_uniform),
		cmocka_unit_test(surfaces_draw_as_they_say),
		cmocka_unit_test(surfaces_are_reciprocal),
		cmocka_unit_test(no_light_from_behind),
		cmocka_unit_test(lamp_cone_as_shaders),
		cmocka_unit_test(soft_lamps_are_met),
		cmocka_unit_test(medium_as_shaders),
		cmocka_unit_test(texels_as_gl),
		cmocka_unit_test(films_come_back),
		cmocka_unit_test(sums_of_a_film_have_a_range),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
