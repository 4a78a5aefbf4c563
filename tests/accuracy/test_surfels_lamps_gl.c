/* Relit surfels through the real shaders: lamps that change, what is not a number, what cannot be. */
#include "base/log.h"
#include "base/result.h"
#include "tests/accuracy/surfels_gl.h"
#include "tests/unit/unit.h"
#include "tools/bench/lpv_bench.h"
#include "tools/bench/room.h"

#include <epoxy/gl.h>
#include <math.h>

static struct surfel_set *coarse;

static void begin(struct lit *s, int lamps)
{
	const struct truth_spot spot = bench_spot();

	lit_begin_with(s, lit_room.scene, coarse, &spot, lamps, false);
}

static void lamp_switches(void **state)
{
	static float found[3 * LIT_POINTS];
	static const float factors[] = { 1, 0, 1, 1e-3f, 1e-7f };
	struct lit s;
	double lit, last = 0, before = 0;
	int frames = 0;

	(void)state;
	begin(&s, 1);
	lit_frame(&s);
	lit = lit_mean(&s, found);
	lit_intensity(&s, 0, 0, 0, 0);
	for (; frames < 40 && (frames == 0 || last > 1e-3 * lit); frames++) {
		lit_frame(&s);
		last = lit_mean(&s, found);
	}
	printf("# lamp off, 2 gathers a frame: under 0.1 %% of the light after %d frames\n", frames);
	assert_true(frames <= 11);
	for (size_t k = 0; k < sizeof factors / sizeof *factors; k++) {
		lit_intensity(&s, 0, 50 * factors[k], 50 * factors[k], 50 * factors[k]);
		for (int i = 0; i < 24; i++)
			lit_frame(&s);
		last = lit_mean(&s, found);
		/* what is left of the light before when work stops */
		assert_true(fabs(last - lit * (double)factors[k]) <
			    1e-5 * lit * fmax(before, (double)factors[k]));
		before = (double)factors[k];
		assert_int_equal(lit_stats(&s).nonfinite, 0);
	}
	printf("# fade to 1e-7: E = %.2e of E lit\n", last / lit);
	lit_end(&s);
}

static void two_lamps(void **state)
{
	static float both[3 * LIT_POINTS], one[3 * LIT_POINTS], other[3 * LIT_POINTS];
	static const float place[3] = { 1.2f, 3.5f, 2.6f };
	struct lit s;
	double worst = 0, mean;

	(void)state;
	begin(&s, 2);
	memcpy(s.rig.frame.lamps[1].position, place, sizeof place);
	s.rig.frame.lamps[1].on = false;
	lit_frame(&s);
	lit_mean(&s, one);
	s.rig.frame.lamps[0].on = false;
	s.rig.frame.lamps[1].on = true;
	lit_intensity(&s, 1, 9, 3, 21);
	s.rig.frame.gi_epoch++;
	lit_frame(&s);
	lit_mean(&s, other);
	s.rig.frame.lamps[0].on = true;
	s.rig.frame.gi_epoch++;
	lit_frame(&s);
	mean = lit_mean(&s, both);
	for (size_t k = 0; k < 3 * lit_room.count; k++)
		worst = fmax(worst, fabs((double)(both[k] - one[k] - other[k])));
	printf("# two lamps: sum off by %.1e of the mean\n", worst / mean);
	assert_true(worst / mean < 1e-5);
	/* another colour: each band by itself */
	s.rig.frame.lamps[1].on = false;
	lit_intensity(&s, 0, 50, 25, 5);
	s.rig.frame.gi_epoch++;
	lit_frame(&s);
	lit_mean(&s, both);
	worst = 0;
	for (size_t k = 0; k < lit_room.count; k++) {
		worst = fmax(worst, fabs((double)(both[3 * k + 1] - 0.5f * one[3 * k + 1])));
		worst = fmax(worst, fabs((double)(both[3 * k + 2] - 0.1f * one[3 * k + 2])));
	}
	printf("# another colour: off by %.1e of the mean\n", worst / mean);
	assert_true(worst / mean < 1e-5);
	lit_end(&s);
}

static void huge_intensity(void **state)
{
	static float found[3 * LIT_POINTS];
	struct lit s;
	double e;

	(void)state;
	begin(&s, 1);
	lit_intensity(&s, 0, 5e10f, 5e10f, 5e10f);
	lit_frame(&s);
	e = lit_mean(&s, found);
	printf("# intensity %g W/sr: mean E %.4g, nonfinite %llu\n", 5e10, e,
	       (unsigned long long)lit_stats(&s).nonfinite);
	assert_true(e > 65504 && isfinite(e));
	assert_int_equal(lit_stats(&s).nonfinite, 0);
	lit_end(&s);
}

static void nan_is_reported(void **state)
{
	const float bad = NAN;
	struct lit s;
	struct surfels *surfels;

	(void)state;
	begin(&s, 1);
	lit_frame(&s);
	assert_int_equal(lit_stats(&s).nonfinite, 0);
	surfels = (struct surfels *)s.method;
	glClearNamedBufferSubData(surfels->found.buffer, GL_R32F, 16 * 77 + 4, 4, GL_RED, GL_FLOAT, &bad);
	lit_intensity(&s, 0, 49, 49, 49);
	lit_frame(&s);
	printf("# one NaN in a surfel: %llu surfels reported a frame later\n",
	       (unsigned long long)lit_stats(&s).nonfinite);
	assert_true(lit_stats(&s).nonfinite > 0);
	/* a new epoch starts from darkness */
	uint64_t known = lit_stats(&s).nonfinite;
	s.rig.frame.gi_epoch++;
	lit_frame(&s);
	assert_int_equal(lit_stats(&s).nonfinite, known);
	lit_end(&s);
}

static void comes_to_rest(void **state)
{
	struct lit s;
	struct gi_stats stats;
	int frames = 0;

	(void)state;
	begin(&s, 1);
	lit_frame(&s);
	assert_true(lit_stats(&s).steady);
	lit_frame(&s);
	assert_false(lit_stats(&s).ran);
	lit_intensity(&s, 0, 25, 25, 25);
	do {
		lit_frame(&s);
		stats = lit_stats(&s);
		frames += stats.ran;
	} while (stats.ran && frames < 1000);
	printf("# after a change: %d frames of work, then none; last change %.1e\n", frames, stats.residual);
	assert_true(frames < 40 && stats.steady);
	assert_true(stats.residual < 1e-5);
	lit_end(&s);
}

/* sigma 0.1/m: what comes over one bounce is less, and all of it is gone at sigma 1. */
static void absorbing_medium(void **state)
{
	static float found[3 * LIT_POINTS];
	struct lit s;
	double clear, thick;

	(void)state;
	begin(&s, 1);
	lit_frame(&s);
	clear = lit_mean(&s, found);
	s.rig.frame.absorption_per_m = 0.1f;
	for (int i = 0; i < 24; i++)
		lit_frame(&s);
	thick = lit_mean(&s, found);
	printf("# absorption 0.1/m: %.3f of the clear room's indirect light\n", thick / clear);
	assert_true(thick < 0.6 * clear && thick > 0.2 * clear);
	s.rig.frame.absorption_per_m = 0;
	s.rig.frame.gi_epoch++;
	lit_frame(&s);
	assert_true(fabs(lit_mean(&s, found) / clear - 1) < 1e-6);
	lit_end(&s);
}

/* Sets that cannot be are refused before anything of them is read. */
static void refused_sets(void **state)
{
	const struct surfels_params params = SURFELS_PARAMS_DEFAULT;
	struct surfel_set set = { .spacing_m = 1, .radius_m = 2, .links_each = 16, .taps_each = 16 };
	struct gi_method *method;

	(void)state;
	gr_log_init("test_surfels_lamps_gl", GR_LOG_ERROR);
	assert_int_equal(gi_surfels_create(&method, &set, &params), GR_ERR_RANGE);
	set.count = (size_t)1 << 28; /* 8 GiB of surfels */
	assert_int_equal(gi_surfels_create(&method, &set, &params), GR_ERR_RANGE);
	set.count = SIZE_MAX / 64;
	assert_int_equal(gi_surfels_create(&method, &set, &params), GR_ERR_RANGE);
	assert_null(method);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	gr_log_init("test_surfels_lamps_gl", GR_LOG_WARNING);
}

static void same_bits(void **state)
{
	struct lit a, b;

	(void)state;
	begin(&a, 1);
	begin(&b, 1);
	for (int i = 0; i < 6; i++) {
		a.rig.frame.lamps[0].position[0] = b.rig.frame.lamps[0].position[0] = 2 + 0.05f * (float)i;
		lit_frame(&a);
		lit_frame(&b);
		assert_true(a.method->ops->hash(a.method) == b.method->ops->hash(b.method));
	}
	lit_end(&b);
	begin(&b, 1);
	b.rig.frame.lamps[0].position[0] = 2.25f;
	a.rig.frame.gi_epoch = b.rig.frame.gi_epoch = 7;
	for (int i = 0; i < 3; i++) {
		lit_frame(&a);
		lit_frame(&b);
		assert_true(a.method->ops->hash(a.method) == b.method->ops->hash(b.method));
		lit_intensity(&a, 0, 20, 30, 40);
		lit_intensity(&b, 0, 20, 30, 40);
	}
	printf("# two runs and a late join: hashes equal in every frame (last %016llx)\n",
	       (unsigned long long)a.method->ops->hash(a.method));
	lit_end(&a);
	lit_end(&b);
}

static int open_room(void **state)
{
	(void)state;
	coarse = lit_bake(lit_room.scene, 0.3f, 128, 16, 4);
	return 0;
}

static int close_room(void **state)
{
	(void)state;
	surfel_set_destroy(&coarse);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lamp_switches),
		cmocka_unit_test(two_lamps),
		cmocka_unit_test(huge_intensity),
		cmocka_unit_test(nan_is_reported),
		cmocka_unit_test(comes_to_rest),
		cmocka_unit_test(absorbing_medium),
		cmocka_unit_test(refused_sets),
		cmocka_unit_test(same_bits),
	};
	int failed = lit_open("test_surfels_lamps_gl");

	if (failed)
		return failed;
	failed = cmocka_run_group_tests(tests, open_room, close_room);
	lit_close();
	return failed;
}
