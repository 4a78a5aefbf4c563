/* Measured BRDFs: what a table gives back, how it is sampled, and texts that are none. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/scene/brdf_read.h"
#include "renderer/scene/brdf_table.h"
#include "tests/unit/shared.h"

#include <math.h>

#define WAVELENGTHS 31

typedef double brdf_function(double theta_i, double theta_o, double phi);

static double lambert(double theta_i, double theta_o, double phi)
{
	(void)theta_i;
	(void)theta_o;
	(void)phi;
	return 0.6 / M_PI;
}

/* Blinn-Phong, exponent 20, half of it diffuse. */
static double glossy(double theta_i, double theta_o, double phi)
{
	double h[3] = { sin(theta_i) + sin(theta_o) * cos(phi), sin(theta_o) * sin(phi),
			cos(theta_i) + cos(theta_o) };
	double c = h[2] / sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);

	return 0.3 / M_PI + 0.3 * 28 / (8 * M_PI) * pow(c, 20);
}

/* A text like the goniometer's, every 10 degrees, of the same value at each wavelength. */
static char *write_text(brdf_function *f, double scale, size_t *len)
{
	const size_t room = 8 * 1024 * 1024;
	char *text = malloc(room);
	size_t n;

	if (!text)
		abort();
	n = (size_t)snprintf(text, room, "# a test\n%d\n", WAVELENGTHS);
	for (int w = 0; w < WAVELENGTHS; w++)
		n += (size_t)snprintf(text + n, room - n, "%d ", 400 + 10 * w);
	for (int i = 1; i <= 8; i++) {
		for (int o = 0; o <= 8; o++) {
			for (int p = 0; p <= 18; p++) {
				double theta_i = i * M_PI / 18, theta_o = o * M_PI / 18;
				double phi = p * M_PI / 18;

				n += (size_t)snprintf(text + n, room - n, "\n%.6f 0 %.6f %.6f", theta_i,
						      theta_o, phi);
				for (int w = 0; w < WAVELENGTHS; w++)
					n += (size_t)snprintf(text + n, room - n, " %.7g",
							      scale * f(theta_i, theta_o, phi));
			}
		}
	}
	*len = n;
	return text;
}

static struct brdf_table *table_of(brdf_function *f)
{
	struct gr_diag diag = { 0 };
	struct brdf_table *t;
	size_t len;
	char *text = write_text(f, 1, &len);

	assert_int_equal(brdf_table_parse(&t, text, len, "test", &diag), GR_OK);
	gr_diag_finish(&diag);
	free(text);
	return t;
}

static void direction(double theta, double phi, float out[3])
{
	out[0] = (float)(sin(theta) * cos(phi));
	out[1] = (float)(sin(theta) * sin(phi));
	out[2] = (float)cos(theta);
}

static void flat(void **state)
{
	struct brdf_table *t = table_of(lambert);
	const struct brdf_table_facts *facts = brdf_table_facts(t);
	float wi[3], wo[3], f[3];

	(void)state;
	direction(0.4, 1, wi);
	direction(1.2, 3, wo);
	brdf_table_evaluate(t, wi, wo, f);
	for (int c = 0; c < 3; c++) {
		assert_true(fabs((double)f[c] * M_PI / 0.6 - 1) < 1e-5);
		assert_true(fabs((double)facts->reflectance[c] / 0.6 - 1) < 1e-3);
		assert_true(fabs((double)facts->normal[c] / 0.6 - 1) < 1e-3);
	}
	assert_false(facts->limited);
	assert_int_equal(facts->samples, 8 * 9 * 19);
	wi[2] = -wi[2];
	brdf_table_evaluate(t, wi, wo, f);
	assert_true(f[0] == 0);
	assert_true(brdf_table_pdf(t, wo, wi) == 0);
	brdf_table_destroy(&t);
}

/* Reciprocity, turning about the normal, mirroring: to rounding. */
static void check_symmetry(const struct brdf_table *t)
{
	struct unit_random random = unit_random_start("brdf symmetry");

	for (int k = 0; k < 2000; k++) {
		double ti = unit_random_range(&random, 0, 1.57), to = unit_random_range(&random, 0, 1.57);
		double pi = unit_random_range(&random, 0, 7), po = unit_random_range(&random, 0, 7);
		float a[3], b[3], f[3], g[3];

		direction(ti, pi, a);
		direction(to, po, b);
		brdf_table_evaluate(t, a, b, f);
		brdf_table_evaluate(t, b, a, g);
		assert_true(isfinite(f[0]) && f[0] >= 0);
		assert_true(fabsf(f[1] - g[1]) <= 1e-5f * f[1]);
		direction(ti, 1 - pi, a);
		direction(to, 1 - po, b);
		brdf_table_evaluate(t, a, b, g);
		assert_true(fabsf(f[2] - g[2]) <= 2e-3f * f[2] + 1e-6f);
	}
}

static double radical_inverse(uint32_t i)
{
	double sum = 0, half = 0.5;

	for (; i; i >>= 1, half /= 2)
		sum += i & 1 ? half : 0;
	return sum;
}

/* Density 1 in all, the same from both functions, and what comes back by it. */
static void check_sampling(const struct brdf_table *t, double theta, const char *what)
{
	const int count = 1 << 18;
	double all = 0, by_sum = 0, by_samples = 0, edges = 0, worst = 0;
	float wo[3];

	direction(theta, 2, wo);
	for (int i = 0; i < 900; i++) {
		for (int j = 0; j < 1800; j++) {
			double at = (i + 0.5) / 900 * M_PI / 2;
			double step = (j % 900 + 0.5) / 900; /* finer towards the mirror's azimuth */
			double da = sin(at) * M_PI / 1800 * 2 * M_PI * step / 900;
			float wi[3], f[3];

			direction(at, 2 + M_PI + (j < 900 ? M_PI : -M_PI) * step * step, wi);
			brdf_table_evaluate(t, wi, wo, f);
			all += (double)brdf_table_pdf(t, wo, wi) * da;
			by_sum += (double)f[1] * cos(at) * da;
		}
	}
	for (int i = 0; i < count; i++) {
		double u1 = (i + 0.5) / count, u2 = radical_inverse((uint32_t)i);
		float wi[3], f[3];
		float pdf = brdf_table_sample(t, wo, u1, u2, wi);
		double weight;

		if (!(pdf > 0))
			continue;
		brdf_table_evaluate(t, wi, wo, f);
		weight = (double)f[1] * (double)wi[2] / (double)pdf;
		worst = fmax(worst, weight);
		by_samples += weight / count;
		edges += fabsf(brdf_table_pdf(t, wo, wi) / pdf - 1) > 1e-3f;
	}
	printf("# %s at %.0f deg: densities add up to 1 %+.1e, %.2g on an edge, reflectance %.4f, by "
	       "samples %+.2e, largest weight %.2f\n", what, theta * 180 / M_PI, all - 1,
	       edges / count, by_sum, by_samples / by_sum - 1, worst);
	assert_true(fabs(all - 1) < 1e-3);
	assert_true(fabs(by_samples / by_sum - 1) < 1e-3);
	assert_true(edges / count < 2e-3);
	assert_true(by_sum < 1.005);
}

static void shiny(void **state)
{
	struct brdf_table *t = table_of(glossy);
	double squares = 0;
	int n = 0;

	(void)state;
	check_symmetry(t);
	check_sampling(t, 0.2, "Blinn-Phong 20");
	check_sampling(t, 1.0, "Blinn-Phong 20");
	for (double a = 0.05; a < 1.3; a += 0.1) {
		for (double b = 0.05; b < 1.3; b += 0.1) {
			for (double p = 0; p < M_PI; p += 0.1) {
				float wi[3], wo[3], f[3];
				double error;

				direction(a, 0, wi);
				direction(b, p, wo);
				brdf_table_evaluate(t, wi, wo, f);
				error = (double)f[0] / glossy(a, b, p) - 1;
				squares += error * error;
				n++;
			}
		}
	}
	printf("# Blinn-Phong 20 between samples: rms relative difference %.3f\n",
	       sqrt(squares / n));
	assert_true(sqrt(squares / n) < 0.06);
	brdf_table_destroy(&t);
}

/* Twice what arrives is no BRDF; a little more at some angles is limited. */
static double bright_edge(double theta_i, double theta_o, double phi)
{
	(void)phi;
	return 0.5 / M_PI / fmax(cos(theta_i) * cos(theta_o), 0.03);
}

static void energy(void **state)
{
	struct brdf_table *t = table_of(bright_edge);
	struct gr_diag diag = { 0 };
	size_t len;
	char *text;

	(void)state;
	assert_true(brdf_table_facts(t)->limited && brdf_table_facts(t)->most > 1);
	check_symmetry(t);
	check_sampling(t, 1.35, "limited");
	brdf_table_destroy(&t);
	text = write_text(lambert, 4, &len);
	assert_int_equal(brdf_table_parse(&t, text, len, "test.brdf", &diag), GR_ERR_CONFIG);
	assert_non_null(strstr(diag.items[0].text, "times the light that comes along the normal"));
	gr_diag_finish(&diag);
	free(text);
}

static void colors(void **state)
{
	double nm[WAVELENGTHS], weights[WAVELENGTHS][3], violet[3] = { 0 }, sum[3] = { 0 };
	double blue_only[5] = { 400, 410, 420, 430, 440 };

	(void)state;
	for (int w = 0; w < WAVELENGTHS; w++)
		nm[w] = 400 + 10 * w;
	assert_int_equal(brdf_color_weights(nm, WAVELENGTHS, weights), GR_OK);
	for (int w = 0; w < WAVELENGTHS; w++) {
		for (int c = 0; c < 3; c++) {
			sum[c] += weights[w][c];
			violet[c] += nm[w] < 430 ? weights[w][c] : 0;
		}
	}
	for (int c = 0; c < 3; c++)
		assert_true(fabs(sum[c] - 1) < 1e-12);
	/* 610 nm is red, 540 green, 450 blue. */
	assert_true(weights[21][0] > weights[21][1] && weights[14][1] > weights[14][0]);
	assert_true(weights[5][2] > weights[5][0] && weights[5][2] > weights[5][1]);
	printf("# share of the noisy wavelengths below 430 nm: R %.3f, G %.3f, B %.3f\n", violet[0],
	       violet[1], violet[2]);
	assert_true(fabs(violet[0]) < 0.02 && fabs(violet[1]) < 0.02 && violet[2] < 0.09);
	assert_int_equal(brdf_color_weights(blue_only, 5, weights), GR_ERR_RANGE);
}

static void refused(const char *text, const char *words)
{
	struct gr_diag diag = { 0 };
	struct brdf_table *t;
	size_t len = strlen(text);
	uint8_t *copy = unit_copy(text, len);

	assert_int_equal(brdf_table_parse(&t, (const char *)copy, len, "bad.brdf", &diag),
			 GR_ERR_CONFIG);
	assert_null(t);
	assert_true(diag.errors == 1);
	if (!strstr(diag.items[0].text, words))
		print_message("%s\n", diag.items[0].text);
	assert_non_null(strstr(diag.items[0].text, words));
	assert_non_null(strstr(diag.items[0].text, "bad.brdf:"));
	gr_diag_finish(&diag);
	free(copy);
}

static void refusals(void **state)
{
	(void)state;
	refused("# nothing\n", "the number of wavelengths");
	refused("x", "\"x\" is no finite number");
	refused("nan", "\"nan\" is no finite number");
	refused("2 400 500", "2 wavelengths");
	refused("3.5", "3.5 wavelengths");
	refused("1e9", "1e+09 wavelengths");
	refused("3 400 500 450", "wavelength 450");
	refused("3 0.4 0.5 0.6", "wavelength 0.4");
	refused("3 400 410 420", "leave a colour out");
	refused("3 450 550 650", "0 samples");
	refused("3 450 550 650\n0.1 0 0.2", "phi_o");
	refused("3 450 550 650\n45 0 0.2 0 1 1 1", "45 from the normal");
	refused("3 450 550 650\n0.1 0 0.2 180 1 1 1", "angle 180");
	refused("3 450 550 650\n0.1 0 0.2 0 1 inf 1", "\"inf\"");
	refused("3 450 550 650\n0.1 0 0.2 0 1 1e7 1", "value 1e+07");
	refused("3 450 550 650\n0.1 0 0.2 0 1 1", "a sample's value");
	refused("3 450 550 650\n0.1 0 0.2 0 1 1 1", "1 samples");
	refused("31111111111111111111111111111111111111111111111111111111111111111111111111 4",
		"no finite number");
	refused("3 450 550 650\n\n0.1 0 \x01\x80 0 1 1 1", "bad.brdf:3: \"??\"");
}

/* Every beginning of a good text is refused, or is a smaller table. */
static void cut_off(void **state)
{
	size_t len;
	char *text = write_text(lambert, 1, &len);

	(void)state;
	for (size_t n = 0; n < 3000; n += 7) {
		struct brdf_samples samples;
		struct gr_diag diag = { 0 };
		uint8_t *copy = unit_copy(text, n);
		int result = brdf_read((const char *)copy, n, "cut.brdf", &samples, &diag);

		assert_true(result == GR_OK || (result == GR_ERR_CONFIG && diag.errors == 1));
		brdf_samples_finish(&samples);
		gr_diag_finish(&diag);
		free(copy);
	}
	free(text);
}

static void measured(void **state)
{
	static const struct {
		const char *name;
		double misfit; /* bound */
	} files[] = { { "garnet_red", 0.08 }, { "krylon_blue", 0.16 }, { "cayman", 0.12 } };

	(void)state;
	for (int i = 0; i < 3; i++) {
		const struct brdf_table_facts *f;
		struct gr_diag diag = { 0 };
		struct brdf_table *t;
		char name[256], path[1024];
		clock_t start = clock();

		snprintf(name, sizeof name, "reference/brdf/%s.brdf", files[i].name);
		if (!shared_file(name, path))
			skip();
		assert_int_equal(brdf_table_load(&t, path, &diag), GR_OK);
		f = brdf_table_facts(t);
		printf("# %s: %zu samples, reflectance %.3f %.3f %.3f, along the normal %.3f %.3f "
		       "%.3f, most %.3f; %zu values below 0, %zu colours cut, misfit %.3f; %.2f s\n",
		       files[i].name, f->samples, (double)f->reflectance[0],
		       (double)f->reflectance[1], (double)f->reflectance[2], (double)f->normal[0],
		       (double)f->normal[1], (double)f->normal[2], (double)f->most, f->below_zero,
		       f->cut, (double)f->misfit, (double)(clock() - start) / CLOCKS_PER_SEC);
		check_symmetry(t);
		check_sampling(t, 0.5, files[i].name);
		check_sampling(t, 1.3, files[i].name);
		assert_true((double)f->misfit < files[i].misfit);
		brdf_table_destroy(&t);
		gr_diag_finish(&diag);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(flat),	    cmocka_unit_test(shiny),   cmocka_unit_test(energy),
		cmocka_unit_test(colors),   cmocka_unit_test(refusals), cmocka_unit_test(cut_off),
		cmocka_unit_test(measured),
	};

	gr_log_init("test_brdf", GR_LOG_WARNING);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
