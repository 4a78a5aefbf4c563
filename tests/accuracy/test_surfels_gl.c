/* Relit surfels through the real shaders: against path tracing, and the hard cases. */
#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/lpv_private.h"
#include "renderer/gi/surfel_bake.h"
#include "renderer/gi/surfels_private.h"
#include "renderer/gl/target.h"
#include "tests/unit/unit.h"
#include "tools/bench/lpv_bench.h"
#include "tools/bench/room.h"
#include "tools/bench/surfel_rig.h"
#include "tools/bench/truth.h"

#include <epoxy/gl.h>
#include <math.h>
#include <pthread.h>

#define MAP 64
#define POINTS 240
#define SHADOW_PIXELS 512

static struct target *target;
static struct scene *scene;
static struct truth truth;
static struct truth_sample samples[POINTS];
static size_t sample_count;
static struct surfel_set *cornell; /* fine enough for the accuracy, */
static struct surfel_set *coarse;  /* and for all else */

/* --- what the tests share --- */

struct setup {
	struct surfel_rig rig;
	struct gi_method *method;
};

static struct surfel_set *bake(const struct scene *of, float spacing, int links, int taps, int probes)
{
	struct surfel_bake_params params = SURFEL_BAKE_PARAMS;
	struct surfel_set *set;
	struct gr_diag diag = { 0 };

	params.spacing_m = spacing;
	params.links = links;
	params.taps = taps;
	params.probes = probes;
	assert_int_equal(surfel_bake(&set, of, NULL, &params, &diag), GR_OK);
	return set;
}

static struct gi_method *method_of(const struct surfel_set *set, int gathers, bool probes)
{
	const struct surfels_params params = { .gathers = gathers, .probes = probes, .lamps = true };
	struct gi_method *method;

	assert_int_equal(gi_surfels_create(&method, set, &params), GR_OK);
	return method;
}

static void begin_with(struct setup *s, const struct scene *of, const struct surfel_set *set,
		       const struct truth_spot *spot, int lamps, bool probes)
{
	assert_int_equal(surfel_rig_init(&s->rig, of, spot, lamps, SHADOW_PIXELS), GR_OK);
	s->method = method_of(set, 2, probes);
}

static void begin(struct setup *s, int lamps)
{
	const struct truth_spot spot = bench_spot();

	begin_with(s, scene, coarse, &spot, lamps, false);
}

static void end(struct setup *s)
{
	s->method->ops->destroy(s->method);
	surfel_rig_finish(&s->rig);
	assert_int_equal(glGetError(), GL_NO_ERROR);
}

static void frame(struct setup *s)
{
	assert_true(surfel_rig_frame(&s->rig, s->method) >= GR_OK);
}

static struct gi_stats stats_now(struct setup *s)
{
	struct gi_stats stats;

	glFinish();
	surfels_check_collect((struct surfels *)s->method);
	s->method->ops->stats(s->method, &stats);
	return stats;
}

static void intensity(struct setup *s, int lamp, float red, float green, float blue)
{
	const float c[3] = { red, green, blue };

	memcpy(s->rig.frame.lamps[lamp].intensity, c, sizeof c);
}

/* A look-up's shader takes long to compile: it is kept for all methods of the same name. */
static struct looker {
	const char *name;
	struct bench_probe *probe;
} lookers[3];

static void look(const struct gi_method *method, const struct truth_sample *at, size_t count, float *found)
{
	struct looker *l = lookers;

	while (l->name && strcmp(l->name, method->ops->shader_name) != 0)
		l++;
	if (!l->name)
		assert_int_equal(bench_probe_create(&l->probe, method), GR_OK);
	l->name = method->ops->shader_name;
	bench_probe_run(l->probe, method, at, count, found);
}

static double mean_at(const struct gi_method *method, const struct truth_sample *at, size_t count, float *found)
{
	double sum = 0;

	look(method, at, count, found);
	for (size_t k = 0; k < 3 * count; k++) {
		assert_true(isfinite(found[k]));
		sum += (double)found[k];
	}
	return sum / (3 * (double)count);
}

static double mean_irradiance(struct setup *s, float *found)
{
	return mean_at(s->method, samples, sample_count, found);
}

struct tracing {
	const struct truth *truth;
	struct truth_sample *samples;
	size_t count;
	int paths;
};

static void *trace_some(void *of)
{
	const struct tracing *t = of;

	truth_trace(t->truth, 7, t->paths, t->samples, t->count);
	return NULL;
}

/* On two threads. */
static void trace(const struct truth *of, int paths, struct truth_sample *at, size_t count)
{
	struct tracing halves[2] = { { of, at, count / 2, paths },
				     { of, at + count / 2, count - count / 2, paths } };
	pthread_t other;

	assert_int_equal(pthread_create(&other, NULL, trace_some, &halves[0]), 0);
	trace_some(&halves[1]);
	pthread_join(other, NULL);
}

static double milliseconds(void)
{
	return (double)gr_clock_now(&gr_clock_monotonic) * 1e-6;
}

/* --- accuracy --- */

static double lpv_error(double *out_ms)
{
	static struct truth_texel texels[MAP * MAP];
	static float found[3 * POINTS];
	struct scene_file file;
	struct render_frame now;
	struct rsm_set maps;
	struct gi_light light = { .rsm = &maps };
	struct gi_method *lpv;
	double start;

	truth_map(&truth, MAP, texels);
	bench_file(&file, 32, 8);
	bench_frame(&now, &file);
	assert_int_equal(gi_lpv_create(&lpv, scene, &file), GR_OK);
	bench_maps_init(&maps, MAP, 1);
	bench_maps_fill(&maps, 0, texels, 1);
	assert_true(lpv->ops->update(lpv, &now, &light) >= GR_OK);
	look(lpv, samples, sample_count, found);
	bench_maps_fill(&maps, 0, texels, 1);
	glFinish();
	start = milliseconds();
	lpv->ops->update(lpv, &now, &light);
	glFinish();
	*out_ms = milliseconds() - start;
	lpv->ops->destroy(lpv);
	bench_maps_finish(&maps);
	return truth_compare(samples, found, sample_count).nrmse;
}

static void accuracy(void **state)
{
	static float found[3 * POINTS];
	const struct truth_spot spot = bench_spot();
	double lpv, lpv_ms, start, ms;
	struct truth_error e;
	struct setup s;

	(void)state;
	begin_with(&s, scene, cornell, &spot, 1, false);
	frame(&s);
	mean_irradiance(&s, found);
	e = truth_compare(samples, found, sample_count);
	printf("# Cornell room, %zu surfels: bias %+.2f %%, nRMSE %.2f %%, shape %.2f %% (noise of the "
	       "truth %.2f %%)\n",
	       cornell->count, 100 * e.bias, 100 * e.nrmse, 100 * e.shape, 100 * e.noise);
	intensity(&s, 0, 49, 49, 49);
	surfel_rig_light(&s.rig);
	glFinish();
	start = milliseconds();
	frame(&s);
	glFinish();
	ms = milliseconds() - start;
	lpv = lpv_error(&lpv_ms);
	printf("# light propagation volumes 32^3 x 8: nRMSE %.1f %%, %.1f times the surfels'; a frame takes "
	       "%.1f ms, of the surfels %.1f ms\n",
	       100 * lpv, lpv / e.nrmse, lpv_ms, ms);
	assert_true(e.nrmse < 0.04);
	assert_true(fabs(e.bias) < 0.01);
	assert_true(lpv > 5 * e.nrmse);
	end(&s);
}

/* Walls that all emit and reflect alike: E of what they reflect is rho / (1 - rho) pi L. */
static void furnace(void **state)
{
	static struct truth_sample at[POINTS];
	static float found[3 * POINTS];
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
	count = truth_points(&room, 5, 0.02f, at, POINTS);
	for (int probes = 0; probes < 2; probes++) {
		struct surfel_set *set = bake(inside, 0.4f, 256, 16, 4);
		struct setup s;

		begin_with(&s, inside, set, &spot, 0, probes);
		frame(&s);
		mean = mean_at(s.method, at, count, found);
		worst = 0;
		for (size_t k = 0; k < 3 * count; k++)
			worst = fmax(worst, fabs((double)found[k] / right - 1));
		printf("# furnace, %s: mean E off by %+.3f %%, worst point %.3f %%\n",
		       probes ? "probes" : "surfels", 100 * (mean / right - 1), 100 * worst);
		assert_true(fabs(mean / right - 1) < 0.01 && worst < 0.01);
		assert_int_equal(stats_now(&s).nonfinite, 0);
		end(&s);
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
	struct truth_sample lit[POINTS], dark[POINTS];
	size_t lit_count, dark_count;
};

static void rooms_init(struct rooms *r, bool doorway)
{
	static struct truth_sample all[POINTS];
	const struct truth_spot spot = { { 1, 2.9f, 1.5f }, { 0, -1, 0 }, { 50, 50, 50 }, 0.5f };
	size_t count;

	memset(r, 0, sizeof *r);
	r->scene = two_rooms(doorway);
	assert_int_equal(truth_init(&r->truth, r->scene, &spot), GR_OK);
	count = truth_points(&r->truth, 3, 0, all, POINTS);
	for (size_t i = 0; i < count; i++) {
		if (all[i].position[0] > (doorway ? 3.11f : 3.0101f))
			r->dark[r->dark_count++] = all[i];
		else if (all[i].position[0] < (doorway ? 2.89f : 2.9901f) &&
			 (doorway || all[i].position[0] < 2.98f || all[i].normal[0] < -0.5f))
			r->lit[r->lit_count++] = all[i];
	}
	r->set = bake(r->scene, 0.2f, 256, 16, 12);
}

static void rooms_finish(struct rooms *r)
{
	surfel_set_destroy(&r->set);
	truth_finish(&r->truth);
	room_free(&r->scene);
}

static void closed_wall(void **state)
{
	static struct truth_sample wall[POINTS];
	size_t walls = 0;
	static float found[3 * POINTS];
	static struct rooms r;

	(void)state;
	rooms_init(&r, false);
	assert_true(r.dark_count > 80 && r.lit_count > 80);
	/* the lit side of the wall must not take the dark inside of it for its own, either */
	for (size_t i = 0; i < r.lit_count; i++)
		if (r.lit[i].position[0] > 2.98f)
			wall[walls++] = r.lit[i];
	trace(&r.truth, 3000, wall, walls);
	for (int probes = 0; probes < 2; probes++) {
		struct setup s;
		double lit, dark, worst = 0;
		struct truth_error e;

		begin_with(&s, r.scene, r.set, &r.truth.spot, 1, probes);
		frame(&s);
		lit = mean_at(s.method, r.lit, r.lit_count, found);
		dark = mean_at(s.method, r.dark, r.dark_count, found);
		for (size_t k = 0; k < 3 * r.dark_count; k++)
			worst = fmax(worst, (double)found[k]);
		look(s.method, wall, walls, found);
		e = truth_compare(wall, found, walls);
		printf("# closed 2 cm wall, %s: %.5f %% of the lit room's light behind it, worst point %.4f "
		       "%%; its lit side: bias %+.1f %%, nRMSE %.1f %% (%zu points, noise %.1f %%)\n",
		       probes ? "probes" : "surfels", 100 * dark / lit, 100 * worst / lit,
		       100 * e.bias, 100 * e.nrmse, walls, 100 * e.noise);
		assert_true(dark / lit < (probes ? 1e-3 : 5e-4));
		end(&s);
	}
	rooms_finish(&r);
}

static void doorway(void **state)
{
	static float found[3 * POINTS];
	static struct rooms r;

	(void)state;
	rooms_init(&r, true);
	assert_true(r.dark_count > 80);
	trace(&r.truth, getenv("GROTTO_LONG") ? 40000 : 4000, r.dark, r.dark_count);
	for (int probes = 0; probes < 2; probes++) {
		struct setup s;
		struct truth_error e;

		begin_with(&s, r.scene, r.set, &r.truth.spot, 1, probes);
		frame(&s);
		mean_at(s.method, r.dark, r.dark_count, found);
		e = truth_compare(r.dark, found, r.dark_count);
		printf("# dark room behind a doorway, %s: bias %+.1f %%, nRMSE %.1f %% (%zu points, noise %.1f %%)\n",
		       probes ? "probes" : "surfels", 100 * e.bias, 100 * e.nrmse, r.dark_count,
		       100 * e.noise);
		assert_true(e.nrmse < (probes ? 0.20 : 0.12));
		end(&s);
	}
	rooms_finish(&r);
}

/* --- lamps that change --- */

static void lamp_switches(void **state)
{
	static float found[3 * POINTS];
	static const float factors[] = { 1, 0, 1, 1e-3f, 1e-7f };
	struct setup s;
	double lit, last = 0, before = 0;
	int frames = 0;

	(void)state;
	begin(&s, 1);
	frame(&s);
	lit = mean_irradiance(&s, found);
	intensity(&s, 0, 0, 0, 0);
	for (; frames < 40 && (frames == 0 || last > 1e-3 * lit); frames++) {
		frame(&s);
		last = mean_irradiance(&s, found);
	}
	printf("# lamp off, 2 gathers a frame: under 0.1 %% of the light after %d frames\n", frames);
	assert_true(frames <= 11);
	for (size_t k = 0; k < sizeof factors / sizeof *factors; k++) {
		intensity(&s, 0, 50 * factors[k], 50 * factors[k], 50 * factors[k]);
		for (int i = 0; i < 24; i++)
			frame(&s);
		last = mean_irradiance(&s, found);
		/* what is left of the light before when work stops */
		assert_true(fabs(last - lit * (double)factors[k]) <
			    1e-5 * lit * fmax(before, (double)factors[k]));
		before = (double)factors[k];
		assert_int_equal(stats_now(&s).nonfinite, 0);
	}
	printf("# fade to 1e-7: E = %.2e of E lit\n", last / lit);
	end(&s);
}

static void two_lamps(void **state)
{
	static float both[3 * POINTS], one[3 * POINTS], other[3 * POINTS];
	static const float place[3] = { 1.2f, 3.5f, 2.6f };
	struct setup s;
	double worst = 0, mean;

	(void)state;
	begin(&s, 2);
	memcpy(s.rig.frame.lamps[1].position, place, sizeof place);
	s.rig.frame.lamps[1].on = false;
	frame(&s);
	mean_irradiance(&s, one);
	s.rig.frame.lamps[0].on = false;
	s.rig.frame.lamps[1].on = true;
	intensity(&s, 1, 9, 3, 21);
	s.rig.frame.gi_epoch++;
	frame(&s);
	mean_irradiance(&s, other);
	s.rig.frame.lamps[0].on = true;
	s.rig.frame.gi_epoch++;
	frame(&s);
	mean = mean_irradiance(&s, both);
	for (size_t k = 0; k < 3 * sample_count; k++)
		worst = fmax(worst, fabs((double)(both[k] - one[k] - other[k])));
	printf("# two lamps: sum off by %.1e of the mean\n", worst / mean);
	assert_true(worst / mean < 1e-5);
	/* another colour: each band by itself */
	s.rig.frame.lamps[1].on = false;
	intensity(&s, 0, 50, 25, 5);
	s.rig.frame.gi_epoch++;
	frame(&s);
	mean_irradiance(&s, both);
	worst = 0;
	for (size_t k = 0; k < sample_count; k++) {
		worst = fmax(worst, fabs((double)(both[3 * k + 1] - 0.5f * one[3 * k + 1])));
		worst = fmax(worst, fabs((double)(both[3 * k + 2] - 0.1f * one[3 * k + 2])));
	}
	printf("# another colour: off by %.1e of the mean\n", worst / mean);
	assert_true(worst / mean < 1e-5);
	end(&s);
}

static void huge_intensity(void **state)
{
	static float found[3 * POINTS];
	struct setup s;
	double e;

	(void)state;
	begin(&s, 1);
	intensity(&s, 0, 5e10f, 5e10f, 5e10f);
	frame(&s);
	e = mean_irradiance(&s, found);
	printf("# intensity %g W/sr: mean E %.4g, nonfinite %llu\n", 5e10, e,
	       (unsigned long long)stats_now(&s).nonfinite);
	assert_true(e > 65504 && isfinite(e));
	assert_int_equal(stats_now(&s).nonfinite, 0);
	end(&s);
}

static void nan_is_reported(void **state)
{
	const float bad = NAN;
	struct setup s;
	struct surfels *surfels;

	(void)state;
	begin(&s, 1);
	frame(&s);
	assert_int_equal(stats_now(&s).nonfinite, 0);
	surfels = (struct surfels *)s.method;
	glClearNamedBufferSubData(surfels->found.buffer, GL_R32F, 16 * 77 + 4, 4, GL_RED, GL_FLOAT, &bad);
	intensity(&s, 0, 49, 49, 49);
	frame(&s);
	printf("# one NaN in a surfel: %llu surfels reported a frame later\n",
	       (unsigned long long)stats_now(&s).nonfinite);
	assert_true(stats_now(&s).nonfinite > 0);
	/* a new epoch starts from darkness */
	uint64_t known = stats_now(&s).nonfinite;
	s.rig.frame.gi_epoch++;
	frame(&s);
	assert_int_equal(stats_now(&s).nonfinite, known);
	end(&s);
}

/* A lamp that moves sideways 8 mm a frame: how evenly the light at a point follows. */
static double flicker(int taps)
{
	static float found[3][3 * POINTS];
	struct surfel_set *set = bake(scene, 0.25f, 128, taps, 0);
	const struct truth_spot spot = bench_spot();
	double worst = 0, mean = 0;
	struct setup s;

	begin_with(&s, scene, set, &spot, 1, false);
	frame(&s);
	for (int i = 0; i < 16; i++) {
		float *now = found[i % 3], *last = found[(i + 2) % 3], *before = found[(i + 1) % 3];

		s.rig.frame.lamps[0].position[0] = 2.2f - 0.008f * (float)i;
		frame(&s);
		mean = mean_irradiance(&s, now);
		for (size_t k = 0; k < 3 * sample_count && i >= 5; k++)
			worst = fmax(worst, fabs((double)(now[k] - 2 * last[k] + before[k])));
	}
	end(&s);
	surfel_set_destroy(&set);
	return worst / mean;
}

static void moving_lamp(void **state)
{
	double few = flicker(16), many = flicker(64);

	(void)state;
	printf("# lamp moving 8 mm a frame: worst second difference %.2f %% of mean E with 16 taps, %.2f %% with 64\n",
	       100 * few, 100 * many);
	assert_true(few < 0.05 && many < 0.05);
}

static void comes_to_rest(void **state)
{
	struct setup s;
	struct gi_stats stats;
	int frames = 0;

	(void)state;
	begin(&s, 1);
	frame(&s);
	assert_true(stats_now(&s).steady);
	frame(&s);
	assert_false(stats_now(&s).ran);
	intensity(&s, 0, 25, 25, 25);
	do {
		frame(&s);
		stats = stats_now(&s);
		frames += stats.ran;
	} while (stats.ran && frames < 1000);
	printf("# after a change: %d frames of work, then none; last change %.1e\n", frames, stats.residual);
	assert_true(frames < 40 && stats.steady);
	assert_true(stats.residual < 1e-5);
	end(&s);
}

/* sigma 0.1/m: what comes over one bounce is less, and all of it is gone at sigma 1. */
static void absorbing_medium(void **state)
{
	static float found[3 * POINTS];
	struct setup s;
	double clear, thick;

	(void)state;
	begin(&s, 1);
	frame(&s);
	clear = mean_irradiance(&s, found);
	s.rig.frame.absorption_per_m = 0.1f;
	for (int i = 0; i < 24; i++)
		frame(&s);
	thick = mean_irradiance(&s, found);
	printf("# absorption 0.1/m: %.3f of the clear room's indirect light\n", thick / clear);
	assert_true(thick < 0.6 * clear && thick > 0.2 * clear);
	s.rig.frame.absorption_per_m = 0;
	s.rig.frame.gi_epoch++;
	frame(&s);
	assert_true(fabs(mean_irradiance(&s, found) / clear - 1) < 1e-6);
	end(&s);
}

/* Sets that cannot be are refused before anything of them is read. */
static void refused_sets(void **state)
{
	const struct surfels_params params = SURFELS_PARAMS_DEFAULT;
	struct surfel_set set = { .spacing_m = 1, .radius_m = 2, .links_each = 16, .taps_each = 16 };
	struct gi_method *method;

	(void)state;
	gr_log_init("test_surfels_gl", GR_LOG_ERROR);
	assert_int_equal(gi_surfels_create(&method, &set, &params), GR_ERR_RANGE);
	set.count = (size_t)1 << 28; /* 8 GiB of surfels */
	assert_int_equal(gi_surfels_create(&method, &set, &params), GR_ERR_RANGE);
	set.count = SIZE_MAX / 64;
	assert_int_equal(gi_surfels_create(&method, &set, &params), GR_ERR_RANGE);
	assert_null(method);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	gr_log_init("test_surfels_gl", GR_LOG_WARNING);
}

/* --- equal nodes --- */

static void same_bits(void **state)
{
	struct setup a, b;

	(void)state;
	begin(&a, 1);
	begin(&b, 1);
	for (int i = 0; i < 6; i++) {
		a.rig.frame.lamps[0].position[0] = b.rig.frame.lamps[0].position[0] = 2 + 0.05f * (float)i;
		frame(&a);
		frame(&b);
		assert_true(a.method->ops->hash(a.method) == b.method->ops->hash(b.method));
	}
	end(&b);
	begin(&b, 1);
	b.rig.frame.lamps[0].position[0] = 2.25f;
	a.rig.frame.gi_epoch = b.rig.frame.gi_epoch = 7;
	for (int i = 0; i < 3; i++) {
		frame(&a);
		frame(&b);
		assert_true(a.method->ops->hash(a.method) == b.method->ops->hash(b.method));
		intensity(&a, 0, 20, 30, 40);
		intensity(&b, 0, 20, 30, 40);
	}
	printf("# two runs and a late join: hashes equal in every frame (last %016llx)\n",
	       (unsigned long long)a.method->ops->hash(a.method));
	end(&a);
	end(&b);
}

/* --- shared work --- */

#define NODES 4

struct cluster {
	struct surfel_rig rig;
	struct gi_method *nodes[NODES], *local;
	uint8_t *slice;
	size_t size, bytes, sent;
	int lost; /* node whose slices do not arrive; -1: none */
	double node_ms[NODES], local_ms;
};

static void cluster_begin(struct cluster *c, const struct surfel_set *set)
{
	const struct truth_spot spot = bench_spot();

	memset(c, 0, sizeof *c);
	assert_int_equal(surfel_rig_init(&c->rig, scene, &spot, 1, SHADOW_PIXELS), GR_OK);
	c->local = method_of(set, 4, false);
	for (unsigned i = 0; i < NODES; i++) {
		c->nodes[i] = method_of(set, 4, false);
		assert_int_equal(c->nodes[i]->ops->share->set(c->nodes[i], i, NODES), GR_OK);
	}
	c->size = c->nodes[0]->ops->share->bytes_max(c->nodes[0], NODES);
	c->slice = test_malloc(c->size);
	c->lost = -1;
}

static void cluster_end(struct cluster *c)
{
	c->local->ops->destroy(c->local);
	for (int i = 0; i < NODES; i++)
		c->nodes[i]->ops->destroy(c->nodes[i]);
	surfel_rig_finish(&c->rig);
	test_free(c->slice);
	assert_int_equal(glGetError(), GL_NO_ERROR);
}

static double timed_update(struct cluster *c, struct gi_method *method, const struct gi_light *light)
{
	double start = milliseconds();

	assert_true(method->ops->update(method, &c->rig.frame, light) >= GR_OK);
	glFinish();
	return milliseconds() - start;
}

static void cluster_frame(struct cluster *c)
{
	const struct gi_light light = surfel_rig_light(&c->rig);

	glFinish();
	c->local_ms = timed_update(c, c->local, &light);
	for (int i = 0; i < NODES; i++)
		c->node_ms[i] = timed_update(c, c->nodes[i], &light);
	c->bytes = c->sent = 0;
	for (int i = 0; i < NODES; i++) {
		const struct gi_share_ops *share = c->nodes[i]->ops->share;
		size_t len;
		int result = share->take(c->nodes[i], c->slice, c->size, &len);

		assert_true(result == GR_OK || (result == GR_NOTHING && len == 0));
		c->bytes += len;
		c->sent += result == GR_OK;
		for (int k = 0; k < NODES && result == GR_OK; k++)
			if (k != i && i != c->lost)
				assert_int_equal(share->put(c->nodes[k], c->slice, len), GR_OK);
	}
	c->rig.frame.frame++;
}

static bool all_equal(const struct cluster *c)
{
	uint64_t first = c->nodes[0]->ops->hash(c->nodes[0]);

	for (int i = 1; i < NODES; i++)
		if (c->nodes[i]->ops->hash(c->nodes[i]) != first)
			return false;
	return true;
}

/* Root of the mean square of the difference over the mean, of what shading sees. */
static double apart(struct gi_method *a, struct gi_method *b)
{
	static float of_a[3 * POINTS], of_b[3 * POINTS];
	double sum = 0, mean = mean_at(b, samples, sample_count, of_b);

	mean_at(a, samples, sample_count, of_a);
	for (size_t k = 0; k < 3 * sample_count; k++)
		sum += pow((double)(of_a[k] - of_b[k]), 2);
	return sqrt(sum / (3 * (double)sample_count)) / mean;
}

static double median(double *values, int count)
{
	for (int i = 1; i < count; i++)
		for (int k = i; k > 0 && values[k] < values[k - 1]; k--) {
			double swap = values[k];

			values[k] = values[k - 1];
			values[k - 1] = swap;
		}
	return values[count / 2];
}

static void shared_work(void **state)
{
	struct cluster c;
	double local[9], node[9];
	size_t bytes = 0;
	int frames = 0;

	(void)state;
	cluster_begin(&c, cornell);
	cluster_frame(&c);
	assert_int_equal(c.sent, NODES); /* after a restart each slice, once */
	assert_true(all_equal(&c));
	printf("# 4 nodes, after a restart: %.2e off what one alone finds\n", apart(c.nodes[1], c.local));
	assert_true(apart(c.nodes[1], c.local) < 1e-3);
	for (int i = 0; i < 9; i++) {
		c.rig.frame.lamps[0].position[0] = 2 - 0.02f * (float)i;
		cluster_frame(&c);
		assert_true(all_equal(&c));
		local[i] = c.local_ms;
		node[i] = 0;
		for (int k = 0; k < NODES; k++)
			node[i] = fmax(node[i], c.node_ms[k]);
		bytes = c.bytes;
	}
	printf("# lamp moving, 4 nodes: slowest node %.2f of one alone (%.1f of %.1f ms), %zu bytes a frame "
	       "of all nodes together\n",
	       median(node, 9) / median(local, 9), median(node, 9), median(local, 9), bytes);
	do {
		cluster_frame(&c);
		assert_true(all_equal(&c));
		frames++;
	} while (c.sent > 0 && frames < 100);
	printf("# then still: slices sent for %d frames more, then none; %.2e off what one alone finds\n",
	       frames - 1, apart(c.nodes[2], c.local));
	assert_true(frames < 40);
	assert_true(apart(c.nodes[2], c.local) < 5e-3);
	for (int i = 0; i < 40; i++)
		cluster_frame(&c);
	for (int i = 0; i < NODES; i++) {
		struct gi_stats stats;

		c.nodes[i]->ops->stats(c.nodes[i], &stats);
		assert_false(stats.ran);
	}
	cluster_end(&c);
}

/* A slice that is lost keeps what it had; a new epoch mends it. */
static void lost_slices(void **state)
{
	struct cluster c;

	(void)state;
	cluster_begin(&c, coarse);
	cluster_frame(&c);
	cluster_frame(&c);
	assert_true(all_equal(&c));
	c.lost = 2;
	memcpy(c.rig.frame.lamps[0].intensity, (float[3]){ 10, 20, 30 }, sizeof(vec3));
	for (int i = 0; i < 40; i++)
		cluster_frame(&c);
	assert_false(all_equal(&c));
	/* those that lost the same hold the same */
	assert_true(c.nodes[0]->ops->hash(c.nodes[0]) == c.nodes[1]->ops->hash(c.nodes[1]));
	double off = apart(c.nodes[0], c.local);
	printf("# slices of one node lost: the others are %.0f %% off, finite\n", 100 * off);
	assert_true(off > 0.01);
	c.lost = -1;
	c.rig.frame.gi_epoch++;
	cluster_frame(&c);
	assert_true(all_equal(&c));
	assert_int_equal(c.sent, NODES);
	/* another division, without a restart */
	for (unsigned i = 0; i < NODES; i++)
		assert_int_equal(c.nodes[i]->ops->share->set(c.nodes[i], NODES - 1 - i, NODES), GR_OK);
	for (int i = 0; i < 3; i++) {
		cluster_frame(&c);
		assert_true(all_equal(&c));
	}
	assert_true(apart(c.nodes[0], c.local) < 5e-3);
	/* and each alone again */
	for (unsigned i = 0; i < NODES; i++)
		assert_int_equal(c.nodes[i]->ops->share->set(c.nodes[i], 0, 1), GR_OK);
	for (int i = 0; i < 30; i++)
		for (int k = 0; k <= NODES; k++) {
			const struct gi_light light = surfel_rig_light(&c.rig);
			struct gi_method *m = k < NODES ? c.nodes[k] : c.local;

			m->ops->update(m, &c.rig.frame, &light);
		}
	printf("# each alone again: %.1e off\n", apart(c.nodes[3], c.local));
	assert_true(apart(c.nodes[3], c.local) < 1e-4);
	cluster_end(&c);
}

/* Bytes from outside: all that are no slice are refused, and change nothing. */
static void hostile_slices(void **state)
{
	struct cluster c;
	uint8_t *bad;
	size_t len, first;
	uint64_t before;

	(void)state;
	cluster_begin(&c, coarse);
	cluster_frame(&c);
	const struct gi_share_ops *share = c.nodes[0]->ops->share;

	memcpy(c.rig.frame.lamps[0].intensity, (float[3]){ 10, 20, 30 }, sizeof(vec3));
	const struct gi_light light = surfel_rig_light(&c.rig);
	c.nodes[1]->ops->update(c.nodes[1], &c.rig.frame, &light);
	glFinish();
	assert_int_equal(share->take(c.nodes[1], c.slice, c.size, &len), GR_OK);
	before = c.nodes[0]->ops->hash(c.nodes[0]);
	assert_int_equal(share->put(c.nodes[1], c.slice, len), GR_ERR_FORMAT); /* its own */
	assert_int_equal(share->put(c.local, c.slice, len), GR_ERR_FORMAT);    /* shares nothing */
	for (size_t cut = 0; cut < len; cut += cut < 64 ? 1 : 97) {
		bad = test_malloc(cut + 1);
		memcpy(bad, c.slice, cut);
		assert_int_equal(share->put(c.nodes[0], bad, cut), GR_ERR_FORMAT);
		test_free(bad);
	}
	first = 28; /* the header */
	for (size_t at = 0; at < first - 4; at++) {
		c.slice[at] ^= 0x41;
		assert_int_equal(share->put(c.nodes[0], c.slice, len), GR_ERR_FORMAT);
		c.slice[at] ^= 0x41;
	}
	/* NaN is one word; others with its exponent are none */
	c.slice[first + 3] |= 0xf8;
	c.slice[first] |= 1;
	assert_int_equal(share->put(c.nodes[0], c.slice, len), GR_ERR_FORMAT);
	assert_true(c.nodes[0]->ops->hash(c.nodes[0]) == before);
	assert_int_equal(share->set(c.nodes[0], 4, 4), GR_ERR_RANGE);
	assert_int_equal(share->set(c.nodes[0], 0, 0), GR_ERR_RANGE);
	assert_int_equal(share->set(c.nodes[0], 0, SURFELS_SLICES_MAX + 1), GR_ERR_RANGE);
	cluster_end(&c);
}

/* --- begin and end --- */

static int open_room(void **state)
{
	const struct truth_spot spot = bench_spot();

	(void)state;
	scene = room_cornell();
	if (truth_init(&truth, scene, &spot) != GR_OK)
		return -1;
	sample_count = truth_points(&truth, 1, 0.02f, samples, POINTS);
	trace(&truth, getenv("GROTTO_LONG") ? 60000 : 9000, samples, sample_count);
	cornell = bake(scene, 0.16f, 256, 16, 0);
	coarse = bake(scene, 0.3f, 128, 16, 4);
	return 0;
}

static int close_room(void **state)
{
	(void)state;
	for (int i = 0; i < 3; i++)
		bench_probe_destroy(&lookers[i].probe);
	surfel_set_destroy(&cornell);
	surfel_set_destroy(&coarse);
	truth_finish(&truth);
	room_free(&scene);
	return 0;
}

int main(void)
{
	const struct target_params params = { .kind = TARGET_HEADLESS, .width = 16, .height = 16, .gpu = -1 };
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(accuracy),	   cmocka_unit_test(furnace),
		cmocka_unit_test(closed_wall),	   cmocka_unit_test(doorway),
		cmocka_unit_test(lamp_switches),   cmocka_unit_test(two_lamps),
		cmocka_unit_test(huge_intensity),  cmocka_unit_test(nan_is_reported),
		cmocka_unit_test(moving_lamp),	   cmocka_unit_test(comes_to_rest),
		cmocka_unit_test(absorbing_medium), cmocka_unit_test(same_bits),
		cmocka_unit_test(refused_sets),
		cmocka_unit_test(shared_work),	   cmocka_unit_test(lost_slices),
		cmocka_unit_test(hostile_slices),
	};
	int failed;

	gr_log_init("test_surfels_gl", GR_LOG_WARNING);
	if (target_create(&target, &params) != GR_OK) {
		printf("# no OpenGL 4.5 here: skipped\n");
		return 77;
	}
	printf("# %s\n", target_renderer_name(target));
	failed = cmocka_run_group_tests(tests, open_room, close_room);
	target_destroy(&target);
	return failed;
}
