/*
 * Where the sun is, what it and the sky shine with: published positions, the sky
 * of Blender (reference/README.md, sky), and the light that the sun is known for.
 */
#include "base/diag.h"
#include "base/photometry.h"
#include "base/result.h"
#include "base/solar.h"
#include "base/sunlight.h"
#include "renderer/image/image.h"
#include "renderer/scene/environment.h"
#include "renderer/scene/sky.h"
#include "tests/unit/shared.h"
#include "tests/unit/unit.h"

#define DEG (180 / M_PI)
/* W/(m^2 sr) of 1.0 in Blender's pictures: 16.667 kcd/m^2. */
#define PER_BLENDER (1000 / 0.06 / GR_LUMENS_PER_WATT)

static double turned(double degrees)
{
	return fabs(remainder(degrees, 360));
}

static double at(const char *text)
{
	int64_t seconds = 0;

	assert_int_equal(solar_time(text, &seconds), GR_OK);
	return (double)seconds;
}

static void times(void **state)
{
	static const char *const wrong[] = {
		"", "2026", "2026-06-21", "2026-06-21T14:30", "2026-6-21T14:30Z", "2026-13-01T00:00Z",
		"2026-02-29T00:00Z", "2026-00-10T00:00Z", "2026-06-31T00:00Z", "2026-06-21T24:00Z",
		"2026-06-21T14:60Z", "2026-06-21T14:30:60Z", "2026-06-21 14:30Z", "2026-06-21T14:30ZZ",
		"2026-06-21T14:30+15:00", "2026-06-21T14:30+14:01", "2026-06-21T14:30+2", "1899-12-31T00:00Z",
		"2101-01-01T00:00Z", "2026-06-21T14:30+02:00 ", "-026-06-21T14:30Z",
	};
	int64_t seconds = 77;

	(void)state;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		char *exact = (char *)unit_copy(wrong[i], strlen(wrong[i]) + 1);

		assert_int_equal(solar_time(exact, &seconds), GR_ERR_RANGE);
		free(exact);
	}
	assert_int_equal(seconds, 77);
	assert_true(at("1970-01-01T00:00Z") == 0);
	assert_true(at("2000-02-29T12:00:30Z") == 951825630);
	assert_true(at("2026-06-21T14:30+02:00") == at("2026-06-21T12:30:00Z"));
	assert_true(at("2026-06-20T22:30-14:00") == at("2026-06-21T12:30:00Z"));
	assert_true(at("1900-03-01T00:00Z") - at("1900-02-28T00:00Z") == 86400);
}

static void positions(void **state)
{
	double right_ascension, declination, elevation, azimuth, worst = 0;

	(void)state;
	/* Meeus 1998, example 25.a: 1992 October 13.0, apparent */
	solar_equatorial(at("1992-10-13T00:00Z"), &right_ascension, &declination);
	printf("# Meeus' example: right ascension off by %.5f, declination by %.5f degrees\n",
	       turned(right_ascension * DEG - 198.38083), fabs(declination * DEG + 7.78507));
	assert_true(turned(right_ascension * DEG - 198.38083) < 2e-5);
	assert_true(fabs(declination * DEG + 7.78507) < 2e-5);
	/* Reda and Andreas 2004, appendix A.5; their air is thinner: 820 hPa and 11 degrees */
	solar_horizontal(at("2003-10-17T12:30:30-07:00"), 39.742476 / DEG, -105.1786 / DEG, &elevation,
			 &azimuth);
	printf("# NREL's example: elevation off by %.4f, azimuth by %.4f degrees\n",
	       fabs(90 - elevation * DEG - 50.11162), turned(azimuth * DEG - 194.34024));
	assert_true(fabs(90 - elevation * DEG - 50.11162) < 0.007);
	assert_true(turned(azimuth * DEG - 194.34024) < 0.004);
	/* overhead at the tropic, at the pole all day alike, and never a jump */
	for (double hour = 0; hour < 24; hour += 0.25) {
		double next, unused;

		solar_horizontal(at("2026-06-21T08:25Z") + 3600 * hour, M_PI / 2, 0.3, &elevation, &unused);
		worst = fmax(worst, fabs(elevation * DEG - 23.436 - 0.037));
		solar_horizontal(at("2026-03-20T00:00Z") + 3600 * hour, 0.7, -2, &elevation, &unused);
		solar_horizontal(at("2026-03-20T00:01Z") + 3600 * hour, 0.7, -2, &next, &unused);
		assert_true(fabs(next - elevation) * DEG < 0.26);
	}
	printf("# at the pole in midsummer %.4f degrees from 23.436 and its refraction\n", worst);
	assert_true(worst < 0.004);
}

/* Illuminance in klx. */
static double klx(const double rgb[3])
{
	return gr_luminance(rgb) / 1000;
}

static void sunlight(void **state)
{
	double rgb[3], clear, worst_step = 0;

	(void)state;
	sunlight_outside(rgb);
	printf("# outside the air the sun gives %.1f klx\n", klx(rgb));
	/* 127.5 (IESNA) to 133.3 klx (Darula, Kittler and Gueymard 2005) */
	assert_true(klx(rgb) > 126.5 && klx(rgb) < 134);
	sunlight_irradiance(2, 90 / DEG, rgb);
	clear = klx(rgb);
	printf("# clear and overhead %.1f klx, W/m2 %.1f %.1f %.1f\n", clear, rgb[0], rgb[1], rgb[2]);
	assert_true(clear > 95 && clear < 110);
	for (double turbidity = 1.7; turbidity < 10.1; turbidity += 0.83) {
		double last = 0;

		for (double deg = 0; deg < 90.1; deg += 0.5) {
			sunlight_irradiance(turbidity, deg / DEG, rgb);
			assert_true(klx(rgb) >= last && klx(rgb) < 128);
			for (int c = 0; c < 3; c++)
				assert_true(isfinite(rgb[c]) && rgb[c] >= 0);
			worst_step = fmax(worst_step, klx(rgb) - last);
			last = klx(rgb);
		}
	}
	sunlight_irradiance(3, -1, rgb);
	assert_true(rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0);
}

static void sun_of(double elevation_deg, double out[3])
{
	out[0] = cos(elevation_deg / DEG);
	out[1] = sin(elevation_deg / DEG);
	out[2] = 0;
}

/* Worst relative difference of luminance above 3 degrees, and of the bands to the largest. */
static void compare(const struct image *want, const struct image *got, double *luminance, double *band)
{
	*luminance = *band = 0;
	for (int y = 0; y < want->height; y++) {
		if (90 - 180 * (y + 0.5) / want->height < 3)
			continue;
		for (int x = 0; x < want->width; x++) {
			const float *w = want->data + 3 * (y * want->width + x);
			const float *g = got->data + 3 * (y * want->width + x);
			double a[3], b[3], most = 0;

			for (int c = 0; c < 3; c++) {
				a[c] = (double)w[c] * PER_BLENDER;
				b[c] = (double)g[c];
				most = fmax(most, a[c]);
			}
			*luminance = fmax(*luminance, fabs(gr_luminance(b) / gr_luminance(a) - 1));
			for (int c = 0; c < 3; c++)
				*band = fmax(*band, fabs(b[c] - fmax(a[c], 0)) / most);
		}
	}
}

static void pictures(void **state)
{
	static const int turbidities[] = { 2, 3, 6 }, elevations[] = { 10, 40, 70 };
	double worst = 0, worst_band = 0;

	(void)state;
	for (int i = 0; i < 9; i++) {
		const int turbidity = turbidities[i / 3], elevation = elevations[i % 3];
		struct gr_diag diag = { 0 };
		struct image want, got;
		double sun[3], luminance, band;
		char name[64], path[1024];
		struct sky sky;

		snprintf(name, sizeof name, "reference/sky/sky_T%d_e%d.exr", turbidity, elevation);
		if (!shared_file(name, path))
			skip();
		assert_int_equal(image_read_exr(path, &want, &diag), GR_OK);
		sun_of(elevation, sun);
		sky_init(&sky, turbidity, sun);
		assert_int_equal(sky_picture(&sky, want.width, want.height, &got), GR_OK);
		compare(&want, &got, &luminance, &band);
		printf("# turbidity %d, sun %d degrees: luminance off by %.2f %%, a band by %.2f %% of the "
		       "largest\n", turbidity, elevation, 100 * luminance, 100 * band);
		worst = fmax(worst, luminance);
		worst_band = fmax(worst_band, band);
		image_finish(&want);
		image_finish(&got);
	}
	assert_true(worst < 0.01);
	assert_true(worst_band < 0.01);
}

/* Any sun and haze: finite, not below 0; and more than nothing while it is day. */
static void any_sky(void **state)
{
	(void)state;
	for (double turbidity = SKY_TURBIDITY_MIN; turbidity < SKY_TURBIDITY_MAX + 0.1; turbidity += 0.83)
		for (double sun_deg = -90; sun_deg < 91; sun_deg += 7.5) {
			double sun[3], rgb[3], total = 0;
			struct sky sky;

			sun_of(sun_deg, sun);
			sky_init(&sky, turbidity, sun);
			for (double deg = 0; deg < 91; deg += 5)
				for (double side = 0; side < 360; side += 30) {
					const double d[3] = { cos(deg / DEG) * cos(side / DEG), sin(deg / DEG),
							      cos(deg / DEG) * sin(side / DEG) };

					sky_radiance(&sky, d, rgb);
					for (int c = 0; c < 3; c++)
						assert_true(isfinite(rgb[c]) && rgb[c] >= 0 && rgb[c] < 1e4);
					total += rgb[1];
				}
			assert_true(sun_deg < 5 || total > 0);
		}
}

/* Irradiance of open ground, by a sum of its own. */
static double open_ground(const struct sky *sky)
{
	double sum = 0;

	for (int i = 0; i < 400; i++)
		for (int k = 0; k < 800; k++) {
			const double y = (i + 0.5) / 400, r = sqrt(1 - y * y), p = 2 * M_PI * (k + 0.5) / 800;
			const double d[3] = { r * cos(p), y, r * sin(p) };
			double rgb[3];

			sky_radiance(sky, d, rgb);
			sum += klx(rgb) * y * 2 * M_PI / 400 / 800;
		}
	return sum;
}

/* No sun below the horizon, and a warning that says so. */
static void night(void **state)
{
	static const char text[] = "model = \"m.obj\"; environment = { kind = \"sky\"; sun_elevation_deg = -3.0; };";
	struct gr_diag diag = { 0 };
	struct scene_file *file;

	(void)state;
	assert_int_equal(scene_file_parse(text, strlen(text), "sky.cfg", &file, &diag), GR_OK);
	assert_int_equal(file->lamp_count, 0);
	assert_int_equal(diag.warnings, 1);
	assert_non_null(strstr(diag.items[0].text, "the sun is 3.0 degrees below the horizon"));
	scene_file_destroy(&file);
	gr_diag_finish(&diag);
}

/* From a scene file: the sun where the time says, as a lamp, and the sky without it. */
static void from_a_file(void **state)
{
	static const char text[] =
		"model = \"m.obj\"; environment = { kind = \"sky\"; turbidity = 2.5; place = [48.14, 11.58]; "
		"time = \"2026-06-21T13:14+02:00\"; heading_deg = 90.0; };";
	static const float up[3] = { 0, 1, 0 };
	struct environment *environment;
	struct gr_diag diag = { 0 };
	struct scene_file *file;
	const struct scene_lamp *sun;
	float open[3];
	struct sky sky;
	double to_sun[3], summed;
	double rgb[3];
	char line[256];

	(void)state;
	assert_int_equal(scene_file_parse(text, strlen(text), "sky.cfg", &file, &diag), GR_OK);
	assert_int_equal(file->lamp_count, 1);
	sun = &file->lamps[0];
	assert_string_equal(sun->name, "sun");
	/* noon in Munich, 65.3 degrees high in the south, which is +X where north is -X */
	assert_true(fabs(asin(-(double)sun->direction[1]) * DEG - 65.3) < 0.1);
	assert_true(fabs((double)sun->direction[2]) < 0.01 && sun->direction[0] < 0);
	assert_int_equal(environment_create(&environment, file, &diag), GR_OK);
	environment_describe(environment, line, sizeof line);
	environment_irradiance(environment, up, open);
	for (int c = 0; c < 3; c++)
		rgb[c] = (double)open[c];
	for (int c = 0; c < 3; c++)
		to_sun[c] = -(double)sun->direction[c];
	sky_init(&sky, 2.5, to_sun);
	summed = open_ground(&sky);
	printf("# %s: %.2f klx, %.2f by a sum\n", line, klx(rgb), summed);
	assert_true(fabs(klx(rgb) / summed - 1) < 1e-3);
	environment_destroy(&environment);
	scene_file_destroy(&file);
	gr_diag_finish(&diag);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(times),    cmocka_unit_test(positions), cmocka_unit_test(sunlight),
		cmocka_unit_test(pictures), cmocka_unit_test(any_sky),   cmocka_unit_test(from_a_file),
		cmocka_unit_test(night),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
