/* What an eye looks at, on the GPU, beside the same in double precision. */
#include "base/photometry.h"
#include "base/result.h"
#include "renderer/tone/gaze.h"
#include "tests/unit/gl.h"
#include "tests/unit/unit.h"

#include <epoxy/gl.h>

#define WIDTH 200
#define HEIGHT 150

static struct gaze_stage *stage;

static const struct projection_wall front = { { -1.5f, 0, -1.5f }, { 1.5f, 0, -1.5f }, { -1.5f, 2.2f, -1.5f } };
static const struct projection_wall left = { { -1.5f, 0, 1.5f }, { -1.5f, 0, -1.5f }, { -1.5f, 2.2f, 1.5f } };
static const struct projection_wall floor_ = { { -1.5f, 0, 1.5f }, { 1.5f, 0, 1.5f }, { -1.5f, 0, -1.5f } };

static unsigned picture(const float *rgba)
{
	unsigned texture;

	glCreateTextures(GL_TEXTURE_2D, 1, &texture);
	glTextureStorage2D(texture, 1, GL_RGBA32F, WIDTH, HEIGHT);
	glTextureSubImage2D(texture, 0, 0, 0, WIDTH, HEIGHT, GL_RGBA, GL_FLOAT, rgba);
	return texture;
}

static struct gaze_view view_to(const struct projection_wall *wall, double x, double y, double z)
{
	const double length = sqrt(x * x + y * y + z * z);

	return (struct gaze_view){
		.wall = *wall,
		.eye = { 0.2f, 1.6f, 0.1f },
		.direction = { (float)(x / length), (float)(y / length), (float)(z / length) },
	};
}

/* From the eye to a point. */
static struct gaze_view view_at(const struct projection_wall *wall, double x, double y, double z)
{
	const struct gaze_view v = view_to(wall, 0, 0, -1);

	return view_to(wall, x - (double)v.eye[0], y - (double)v.eye[1], z - (double)v.eye[2]);
}

static struct adapt_sample measured(const struct gaze_view *view, const float *rgba)
{
	static uint64_t frame;
	const unsigned texture = picture(rgba);
	struct adapt_sample sample;
	uint64_t of = 0;

	assert_int_equal(gaze_measure(stage, view, texture, WIDTH, HEIGHT, ++frame), GR_OK);
	glFinish();
	assert_int_equal(gaze_newest(stage, &sample, &of), GR_OK);
	assert_int_equal(of, frame);
	glDeleteTextures(1, &texture);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	return sample;
}

/* The same in double. */
static struct adapt_sample reckoned(const struct gaze_view *v, const float *rgba)
{
	const int columns = GAZE_CELLS, rows = GAZE_CELLS;
	struct adapt_sample sample = { 0 };
	double most = 0;

	for (int cy = 0; cy < rows; cy++)
		for (int cx = 0; cx < columns; cx++) {
			const double u = (cx + 0.5) / columns, w = (cy + 0.5) / rows;
			double to[3], right[3], up[3], area[3], d = 0, along = 0, facing = 0, sum = 0;
			int count = 0;

			for (int i = 0; i < 3; i++) {
				right[i] = (double)v->wall.lower_right[i] - (double)v->wall.lower_left[i];
				up[i] = (double)v->wall.upper_left[i] - (double)v->wall.lower_left[i];
				to[i] = (double)v->wall.lower_left[i] - (double)v->eye[i] + u * right[i] + w * up[i];
				d += to[i] * to[i];
				along += to[i] * (double)v->direction[i];
			}
			for (int i = 0; i < 3; i++) {
				area[i] = right[(i + 1) % 3] * up[(i + 2) % 3] - right[(i + 2) % 3] * up[(i + 1) % 3];
				facing += area[i] * to[i];
			}
			for (int y = cy * HEIGHT / rows; y < (cy + 1) * HEIGHT / rows; y++)
				for (int x = cx * WIDTH / columns; x < (cx + 1) * WIDTH / columns; x++) {
					const float *p = rgba + 4 * (y * WIDTH + x);
					const double rgb[3] = { (double)p[0], (double)p[1], (double)p[2] };
					double l;

					if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
						continue;
					l = fmin(gr_luminance(rgb), ADAPT_LEVEL_MAX);
					most = fmax(most, l);
					sum += l;
					count++;
				}
			if (count && along >= cos((double)GAZE_CONE_RAD / 2) * sqrt(d))
				adapt_sample_add(&sample, sum / count, fabs(facing) / (d * sqrt(d) * columns * rows));
		}
	sample.max = most;
	return sample;
}

static void compare(const char *what, const struct gaze_view *view, const float *rgba)
{
	const struct adapt_sample got = measured(view, rgba), want = reckoned(view, rgba);
	double goal = 0, truth = 0, max, true_max;

	/* A cell whose middle is on the cone's edge may be on either side: one of some hundreds. */
	assert_true(fabs(got.solid_angle - want.solid_angle) <= 0.01 * want.solid_angle);
	assert_true(fabs(got.max - want.max) <= 1e-5 * want.max);
	if (want.solid_angle > 0) {
		assert_int_equal(adapt_merge(&got, 1, &goal, &max), GR_OK);
		assert_int_equal(adapt_merge(&want, 1, &truth, &true_max), GR_OK);
		assert_true(fabs(goal / truth - 1) < 0.005);
	} else {
		assert_int_equal(adapt_merge(&got, 1, &goal, &max), GR_NOTHING);
	}
	printf("# %s: %.6f sr of %.6f, goal %.6g cd/m2 of %.6g, most %.4g\n", what, got.solid_angle,
	       want.solid_angle, goal, truth, got.max);
}

static float *uniform(float value)
{
	static float rgba[4 * WIDTH * HEIGHT];

	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = value;
		rgba[4 * i + 3] = 1;
	}
	return rgba;
}

static void as_in_double(void **state)
{
	struct unit_random r = unit_random_start("gaze");
	const struct gaze_view ahead = view_to(&front, 0.05, -0.02, -1), aside = view_to(&left, -1, 0.1, -0.5);
	float *rgba = uniform(0);

	(void)state;
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		for (int k = 0; k < 3; k++)
			rgba[4 * i + k] = (float)exp(unit_random_range(&r, -8, 8));
	compare("a wall ahead", &ahead, rgba);
	compare("a wall askew", &aside, rgba);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			for (int k = 0; k < 3; k++)
				rgba[4 * (y * WIDTH + x) + k] = expf(0.05f * (float)x);
	compare("a slope", &ahead, rgba);
}

static void extremes(void **state)
{
	const struct gaze_view ahead = view_to(&front, 0, 0, -1);
	const float values[] = { 0, 1e-38f, 1e-9f, 1e-3f, 1, 1e6f, 3e38f };
	struct adapt_sample sample;
	double goal, max;

	(void)state;
	for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
		const double l = GR_LUMENS_PER_WATT * (double)values[i],
			     level = fmin(fmax(l, ADAPT_LEVEL_MIN), ADAPT_LEVEL_MAX);

		sample = measured(&ahead, uniform(values[i]));
		assert_int_equal(adapt_merge(&sample, 1, &goal, &max), GR_OK);
		assert_true(fabs(goal / level - 1) < 1e-4);
		assert_true(fabs(max - fmin(l, ADAPT_LEVEL_MAX)) <= 1e-5 * fmin(l, ADAPT_LEVEL_MAX));
	}
	/* Pixels that are no numbers are left out; a wall of nothing else says nothing. */
	sample = measured(&ahead, uniform(NAN));
	assert_int_equal(adapt_merge(&sample, 1, &goal, &max), GR_NOTHING);
	{
		float *rgba = uniform(1);

		for (int i = 0; i < WIDTH * HEIGHT; i += 7)
			rgba[4 * i + i % 3] = i & 1 ? NAN : INFINITY;
		sample = measured(&ahead, rgba);
		assert_int_equal(adapt_merge(&sample, 1, &goal, &max), GR_OK);
		assert_true(fabs(goal / GR_LUMENS_PER_WATT - 1) < 1e-4 && fabs(max / GR_LUMENS_PER_WATT - 1) < 1e-4);
	}
	/* A sun in one pixel, far from where one looks: the brightest, and nothing to the goal. */
	{
		float *rgba = uniform(1);

		rgba[4 * (3 * WIDTH + 5)] = 1e4f;
		sample = measured(&ahead, rgba);
		assert_int_equal(adapt_merge(&sample, 1, &goal, &max), GR_OK);
		assert_true(fabs(goal / GR_LUMENS_PER_WATT - 1) < 1e-4);
		assert_true(max > 0.2 * 1e4 * GR_LUMENS_PER_WATT);
	}
}

/* Where three walls meet all three are looked at, and together they are the cone. */
static void corner(void **state)
{
	const struct projection_wall *const walls[] = { &front, &left, &floor_ };
	const double cone = 2 * M_PI * (1 - cos((double)GAZE_CONE_RAD / 2));
	const float values[] = { 1, 10, 100 };
	struct adapt_sample samples[3];
	double goal, max, sum = 0, expected = 0;

	(void)state;
	for (int i = 0; i < 3; i++) {
		const struct gaze_view v = view_at(walls[i], -1.5, 0, -1.5);

		samples[i] = measured(&v, uniform(values[i]));
		assert_true(samples[i].solid_angle > 0.1 * cone);
		sum += samples[i].solid_angle;
		expected += samples[i].solid_angle * log((double)values[i] * GR_LUMENS_PER_WATT);
	}
	assert_int_equal(adapt_merge(samples, 3, &goal, &max), GR_OK);
	printf("# the corner of three walls: %.4f + %.4f + %.4f of a cone of %.4f sr; goal %.4g cd/m2\n",
	       samples[0].solid_angle, samples[1].solid_angle, samples[2].solid_angle, cone, goal);
	assert_true(fabs(sum / cone - 1) < 0.03);
	assert_true(fabs(log(goal) - expected / sum) < 1e-4);
	assert_true(fabs(max / (100 * GR_LUMENS_PER_WATT) - 1) < 1e-4);
	/* Out of the room's open back, and above its walls: nothing. */
	for (int i = 0; i < 3; i++) {
		const struct gaze_view back = view_to(walls[i], 0, 0.1, 1), above = view_to(walls[i], 0, 1, 0);

		assert_true(measured(&back, uniform(1)).solid_angle == 0);
		assert_true(measured(&above, uniform(1)).solid_angle == 0);
	}
}

static void refused(void **state)
{
	const unsigned texture = picture(uniform(1));
	struct gaze_view v = view_to(&front, 0, 0, -1);
	const float eyes[][3] = { { 0, 1, -1.5f }, { 0, 1, -3 }, { NAN, 1, 0 }, { 0, INFINITY, 0 } };
	struct gaze_stage *fresh;
	struct adapt_sample sample;
	uint64_t frame;

	(void)state;
	for (size_t i = 0; i < sizeof eyes / sizeof *eyes; i++) {
		memcpy(v.eye, eyes[i], sizeof v.eye);
		assert_int_equal(gaze_measure(stage, &v, texture, WIDTH, HEIGHT, 1), GR_ERR_RANGE);
	}
	v = view_to(&front, 0, 0, -1);
	v.direction[2] = -2;
	assert_int_equal(gaze_measure(stage, &v, texture, WIDTH, HEIGHT, 1), GR_ERR_RANGE);
	v.direction[2] = NAN;
	assert_int_equal(gaze_measure(stage, &v, texture, WIDTH, HEIGHT, 1), GR_ERR_RANGE);
	v = view_to(&front, 0, 0, -1);
	assert_int_equal(gaze_measure(stage, &v, texture, 0, HEIGHT, 1), GR_ERR_RANGE);
	assert_int_equal(gaze_create(&fresh), GR_OK);
	assert_int_equal(gaze_newest(fresh, &sample, &frame), GR_NOTHING);
	/* Many at once: the newest comes out, and none is waited for. */
	for (uint64_t f = 1; f <= 40; f++)
		assert_true(gaze_measure(fresh, &v, texture, WIDTH, HEIGHT, f) >= 0);
	glFinish();
	assert_int_equal(gaze_newest(fresh, &sample, &frame), GR_OK);
	assert_true(frame >= 4 && frame <= 40);
	gaze_destroy(&fresh);
	glDeleteTextures(1, &texture);
}

int main(void)
{
	struct target *target = gl_target_or_skip(16, 16);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(as_in_double), cmocka_unit_test(extremes),
		cmocka_unit_test(corner),       cmocka_unit_test(refused),
	};
	int failed;

	if (gaze_create(&stage) != GR_OK)
		return 1;
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	gaze_destroy(&stage);
	target_destroy(&target);
	return failed;
}
