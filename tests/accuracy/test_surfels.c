/* Surfel sets by themselves: the light that they give, against path tracing and closed forms. */
#include "base/result.h"
#include "renderer/gi/surfel_bake.h"
#include "tools/bench/room.h"
#include "tools/bench/surfel_cpu.h"
#include "tests/unit/unit.h"

#include <math.h>

#define POINTS 600
#define PI 3.14159265358979

static struct surfel_set *bake(const struct scene *scene, float spacing, int links)
{
	struct surfel_bake_params params = SURFEL_BAKE_PARAMS;
	struct gr_diag diag = { 0 };
	struct surfel_set *set;

	params.spacing_m = spacing;
	params.links = links;
	params.probes = 4;
	assert_int_equal(surfel_bake(&set, scene, NULL, &params, &diag), GR_OK);
	gr_diag_finish(&diag);
	return set;
}

static void lit(struct surfel_cpu *cpu, const struct surfel_set *set, const struct truth *truth)
{
	surfel_cpu_init(cpu, set);
	surfel_cpu_spot(cpu, truth);
	surfel_cpu_settle(cpu);
}

static struct truth_error compare(const struct surfel_set *set, const struct truth *truth,
				  const struct truth_sample *samples, size_t count)
{
	static float found[3 * POINTS];
	struct surfel_cpu cpu;

	lit(&cpu, set, truth);
	for (size_t i = 0; i < count; i++) {
		double e[3];

		assert_true(surfel_cpu_irradiance(&cpu, samples[i].position, samples[i].normal, e) > 0);
		for (size_t c = 0; c < 3; c++)
			found[3 * i + c] = (float)e[c];
	}
	surfel_cpu_finish(&cpu);
	return truth_compare(samples, found, count);
}

/* Without the truth's own noise. */
static double nrmse_of(const struct truth_error *e)
{
	return sqrt(fmax(e->nrmse * e->nrmse - e->noise * e->noise, 0));
}

static void cornell(void **state)
{
	static struct truth_sample samples[POINTS];
	const struct truth_spot spot = { { 2, 3.9f, 2 }, { 0.1f, -0.995f, 0 }, { 50, 50, 50 }, 0.6f };
	static const int links[] = { 256, 100, 300 };
	struct scene *scene = room_cornell();
	struct truth truth;
	size_t count;

	(void)state;
	assert_int_equal(truth_init(&truth, scene, &spot), GR_OK);
	count = truth_points(&truth, 5, 0.02f, samples, POINTS);
	truth_trace(&truth, 7, 3000, samples, count);
	/* numbers that are no squares, too: a grid of strata would be biased there */
	for (size_t k = 0; k < sizeof links / sizeof *links; k++) {
		struct surfel_set *set = bake(scene, 0, links[k]);
		struct truth_error e = compare(set, &truth, samples, count);

		printf("# Cornell room, %zu surfels of %.3g m, %u links: bias %+.2f %%, nRMSE %.1f %% (and noise of the truth %.1f %%)\n",
		       set->count, (double)set->spacing_m, set->links_each, 100 * e.bias,
		       100 * nrmse_of(&e), 100 * e.noise);
		assert_true(fabs(e.bias) < 0.01);
		assert_true(nrmse_of(&e) < (links[k] < 256 ? 0.06 : 0.04));
		surfel_set_destroy(&set);
	}
	truth_finish(&truth);
	room_free(&scene);
}

/* Radiance L all around: what emits L (1 - albedo) and reflects the rest, and mirrors between. */
static void furnace(void **state)
{
	const double radiance = 3;

	(void)state;
	for (int mirrors = 0; mirrors < 2; mirrors++) {
		struct room_builder b;
		struct surfel_cpu cpu;
		struct surfel_set *set;
		struct scene *scene;
		double sum = 0, worst = 0;
		size_t seen = 0;

		room_begin(&b);
		uint32_t m = room_material(&b, 0.6f, 0.6f, 0.6f);
		uint32_t glass = room_material(&b, 0, 0, 0);
		room_inside(&b, (uint32_t[6]){ mirrors ? glass : m, m, m, m, m, mirrors ? glass : m },
			    (float[3]){ 0, 0, 0 }, (float[3]){ 3, 2, 4 });
		room_box(&b, m, (float[3]){ 1, 0.5f, 1 }, (float[3]){ 0.3f, 0.4f, 0.3f }, 0.4f);
		scene = room_end(&b);
		for (size_t i = 0; i < scene->material_count; i++)
			scene->materials[i].two_sided = false;
		for (int c = 0; c < 3; c++) {
			scene->materials[m].emission[c] = (float)(radiance * (1 - 0.6));
			scene->materials[glass].specular[c] = 1;
		}
		scene->materials[glass].kind = MATERIAL_MIRROR;
		scene->emissive = true;
		set = bake(scene, 0.3f, 256);
		surfel_cpu_init(&cpu, set);
		surfel_cpu_settle(&cpu);
		for (size_t i = 0; i < set->count; i++) {
			double e = cpu.indirect[i][1] + (double)set->fixed_emissive[i][1] +
				   (double)set->fixed_other[i][1];

			seen++;
			sum += e;
			worst = fmax(worst, fabs(e / (PI * radiance) - 1));
		}
		printf("# furnace%s: E / (pi L) = %.4f, worst of %zu surfels off by %.1f %%\n",
		       mirrors ? " with two mirrors for walls" : "", sum / (double)seen / (PI * radiance),
		       seen, 100 * worst);
		assert_true(fabs(sum / (double)seen / (PI * radiance) - 1) < 0.01);
		assert_true(worst < 0.12);
		surfel_cpu_finish(&cpu);
		surfel_set_destroy(&set);
		room_free(&scene);
	}
}

/* Two rooms of 3 m and a wall of so many metres between; with a doorway of 1 x 2 m, or closed. */
static struct scene *two_rooms(float thick, bool door)
{
	struct room_builder b;

	room_begin(&b);
	uint32_t m = room_material(&b, 0.7f, 0.7f, 0.7f);
	room_inside(&b, (uint32_t[6]){ m, m, m, m, m, m }, (float[3]){ 0, 0, 0 }, (float[3]){ 6, 3, 3 });
	if (door) {
		room_box(&b, m, (float[3]){ 3, 1.5f, 0.5f }, (float[3]){ thick / 2, 1.5f, 0.5f }, 0);
		room_box(&b, m, (float[3]){ 3, 1.5f, 2.5f }, (float[3]){ thick / 2, 1.5f, 0.5f }, 0);
		room_box(&b, m, (float[3]){ 3, 2.5f, 1.5f }, (float[3]){ thick / 2, 0.5f, 0.5f }, 0);
	} else {
		room_box(&b, m, (float[3]){ 3, 1.5f, 1.5f }, (float[3]){ thick / 2, 1.5f, 1.5f }, 0);
	}
	return room_end(&b);
}

static const struct truth_spot in_first_room = { { 1, 2.9f, 1.5f }, { 0, -1, 0 }, { 50, 50, 50 }, 0.5f };

/* Mean of the light that arrives over a probe's links. */
static double probe_light(const struct surfel_cpu *cpu, size_t probe)
{
	const struct surfel_probes *p = &cpu->set->probes;
	double sum = 0;

	for (uint32_t k = 0; k < p->links_each; k++) {
		uint32_t to = p->links[probe * p->links_each + k];

		if (to != SURFEL_NONE)
			sum += cpu->exitance[to][1] / p->links_each;
	}
	return sum;
}

static void closed_wall(void **state)
{
	static struct truth_sample samples[POINTS * 4];
	static const float spacings[] = { 0.25f, 0.5f };
	struct scene *scene = two_rooms(0.02f, false);
	struct truth truth;
	size_t count;

	(void)state;
	assert_int_equal(truth_init(&truth, scene, &in_first_room), GR_OK);
	count = truth_points(&truth, 3, 0, samples, POINTS * 4);
	for (size_t s = 0; s < sizeof spacings / sizeof *spacings; s++) {
		struct surfel_set *set = bake(scene, spacings[s], 256);
		double side[2] = { 0 }, most = 0, probes[2] = { 0 };
		size_t of[2] = { 0 };
		struct surfel_cpu cpu;

		lit(&cpu, set, &truth);
		for (size_t i = 0; i < count; i++) {
			float x = samples[i].position[0];
			int dark = x > 3;
			double e[3];

			if (fabsf(x - 3) < 0.0099f)
				continue;
			surfel_cpu_irradiance(&cpu, samples[i].position, samples[i].normal, e);
			side[dark] += e[1];
			of[dark]++;
			most = dark ? fmax(most, e[1]) : most;
		}
		for (size_t i = 0; i < set->probes.count; i++) {
			size_t x = i % (size_t)set->probes.size[0];
			int dark = set->probes.origin[0] + (float)x * set->probes.cell_m > 3;

			probes[dark] += probe_light(&cpu, i);
		}
		side[0] /= (double)of[0];
		side[1] /= (double)of[1];
		printf("# a closed wall of 2 cm, surfels of %.2g m: %.4f %% of the light goes through (at the worst point %.3f %%); to probes %.4f %%\n",
		       (double)spacings[s], 100 * side[1] / side[0], 100 * most / side[0],
		       100 * probes[1] / probes[0]);
		assert_true(side[0] > 0 && side[1] < 0.0005 * side[0]);
		assert_true(probes[0] > 0 && probes[1] < 0.001 * probes[0]);
		surfel_cpu_finish(&cpu);
		surfel_set_destroy(&set);
	}
	truth_finish(&truth);
	room_free(&scene);
}

static void doorway(void **state)
{
	static struct truth_sample points[POINTS];
	struct scene *scene = two_rooms(0.2f, true);
	struct surfel_set *set = bake(scene, 0, 256);
	struct truth rooms;
	struct truth_error e;
	size_t count, dark = 0;

	(void)state;
	assert_int_equal(truth_init(&rooms, scene, &in_first_room), GR_OK);
	count = truth_points(&rooms, 3, 0.02f, points, POINTS);
	for (size_t i = 0; i < count; i++)
		if (points[i].position[0] > 3.11f)
			points[dark++] = points[i];
	truth_trace(&rooms, 11, 8000, points, dark);
	e = compare(set, &rooms, points, dark);
	printf("# dark room behind a doorway, %zu surfels of %.3g m: bias %+.1f %%, nRMSE %.1f %% (%zu points, and noise %.1f %%)\n",
	       set->count, (double)set->spacing_m, 100 * e.bias, 100 * nrmse_of(&e), dark,
	       100 * e.noise);
	assert_true(dark > 50);
	assert_true(nrmse_of(&e) < 0.12);
	surfel_set_destroy(&set);
	truth_finish(&rooms);
	room_free(&scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cornell),
		cmocka_unit_test(furnace),
		cmocka_unit_test(closed_wall),
		cmocka_unit_test(doorway),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
