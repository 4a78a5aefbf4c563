/* Surfel sets by themselves: the light that they give, against path tracing. */
#include "base/result.h"
#include "renderer/gi/surfel_bake.h"
#include "tools/bench/room.h"
#include "tools/bench/surfel_cpu.h"
#include "tests/unit/unit.h"

#include <math.h>

#define POINTS 600

static struct surfel_set *bake(const struct scene *scene, const struct surfel_bake_params *params)
{
	struct gr_diag diag = { 0 };
	struct surfel_set *set;

	assert_int_equal(surfel_bake(&set, scene, NULL, params, &diag), GR_OK);
	gr_diag_finish(&diag);
	return set;
}

static struct truth_error compare(const struct surfel_set *set, const struct truth *truth,
				  const struct truth_sample *samples, size_t count)
{
	static float found[3 * POINTS];
	struct surfel_cpu cpu;

	surfel_cpu_init(&cpu, set);
	surfel_cpu_spot(&cpu, truth);
	surfel_cpu_settle(&cpu);
	for (size_t i = 0; i < count; i++) {
		double e[3];

		assert_true(surfel_cpu_irradiance(&cpu, samples[i].position, samples[i].normal, e) > 0);
		for (size_t c = 0; c < 3; c++)
			found[3 * i + c] = (float)e[c];
	}
	surfel_cpu_finish(&cpu);
	return truth_compare(samples, found, count);
}

static void cornell(void **state)
{
	static struct truth_sample samples[POINTS];
	const struct truth_spot spot = { { 2, 3.9f, 2 }, { 0.1f, -0.995f, 0 }, { 50, 50, 50 }, 0.6f };
	const struct surfel_bake_params params = SURFEL_BAKE_PARAMS;
	struct scene *scene = room_cornell();
	struct surfel_set *set = bake(scene, &params);
	struct truth truth;
	struct truth_error e;
	size_t count;

	(void)state;
	assert_int_equal(truth_init(&truth, scene, &spot), GR_OK);
	count = truth_points(&truth, 5, 0, samples, POINTS);
	truth_trace(&truth, 7, 2000, samples, count);
	e = compare(set, &truth, samples, count);
	printf("# Cornell room, %zu surfels of %.3g m, %u links: bias %+.2f %%, nRMSE %.1f %%, shape %.1f %% (noise of the truth %.1f %%)\n",
	       set->count, (double)set->spacing_m, set->links_each, 100 * e.bias, 100 * e.nrmse,
	       100 * e.shape, 100 * e.noise);
	assert_true(e.nrmse < 0.08);
	assert_true(fabs(e.bias) < 0.02);
	surfel_set_destroy(&set);
	truth_finish(&truth);
	room_free(&scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cornell),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
