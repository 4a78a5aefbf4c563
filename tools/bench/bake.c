/*
 * How fast surfels are baked: whole bakes of a generated atrium or of a model,
 * and the links' rays beside a bare Embree loop over the same rays, in turns,
 * since a machine is rarely alone.
 */
#include "base/clock.h"
#include "base/plain.h"
#include "base/result.h"
#include "renderer/gi/surfel_bake_private.h"
#include "renderer/scene/import.h"
#include "tools/bench/atrium.h"
#include "tools/bench/room.h"

#include <embree3/rtcore.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define TURNS 5
#define AT_ONCE 4096 /* surfels whose rays are kept at once for the bare loop */
#define PORTION 8    /* surfels, as the baker has them */

/* Of the machine, and of the threads: the first counts, the second bears other work. */
struct seconds {
	double wall, processor;
};

struct race {
	const struct bake *bake;
	size_t first; /* surfel of those kept */
	struct RTCRayHit *rays;
	RTCScene scene;
};

static struct seconds now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (struct seconds){ (double)gr_clock_now(&gr_clock_monotonic) * 1e-9,
				 (double)t.tv_sec + (double)t.tv_nsec * 1e-9 };
}

static void add_since(struct seconds *sum, struct seconds start)
{
	struct seconds end = now();

	sum->wall += end.wall - start.wall;
	sum->processor += end.processor - start.processor;
}

/* Those that the baker traces, in its order. */
static void fill_rays(void *ctx, size_t begin, size_t end, int thread)
{
	const struct race *r = ctx;
	uint32_t each = r->bake->set->links_each;
	struct bake_links_rays rays;

	(void)thread;
	for (size_t i = begin; i < end; i++)
		for (uint32_t first = 0; first < each; first += rays.count) {
			bake_link_rays(r->bake, r->first + i, first, &rays);
			for (uint32_t k = 0; k < rays.count; k++) {
				const float *from = rays.ray[k].origin, *way = rays.ray[k].direction;

				r->rays[i * each + first + k] = (struct RTCRayHit){
					.ray = { .org_x = from[0], .org_y = from[1], .org_z = from[2],
						 .dir_x = way[0], .dir_y = way[1], .dir_z = way[2],
						 .tfar = INFINITY, .mask = ~0u },
					.hit = { .geomID = RTC_INVALID_GEOMETRY_ID },
				};
			}
		}
}

static void trace_rays(void *ctx, size_t begin, size_t end, int thread)
{
	const struct race *r = ctx;
	uint32_t each = r->bake->set->links_each;
	struct RTCIntersectContext context;

	(void)thread;
	rtcInitIntersectContext(&context);
	for (size_t k = begin * each; k < end * each; k++)
		rtcIntersect1(r->scene, &context, &r->rays[k]);
}

static RTCScene bare_scene(RTCDevice device, const struct scene *scene)
{
	RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
	RTCScene bare = rtcNewScene(device);
	float *at = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
					    3 * sizeof(float), scene->vertex_count);
	void *triangles = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
						  3 * sizeof(uint32_t), scene->index_count / 3);

	for (size_t i = 0; i < scene->vertex_count; i++)
		memcpy(at + 3 * i, scene->vertices[i].position, 3 * sizeof *at);
	memcpy(triangles, scene->indices, scene->index_count / 3 * 3 * sizeof(uint32_t));
	rtcCommitGeometry(mesh);
	rtcAttachGeometry(bare, mesh);
	rtcReleaseGeometry(mesh);
	rtcSetSceneFlags(bare, RTC_SCENE_FLAG_ROBUST);
	rtcCommitScene(bare);
	return bare;
}

/* All of the baker's step: tables, rays, look-ups, and what it writes. */
static struct seconds run_baker(struct bake *bake)
{
	struct seconds sum = { 0 }, start;

	start = now();
	if (bake_links(bake) != GR_OK)
		abort();
	add_since(&sum, start);
	return sum;
}

static struct seconds run_bare(struct race *r)
{
	struct seconds sum = { 0 };
	size_t count = r->bake->set->count;

	for (r->first = 0; r->first < count; r->first += AT_ONCE) {
		size_t some = count - r->first < AT_ONCE ? count - r->first : AT_ONCE;
		struct seconds start;

		crew_run(r->bake->threads, some, PORTION, fill_rays, r, NULL, NULL);
		start = now();
		crew_run(r->bake->threads, some, PORTION, trace_rays, r, NULL, NULL);
		add_since(&sum, start);
	}
	return sum;
}

static int by_value(const void *a, const void *b)
{
	const double *x = a, *y = b;

	return *x < *y ? -1 : *x > *y;
}

static double middle(double values[TURNS])
{
	qsort(values, TURNS, sizeof *values, by_value);
	return values[TURNS / 2];
}

static void race(struct bake *bake, void *ctx)
{
	size_t each = bake->set->links_each;
	double count = (double)(bake->set->count * each);
	double baker[TURNS], bare[TURNS], share[TURNS], processor[TURNS];
	RTCDevice device = rtcNewDevice("set_affinity=0");
	struct race r = { .bake = bake };

	(void)ctx;
	r.rays = calloc(AT_ONCE * each, sizeof *r.rays);
	if (!r.rays || !device)
		abort();
	r.scene = bare_scene(device, bake->scene);
	for (int turn = 0; turn < TURNS; turn++) {
		struct seconds a = run_baker(bake), b = run_bare(&r);

		baker[turn] = 1e-6 * count / a.wall;
		bare[turn] = 1e-6 * count / b.wall;
		share[turn] = 100 * b.wall / a.wall;
		processor[turn] = 100 * b.processor / a.processor;
	}
	printf("  links: %.0f rays, %.3f million/s made, traced and looked up, %.3f by bare rtcIntersect1\n",
	       count, middle(baker), middle(bare));
	middle(share);
	middle(processor);
	printf("  share %.0f %% (%.0f..%.0f in %d turns)", share[TURNS / 2], share[0], share[TURNS - 1],
	       TURNS);
	printf("; of processor time %.0f %% (%.0f..%.0f)\n", processor[TURNS / 2], processor[0],
	       processor[TURNS - 1]);
	rtcReleaseScene(r.scene);
	rtcReleaseDevice(device);
	free(r.rays);
}

static int measure(const struct scene *scene)
{
	const struct surfel_bake_params params = SURFEL_BAKE_PARAMS;
	struct gr_diag diag = { 0 };
	struct surfel_set *set;
	int result = bake_then(&set, scene, NULL, &params, &diag, race, NULL);

	gr_diag_log(&diag);
	gr_diag_finish(&diag);
	if (result != GR_OK)
		return result;
	printf("%zu triangles: %zu surfels of %s m, %zu probes: %.1f s on %d threads (links %.1f s), %.1f MB\n",
	       scene->index_count / 3, set->count, gr_plain((double)set->spacing_m, 3).text, set->probes.count,
	       set->seconds, set->threads, set->ray_seconds, (double)surfel_set_bytes(set) * 1e-6);
	surfel_set_destroy(&set);
	return GR_OK;
}

static int measure_model(const char *path)
{
	const struct import_options options = { .scale = 1, .emission_scale = 1 };
	struct gr_diag diag = { 0 };
	struct scene *scene;
	int result = import_model(path, &options, &scene, &diag);

	gr_diag_log(&diag);
	gr_diag_finish(&diag);
	if (result == GR_OK)
		result = measure(scene);
	scene_destroy(&scene);
	return result;
}

static int measure_atrium(size_t triangles)
{
	struct scene *scene = atrium_build(triangles);
	int result = measure(scene);

	room_free(&scene);
	return result;
}

int main(int argc, char **argv)
{
	int result = GR_OK;

	if (argc == 4 && strcmp(argv[1], "--write") == 0) {
		struct scene *scene = atrium_build(strtoul(argv[2], NULL, 10));

		result = atrium_write(scene, argv[3]);
		if (result != GR_OK)
			fprintf(stderr, "%s: %s\n", argv[3], strerror(errno));
		room_free(&scene);
		return result == GR_OK ? GR_EXIT_OK : GR_EXIT_RUNTIME;
	}
	if (argc < 2) {
		fprintf(stderr, "usage: bench-bake TRIANGLES|MODEL...  or  bench-bake --write TRIANGLES FILE.glb\n");
		return GR_EXIT_CONFIG;
	}
	for (int i = 1; i < argc && result == GR_OK; i++) {
		char *end;
		size_t triangles = strtoul(argv[i], &end, 10);

		result = *end == 0 && triangles > 0 ? measure_atrium(triangles) : measure_model(argv[i]);
	}
	if (result != GR_OK)
		fprintf(stderr, "bench-bake: %s\n", gr_result_name(result));
	return result == GR_OK ? GR_EXIT_OK : GR_EXIT_RUNTIME;
}
