/* Tone curve and encodings against their closed forms, and what is not finite. */
#include "base/log.h"
#include "base/result.h"
#include "renderer/renderer.h"
#include "renderer/tone/projector.h"
#include "tests/accuracy/cornell.h"
#include "tests/unit/gl.h"
#include "tests/unit/unit.h"

#include <epoxy/gl.h>

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
static void start_for(struct ramp *ramp, struct target *target, const double radiance[STRIPS][3],
		      const struct projector *projector, bool dither)
{
	const struct renderer_params params = { .width = WIDTH, .height = HEIGHT,
						.eyes = RENDERER_MONO, .keep_radiance = true,
						.projector = projector, .dither = dither };
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

static void start(struct ramp *ramp, struct target *target, const double radiance[STRIPS][3])
{
	start_for(ramp, target, radiance, NULL, false);
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

/* Seed 004 equation 3.3 and its gamma; IEC 61966-2-1. The others: test_curves has them. */
static void encoded(const struct render_frame *frame, const double radiance[3], double out[3])
{
	if (frame->curve > SCENE_CURVE_REINHARD) {
		const struct tone_look look = render_frame_look(frame);
		struct tone_factors factors;

		tone_factors(&look, &factors);
		tone_curve(&factors, radiance, out);
	}
	for (int i = 0; i < 3; i++) {
		double l = radiance[i] * (double)frame->exposure;

		if (frame->curve == SCENE_CURVE_REINHARD)
			l = l / (1 + l);
		l = fmin(frame->curve > SCENE_CURVE_REINHARD ? out[i] : l, 1);
		out[i] = pow(l, (double)frame->gamma_encode);
		if (frame->srgb)
			out[i] = l <= 0.0031308 ? 12.92 * l : 1.055 * pow(l, 1 / 2.4) - 0.055;
	}
}

static double worst_step(struct ramp *ramp)
{
	static uint8_t rgb[3 * WIDTH * HEIGHT];
	double worst = 0;

	draw(ramp, rgb);
	for (int k = 0; k < STRIPS; k++) {
		double want[3];

		encoded(&ramp->frame, ramp->radiance[k], want);
		for (int i = 0; i < 3; i++) {
			double got = rgb[3 * (WIDTH * (HEIGHT / 2) + 4 * k + 2) + i];

			worst = fmax(worst, fabs(got - 255 * want[i]));
		}
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

/* 1e-6 to 1e9 cd/m2, for eyes used to anything between, and what Drago's makes white. */
static void eyes(void **state)
{
	double radiance[STRIPS][3], worst = 0;
	struct ramp ramp;

	for (int k = 0; k < STRIPS; k++)
		for (int i = 0; i < 3; i++)
			radiance[k][i] = (float)(pow(10, -6 + 15.0 * k / (STRIPS - 1) - 0.5 * i * (k % 3)) / 683);
	radiance[0][0] = radiance[0][1] = radiance[0][2] = 0;
	radiance[5][1] = radiance[5][2] = 0;
	start(&ramp, *state, radiance);
	ramp.frame.srgb = true;
	for (int curve = SCENE_CURVE_DRAGO; curve <= SCENE_CURVE_PATTANAIK; curve++)
		for (double level = 1e-6; level < 2e9; level *= 1000) {
			const double max = level * pow(10, 1 + (curve == SCENE_CURVE_DRAGO ? 4 : 0));
			struct adapt_state eye;

			assert_int_equal(adapt_settle(&eye, level), GR_OK);
			ramp.frame.curve = (enum scene_curve)curve;
			ramp.frame.adaptation[0] = (float)eye.cone;
			ramp.frame.adaptation[1] = (float)(eye.rod / 3);
			ramp.frame.pigment[0] = (float)eye.cone_pigment;
			ramp.frame.pigment[1] = (float)eye.rod_pigment;
			ramp.frame.luminance_max = (float)max;
			worst = fmax(worst, worst_step(&ramp));
		}
	printf("# tone: Drago's and Pattanaik's curve, 1e-6 to 1e9 cd/m2 for 6 levels in that range, worst "
	       "difference %.3f of 255\n", worst);
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

/* What the target holds, in its steps; and what it should. */
static void read_steps(struct ramp *ramp, struct target *target, float got[3 * WIDTH * HEIGHT])
{
	const float steps = exp2f((float)target_bits(target)) - 1;

	assert_int_equal(renderer_draw_camera(ramp->renderer, &ramp->frame, &camera), GR_OK);
	target_bind(target, 0, true);
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGB, GL_FLOAT, got);
	for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
		got[i] *= steps;
}

/* A projector that was measured, with 10 bits. */
static void projected(struct target *target)
{
	static const struct projector projector = { .black = { 0.002, 0.001, 0 },
						    .gain = { 0.8, 1, 1.4 }, .gamma = { 2, 2.4, 1.8 } };
	static float got[3 * WIDTH * HEIGHT];
	double radiance[STRIPS][3], worst = 0, want[3];
	struct ramp ramp;

	for (int k = 0; k < STRIPS; k++)
		for (int i = 0; i < 3; i++)
			radiance[k][i] = (float)pow(10, -4 + 4.3 * k / (STRIPS - 1) - 0.1 * i);
	start_for(&ramp, target, radiance, &projector, false);
	ramp.frame.curve = SCENE_CURVE_LINEAR;
	read_steps(&ramp, target, got);
	for (int k = 0; k < STRIPS; k++) {
		encoded(&ramp.frame, radiance[k], want);
		for (int i = 0; i < 3; i++) {
			const double gamma = (double)ramp.file.tone.gamma_display;
			const double code = (double)got[3 * (WIDTH * (HEIGHT / 2) + 4 * k + 2) + i] / 1023;
			const double most = projector.gain[i], least = projector.black[i];
			const double light = fmin(fmax(pow(want[i], gamma), least), most);
			const double shown = least + (most - least) * pow(code, projector.gamma[i]);
			/* a step of the code here, in light */
			const double step = (most - least) * (pow(code + 1.0 / 1023, projector.gamma[i]) -
							      pow(code, projector.gamma[i]));

			worst = fmax(worst, fabs(shown - light) / step);
		}
	}
	printf("# projector: %d radiances in 10 bits, light off by %.2f of the steps that it can show (rounding "
	       "alone 0.5)\n", STRIPS, worst);
	assert_true(worst < 1.05);
	stop(&ramp);
}

/* Whatever the bits: every pixel is a neighbour of the value, and their mean is the value. */
static void dithered(struct target *target)
{
	static float got[3 * WIDTH * HEIGHT];
	const double steps = exp2((double)target_bits(target)) - 1;
	const double slack = target_bits(target) == 10 ? 0.1 : 0;
	double radiance[STRIPS][3], want[3], worst = 0, sum = 0, plain = 0;
	struct ramp ramp;

	for (int k = 0; k < STRIPS; k++)
		for (int i = 0; i < 3; i++) /* a slope over few steps */
			radiance[k][i] = 0.2 + 0.02 * k / STRIPS;
	start_for(&ramp, target, radiance, NULL, true);
	read_steps(&ramp, target, got);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			double value;

			encoded(&ramp.frame, radiance[x / 4], want);
			value = want[0] * steps;
			worst = fmax(worst, fabs((double)got[3 * (WIDTH * y + x)] - value));
			sum += (double)got[3 * (WIDTH * y + x)] - value;
			plain = fmax(plain, fabs(round(value) - value));
		}
	printf("# dither: %d bits, a pixel off by at most %.3f steps, their mean by %.4f\n",
	       target_bits(target), worst, sum / (WIDTH * HEIGHT));
	/* llvmpipe rounds down from 0.58 of a step on in 10 bits, from 0.5 in 8 */
	assert_true(worst > plain && worst <= 1.01 + slack);
	assert_true(fabs(sum / (WIDTH * HEIGHT)) < 0.02 + slack);
	stop(&ramp);
}

/* Float takes what comes, of no steps. */
static void unquantised(struct target *target)
{
	static float got[3 * WIDTH * HEIGHT];
	double radiance[STRIPS][3], want[3], worst = 0;
	struct ramp ramp;

	for (int k = 0; k < STRIPS; k++)
		for (int i = 0; i < 3; i++)
			radiance[k][i] = (float)pow(10, -4 + 5.0 * k / (STRIPS - 1));
	start_for(&ramp, target, radiance, NULL, true);
	read_steps(&ramp, target, got);
	for (int k = 0; k < STRIPS; k++) {
		encoded(&ramp.frame, radiance[k], want);
		worst = fmax(worst, fabs((double)got[3 * (WIDTH * 4 + 4 * k + 2)] / 65535 / want[0] - 1));
	}
	printf("# float target: relative difference %.1e\n", worst);
	assert_true(worst < 1e-3); /* a step of 11 bits: llvmpipe cuts off */
	stop(&ramp);
}

static struct target *target_of(enum target_depth depth)
{
	const struct target_params params = { .kind = TARGET_HEADLESS, .width = WIDTH, .gpu = -1,
					      .height = HEIGHT, .depth = depth, .debug = true };
	struct target *target;

	assert_int_equal(target_create(&target, &params), GR_OK);
	return target;
}

static void with_8_bits(void **state)
{
	struct target *target = target_of(TARGET_DEPTH_8);

	(void)state;
	dithered(target);
	target_destroy(&target);
}

static void with_10_bits(void **state)
{
	struct target *target = target_of(TARGET_DEPTH_10);

	(void)state;
	projected(target);
	dithered(target);
	target_destroy(&target);
}

static void with_floats(void **state)
{
	struct target *target = target_of(TARGET_DEPTH_FLOAT);

	(void)state;
	unquantised(target);
	target_destroy(&target);
}

int main(void)
{
	struct target *target = gl_target_or_skip(WIDTH, HEIGHT);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(curves, target),
		cmocka_unit_test_prestate(eyes, target),
		cmocka_unit_test_prestate(nothing_clamped, target),
		cmocka_unit_test_prestate(not_finite, target),
	};
	/* one context at a time: these make their own */
	const struct CMUnitTest depths[] = {
		cmocka_unit_test(with_8_bits),
		cmocka_unit_test(with_10_bits),
		cmocka_unit_test(with_floats),
	};
	int failed;

	gr_log_init("test_tone", GR_LOG_WARNING);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	return failed + cmocka_run_group_tests(depths, NULL, NULL);
}
