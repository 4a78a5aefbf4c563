/* Light that is no number, in surfels and in probes' cells: counted, and shown as what it is. */
#include "base/log.h"
#include "base/result.h"
#include "tests/accuracy/surfels_gl.h"
#include "tests/unit/unit.h"
#include "tools/bench/lpv_bench.h"

#include <epoxy/gl.h>
#include <math.h>

static struct truth_sample point(const float at[3])
{
	struct truth_sample sample = { .normal = { 0, 1, 0 } };

	memcpy(sample.position, at, sizeof sample.position);
	return sample;
}

static void probe_place(const struct surfel_probes *probes, size_t probe, float out[3])
{
	const size_t size[2] = { (size_t)probes->size[0], (size_t)probes->size[1] };
	const size_t cell[3] = { probe % size[0], probe / size[0] % size[1], probe / (size[0] * size[1]) };

	for (int k = 0; k < 3; k++)
		out[k] = probes->origin[k] + (float)cell[k] * probes->cell_m;
}

static bool finite3(const float v[3])
{
	return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* Of the light of two points: one beside the first probe, one beside the last. */
static void look(struct lit *s, const struct surfel_set *set, float out[6])
{
	struct truth_sample at[2];
	float place[3];

	for (int i = 0; i < 2; i++) {
		probe_place(&set->probes, i ? set->probes.count - 1 : 0, place);
		at[i] = point(place);
	}
	lit_look(s->method, at, 2, out);
}

/* A set is checked when it is baked and when it is read; what is wrong all the same is not hidden. */
static void in_a_probes_cell(void **state)
{
	const float wrong[] = { NAN, INFINITY, -INFINITY };
	const struct truth_spot spot = bench_spot();
	struct surfel_set *set = lit_bake(lit_room.scene, 0.4f, 64, 16, 4);

	(void)state;
	assert_true(set->probes.count > 8);
	for (size_t k = 0; k <= sizeof wrong / sizeof *wrong; k++) {
		const bool healthy = k == sizeof wrong / sizeof *wrong;
		float *at = &set->probes.fixed[0][4][1], before = *at, found[6];
		struct gi_stats stats;
		struct lit s;

		if (!healthy)
			*at = wrong[k];
		gr_log_set_level((enum gr_log_level)0);
		lit_begin_with(&s, lit_room.scene, set, &spot, 1, true);
		lit_frame(&s);
		stats = lit_stats(&s);
		gr_log_set_level(GR_LOG_WARNING);
		*at = before;
		assert_int_equal(stats.nonfinite, healthy ? 0 : 1);
		look(&s, set, found);
		assert_int_equal(finite3(found), healthy);
		assert_true(finite3(found + 3));
		/* it stays, and goes on being counted while the light changes */
		lit_intensity(&s, 0, 30, 30, 30);
		surfel_rig_light(&s.rig);
		gr_log_set_level((enum gr_log_level)0);
		lit_frame(&s);
		assert_int_equal(lit_stats(&s).nonfinite, healthy ? 0 : 2);
		gr_log_set_level(GR_LOG_WARNING);
		lit_end(&s);
	}
	surfel_set_destroy(&set);
}

/* A surfel's own, which its links hand on: to other surfels, and to probes. */
static void in_a_surfel(void **state)
{
	const struct truth_spot spot = bench_spot();
	struct surfel_set *set = lit_bake(lit_room.scene, 0.4f, 64, 16, 4);
	uint64_t surfels = 0;

	(void)state;
	for (int probes = 0; probes < 2; probes++) {
		const float before = set->fixed_other[0][0];
		struct gi_stats stats;
		struct lit s;

		set->fixed_other[0][0] = NAN;
		gr_log_set_level((enum gr_log_level)0);
		lit_begin_with(&s, lit_room.scene, set, &spot, 1, probes);
		lit_frame(&s);
		stats = lit_stats(&s);
		gr_log_set_level(GR_LOG_WARNING);
		set->fixed_other[0][0] = before;
		printf("# one surfel of NaN among %zu, %s: %llu are found\n", set->count,
		       probes ? "probes" : "surfels", (unsigned long long)stats.nonfinite);
		/* all that see it; with probes, these too */
		assert_true(stats.nonfinite > (probes ? surfels : set->count / 4));
		surfels = stats.nonfinite;
		lit_end(&s);
	}
	surfel_set_destroy(&set);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(in_a_probes_cell),
		cmocka_unit_test(in_a_surfel),
	};
	int failed = lit_open("test_surfels_nonfinite_gl");

	if (failed)
		return failed;
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	lit_close();
	return failed;
}
