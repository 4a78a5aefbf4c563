/*
 * The lattice's cost and error, product and thesis side by side on one device:
 * bench-lattice [--speed] [CELLS...] (default 32 64). The two kernels run in
 * turn, so that a busy machine slows both; the table gives the medians over
 * the rounds, in time to the end of the work and, since a software renderer's
 * GPU is this CPU, in processor time. The product's links, clamp and
 * reflection are part of what is measured. The error is of indirect irradiance
 * in the Cornell-like room against path tracing, area-weighted over its
 * surfaces; --speed leaves it out.
 */
#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/lpv_private.h"
#include "renderer/gl/target.h"
#include "tools/bench/lpv_bench.h"
#include "tools/bench/room.h"
#include "tools/bench/truth.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define MAP 128
#define POINTS 600
#define PATHS 2000
#define STEPS 8
#define ROUNDS_MAX 41
#define ROUNDS_MIN 5
#define THESIS_FRAMES 12 /* of 8 steps, incremental factor 0.8: 7 % of the first is left */
#define ROUND_BUDGET_MS 8000.0

static struct truth_texel texels[MAP * MAP];
static struct truth_sample samples[POINTS];
static size_t sample_count;
static float found[3 * POINTS];

struct cost {
	double wall_ms[ROUNDS_MAX], cpu_ms[ROUNDS_MAX];
};

static double clock_ms(clockid_t clock)
{
	struct timespec t;

	clock_gettime(clock, &t);
	return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static void run(struct lpv *lpv, bool thesis, struct cost *cost, int round)
{
	double wall, cpu;

	glFinish();
	wall = clock_ms(CLOCK_MONOTONIC);
	cpu = clock_ms(CLOCK_PROCESS_CPUTIME_ID);
	if (thesis)
		lpv_thesis_steps(&lpv->thesis, &lpv->lattice, 0, 0, STEPS);
	else
		lpv_propagate(lpv, STEPS, 1);
	glFinish();
	cost->cpu_ms[round] = clock_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu;
	cost->wall_ms[round] = clock_ms(CLOCK_MONOTONIC) - wall;
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static double median(double *values, int count)
{
	qsort(values, (size_t)count, sizeof *values, ascending);
	return values[count / 2];
}

/* One round that is not counted, then as many as the time allows. */
static int run_rounds(struct gi_method *const method[2], struct cost cost[2])
{
	double start = clock_ms(CLOCK_MONOTONIC);
	int count = 0;

	for (int round = -1; round < ROUNDS_MAX; round++) {
		for (int k = 0; k < 2; k++) {
			method[k]->ops->bind(method[k]);
			run((struct lpv *)method[k], k, &cost[k], round < 0 ? 0 : round);
		}
		count = round + 1;
		if (count >= ROUNDS_MIN && clock_ms(CLOCK_MONOTONIC) - start > ROUND_BUDGET_MS)
			break;
	}
	return count;
}

/* Light of the room after `frames` frames against the truth. */
static int error_of(struct gi_method *method, const struct scene_file *file, struct rsm_set *maps,
		    int frames, struct truth_error *out)
{
	const struct gi_light light = { .rsm = maps };
	struct bench_probe *probe;
	struct render_frame frame;
	int result = bench_probe_create(&probe, method);

	if (result != GR_OK)
		return result;
	bench_frame(&frame, file);
	frame.lamps[0].on = true;
	for (int c = 0; c < 3; c++)
		frame.lamps[0].intensity[c] = bench_spot().intensity[c];
	for (int i = 0; i < frames; i++, frame.frame++)
		method->ops->update(method, &frame, &light);
	bench_probe_run(probe, method, samples, sample_count, found);
	bench_probe_destroy(&probe);
	*out = truth_compare(samples, found, sample_count);
	return GR_OK;
}

static void print_table(int cells, struct cost cost[2], int rounds, const struct truth_error *error)
{
	double wall[2], cpu[2];

	for (int k = 0; k < 2; k++) {
		wall[k] = median(cost[k].wall_ms, rounds);
		cpu[k] = median(cost[k].cpu_ms, rounds);
	}
	for (int k = 0; k < 2; k++) {
		printf("%3d^3  %-8s %10.3f %10.3f   %5.2f  %5.2f", cells, k ? "thesis" : "product", wall[k],
		       cpu[k], wall[1] / wall[k], cpu[1] / cpu[k]);
		if (error)
			printf("   %+6.1f %% %7.1f %% %7.1f %%", 100 * error[k].bias, 100 * error[k].nrmse,
			       100 * error[k].shape);
		printf("   %d rounds\n", rounds);
	}
	fflush(stdout);
}

static int bench(const struct scene *scene, int cells, bool speed_only)
{
	static struct cost cost[2];
	struct truth_error error[2];
	struct gi_method *method[2] = { NULL, NULL };
	struct rsm_set maps;
	struct scene_file file;
	int result = GR_OK;

	bench_maps_init(&maps, MAP, 1);
	bench_maps_fill(&maps, 0, texels, 1);
	for (int k = 0; k < 2 && result == GR_OK; k++) {
		bench_file(&file, cells, STEPS);
		file.gi.lpv_mode = k ? SCENE_LPV_THESIS : SCENE_LPV_REPAIRED;
		file.gi.incremental = 0.8f;
		result = gi_lpv_create(&method[k], scene, &file);
		if (result == GR_OK)
			result = error_of(method[k], &file, &maps, k ? THESIS_FRAMES : 1, &error[k]);
	}
	if (result == GR_OK)
		print_table(cells, cost, run_rounds(method, cost), speed_only ? NULL : error);
	for (int k = 0; k < 2; k++)
		if (method[k])
			method[k]->ops->destroy(method[k]);
	bench_maps_finish(&maps);
	return result;
}

static int run_all(const struct scene *scene, int count, char **cells, bool speed_only)
{
	const struct truth_spot spot = bench_spot();
	char *usual[] = { "32", "64" };
	struct truth truth;
	struct truth_error noise;
	int result = truth_init(&truth, scene, &spot);

	if (result != GR_OK)
		return result;
	truth_map(&truth, MAP, texels);
	sample_count = truth_points(&truth, 1, 0.02f, samples, POINTS);
	if (!speed_only) {
		truth_trace(&truth, 7, PATHS, samples, sample_count);
		noise = truth_compare(samples, found, sample_count);
		printf("room of 4 m, two boxes, one spotlight; truth: %zu points, %d paths each, noise %.1f %%\n",
		       sample_count, PATHS, 100 * noise.noise);
	}
	printf("lattice kernel       ms/%d   CPU ms/%d   faster (ms, CPU)%s\n", STEPS, STEPS,
	       speed_only ? "" : "   bias     nRMSE     shape");
	if (!count) {
		cells = usual;
		count = 2;
	}
	for (int i = 0; i < count && result == GR_OK; i++)
		result = bench(scene, atoi(cells[i]), speed_only);
	truth_finish(&truth);
	return result;
}

int main(int argc, char **argv)
{
	const struct target_params params = { .kind = TARGET_HEADLESS, .width = 16, .height = 16, .gpu = -1 };
	struct target *target;
	bool speed_only = argc > 1 && !strcmp(argv[1], "--speed");
	struct scene *scene;
	int result;

	gr_log_init("bench-lattice", GR_LOG_WARNING);
	result = target_create(&target, &params);
	if (result != GR_OK)
		return GR_EXIT_RUNTIME;
	printf("%s\n", target_renderer_name(target));
	scene = room_cornell();
	result = run_all(scene, argc - 1 - speed_only, argv + 1 + speed_only, speed_only);
	if (result != GR_OK)
		fprintf(stderr, "bench-lattice: %s\n", gr_result_name(result));
	room_free(&scene);
	target_destroy(&target);
	return result == GR_OK ? GR_EXIT_OK : GR_EXIT_RUNTIME;
}
