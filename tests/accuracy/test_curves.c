/*
 * Tone curves and the eye's time course on the CPU against the pictures and the
 * sequence of pfstools (reference/README.md, tonemap), and light that no scene
 * should have. The GPU's side is in test_tone.
 */
#include "base/diag.h"
#include "base/photometry.h"
#include "base/result.h"
#include "renderer/image/image.h"
#include "renderer/tone/adapt.h"
#include "renderer/tone/curve.h"
#include "tests/unit/shared.h"
#include "tests/unit/unit.h"

static const char *const inputs[] = { "ramp", "hall_x200", "cornell_x100" };

struct operator_case {
	const char *name;
	enum scene_curve curve;
	double bias;      /* drago */
	double cone, rod; /* pattanaik; 0: five times the log average */
};
static const struct operator_case operators[] = {
	{ "drago03_b085", SCENE_CURVE_DRAGO, 0.85, 0, 0 },
	{ "drago03_b070", SCENE_CURVE_DRAGO, 0.70, 0, 0 },
	{ "pattanaik00", SCENE_CURVE_PATTANAIK, 0.85, 0, 0 },
	{ "pattanaik00_c100", SCENE_CURVE_PATTANAIK, 0.85, 100, 100 },
	{ "pattanaik00_c10_r1", SCENE_CURVE_PATTANAIK, 0.85, 10, 1 },
};

static double luminance(const float *cd)
{
	return GR_LUMINANCE_RED * (double)cd[0] + GR_LUMINANCE_GREEN * (double)cd[1] +
	       GR_LUMINANCE_BLUE * (double)cd[2];
}

static bool read_picture(const char *name, const char *suffix, struct image *out)
{
	char file[128], path[1024];
	struct gr_diag diag = { 0 };

	snprintf(file, sizeof file, "reference/tonemap/%s_%s.exr", name, suffix);
	if (!shared_file(file, path))
		return false;
	assert_int_equal(image_read_exr(path, out, &diag), GR_OK);
	return true;
}

/* As the programs measure a picture: 1e-4 keeps the logarithm of black away. */
static void measure(const struct image *in, double *average, double *max)
{
	size_t pixels = (size_t)in->width * (size_t)in->height;
	double sum = 0;

	*max = 0;
	for (size_t i = 0; i < pixels; i++) {
		double y = luminance(in->data + 3 * i);

		sum += log(y + 1e-4);
		*max = fmax(*max, y);
	}
	*average = exp(sum / (double)pixels);
}

static struct tone_look look_of(const struct operator_case *op, double average, double max)
{
	struct tone_look look = { .curve = op->curve, .exposure = 1 / GR_LUMENS_PER_WATT,
				  .luminance_max = max, .bias = op->bias };
	struct adapt_state rods;

	if (op->curve == SCENE_CURVE_DRAGO) {
		assert_int_equal(adapt_settle(&look.eye, average), GR_OK);
		return look;
	}
	assert_int_equal(adapt_settle(&look.eye, op->cone > 0 ? op->cone : 5 * (average - 1e-4)), GR_OK);
	if (op->rod > 0) {
		assert_int_equal(adapt_settle(&rods, op->rod), GR_OK);
		look.eye.rod = rods.rod;
		look.eye.rod_pigment = rods.rod_pigment;
	}
	return look;
}

/*
 * Worst difference in 255ths over what a display shows. pfstmo_pattanaik00 takes a
 * power of each band over the luminance, and has NaN, shown as 1, where the way through
 * XYZ has made a band of about 0 negative, and for black: such pixels are counted.
 */
static double compare(const struct tone_look *look, const struct image *in,
		      const struct image *want, size_t *left_out)
{
	size_t pixels = (size_t)in->width * (size_t)in->height;
	struct tone_factors factors;
	double worst = 0;

	*left_out = 0;
	assert_true(tone_look_valid(look));
	tone_factors(look, &factors);
	for (size_t i = 0; i < pixels; i++) {
		const float *p = in->data + 3 * i;
		double l[3] = { (double)p[0], (double)p[1], (double)p[2] };

		if (look->curve == SCENE_CURVE_PATTANAIK &&
		    !(fmin(l[0], fmin(l[1], l[2])) > 1e-5 * luminance(p))) {
			++*left_out;
			continue;
		}
		tone_curve(&factors, l, l);
		for (int c = 0; c < 3; c++) {
			double ref = (double)want->data[3 * i + (size_t)c];

			worst = fmax(worst, fabs(fmin(l[c], 1) - fmin(fmax(ref, 0), 1)));
			assert_true(isfinite(l[c]));
		}
	}
	return 255 * worst;
}

static void pictures(void **state)
{
	double worst = 0;

	(void)state;
	for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++) {
		struct image in, want;
		double average, max;

		if (!read_picture(inputs[i], "in", &in))
			skip();
		measure(&in, &average, &max);
		for (size_t k = 0; k < sizeof operators / sizeof *operators; k++) {
			struct tone_look look = look_of(&operators[k], average, max);
			size_t left_out;
			double step;

			if (!read_picture(inputs[i], operators[k].name, &want))
				skip();
			step = compare(&look, &in, &want, &left_out);
			printf("# %s %s: worst difference %.4f of 255 (%zu pixels left out)\n",
			       inputs[i], operators[k].name, step, left_out);
			worst = fmax(worst, step);
			image_finish(&want);
		}
		image_finish(&in);
	}
	assert_true(worst < 0.035);
}

/* One frame of pattanaik_time_step.csv. */
struct step_row {
	double base, in[8], out[8];
};

static bool read_row(FILE *file, struct step_row *row)
{
	char line[1024], *at = line;
	double values[19];

	if (!fgets(line, sizeof line, file))
		return false;
	for (int i = 0; i < 19; i++) {
		values[i] = strtod(at, &at);
		at += *at == ',';
	}
	row->base = values[2];
	memcpy(row->in, values + 3, sizeof row->in);
	memcpy(row->out, values + 11, sizeof row->out);
	return true;
}

/* What the program takes for a frame's light: a ramp over three decades in 64 columns. */
static double program_goal(double base)
{
	double sum = 0;

	for (int k = 0; k < 64; k++)
		sum += log(base * pow(10, -1.5 + 3.0 * k / 63) + 1e-4);
	return exp(sum / 64) - 1e-4;
}

/* The pigment's step of pfstmo_pattanaik00 2.2.0, explicit: breaks down where dt G / (t K) > 2. */
static double program_pigment(double p, double goal, double half, double time_s, double dt_s)
{
	return p + dt_s / time_s * ((1 - p) - p * goal / half);
}

/* A 60th of a second in 400 parts, by the midpoint rule. */
static double fine_pigment(double p, double goal, double half, double time_s)
{
	for (int i = 0; i < 400; i++) {
		double middle = program_pigment(p, goal, half, time_s, 1.0 / 48000);

		p += program_pigment(middle, goal, half, time_s, 1.0 / 24000) - middle;
	}
	return p;
}

static double row_difference(const struct adapt_state *eye, const struct step_row *row)
{
	const struct tone_look look = { .curve = SCENE_CURVE_PATTANAIK, .eye = *eye,
					.exposure = 1 / GR_LUMENS_PER_WATT, .luminance_max = 1,
					.bias = 0.85 };
	struct tone_factors factors;
	double worst = 0;

	tone_factors(&look, &factors);
	for (int c = 0; c < 8; c++) {
		double l[3] = { row->in[c], row->in[c], row->in[c] };

		tone_curve(&factors, l, l);
		worst = fmax(worst, fabs(fmin(l[0], 1) - row->out[c]));
	}
	return 255 * worst;
}

/*
 * The program's own sequence, frame by frame: its levels are ours, its pigment
 * is stepped here as it does, and where that has become negative it shows black.
 */
static void time_step(void **state)
{
	const struct adapt_params params = ADAPT_PARAMS_DEFAULT;
	const double dt = 1.0 / 16;
	double worst = 0, p_cone, p_rod;
	struct adapt_state ours;
	struct step_row row;
	int compared = 0, broken = 0;
	char path[1024], head[1024];
	FILE *file;

	(void)state;
	if (!shared_file("reference/tonemap/pattanaik_time_step.csv", path))
		skip();
	file = fopen(path, "r");
	assert_non_null(file);
	assert_non_null(fgets(head, sizeof head, file));
	for (int frame = 0; read_row(file, &row); frame++) {
		const double goal = program_goal(row.base);
		struct adapt_state program;

		if (frame == 0) {
			assert_int_equal(adapt_settle(&ours, 5 * goal), GR_OK);
			p_cone = ours.cone_pigment;
			p_rod = ours.rod_pigment;
		} else {
			assert_int_equal(adapt_step(&ours, &params, goal, dt), GR_OK);
			p_cone = program_pigment(p_cone, goal, 2e6, 110, dt);
			p_rod = program_pigment(p_rod, goal, 0.04, 400, dt);
		}
		program = ours;
		program.cone_pigment = p_cone;
		program.rod_pigment = p_rod;
		if (p_rod < -0.5) { /* what cones see no longer outweighs it */
			for (int c = 0; c < 8; c++)
				assert_true(row.out[c] == 0);
			broken++;
			continue;
		}
		worst = fmax(worst, row_difference(&program, &row));
		compared++;
	}
	fclose(file);
	printf("# pattanaik_time_step: %d frames within %.4f of 255 with the program's pigment, %d that it "
	       "shows black\n", compared, worst, broken);
	assert_true(worst < 0.01);
	assert_int_equal(compared + broken, 144);
}

/* Our steps against the same equations in steps of a 400th of them; and one step against many. */
static void time_course(void **state)
{
	static const double lights[] = { 1000, 0.1, 1000 };
	const struct adapt_params params = ADAPT_PARAMS_DEFAULT;
	struct adapt_state eye, fine, whole;
	double worst = 0, split = 0;

	(void)state;
	assert_int_equal(adapt_settle(&eye, 1000), GR_OK);
	fine = whole = eye;
	for (size_t k = 0; k < 3; k++) {
		const double before = eye.cone;

		for (int frame = 0; frame < 600; frame++) {
			const double last = eye.cone;

			assert_int_equal(adapt_step(&eye, &params, lights[k], 1.0 / 60), GR_OK);
			/* towards the light, and never beyond */
			assert_true(before < lights[k] ? eye.cone >= last && eye.cone <= lights[k] * (1 + 1e-12)
						       : eye.cone <= last && eye.cone >= lights[k] * (1 - 1e-12));
			fine.rod_pigment = fine_pigment(fine.rod_pigment, lights[k], 0.04, 400);
			worst = fmax(worst, fabs(eye.rod_pigment / fine.rod_pigment - 1));
		}
		assert_int_equal(adapt_step(&whole, &params, lights[k], 10), GR_OK);
		split = fmax(split, fabs(whole.rod_pigment / eye.rod_pigment - 1));
		split = fmax(split, fabs(whole.cone / eye.cone - 1));
	}
	printf("# 1000, 0.1, 1000 cd/m2, 10 s each at 60 Hz: pigment off the fine steps by %.1e, one "
	       "step of 10 s off 600 by %.1e\n", worst, split);
	assert_true(worst < 1e-5);
	assert_true(split < 1e-9);
}

static void steps_that_are_odd(void **state)
{
	const struct adapt_params models[] = { ADAPT_PARAMS_DEFAULT, { ADAPT_EXPONENTIAL, 0.5 } };
	static const double goals[] = { 0, 1e-6, 0.1, 1000, 1e9, 1e300 };
	static const double times[] = { 0, 1e-300, 1e-9, 0.016, 1, 1e9, 1e300, INFINITY };

	(void)state;
	for (size_t m = 0; m < 2; m++)
		for (size_t g = 0; g < 6; g++)
			for (size_t t = 0; t < 8; t++) {
				struct adapt_state eye, settled, before;
				double level = fmin(fmax(goals[g], ADAPT_LEVEL_MIN), ADAPT_LEVEL_MAX);

				assert_int_equal(adapt_settle(&eye, 1000), GR_OK);
				before = eye;
				assert_int_equal(adapt_step(&eye, &models[m], goals[g], times[t]), GR_OK);
				assert_true(eye.cone >= fmin(level, 1000) * (1 - 1e-9) &&
					    eye.cone <= fmax(level, 1000) * (1 + 1e-9));
				assert_true(eye.rod_pigment > 0 && eye.rod_pigment <= 1 &&
					    eye.cone_pigment > 0 && eye.cone_pigment <= 1);
				if (times[t] == 0 && m == 0)
					assert_memory_equal(&eye, &before, sizeof eye);
				if (times[t] >= 1e9) {
					assert_int_equal(adapt_settle(&settled, goals[g]), GR_OK);
					assert_true(fabs(eye.rod / settled.rod - 1) < 1e-9);
					assert_true(fabs(eye.rod_pigment / settled.rod_pigment - 1) < 1e-9);
				}
				before = eye;
				assert_int_equal(adapt_step(&eye, &models[m], NAN, 1), GR_ERR_RANGE);
				assert_int_equal(adapt_step(&eye, &models[m], -1, 1), GR_ERR_RANGE);
				assert_int_equal(adapt_step(&eye, &models[m], 1, NAN), GR_ERR_RANGE);
				assert_int_equal(adapt_step(&eye, &models[m], 1, -1), GR_ERR_RANGE);
				assert_memory_equal(&eye, &before, sizeof eye);
			}
}

/* What walls report: all black, one NaN, no wall at all. */
static void merging(void **state)
{
	struct adapt_sample walls[3] = { { 0 } };
	double goal = 7, max = 8;

	(void)state;
	assert_int_equal(adapt_merge(walls, 3, &goal, &max), GR_NOTHING);
	assert_int_equal(adapt_sample_add(&walls[0], NAN, 1), GR_NOTHING);
	assert_int_equal(adapt_sample_add(&walls[0], INFINITY, 1), GR_NOTHING);
	assert_int_equal(adapt_sample_add(&walls[0], 1, 0), GR_NOTHING);
	assert_int_equal(adapt_sample_add(&walls[0], 1, NAN), GR_NOTHING);
	assert_int_equal(adapt_merge(walls, 3, &goal, &max), GR_NOTHING);
	assert_true(goal == 7 && max == 8);
	for (int i = 0; i < 100; i++)
		assert_int_equal(adapt_sample_add(&walls[1], 0, 1e-4), GR_OK);
	assert_int_equal(adapt_merge(walls, 3, &goal, &max), GR_OK);
	assert_true(fabs(goal / ADAPT_LEVEL_MIN - 1) < 1e-9 && max == 0);
	for (int i = 0; i < 100; i++)
		assert_int_equal(adapt_sample_add(&walls[2], 100, 1e-4), GR_OK);
	assert_int_equal(adapt_merge(walls, 3, &goal, &max), GR_OK);
	assert_true(fabs(goal / 1e-2 - 1) < 1e-9 && max == 100);
	walls[2].max = NAN;
	assert_int_equal(adapt_merge(walls, 3, &goal, &max), GR_NOTHING);
}

/* Every light for every eye through every curve: finite, and brighter never darker. */
static void any_light(void **state)
{
	(void)state;
	for (int curve = 0; curve < SCENE_CURVES; curve++)
		for (double level = 1e-6; level < 2e9; level *= 1000)
			for (double max = 1e-6; max < 2e12; max *= 1e6) {
				struct tone_look look = { .curve = (enum scene_curve)curve, .bias = 0.85,
							  .exposure = 1 / GR_LUMENS_PER_WATT,
							  .luminance_max = max };
				struct tone_factors factors;
				double last = 0;

				assert_int_equal(adapt_settle(&look.eye, level), GR_OK);
				assert_true(tone_look_valid(&look));
				tone_factors(&look, &factors);
				for (double y = 0; y < 2e9; y = y > 0 ? y * 1.5 : 1e-9) {
					double l[3] = { y, y, y };

					tone_curve(&factors, l, l);
					assert_true(isfinite(l[1]) && l[1] >= 0);
					assert_true(fmin(l[1], 1) >= last * (1 - 1e-9));
					last = fmin(l[1], 1);
				}
				for (int c = 0; c < 3; c++) { /* one band, and less than nothing in another */
					double l[3] = { -1, -1, -1 };

					l[c] = 1e9;
					tone_curve(&factors, l, l);
					for (int i = 0; i < 3; i++)
						assert_true(isfinite(l[i]) && l[i] >= 0);
				}
			}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pictures),
		cmocka_unit_test(time_step),
		cmocka_unit_test(time_course),
		cmocka_unit_test(steps_that_are_odd),
		cmocka_unit_test(merging),
		cmocka_unit_test(any_light),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
