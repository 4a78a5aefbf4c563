/* The lattice on the GPU: against the CPU, against path tracing, and the hard cases. */
#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/lpv_cpu.h"
#include "renderer/gi/lpv_private.h"
#include "renderer/gl/target.h"
#include "tools/bench/lpv_bench.h"
#include "tools/bench/room.h"
#include "tools/bench/truth.h"
#include "tests/unit/unit.h"

#include <epoxy/gl.h>
#include <math.h>

#define MAP 64
#define POINTS 400

static struct target *target;
static struct scene *scene;
static struct truth truth;
static struct truth_texel texels[MAP * MAP];
static struct truth_sample samples[POINTS];
static size_t sample_count;

struct setup {
	struct scene_file file;
	struct render_frame frame;
	struct gi_method *method;
	struct rsm_set maps;
};

static void begin(struct setup *s, int lattice, int layers)
{
	bench_file(&s->file, lattice, 8);
	bench_frame(&s->frame, &s->file);
	assert_int_equal(gi_lpv_create(&s->method, scene, &s->file), GR_OK);
	bench_maps_init(&s->maps, MAP, layers);
}

static void end(struct setup *s)
{
	s->method->ops->destroy(s->method);
	bench_maps_finish(&s->maps);
	assert_int_equal(glGetError(), GL_NO_ERROR);
}

static void frame(struct setup *s)
{
	const struct gi_light light = { .rsm = &s->maps };

	assert_true(s->method->ops->update(s->method, &s->frame, &light) >= GR_OK);
	s->frame.frame++;
}

static struct gi_stats stats_now(struct setup *s)
{
	struct gi_stats stats;

	glFinish();
	lpv_check_collect((struct lpv *)s->method);
	s->method->ops->stats(s->method, &stats);
	return stats;
}

static double mean_irradiance(struct setup *s, float *found)
{
	struct bench_probe *probe;
	double sum = 0;

	assert_int_equal(bench_probe_create(&probe, s->method), GR_OK);
	bench_probe_run(probe, s->method, samples, sample_count, found);
	bench_probe_destroy(&probe);
	for (size_t k = 0; k < 3 * sample_count; k++) {
		assert_true(isfinite(found[k]));
		sum += (double)found[k];
	}
	return sum / (3 * (double)sample_count);
}

static void gpu_as_cpu(void **state)
{
	static float gpu[3 * POINTS];
	struct setup s;
	struct lattice l;
	struct links *links;
	struct lpv_cpu cpu;
	double difference = 0, square = 0;

	(void)state;
	begin(&s, 12, 1);
	bench_maps_fill(&s.maps, 0, texels, 1);
	frame(&s);
	mean_irradiance(&s, gpu);
	assert_int_equal(lattice_init(&l, scene->min, scene->max, 12), GR_OK);
	assert_int_equal(links_create(&links, scene, truth.rays, &l, s.file.gi.link_rays,
				      s.file.gi.albedo_override), GR_OK);
	assert_int_equal(lpv_cpu_init(&cpu, links, NULL), GR_OK);
	cpu.clamp = true;
	for (size_t k = 0; k < MAP * MAP; k++) {
		float flux[3];

		for (int c = 0; c < 3; c++)
			flux[c] = texels[k].area * texels[k].exitance[c];
		if (texels[k].area > 0)
			lpv_cpu_inject(&cpu, texels[k].position, texels[k].normal, flux);
	}
	for (int i = 0; i < links->settle_steps; i++)
		lpv_cpu_step(&cpu);
	for (size_t k = 0; k < sample_count; k++) {
		float e[3];

		lpv_cpu_irradiance(&cpu, samples[k].position, samples[k].normal, e);
		for (size_t c = 0; c < 3; c++) {
			difference += pow((double)(e[c] - gpu[3 * k + c]), 2);
			square += pow((double)e[c], 2);
		}
	}
	/* normals travel as 16 bit floats */
	printf("# GPU against CPU: relative rms difference %.1e\n", sqrt(difference / square));
	assert_true(sqrt(difference / square) < 2e-4);
	lpv_cpu_finish(&cpu);
	links_destroy(&links);
	end(&s);
}

static void accuracy_at(int lattice, double nrmse, double bias)
{
	static float found[3 * POINTS];
	struct truth_error e;
	struct setup s;

	begin(&s, lattice, 1);
	bench_maps_fill(&s.maps, 0, texels, 1);
	frame(&s);
	mean_irradiance(&s, found);
	e = truth_compare(samples, found, sample_count);
	printf("# %d cells: bias %+.1f %%, nRMSE %.1f %%, shape %.1f %% (noise of the truth %.1f %%)\n",
	       lattice, 100 * e.bias, 100 * e.nrmse, 100 * e.shape, 100 * e.noise);
	assert_true(e.nrmse < nrmse);
	assert_true(fabs(e.bias) < bias);
	end(&s);
}

static void accuracy(void **state)
{
	(void)state;
	accuracy_at(16, 0.27, 0.06);
	accuracy_at(32, 0.36, 0.06);
}

/* On, off, on, and a fade to 1e-7; dark within 11 frames of 8 steps at 16 cells. */
static void lamp_switches(void **state)
{
	static float found[3 * POINTS];
	static const float factors[] = { 1, 0, 1, 1e-3f, 1e-7f };
	struct setup s;
	double lit = 0, last = 0;
	double before = 0;
	int frames = 0;

	(void)state;
	begin(&s, 16, 1);
	bench_maps_fill(&s.maps, 0, texels, 1);
	frame(&s);
	lit = mean_irradiance(&s, found);
	bench_maps_fill(&s.maps, 0, texels, 0);
	for (; frames < 40 && (frames == 0 || last > 1e-3 * lit); frames++) {
		frame(&s);
		last = mean_irradiance(&s, found);
	}
	printf("# lamp off at 16 cells: under 0.1 %% of the light after %d frames\n", frames);
	assert_true(frames <= 11);
	for (size_t k = 0; k < sizeof factors / sizeof *factors; k++) {
		bench_maps_fill(&s.maps, 0, texels, factors[k]);
		for (int i = 0; i < 24; i++)
			frame(&s);
		last = mean_irradiance(&s, found);
		/* what is left of the light before when work stops */
		assert_true(fabs(last - lit * (double)factors[k]) <
			    1e-4 * lit * fmax(before, (double)factors[k]));
		before = (double)factors[k];
		assert_int_equal(stats_now(&s).nonfinite, 0);
	}
	printf("# fade to 1e-7: E = %.2e of E lit\n", last / lit);
	end(&s);
}

/* The lamp of a room of 32 cells goes off: under 0.1 % within 24 frames of 8 steps. */
static void dark_at_32(void **state)
{
	static float found[3 * POINTS];
	struct setup s;
	double lit, last = INFINITY;
	int frames = 0;

	(void)state;
	begin(&s, 32, 1);
	bench_maps_fill(&s.maps, 0, texels, 1);
	frame(&s);
	lit = mean_irradiance(&s, found);
	bench_maps_fill(&s.maps, 0, texels, 0);
	for (; frames < 40 && last > 1e-3 * lit; frames++) {
		frame(&s);
		last = mean_irradiance(&s, found);
	}
	printf("# lamp off at 32 cells: under 0.1 %% of the light after %d frames\n", frames);
	assert_true(frames <= 24);
	end(&s);
}

static double buffer_flux(const struct lpv_buffer *b, size_t cells)
{
	float *rows = malloc(cells * LPV_LIGHT_FLOATS * sizeof *rows);
	double sum = 0;

	assert_non_null(rows);
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glGetNamedBufferSubData(b->buffer, 0, (GLsizeiptr)(cells * LPV_LIGHT_FLOATS * sizeof *rows),
				rows);
	for (size_t i = 0; i < 3 * cells; i++)
		sum += (double)rows[4 * i];
	free(rows);
	return sum;
}

/* Steady: what the walls take away in a step is what the lamps bring. */
static void incident_is_injected(void **state)
{
	struct setup s;
	struct lpv *lpv;
	double injected, before, absorbed;
	size_t cells;

	(void)state;
	begin(&s, 12, 1);
	bench_maps_fill(&s.maps, 0, texels, 1);
	frame(&s);
	lpv = (struct lpv *)s.method;
	cells = lattice_cells(&lpv->lattice);
	lpv_propagate(lpv, 400, 1);
	injected = buffer_flux(&lpv->inject, cells);
	before = buffer_flux(&lpv->light[lpv->current], cells);
	const unsigned lamps[2] = { lpv->inject.buffer, lpv->emitted.buffer };
	for (int i = 0; i < 2; i++)
		glClearNamedBufferData(lamps[i], GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
	lpv_propagate(lpv, 1, 1);
	absorbed = before - buffer_flux(&lpv->light[lpv->current], cells);
	printf("# on the GPU, clamped: absorbed / injected - 1 = %.1e\n", absorbed / injected - 1);
	assert_true(injected > 0 && fabs(absorbed / injected - 1) < 1e-4);
	end(&s);
}

/* Two rooms of 3 m, a wall of 20 cm with a doorway of 1 x 2 m; the lamp is in the first. */
static struct scene *two_rooms(void)
{
	struct room_builder b;

	room_begin(&b);
	uint32_t m = room_material(&b, 0.7f, 0.7f, 0.7f);
	room_inside(&b, (uint32_t[6]){ m, m, m, m, m, m }, (float[3]){ 0, 0, 0 }, (float[3]){ 6, 3, 3 });
	room_box(&b, m, (float[3]){ 3, 1.5f, 0.5f }, (float[3]){ 0.1f, 1.5f, 0.5f }, 0);
	room_box(&b, m, (float[3]){ 3, 1.5f, 2.5f }, (float[3]){ 0.1f, 1.5f, 0.5f }, 0);
	room_box(&b, m, (float[3]){ 3, 2.5f, 1.5f }, (float[3]){ 0.1f, 0.5f, 0.5f }, 0);
	return room_end(&b);
}

static void doorway(void **state)
{
	static struct truth_texel map[MAP * MAP];
	static struct truth_sample points[POINTS];
	static float found[3 * POINTS];
	const struct truth_spot spot = { { 1, 2.9f, 1.5f }, { 0, -1, 0 }, { 50, 50, 50 }, 0.5f };
	struct scene *kept = scene;
	struct bench_probe *probe;
	struct truth rooms;
	struct truth_error e;
	struct setup s;
	size_t count, dark = 0;

	(void)state;
	scene = two_rooms();
	assert_int_equal(truth_init(&rooms, scene, &spot), GR_OK);
	truth_map(&rooms, MAP, map);
	count = truth_points(&rooms, 3, 0.02f, points, POINTS);
	for (size_t i = 0; i < count; i++)
		if (points[i].position[0] > 3.11f)
			points[dark++] = points[i];
	truth_trace(&rooms, 11, 4000, points, dark);
	begin(&s, 24, 1);
	bench_maps_fill(&s.maps, 0, map, 1);
	frame(&s);
	assert_int_equal(bench_probe_create(&probe, s.method), GR_OK);
	bench_probe_run(probe, s.method, points, dark, found);
	bench_probe_destroy(&probe);
	e = truth_compare(points, found, dark);
	printf("# dark room behind a doorway, 24 cells: bias %+.0f %%, nRMSE %.0f %% (%zu points, noise %.0f %%)\n",
	       100 * e.bias, 100 * e.nrmse, dark, 100 * e.noise);
	assert_true(dark > 50);
	assert_true(e.nrmse < 0.35);
	end(&s);
	truth_finish(&rooms);
	room_free(&scene);
	scene = kept;
}

static void huge_intensity(void **state)
{
	static float found[3 * POINTS];
	struct setup s;
	double e;

	(void)state;
	begin(&s, 8, 1);
	bench_maps_fill(&s.maps, 0, texels, 1e9f);
	frame(&s);
	e = mean_irradiance(&s, found);
	printf("# intensity %g W/sr: mean E %.4g, nonfinite %llu\n", 50 * 1e9, e,
	       (unsigned long long)stats_now(&s).nonfinite);
	assert_true(e > 65504 && isfinite(e));
	assert_int_equal(stats_now(&s).nonfinite, 0);
	end(&s);
}

static void nan_is_reported(void **state)
{
	const float bad = NAN;
	struct setup s;
	struct lpv *lpv;

	(void)state;
	begin(&s, 8, 1);
	bench_maps_fill(&s.maps, 0, texels, 1);
	frame(&s);
	assert_int_equal(stats_now(&s).nonfinite, 0);
	lpv = (struct lpv *)s.method;
	/* flux of the red band of cell (4, 6, 4), in the bordered lattice */
	glClearNamedBufferSubData(lpv->sent[lpv->sending].buffer, GL_R32F,
				  16 * (5 + 10 * (7 + 10 * 5)), 4, GL_RED, GL_FLOAT, &bad);
	s.maps.version++;
	frame(&s);
	printf("# one NaN in a cell: %llu cells reported a frame later\n",
	       (unsigned long long)stats_now(&s).nonfinite);
	assert_true(stats_now(&s).nonfinite > 0);
	/* a new epoch starts from darkness */
	uint64_t known = stats_now(&s).nonfinite;
	s.frame.gi_epoch++;
	frame(&s);
	assert_int_equal(stats_now(&s).nonfinite, known);
	/* and a texel that is NaN is counted, not spread */
	struct truth_texel kept = texels[7 * MAP + 9];
	texels[7 * MAP + 9].exitance[1] = NAN;
	bench_maps_fill(&s.maps, 0, texels, 1);
	texels[7 * MAP + 9] = kept;
	frame(&s);
	assert_int_equal(stats_now(&s).nonfinite, known + (kept.area > 0 ? 1 : 0));
	end(&s);
}

static void two_lamps(void **state)
{
	static float both[3 * POINTS], one[3 * POINTS], other[3 * POINTS];
	struct setup s;
	double worst = 0, mean;

	(void)state;
	begin(&s, 12, 2);
	bench_maps_fill(&s.maps, 0, texels, 1);
	frame(&s);
	mean_irradiance(&s, one);
	bench_maps_fill(&s.maps, 0, texels, 0);
	bench_maps_fill(&s.maps, 1, texels, 0.37f);
	s.frame.gi_epoch++;
	frame(&s);
	mean_irradiance(&s, other);
	bench_maps_fill(&s.maps, 0, texels, 1);
	s.frame.gi_epoch++;
	frame(&s);
	mean = mean_irradiance(&s, both);
	for (size_t k = 0; k < 3 * sample_count; k++)
		worst = fmax(worst, fabs((double)(both[k] - one[k] - other[k])));
	printf("# two lamps from one place, clamped: sum off by %.1e of the mean\n", worst / mean);
	assert_true(worst / mean < 1e-5);
	end(&s);
}

/* Two that saw the same, and one that came late and was told a new epoch. */
static void same_bits(void **state)
{
	struct setup a, b;

	(void)state;
	begin(&a, 12, 1);
	begin(&b, 12, 1);
	for (int i = 0; i < 6; i++) {
		bench_maps_fill(&a.maps, 0, texels, 1 + 0.1f * (float)i);
		bench_maps_fill(&b.maps, 0, texels, 1 + 0.1f * (float)i);
		frame(&a);
		frame(&b);
		assert_true(a.method->ops->hash(a.method) == b.method->ops->hash(b.method));
	}
	end(&b);
	begin(&b, 12, 1);
	bench_maps_fill(&b.maps, 0, texels, 1.5f);
	a.frame.gi_epoch = b.frame.gi_epoch = 7;
	for (int i = 0; i < 3; i++) {
		frame(&a);
		frame(&b);
		assert_true(a.method->ops->hash(a.method) == b.method->ops->hash(b.method));
		bench_maps_fill(&a.maps, 0, texels, 0.5f);
		bench_maps_fill(&b.maps, 0, texels, 0.5f);
	}
	printf("# two runs and a late join: hashes equal in every frame (last %016llx)\n",
	       (unsigned long long)a.method->ops->hash(a.method));
	end(&a);
	end(&b);
}

/* The quick start against very many plain steps; all cells, both bands of directions. */
static void quick_start(void **state)
{
	const size_t count = (size_t)16 * 16 * 16 * LPV_LIGHT_FLOATS;
	float *quick = calloc(count, sizeof *quick), *plain = calloc(count, sizeof *plain);
	double worst = 0, largest = 0;
	struct setup s;
	struct lpv *lpv;
	int steps;

	(void)state;
	assert_true(quick && plain);
	begin(&s, 16, 1);
	bench_maps_fill(&s.maps, 0, texels, 1);
	frame(&s);
	steps = stats_now(&s).steps;
	lpv = (struct lpv *)s.method;
	glGetNamedBufferSubData(lpv->light[lpv->current].buffer, 0,
				(GLsizeiptr)(count * sizeof *quick), quick);
	s.method->ops->bind(s.method);
	lpv_propagate(lpv, 3 * lpv->settle_steps, 1);
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glGetNamedBufferSubData(lpv->light[lpv->current].buffer, 0,
				(GLsizeiptr)(count * sizeof *plain), plain);
	for (size_t k = 0; k < count; k++) {
		worst = fmax(worst, fabs((double)(quick[k] - plain[k])));
		largest = fmax(largest, fabs((double)plain[k]));
	}
	printf("# steady after %d steps from darkness (%d after a change): %.1e off\n", steps,
	       lpv->settle_steps, worst / largest);
	assert_true(worst < 1e-4 * largest);
	free(quick);
	free(plain);
	end(&s);
}

/* A lamp that changes in every frame: gi_steps steps each, no more. */
static void never_at_rest(void **state)
{
	struct setup s;

	(void)state;
	begin(&s, 12, 1);
	bench_maps_fill(&s.maps, 0, texels, 1);
	frame(&s);
	for (int i = 0; i < 5; i++) {
		bench_maps_fill(&s.maps, 0, texels, 1 + 0.1f * (float)i);
		frame(&s);
		assert_true(stats_now(&s).ran);
		assert_int_equal(stats_now(&s).steps, s.frame.gi_steps);
	}
	end(&s);
}

static void comes_to_rest(void **state)
{
	struct setup s;
	struct gi_stats stats;
	int frames = 0;

	(void)state;
	begin(&s, 12, 1);
	bench_maps_fill(&s.maps, 0, texels, 1);
	frame(&s);
	assert_true(stats_now(&s).steady);
	frame(&s);
	assert_false(stats_now(&s).ran);
	bench_maps_fill(&s.maps, 0, texels, 0.5f);
	do {
		frame(&s);
		stats = stats_now(&s);
		frames += stats.ran;
	} while (stats.ran && frames < 1000);
	printf("# after a change: %d frames of work, then none; last change %.1e\n", frames,
	       stats.residual);
	assert_true(frames < 100 && stats.steady);
	assert_true(stats.residual < 1e-3);
	end(&s);
}

static void thesis_mode(void **state)
{
	static float found[3 * POINTS];
	struct truth_error e;
	struct setup s;

	(void)state;
	bench_file(&s.file, 16, 8);
	s.file.gi.lpv_mode = SCENE_LPV_THESIS;
	s.file.gi.incremental = 0.8f;
	bench_frame(&s.frame, &s.file);
	s.frame.lamps[0].on = true;
	for (int c = 0; c < 3; c++)
		s.frame.lamps[0].intensity[c] = 50;
	assert_int_equal(gi_lpv_create(&s.method, scene, &s.file), GR_OK);
	bench_maps_init(&s.maps, MAP, 1);
	bench_maps_fill(&s.maps, 0, texels, 1);
	for (int i = 0; i < 20; i++)
		frame(&s);
	mean_irradiance(&s, found);
	e = truth_compare(samples, found, sample_count);
	printf("# thesis mode, 16 cells: bias %+.0f %%, nRMSE %.0f %%\n", 100 * e.bias, 100 * e.nrmse);
	/* off and on again: its ratio of energies must not become 0/0 */
	for (int i = 0; i < 6; i++) {
		s.frame.lamps[0].on = i % 2;
		bench_maps_fill(&s.maps, 0, texels, i % 2 ? 1.0f : 0.0f);
		frame(&s);
		mean_irradiance(&s, found);
	}
	assert_int_equal(stats_now(&s).nonfinite, 0);
	end(&s);
}

static int open_room(void **state)
{
	const struct truth_spot spot = bench_spot();

	(void)state;
	scene = room_cornell();
	if (truth_init(&truth, scene, &spot) != GR_OK)
		return -1;
	truth_map(&truth, MAP, texels);
	sample_count = truth_points(&truth, 1, 0.02f, samples, POINTS);
	truth_trace(&truth, 7, getenv("GROTTO_LONG") ? 8000 : 1500, samples, sample_count);
	return 0;
}

static int close_room(void **state)
{
	(void)state;
	truth_finish(&truth);
	room_free(&scene);
	return 0;
}

int main(void)
{
	const struct target_params params = { .kind = TARGET_HEADLESS, .width = 16, .height = 16, .gpu = -1 };
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gpu_as_cpu),	    cmocka_unit_test(accuracy),
		cmocka_unit_test(lamp_switches),    cmocka_unit_test(huge_intensity),
		cmocka_unit_test(dark_at_32),	    cmocka_unit_test(incident_is_injected),
		cmocka_unit_test(doorway),
		cmocka_unit_test(nan_is_reported),  cmocka_unit_test(two_lamps),
		cmocka_unit_test(same_bits),	    cmocka_unit_test(comes_to_rest),
		cmocka_unit_test(quick_start),	    cmocka_unit_test(never_at_rest),
		cmocka_unit_test(thesis_mode),
	};
	int failed;

	gr_log_init("test_lpv_gl", GR_LOG_WARNING);
	if (target_create(&target, &params) != GR_OK) {
		printf("# no OpenGL 4.5 here: skipped\n");
		return 77;
	}
	printf("# %s\n", target_renderer_name(target));
	failed = cmocka_run_group_tests(tests, open_room, close_room);
	target_destroy(&target);
	return failed;
}
