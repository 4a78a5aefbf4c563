/* Relit surfels through the real shaders: against path tracing. */
#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/lpv_private.h"
#include "tests/accuracy/surfels_gl.h"
#include "tests/unit/unit.h"
#include "tools/bench/lpv_bench.h"
#include "tools/bench/room.h"

#include <epoxy/gl.h>
#include <math.h>

#define MAP 64

static double lpv_error(double *out_ms)
{
	static struct truth_texel texels[MAP * MAP];
	static float found[3 * LIT_POINTS];
	struct scene_file file;
	struct render_frame now;
	struct rsm_set maps;
	struct gi_light light = { .rsm = &maps };
	struct gi_method *lpv;
	double start;

	truth_map(&lit_room.truth, MAP, texels);
	bench_file(&file, 32, 8);
	bench_frame(&now, &file);
	assert_int_equal(gi_lpv_create(&lpv, lit_room.scene, &file), GR_OK);
	bench_maps_init(&maps, MAP, 1);
	bench_maps_fill(&maps, 0, texels, 1);
	assert_true(lpv->ops->update(lpv, &now, &light) >= GR_OK);
	lit_look(lpv, lit_room.samples, lit_room.count, found);
	bench_maps_fill(&maps, 0, texels, 1);
	glFinish();
	start = lit_cpu_milliseconds();
	lpv->ops->update(lpv, &now, &light);
	glFinish();
	*out_ms = lit_cpu_milliseconds() - start;
	lpv->ops->destroy(lpv);
	bench_maps_finish(&maps);
	return truth_compare(lit_room.samples, found, lit_room.count).nrmse;
}

static void accuracy(void **state)
{
	static float found[3 * LIT_POINTS];
	const struct truth_spot spot = bench_spot();
	struct surfel_set *cornell = lit_bake(lit_room.scene, 0.16f, 256, 64, 0);
	double lpv, lpv_ms, start, ms;
	struct truth_error e;
	struct lit s;

	(void)state;
	lit_trace(&lit_room.truth, getenv("GROTTO_LONG") ? 60000 : 9000, lit_room.samples, lit_room.count);
	lit_begin_with(&s, lit_room.scene, cornell, &spot, 1, false);
	lit_frame(&s);
	lit_mean(&s, found);
	e = truth_compare(lit_room.samples, found, lit_room.count);
	printf("# Cornell room, %zu surfels: bias %+.2f %%, nRMSE %.2f %%, shape %.2f %% (noise of the "
	       "truth %.2f %%)\n",
	       cornell->count, 100 * e.bias, 100 * e.nrmse, 100 * e.shape, 100 * e.noise);
	lit_intensity(&s, 0, 49, 49, 49);
	surfel_rig_light(&s.rig);
	glFinish();
	start = lit_cpu_milliseconds();
	lit_frame(&s);
	glFinish();
	ms = lit_cpu_milliseconds() - start;
	lpv = lpv_error(&lpv_ms);
	printf("# light propagation volumes 32^3 x 8: nRMSE %.1f %%, %.1f times the surfels'; a frame takes "
	       "%.1f ms of processor time, of the surfels %.1f ms\n",
	       100 * lpv, lpv / e.nrmse, lpv_ms, ms);
	assert_true(e.nrmse < 0.04);
	assert_true(fabs(e.bias) < 0.01);
	assert_true(lpv > 5 * e.nrmse);
	assert_true(ms < lpv_ms);
	lit_end(&s);
	surfel_set_destroy(&cornell);
}

/* Walls that all emit and reflect alike: E of what they reflect is rho / (1 - rho) pi L. */
static void furnace(void **state)
{
	static struct truth_sample at[LIT_POINTS];
	static float found[3 * LIT_POINTS];
	const struct truth_spot spot = bench_spot();
	struct room_builder b;
	struct truth room;
	double right = 0.5 / (1 - 0.5) * 3.14159265358979 * 2, worst, mean;
	size_t count;

	(void)state;
	room_begin(&b);
	uint32_t m = room_material(&b, 0.5f, 0.5f, 0.5f);
	room_inside(&b, (uint32_t[6]){ m, m, m, m, m, m }, (float[3]){ 0, 0, 0 }, (float[3]){ 3, 2, 4 });
	struct scene *inside = room_end(&b);
	for (int c = 0; c < 3; c++)
		inside->materials[m].emission[c] = 2;
	inside->emissive = true;
	assert_int_equal(truth_init(&room, inside, &spot), GR_OK);
	count = truth_points(&room, 5, 0.02f, at, LIT_POINTS);
	for (int probes = 0; probes < 2; probes++) {
		struct surfel_set *set = lit_bake(inside, 0.4f, 256, 16, 4);
		struct lit s;

		lit_begin_with(&s, inside, set, &spot, 0, probes);
		lit_frame(&s);
		mean = lit_mean_at(s.method, at, count, found);
		worst = 0;
		for (size_t k = 0; k < 3 * count; k++)
			worst = fmax(worst, fabs((double)found[k] / right - 1));
		printf("# furnace, %s: mean E off by %+.3f %%, worst point %.3f %%\n",
		       probes ? "probes" : "surfels", 100 * (mean / right - 1), 100 * worst);
		assert_true(fabs(mean / right - 1) < 0.01 && worst < 0.01);
		assert_int_equal(lit_stats(&s).nonfinite, 0);
		lit_end(&s);
		surfel_set_destroy(&set);
	}
	truth_finish(&room);
	room_free(&inside);
}

/* Two rooms of 3 m and what is between them: 2 cm of wall, or 20 cm with a doorway of 1 x 2 m. */
static struct scene *two_rooms(bool doorway)
{
	struct room_builder b;

	room_begin(&b);
	uint32_t m = room_material(&b, 0.7f, 0.7f, 0.7f);
	room_inside(&b, (uint32_t[6]){ m, m, m, m, m, m }, (float[3]){ 0, 0, 0 }, (float[3]){ 6, 3, 3 });
	if (doorway) {
		room_box(&b, m, (float[3]){ 3, 1.5f, 0.5f }, (float[3]){ 0.1f, 1.5f, 0.5f }, 0);
		room_box(&b, m, (float[3]){ 3, 1.5f, 2.5f }, (float[3]){ 0.1f, 1.5f, 0.5f }, 0);
		room_box(&b, m, (float[3]){ 3, 2.5f, 1.5f }, (float[3]){ 0.1f, 0.5f, 0.5f }, 0);
	} else {
		room_box(&b, m, (float[3]){ 3, 1.5f, 1.5f }, (float[3]){ 0.01f, 1.5f, 1.5f }, 0);
	}
	return room_end(&b);
}

struct rooms {
	struct scene *scene;
	struct truth truth;
	struct surfel_set *set;
	struct truth_sample lit[LIT_POINTS], dark[LIT_POINTS];
	size_t lit_count, dark_count;
};

static void rooms_init(struct rooms *r, bool doorway)
{
	static struct truth_sample all[LIT_POINTS];
	const struct truth_spot spot = { { 1, 2.9f, 1.5f }, { 0, -1, 0 }, { 50, 50, 50 }, 0.5f };
	size_t count;

	memset(r, 0, sizeof *r);
	r->scene = two_rooms(doorway);
	assert_int_equal(truth_init(&r->truth, r->scene, &spot), GR_OK);
	count = truth_points(&r->truth, 3, 0, all, LIT_POINTS);
	for (size_t i = 0; i < count; i++) {
		if (all[i].position[0] > (doorway ? 3.11f : 3.0101f))
			r->dark[r->dark_count++] = all[i];
		else if (all[i].position[0] < (doorway ? 2.89f : 2.9901f) &&
			 (doorway || all[i].position[0] < 2.98f || all[i].normal[0] < -0.5f))
			r->lit[r->lit_count++] = all[i];
	}
	r->set = lit_bake(r->scene, 0.2f, 256, 16, 12);
}

static void rooms_finish(struct rooms *r)
{
	surfel_set_destroy(&r->set);
	truth_finish(&r->truth);
	room_free(&r->scene);
}

static void closed_wall(void **state)
{
	static struct truth_sample wall[LIT_POINTS];
	size_t walls = 0;
	static float found[3 * LIT_POINTS];
	static struct rooms r;

	(void)state;
	rooms_init(&r, false);
	assert_true(r.dark_count > 80 && r.lit_count > 80);
	/* the lit side of the wall must not take the dark inside of it for its own, either */
	for (size_t i = 0; i < r.lit_count; i++)
		if (r.lit[i].position[0] > 2.98f)
			wall[walls++] = r.lit[i];
	lit_trace(&r.truth, 3000, wall, walls);
	for (int probes = 0; probes < 2; probes++) {
		struct lit s;
		double lit, dark, worst = 0;
		struct truth_error e;

		lit_begin_with(&s, r.scene, r.set, &r.truth.spot, 1, probes);
		lit_frame(&s);
		lit = lit_mean_at(s.method, r.lit, r.lit_count, found);
		dark = lit_mean_at(s.method, r.dark, r.dark_count, found);
		for (size_t k = 0; k < 3 * r.dark_count; k++)
			worst = fmax(worst, (double)found[k]);
		lit_look(s.method, wall, walls, found);
		e = truth_compare(wall, found, walls);
		printf("# closed 2 cm wall, %s: %.5f %% of the lit room's light behind it, worst point %.4f "
		       "%%; its lit side: bias %+.1f %%, nRMSE %.1f %% (%zu points, noise %.1f %%)\n",
		       probes ? "probes" : "surfels", 100 * dark / lit, 100 * worst / lit,
		       100 * e.bias, 100 * e.nrmse, walls, 100 * e.noise);
		assert_true(dark / lit < (probes ? 1e-3 : 5e-4));
		lit_end(&s);
	}
	rooms_finish(&r);
}

static void doorway(void **state)
{
	static float found[3 * LIT_POINTS];
	static struct rooms r;

	(void)state;
	rooms_init(&r, true);
	assert_true(r.dark_count > 80);
	lit_trace(&r.truth, getenv("GROTTO_LONG") ? 40000 : 4000, r.dark, r.dark_count);
	for (int probes = 0; probes < 2; probes++) {
		struct lit s;
		struct truth_error e;

		lit_begin_with(&s, r.scene, r.set, &r.truth.spot, 1, probes);
		lit_frame(&s);
		lit_mean_at(s.method, r.dark, r.dark_count, found);
		e = truth_compare(r.dark, found, r.dark_count);
		printf("# dark room behind a doorway, %s: bias %+.1f %%, nRMSE %.1f %% (%zu points, noise %.1f %%)\n",
		       probes ? "probes" : "surfels", 100 * e.bias, 100 * e.nrmse, r.dark_count,
		       100 * e.noise);
		assert_true(e.nrmse < (probes ? 0.20 : 0.12));
		lit_end(&s);
	}
	rooms_finish(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(accuracy),
		cmocka_unit_test(furnace),
		cmocka_unit_test(closed_wall),
		cmocka_unit_test(doorway),
	};
	int failed = lit_open("test_surfels_gl");

	if (failed)
		return failed;
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	lit_close();
	return failed;
}
