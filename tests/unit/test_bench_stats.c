/* What the bench computes of its measurements: quantiles, errors, flicker, the Pareto front, axes, the plot. */
#include "tests/unit/unit.h"

#include "base/result.h"
#include "tools/bench/axis.h"
#include "tools/bench/plot.h"
#include "tools/bench/stats.h"
#include "tools/bench/svg.h"

#include <math.h>

static void assert_near(double a, double b)
{
	if (!(fabs(a - b) <= 1e-9 * fmax(1, fabs(b))))
		fail_msg("%.12g is not %.12g", a, b);
}

static void quantiles(void **state)
{
	double five[] = { 5, 1, 4, 2, 3 }, four[] = { 4, 1, 3, 2 }, one[] = { 7 };
	struct stats_spread s = stats_spread(five, 5);

	(void)state;
	assert_near(s.median, 3);
	assert_near(s.p10, 1.4);
	assert_near(s.p90, 4.6);
	assert_int_equal(s.count, 5);
	assert_near(stats_spread(four, 4).median, 2.5);
	s = stats_spread(one, 1);
	assert_near(s.p10, 7);
	assert_near(s.p90, 7);
	assert_near(stats_quantile(five, 5, 0), 1);
	assert_near(stats_quantile(five, 5, 1), 5);
	assert_true(isnan(stats_quantile(five, 0, 0.5)));
	assert_true(isnan(stats_quantile(five, 5, -0.1)));
	assert_true(isnan(stats_quantile(five, 5, (double)NAN)));
	assert_true(isnan(stats_spread(NULL, 0).median));
}

static void errors(void **state)
{
	const double truth[] = { 1, 1, 1, 3, 3, 3 }, weights[] = { 3, 1 };
	const float same[] = { 1, 1, 1, 3, 3, 3 }, tenth[] = { 1.5f, 1.5f, 1.5f, 3, 3, 3 };
	const float bad[] = { 1, NAN, 1, 3, 3, 3 };
	const double dark[6] = { 0 };
	double scratch[2];
	struct stats_error e;

	(void)state;
	assert_int_equal(stats_compare(same, truth, weights, 2, 3, scratch, &e), GR_OK);
	assert_near(e.mean, 1.5);
	assert_near(e.bias, 0);
	assert_near(e.nrmse, 0);
	assert_near(e.p95, 0);
	assert_int_equal(stats_compare(tenth, truth, weights, 2, 3, scratch, &e), GR_OK);
	assert_near(e.bias, 0.25);
	assert_near(e.nrmse, sqrt(0.25 * 0.75) / 1.5);
	assert_near(e.p95, 0.5 * 0.95);
	/* without weights both points count alike */
	assert_int_equal(stats_compare(tenth, truth, NULL, 2, 3, scratch, &e), GR_OK);
	assert_near(e.bias, 0.125);
	assert_int_equal(stats_compare(bad, truth, weights, 2, 3, scratch, &e), GR_OK);
	assert_int_equal(e.nonfinite, 1);
	assert_int_equal(e.count, 1);
	assert_near(e.bias, 0);
	assert_int_equal(stats_compare(same, dark, NULL, 2, 3, scratch, &e), GR_NOTHING);
	assert_true(isnan(e.nrmse));
	assert_int_equal(stats_compare(NULL, NULL, NULL, 0, 3, scratch, &e), GR_NOTHING);
}

static void flicker(void **state)
{
	const float line[] = { 1, 2, 3, 4 }, jump[] = { 1, 1, 2, 1, 1 };

	(void)state;
	assert_near(stats_flicker(line, 4, 1).worst, 0);
	assert_near(stats_flicker(jump, 5, 1).worst, 2 / 1.2);
	assert_near(stats_flicker(jump, 5, 1).mean, (1 + 2 + 1) / 3.0 / 1.2);
	assert_true(isnan(stats_flicker(line, 2, 2).worst));
	assert_true(isnan(stats_flicker((const float[]){ 0, 0, 0 }, 3, 1).mean));
}

static void frames_within(void **state)
{
	const double falls[] = { 0.5, 0.2, 0.09, 0.12, 0.08, 0.01 };

	(void)state;
	assert_int_equal(stats_frames_within(falls, 6, 0.1), 5);
	assert_int_equal(stats_frames_within(falls, 6, 1), 1);
	assert_int_equal(stats_frames_within(falls, 6, 0.001), 0);
	assert_int_equal(stats_frames_within(falls, 0, 1), 0);
	assert_int_equal(stats_frames_within((const double[]){ 0.1, (double)NAN }, 2, 1), 0);
}

static void pareto_front(void **state)
{
	const struct stats_point points[] = { { 4, 1 }, { 1, 5 }, { 2, 5 }, { 2, 3 }, { 3, 4 },
					      { 2, 3 }, { (double)NAN, 0 }, { 0.5, (double)INFINITY } };
	size_t front[8];

	(void)state;
	assert_int_equal(stats_pareto(points, 8, front), 3);
	assert_int_equal(front[0], 1);
	assert_int_equal(front[1], 3); /* the first of two equal ones */
	assert_int_equal(front[2], 0);
	assert_int_equal(stats_pareto(points, 0, front), 0);
}

/* On the front nobody is beaten, off it everybody is. */
static void pareto_of_many(void **state)
{
	struct unit_random r = unit_random_start("pareto_of_many");

	(void)state;
	for (int round = 0; round < 200; round++) {
		struct stats_point p[40];
		size_t front[40], count;
		bool on[40] = { false };

		for (int i = 0; i < 40; i++)
			p[i] = (struct stats_point){ unit_random_u32(&r) % 12, unit_random_u32(&r) % 12 };
		count = stats_pareto(p, 40, front);
		for (size_t i = 0; i < count; i++) {
			on[front[i]] = true;
			if (i > 0) {
				assert_true(p[front[i]].cost > p[front[i - 1]].cost);
				assert_true(p[front[i]].error < p[front[i - 1]].error);
			}
		}
		for (int i = 0; i < 40; i++) {
			bool covered = false;

			for (size_t k = 0; k < count; k++)
				covered |= p[front[k]].cost <= p[i].cost && p[front[k]].error <= p[i].error;
			assert_true(covered || on[i]);
		}
	}
}

static const struct axis_tick *tick_of(const struct axis *axis, double value)
{
	for (size_t i = 0; i < axis->tick_count; i++)
		if (fabs(axis->ticks[i].value / value - 1) < 1e-9)
			return &axis->ticks[i];
	return NULL;
}

static void axis_ticks(void **state)
{
	const double values[] = { 0.8, 31, 4.1, -3, 0, (double)NAN, (double)INFINITY };
	const double wide[] = { 1e-7, 1e6 }, one[] = { 3 }, huge[] = { 1e-300, 1e300 };
	struct axis axis;

	(void)state;
	axis_fit(&axis, values, 7);
	assert_near(axis.low, 0.5);
	assert_near(axis.high, 50);
	assert_string_equal(tick_of(&axis, 0.5)->label, "0.5");
	assert_string_equal(tick_of(&axis, 20)->label, "20");
	assert_false(tick_of(&axis, 3)->labelled);
	assert_null(tick_of(&axis, 60));
	assert_near(axis_place(&axis, 0.5), 0);
	assert_near(axis_place(&axis, 5), 0.5);
	assert_near(axis_place(&axis, 50), 1);
	axis_fit(&axis, wide, 2);
	assert_true(tick_of(&axis, 1e3)->labelled);
	assert_false(tick_of(&axis, 2e3) && tick_of(&axis, 2e3)->labelled);
	axis_fit(&axis, one, 1);
	assert_true(axis.low < 3 && axis.high > 3 && axis.high / axis.low >= 3);
	axis_fit(&axis, huge, 2);
	assert_true(axis.tick_count > 3 && axis.low > 0 && isfinite(axis.high));
	axis_fit(&axis, NULL, 0);
	assert_near(axis.low, 0.1);
	assert_near(axis.high, 10);
}

/* Any data: ends are ordered, ticks rise and lie within, labels are numbers. */
static void axis_of_anything(void **state)
{
	struct unit_random r = unit_random_start("axis_of_anything");

	(void)state;
	for (int round = 0; round < 2000; round++) {
		double values[5];
		struct axis axis;
		int labels = 0;

		for (int i = 0; i < 5; i++)
			values[i] = pow(10, unit_random_range(&r, -12, 12) * (round % 5) / 4);
		axis_fit(&axis, values, 5);
		for (int i = 0; i < 5; i++) {
			double at = axis_place(&axis, values[i]);

			assert_true(at >= 0 && at <= 1);
		}
		assert_true(axis.tick_count <= AXIS_TICKS_MAX);
		for (size_t i = 0; i < axis.tick_count; i++) {
			assert_true(i == 0 || axis.ticks[i].value > axis.ticks[i - 1].value);
			labels += axis.ticks[i].labelled;
			assert_true(!axis.ticks[i].labelled || atof(axis.ticks[i].label) > 0);
		}
		assert_true(labels >= 1);
	}
}

static char *plot_text(const struct plot *plot, int *result)
{
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);

	assert_non_null(out);
	*result = plot_write(out, plot);
	fclose(out);
	return text;
}

static void plot_is_written(void **state)
{
	struct plot_point points[] = {
		{ "lpv", "32 x 8 <&>", 31, 30, 28, 40 },
		{ "surfels", "0.25 m", 1.5, 4, (double)NAN, (double)NAN },
		{ "surfels", "not shown", 0, 4, (double)NAN, (double)NAN },
		{ "hidden", "nor this", (double)NAN, 4, (double)NAN, (double)NAN },
	};
	struct plot plot = { .title = "a \"room\"", .subtitle = "x", .cost_label = "ms",
			     .error_label = "%", .points = points, .count = 4,
			     .level_label = "none", .level = 130 };
	char *text, *again;
	int result;

	(void)state;
	text = plot_text(&plot, &result);
	again = plot_text(&plot, &result);
	assert_int_equal(result, GR_OK);
	assert_string_equal(text, again);
	assert_non_null(strstr(text, "32 x 8 &lt;&amp;&gt;"));
	assert_non_null(strstr(text, "a &quot;room&quot;"));
	assert_non_null(strstr(text, "<polyline"));
	assert_null(strstr(text, "not shown"));
	assert_null(strstr(text, "hidden"));
	assert_null(strstr(text, "nan"));
	assert_null(strstr(text, "inf"));
	free(text);
	free(again);
	plot.count = 0;
	plot.level_label = NULL;
	text = plot_text(&plot, &result);
	assert_int_equal(result, GR_OK);
	assert_non_null(strstr(text, "nothing to show"));
	free(text);
	plot.count = PLOT_POINTS_MAX + 1;
	text = plot_text(&plot, &result);
	assert_int_equal(result, GR_ERR_RANGE);
	free(text);
}

/* As many as fit, all in one spot: labels find a place or share one; nothing runs over. */
static void plot_of_many(void **state)
{
	static struct plot_point points[PLOT_POINTS_MAX];
	const struct plot plot = { .title = "t", .subtitle = "s", .cost_label = "c", .error_label = "e",
				   .points = points, .count = PLOT_POINTS_MAX, .level_label = "l",
				   .level = 1 };
	static const char *const names[] = { "a", "b", "c", "d", "e", "f", "g", "h", "i" };
	int result;

	(void)state;
	for (size_t i = 0; i < PLOT_POINTS_MAX; i++)
		points[i] = (struct plot_point){ names[i % 8], "a label of some length", 1 + (double)i * 1e-3,
						 2 - (double)i * 1e-3, 0.5, 2 };
	free(plot_text(&plot, &result));
	assert_int_equal(result, GR_OK);
	points[3].series = names[8];
	free(plot_text(&plot, &result));
	assert_int_equal(result, GR_ERR_RANGE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(quantiles),	 cmocka_unit_test(errors),
		cmocka_unit_test(flicker),	 cmocka_unit_test(frames_within),
		cmocka_unit_test(pareto_front),	 cmocka_unit_test(pareto_of_many),
		cmocka_unit_test(axis_ticks),	 cmocka_unit_test(axis_of_anything),
		cmocka_unit_test(plot_is_written), cmocka_unit_test(plot_of_many),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
