/* Tone curve and encodings against their closed forms, and what is not finite. */
#include "base/log.h"
#include "base/result.h"
#include "renderer/renderer.h"
#include "tests/accuracy/cornell.h"
#include "tests/unit/gl.h"
#include "tests/unit/unit.h"

#define STRIPS 64
#define WIDTH (4 * STRIPS)
#define HEIGHT 8

struct ramp {
	struct scene scene;
	struct scene_file file;
	struct renderer *renderer;
	struct render_frame frame;
	double radiance[STRIPS][3];
};

static const struct scene_camera camera = { .position = { 0, 0, 1 }, .target = { 0, 0, 0 },
					    .up = { 0, 1, 0 }, .vfov_rad = (float)M_PI_2 };

/* Strips side by side that fill the picture; their emission is what the eye gets. */
static void start(struct ramp *ramp, struct target *target, const double radiance[STRIPS][3])
{
	const struct renderer_params params = { .width = WIDTH, .height = HEIGHT,
						.eyes = RENDERER_MONO, .keep_radiance = true };
	const float half = (float)WIDTH / HEIGHT;
	static struct quad quads[STRIPS];
	static struct scene_material materials[STRIPS];

	memset(ramp, 0, sizeof(*ramp));
	memcpy(ramp->radiance, radiance, sizeof(ramp->radiance));
	for (int k = 0; k < STRIPS; k++) {
		float l = half * (2.0f * (float)k / STRIPS - 1);
		float r = half * (2.0f * (float)(k + 1) / STRIPS - 1);

		quads[k] = (struct quad){ k, { { l, -2, 0 }, { r, -2, 0 }, { r, 2, 0 }, { l, 2, 0 } } };
		materials[k] = (struct scene_material){ .diffuse_image = -1, .emission_image = -1 };
		for (int i = 0; i < 3; i++)
			materials[k].emission[i] = (float)radiance[k][i];
	}
	ramp->file = quads_file();
	quads_scene(&ramp->scene, quads, STRIPS, materials, STRIPS);
	assert_int_equal(renderer_create(&ramp->renderer, target, &params, &ramp->file,
					 &ramp->scene), GR_OK);
	render_frame_init(&ramp->frame, &ramp->file);
}

static void stop(struct ramp *ramp)
{
	renderer_destroy(&ramp->renderer);
	quads_free(&ramp->scene);
}

static void draw(struct ramp *ramp, uint8_t rgb[3 * WIDTH * HEIGHT])
{
	assert_int_equal(renderer_draw_camera(ramp->renderer, &ramp->frame, &camera), GR_OK);
	assert_int_equal(renderer_read_rgb(ramp->renderer, rgb), GR_OK);
}

/* Seed 004 equation 3.3 and its gamma; IEC 61966-2-1. */
static double encoded(const struct render_frame *frame, double radiance)
{
	double l = radiance * (double)frame->exposure;

	if (frame->curve == SCENE_CURVE_REINHARD)
		l = l / (1 + l);
	l = fmin(l, 1);
	if (frame->srgb)
		return l <= 0.0031308 ? 12.92 * l : 1.055 * pow(l, 1 / 2.4) - 0.055;
	return pow(l, (double)frame->gamma_encode);
}

static double worst_step(struct ramp *ramp)
{
	static uint8_t rgb[3 * WIDTH * HEIGHT];
	double worst = 0;

	draw(ramp, rgb);
	for (int k = 0; k < STRIPS; k++)
		for (int i = 0; i < 3; i++) {
			double got = rgb[3 * (WIDTH * (HEIGHT / 2) + 4 * k + 2) + i];

			worst = fmax(worst, fabs(got - 255 * encoded(&ramp->frame,
								     ramp->radiance[k][i])));
		}
	return worst;
}

static void curves(void **state)
{
	/* Table 3.1: end-to-end gamma of dark, dim and light surrounds. */
	static const float end_to_end[3] = { 1.5f, 1.25f, 1.125f };
	double radiance[STRIPS][3], worst = 0;
	struct ramp ramp;

	for (int k = 0; k < STRIPS; k++)
		for (int i = 0; i < 3; i++)
			radiance[k][i] = (float)pow(10, -4 + 8.0 * k / (STRIPS - 1) - 0.3 * i);
	start(&ramp, *state, radiance);
	for (int curve = 0; curve < 2; curve++)
		for (int kind = 0; kind < 4; kind++) {
			double step;

			ramp.frame.curve = curve ? SCENE_CURVE_REINHARD : SCENE_CURVE_LINEAR;
			ramp.frame.srgb = kind == 3;
			ramp.frame.gamma_encode = kind < 3 ? end_to_end[kind] / 2.2f : 1;
			ramp.frame.exposure = curve ? 1.0f : 0.37f;
			step = worst_step(&ramp);
			worst = fmax(worst, step);
		}
	printf("# tone: 8 curves of %d radiances 1e-4..1e4, worst difference %.3f of 255 "
	       "(rounding alone 0.5)\n", STRIPS, worst);
	assert_true(worst < 0.55);
	stop(&ramp);
}

/* Emission up to 1e9 gets through unclamped. */
static void nothing_clamped(void **state)
{
	double radiance[STRIPS][3];
	struct image image;
	struct ramp ramp;

	for (int k = 0; k < STRIPS; k++)
		for (int i = 0; i < 3; i++)
			radiance[k][i] = (float)pow(10, 9.0 * k / (STRIPS - 1));
	start(&ramp, *state, radiance);
	assert_int_equal(renderer_draw_camera(ramp.renderer, &ramp.frame, &camera), GR_OK);
	assert_int_equal(renderer_read_radiance(ramp.renderer, 0, &image), GR_OK);
	for (int k = 0; k < STRIPS; k++) {
		double got = (double)image.data[3 * (WIDTH * (HEIGHT / 2) + 4 * k + 2)];

		assert_true(fabs(got / radiance[k][0] - 1) < 1e-6);
	}
	image_finish(&image);
	stop(&ramp);
}

static void not_finite(void **state)
{
	static uint8_t rgb[3 * WIDTH * HEIGHT];
	static const uint8_t magenta[3] = { 255, 0, 255 };
	double radiance[STRIPS][3];
	struct renderer_stats stats;
	struct ramp ramp;

	for (int k = 0; k < STRIPS; k++)
		for (int i = 0; i < 3; i++)
			radiance[k][i] = 0.1;
	radiance[10][1] = NAN;
	radiance[20][2] = -NAN;
	radiance[30][0] = INFINITY;
	start(&ramp, *state, radiance);
	gr_log_set_level(0);
	for (int k = 0; k < 3; k++) { /* the same picture is not toned, so not counted, again */
		draw(&ramp, rgb);
		assert_int_equal(renderer_finished(ramp.renderer, INT64_C(10000000000)), GR_OK);
	}
	renderer_stats(ramp.renderer, &stats);
	gr_log_set_level(GR_LOG_WARNING);
	for (int k = 0; k < STRIPS; k++) {
		const uint8_t *p = &rgb[3 * (WIDTH * (HEIGHT / 2) + 4 * k + 2)];
		bool bad = k == 10 || k == 20 || k == 30;

		assert_int_equal(memcmp(p, magenta, 3) == 0, bad);
	}
	printf("# three strips of %d pixels are not finite, counted %llu\n", 4 * HEIGHT,
	       (unsigned long long)stats.nonfinite);
	assert_int_equal(stats.nonfinite, 3 * 4 * HEIGHT);
	stop(&ramp);
}

int main(void)
{
	struct target *target = gl_target_or_skip(WIDTH, HEIGHT);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(curves, target),
		cmocka_unit_test_prestate(nothing_clamped, target),
		cmocka_unit_test_prestate(not_finite, target),
	};
	int failed;

	gr_log_init("test_tone", GR_LOG_WARNING);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	return failed;
}
