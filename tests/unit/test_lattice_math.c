/* The lattice on the CPU: sectors, medium, links, sums, leaks, dispatch. */
#include "base/result.h"
#include "renderer/gi/dispatch.h"
#include "renderer/gi/lpv_cpu.h"
#include "renderer/gi/transfer.h"
#include "tools/bench/room.h"
#include "tests/unit/unit.h"

#include <math.h>

#define PI 3.14159265358979323846

static const float own_albedo[3] = { -1, -1, -1 };

static void sectors_whole(void **state)
{
	struct sectors s;
	double omega, forward = 0;
	const double members[3] = { 6, 12, 8 };

	(void)state;
	sectors_init(&s);
	omega = 6 * s.omega[0] + 12 * s.omega[1] + 8 * s.omega[2];
	for (int k = 0; k < 3; k++)
		forward += members[k] * s.a[k] * s.mu[k] * s.mu[k];
	printf("# sectors: sum of solid angles / 4 pi - 1 = %.1e, K = %.4f, forward %.4f a step\n",
	       omega / (4 * PI) - 1, s.look_f, forward);
	assert_true(fabs(omega / (4 * PI) - 1) < 1e-12);
	assert_true(fabs(s.look_f - 1.338) < 0.001);
	assert_true(forward > 0.915);
	for (int j = 0; j < SECTOR_COUNT; j++)
		for (int i = 0; i < 3; i++)
			assert_int_equal(sector_offset[j][i], -sector_offset[SECTOR_COUNT - 1 - j][i]);
}

static void thesis_kappa(void **state)
{
	struct transfer t;

	(void)state;
	transfer_init(&t);
	printf("# thesis: kappa %.6f (closed form)\n", t.kappa);
	assert_true(fabs(t.kappa - 0.221293) < 2e-6);
}

/* sigma 0.1/m: 0.9^4 is left after 4 m, however fine the lattice. */
static void medium_any_resolution(void **state)
{
	struct sectors s;
	double worst = 0;

	(void)state;
	sectors_init(&s);
	for (int n = 4; n <= 128; n *= 2) {
		struct sector_medium m;
		double left = 1;

		sectors_medium(&s, 0.06, 0.04, 4.0 / n, &m);
		for (int i = 0; i < n; i++)
			left *= m.b[0] / s.b[0]; /* unscattered share of a hop to a face */
		worst = fmax(worst, fabs(left - 0.6561));
		/* what is scattered is not lost */
		sectors_medium(&s, 0, 0.1, 4.0 / n, &m);
		assert_true(fabs(6 * m.a[0] + 12 * m.a[1] + 8 * m.a[2] - 1) < 1e-12);
	}
	printf("# medium: transmittance over 4 m at 0.1/m: 0.6561, off by %.1e at worst\n", worst);
	assert_true(worst < 1e-12);
	assert_true(medium_transmittance(1.5, 1) == 0);
}

static double total(const struct lpv_cpu *lpv, const float *light)
{
	double sum = 0;

	for (size_t i = 0; i < lattice_cells(&lpv->lattice); i++)
		for (size_t c = 0; c < 3; c++)
			sum += (double)light[i * LPV_CELL_FLOATS + 4 * c];
	return sum;
}

/*
 * A row of cells in empty space, lit at one end: what is in the cell n hops on
 * after n steps has come straight, 4 m. Against the same without a medium;
 * both are brought back to 1 after every step, since sideways most is lost.
 */
static void medium_along_a_row(void **state)
{
	(void)state;
	for (int n = 4; n <= 64; n *= 2) {
		struct lattice l = { { n + 1, 1, 1 }, { 0, 0, 0 }, 4.0f / (float)n };
		struct lpv_cpu lpv[2];
		double left = 1;

		for (int k = 0; k < 2; k++) {
			assert_int_equal(lpv_cpu_init(&lpv[k], NULL, &l), GR_OK);
			sectors_medium(&lpv[k].sectors, k ? 0.1 : 0, 0, (double)l.d, &lpv[k].medium);
			lpv[k].light[0] = 1;
		}
		for (int i = 1; i <= n; i++) {
			float front[2];

			for (int k = 0; k < 2; k++) {
				lpv_cpu_step(&lpv[k]);
				front[k] = lpv[k].light[(size_t)i * LPV_CELL_FLOATS];
				assert_true(front[k] > 0);
				for (size_t f = 0; f < ((size_t)n + 1) * LPV_CELL_FLOATS; f++)
					lpv[k].light[f] /= front[k];
			}
			left *= (double)front[1] / (double)front[0];
		}
		printf("# medium: light through %d cells over 4 m at 0.1/m: %.6f is left\n", n, left);
		assert_true(fabs(left - 0.6561) < 1e-5);
		for (int k = 0; k < 2; k++)
			lpv_cpu_finish(&lpv[k]);
	}
}

static void periodic_drift(void **state)
{
	const int steps = 10000;
	struct unit_random random = { 12345 };
	struct lattice l = { { 3, 3, 3 }, { 0, 0, 0 }, 0.25f };

	(void)state;
	for (int clamp = 0; clamp < 2; clamp++) {
		struct lpv_cpu lpv;

		assert_int_equal(lpv_cpu_init(&lpv, NULL, &l), GR_OK);
		lpv.periodic = true;
		lpv.clamp = clamp;
		for (size_t i = 0; i < lattice_cells(&l) * LPV_CELL_FLOATS; i++)
			lpv.light[i] = (float)unit_random_range(&random, 0, i % 4 ? 0.5 : 1);
		double before = total(&lpv, lpv.light);
		for (int i = 0; i < steps; i++)
			lpv_cpu_step(&lpv);
		double drift = total(&lpv, lpv.light) / before - 1;
		printf("# periodic, %s: drift %.1e in %d steps\n", clamp ? "clamped" : "linear", drift,
		       steps);
		assert_true(fabs(drift) < 1e-4);
		lpv_cpu_finish(&lpv);
	}
}

/* An empty closed room with even reflectance. */
static struct scene *room(float albedo, const float min[3], const float max[3])
{
	struct room_builder b;

	room_begin(&b);
	uint32_t m = room_material(&b, albedo, albedo, albedo);
	room_inside(&b, (uint32_t[6]){ m, m, m, m, m, m }, min, max);
	return room_end(&b);
}

static struct links *links_of(const struct scene *scene, int cells, float shift)
{
	struct lattice l;
	struct rays *rays;
	struct links *links;
	float min[3], max[3];

	for (int i = 0; i < 3; i++) {
		/* shifted by part of a cell, one cell more so that the scene stays inside */
		float d = (scene->max[i] - scene->min[i]) / (float)cells;

		min[i] = scene->min[i] - shift * d;
		max[i] = scene->max[i] + (shift > 0 ? (1 - shift) * d : 0);
	}
	assert_int_equal(lattice_init(&l, min, max, shift > 0 ? cells + 1 : cells), GR_OK);
	assert_int_equal(rays_create(&rays, scene), GR_OK);
	assert_int_equal(links_create(&links, scene, rays, &l, 8, own_albedo), GR_OK);
	rays_destroy(&rays);
	return links;
}

/* Rays by the many find what each finds by itself; no number and too far find nothing. */
static void rays_by_many(void **state)
{
	const float min[3] = { 0, 0, 0 }, max[3] = { 4, 4, 4 };
	struct unit_random random = unit_random_start("rays");
	struct scene *scene = room(0.5f, min, max);
	struct ray_start starts[203];
	struct ray_met met[203];
	struct rays *rays;

	(void)state;
	for (size_t k = 0; k < 203; k++)
		for (int i = 0; i < 3; i++) {
			starts[k].origin[i] = (float)unit_random_range(&random, -1, 5);
			starts[k].direction[i] = (float)unit_random_range(&random, -1, 1);
		}
	starts[70].origin[1] = NAN;
	starts[71].direction[2] = 4 * RAYS_MOST;
	assert_int_equal(rays_create(&rays, scene), GR_OK);
	rays_nearest_many(rays, 203, starts, met);
	for (size_t k = 0; k < 203; k++) {
		const float *n, *way = starts[k].direction;
		struct ray_hit hit;

		if (!rays_nearest(rays, starts[k].origin, way, INFINITY, &hit)) {
			assert_true(met[k].triangle == RAYS_NONE && isinf(met[k].distance));
			continue;
		}
		n = hit.normal;
		assert_true(met[k].triangle == hit.triangle && met[k].distance == hit.distance);
		assert_true(met[k].back == (n[0] * way[0] + n[1] * way[1] + n[2] * way[2] > 0));
	}
	assert_true(met[70].triangle == RAYS_NONE && met[71].triangle == RAYS_NONE);
	rays_destroy(&rays);
	room_free(&scene);
}

/* In a closed black room all that is injected meets the walls, all in one step's books. */
static void incident_is_injected(void **state)
{
	const float min[3] = { 0, 0, 0 }, max[3] = { 4, 4, 4 };
	struct scene *scene = room(0.5f, min, max);
	struct links *links = links_of(scene, 8, 0);

	(void)state;
	for (int clamp = 0; clamp < 2; clamp++) {
		struct lpv_cpu lpv;
		double injected, absorbed = 0;

		assert_int_equal(lpv_cpu_init(&lpv, links, NULL), GR_OK);
		lpv.clamp = clamp;
		for (int k = 0; k < 20; k++)
			assert_true(lpv_cpu_inject(&lpv, (float[3]){ 0.1f + 0.19f * (float)k, 0, 1.3f },
						   (float[3]){ 0, 1, 0 }, (float[3]){ 1, 2, 3 }));
		injected = total(&lpv, lpv.inject);
		for (int i = 0; i < 400; i++)
			lpv_cpu_step(&lpv);
		/* steady: what the walls take away each step is what is injected */
		double before = total(&lpv, lpv.light);
		memset(lpv.inject, 0, lattice_cells(&links->lattice) * LPV_CELL_FLOATS * sizeof(float));
		lpv_cpu_step(&lpv);
		absorbed = before - total(&lpv, lpv.light);
		printf("# %s: absorbed / injected - 1 = %.1e, escaped %g\n",
		       clamp ? "clamped" : "linear", absorbed / injected - 1, lpv.escaped[0]);
		assert_true(fabs(absorbed / injected - 1) < 1e-4);
		assert_true(lpv.escaped[0] == 0);
		lpv_cpu_finish(&lpv);
	}
	links_destroy(&links);
	room_free(&scene);
}

static void superposition(void **state)
{
	struct scene *scene = room_cornell();
	struct links *links = links_of(scene, 8, 0);
	struct lpv_cpu lpv[3];
	double worst = 0, largest = 0;

	(void)state;
	for (int k = 0; k < 3; k++)
		assert_int_equal(lpv_cpu_init(&lpv[k], links, NULL), GR_OK);
	for (int k = 0; k < 2; k++) {
		const float at[3] = { k ? 0.3f : 3.6f, 0, 2.2f }, up[3] = { 0, 1, 0 };
		const float flux[3] = { k ? 5.0f : 0.1f, 1, k ? 0.0f : 3.0f };

		lpv_cpu_inject(&lpv[k], at, up, flux);
		lpv_cpu_inject(&lpv[2], at, up, flux);
	}
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 200; i++)
			lpv_cpu_step(&lpv[k]);
	for (size_t i = 0; i < lattice_cells(&links->lattice) * LPV_CELL_FLOATS; i++) {
		worst = fmax(worst, fabs((double)(lpv[0].light[i] + lpv[1].light[i] - lpv[2].light[i])));
		largest = fmax(largest, fabs((double)lpv[2].light[i]));
	}
	printf("# two lamps, linear: sum off by %.1e of the largest\n", worst / largest);
	assert_true(worst / largest < 1e-5);
	for (int k = 0; k < 3; k++)
		lpv_cpu_finish(&lpv[k]);
	links_destroy(&links);
	room_free(&scene);
}

/* Radiance L everywhere: E = pi L, in free space and at a wall. */
static void uniform_radiance(void **state)
{
	const float min[3] = { 0, 0, 0 }, max[3] = { 4, 4, 4 };
	struct scene *scene = room(0.5f, min, max);
	struct links *links = links_of(scene, 8, 0);
	struct lpv_cpu lpv;
	double worst = 0;

	(void)state;
	assert_int_equal(lpv_cpu_init(&lpv, links, NULL), GR_OK);
	/* psi = L d^2 / K [W/sr], F = 4 pi psi */
	float f = (float)(4 * PI * 1.0 * (double)(links->lattice.d * links->lattice.d) /
			  lpv.sectors.look_f);
	for (size_t i = 0; i < lattice_cells(&links->lattice); i++)
		for (size_t c = 0; c < 3; c++)
			lpv.light[i * LPV_CELL_FLOATS + 4 * c] = f;
	for (int k = 0; k < 6; k++) {
		float n[3] = { 0, 0, 0 }, at[3] = { 1.7f, 2.3f, 0.9f }, e[3];

		n[k / 2] = k % 2 ? -1.0f : 1.0f;
		at[k / 2] = k % 2 ? 4.0f : 0.0f;
		lpv_cpu_irradiance(&lpv, at, n, e);
		worst = fmax(worst, fabs((double)e[0] / PI - 1));
		/* and what the wall's links stop is the same */
	}
	printf("# uniform radiance: E / pi L - 1 = %.1e at worst\n", worst);
	assert_true(worst < 0.01);
	lpv_cpu_finish(&lpv);
	links_destroy(&links);
	room_free(&scene);
}

/* A wall of 2 cm across the room, lit on one side, wherever the lattice lies. */
static void thin_wall(void **state)
{
	float most = 0, lit = 0;
	struct room_builder b;

	(void)state;
	room_begin(&b);
	uint32_t m = room_material(&b, 0.7f, 0.7f, 0.7f);
	room_inside(&b, (uint32_t[6]){ m, m, m, m, m, m }, (float[3]){ 0, 0, 0 }, (float[3]){ 4, 3, 3 });
	room_box(&b, m, (float[3]){ 2.05f, 1.5f, 1.5f }, (float[3]){ 0.01f, 1.6f, 1.6f }, 0);
	struct scene *scene = room_end(&b);
	/* the box goes through the room's walls; the bounds are the room's */
	for (int k = 0; k < 4; k++) {
		struct links *links = links_of(scene, 10 + 3 * k, 0.17f * (float)k);
		struct lpv_cpu lpv;

		assert_int_equal(lpv_cpu_init(&lpv, links, NULL), GR_OK);
		lpv.clamp = true;
		assert_true(lpv_cpu_inject(&lpv, (float[3]){ 1.1f, 0, 1.3f }, (float[3]){ 0, 1, 0 },
					   (float[3]){ 1000, 1000, 1000 }));
		assert_true(lpv_cpu_inject(&lpv, (float[3]){ 2.04f, 1, 1.3f }, (float[3]){ -1, 0, 0 },
					   (float[3]){ 1000, 1000, 1000 }));
		for (int i = 0; i < 60; i++)
			lpv_cpu_step(&lpv);
		for (int i = 0; i < 100; i++) {
			/* on the far side: floor up to a cell from the wall, far wall, the wall itself */
			float e[3], d = links->lattice.d;
			float t = (float)i / 100;
			const float at[3][3] = { { 2.06f + d + (1.9f - d) * t, 0, 0.2f + 2.6f * t },
						 { 4, 0.1f + 2.8f * t, 1.5f },
						 { 2.06f, 0.1f + 2.8f * t, 1.5f } };
			const float n[3][3] = { { 0, 1, 0 }, { -1, 0, 0 }, { 1, 0, 0 } };

			for (int q = 0; q < 3; q++) {
				lpv_cpu_irradiance(&lpv, at[q], n[q], e);
				most = fmaxf(most, fabsf(e[0]));
			}
			lpv_cpu_irradiance(&lpv, (float[3]){ 1.8f * t, 0, 1.5f }, (float[3]){ 0, 1, 0 }, e);
			lit = fmaxf(lit, e[0]);
		}
		lpv_cpu_finish(&lpv);
		links_destroy(&links);
	}
	printf("# closed 2 cm wall: %g W/m^2 behind it, up to %.3g before it\n", (double)most,
	       (double)lit);
	assert_true(most == 0);
	assert_true(lit > 1);
	room_free(&scene);
}

static void shifted_lattice(void **state)
{
	struct scene *scene = room_cornell();
	double least = INFINITY, most = 0;

	(void)state;
	for (int k = 0; k < 4; k++) {
		struct links *links = links_of(scene, 12, 0.25f * (float)k);
		struct lpv_cpu lpv;
		double sum = 0;

		assert_int_equal(lpv_cpu_init(&lpv, links, NULL), GR_OK);
		lpv.clamp = true;
		lpv_cpu_inject(&lpv, (float[3]){ 2.1f, 0, 1.0f }, (float[3]){ 0, 1, 0 },
			       (float[3]){ 1, 1, 1 });
		for (int i = 0; i < 80; i++)
			lpv_cpu_step(&lpv);
		for (int i = 0; i < 400; i++) {
			float t = 4 * ((float)(i % 20) + 0.5f) / 20, u = 4 * ((float)(i / 20) + 0.5f) / 20, e[3];

			lpv_cpu_irradiance(&lpv, (float[3]){ t, 4, u }, (float[3]){ 0, -1, 0 }, e);
			sum += (double)e[0] / 400;
		}
		least = fmin(least, sum);
		most = fmax(most, sum);
		lpv_cpu_finish(&lpv);
		links_destroy(&links);
	}
	printf("# lattice moved by parts of a cell: mean E of the ceiling varies %.1f %%\n",
	       100 * (most / least - 1));
	assert_true(most / least < 1.35);
	room_free(&scene);
}

static void dispatch_splits(void **state)
{
	struct unit_random r = unit_random_start("dispatch");
	struct dispatch d;

	(void)state;
	assert_int_equal(dispatch_plan(0, 64, &d), GR_OK);
	assert_true(d.x == 1 && d.y == 1);
	assert_int_equal(dispatch_plan(UINT64_C(65536) * 64, 64, &d), GR_OK);
	assert_true(d.y == 2 && d.x == 32768);
	assert_int_equal(dispatch_plan(UINT64_MAX, 1, &d), GR_ERR_RANGE);
	for (int i = 0; i < 10000; i++) {
		uint64_t items = (uint64_t)unit_random_u32(&r) << (unit_random_u32(&r) % 6);
		uint32_t group = 1 + unit_random_u32(&r) % 256;

		if (dispatch_plan(items, group, &d) != GR_OK) {
			assert_true(items / group > UINT64_C(65535) * 65535 - 2);
			continue;
		}
		assert_true(d.x >= 1 && d.x <= 65535 && d.y >= 1 && d.y <= 65535);
		assert_true((uint64_t)d.x * d.y * group >= items);
	}
}

static void lattice_limits(void **state)
{
	struct lattice l;
	const float zero[3] = { 0, 0, 0 };

	(void)state;
	assert_int_equal(lattice_init(&l, zero, (float[3]){ 4, 2, 3.1f }, 16), GR_OK);
	assert_true(l.size[0] == 16 && l.size[1] == 8 && l.size[2] == 13);
	assert_int_equal(lattice_init(&l, zero, (float[3]){ 4, 0, 4 }, 8), GR_OK);
	assert_int_equal(l.size[1], 1);
	assert_int_equal(lattice_init(&l, zero, zero, 8), GR_ERR_RANGE);
	assert_int_equal(lattice_init(&l, zero, (float[3]){ 1, NAN, 1 }, 8), GR_ERR_RANGE);
	assert_int_equal(lattice_init(&l, zero, (float[3]){ 1, INFINITY, 1 }, 8), GR_ERR_RANGE);
	assert_int_equal(lattice_init(&l, zero, (float[3]){ 1, 1, 1 }, 1), GR_ERR_RANGE);
	assert_int_equal(lattice_init(&l, zero, (float[3]){ 1, 1, 1 }, 129), GR_ERR_RANGE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sectors_whole),      cmocka_unit_test(thesis_kappa),
		cmocka_unit_test(medium_any_resolution), cmocka_unit_test(medium_along_a_row),
		cmocka_unit_test(periodic_drift),
		cmocka_unit_test(incident_is_injected), cmocka_unit_test(superposition),
		cmocka_unit_test(uniform_radiance),   cmocka_unit_test(thin_wall),
		cmocka_unit_test(shifted_lattice),    cmocka_unit_test(dispatch_splits),
		cmocka_unit_test(lattice_limits),     cmocka_unit_test(rays_by_many),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
