#include "tests/accuracy/surfels_gl.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/surfel_bake.h"
#include "renderer/gl/target.h"
#include "tests/unit/unit.h"
#include "tools/bench/lpv_bench.h"
#include "tools/bench/room.h"

#include <epoxy/gl.h>
#include <math.h>
#include <pthread.h>
#include <time.h>

#define SHADOW_PIXELS 512

struct lit_room lit_room;

struct surfel_set *lit_bake(const struct scene *of, float spacing, int links, int taps, int probes)
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

struct gi_method *lit_method(const struct surfel_set *set, int gathers, bool probes)
{
	const struct surfels_params params = { .gathers = gathers, .probes = probes, .lamps = true };
	struct gi_method *method;

	assert_int_equal(gi_surfels_create(&method, set, &params), GR_OK);
	return method;
}

void lit_begin_with(struct lit *s, const struct scene *of, const struct surfel_set *set,
		       const struct truth_spot *spot, int lamps, bool probes)
{
	assert_int_equal(surfel_rig_init(&s->rig, of, spot, lamps, SHADOW_PIXELS), GR_OK);
	s->method = lit_method(set, 2, probes);
}

void lit_end(struct lit *s)
{
	s->method->ops->destroy(s->method);
	surfel_rig_finish(&s->rig);
	assert_int_equal(glGetError(), GL_NO_ERROR);
}

void lit_frame(struct lit *s)
{
	assert_true(surfel_rig_frame(&s->rig, s->method) >= GR_OK);
}

struct gi_stats lit_stats(struct lit *s)
{
	struct gi_stats stats;

	glFinish();
	surfels_check_collect((struct surfels *)s->method);
	s->method->ops->stats(s->method, &stats);
	return stats;
}

void lit_intensity(struct lit *s, int lamp, float red, float green, float blue)
{
	const float c[3] = { red, green, blue };

	memcpy(s->rig.frame.lamps[lamp].intensity, c, sizeof c);
}


/* A look-up's shader takes long to compile: it is kept for all methods of the same name. */
static struct looker {
	const char *name;
	struct bench_probe *probe;
} lookers[3];

void lit_look(const struct gi_method *method, const struct truth_sample *at, size_t count, float *found)
{
	struct looker *l = lookers;

	while (l->name && strcmp(l->name, method->ops->shader_name) != 0)
		l++;
	if (!l->name)
		assert_int_equal(bench_probe_create(&l->probe, method), GR_OK);
	l->name = method->ops->shader_name;
	bench_probe_run(l->probe, method, at, count, found);
}

double lit_mean_at(const struct gi_method *method, const struct truth_sample *at, size_t count, float *found)
{
	double sum = 0;

	lit_look(method, at, count, found);
	for (size_t k = 0; k < 3 * count; k++) {
		assert_true(isfinite(found[k]));
		sum += (double)found[k];
	}
	return sum / (3 * (double)count);
}

double lit_mean(struct lit *s, float *found)
{
	return lit_mean_at(s->method, lit_room.samples, lit_room.count, found);
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
void lit_trace(const struct truth *of, int paths, struct truth_sample *at, size_t count)
{
	struct tracing halves[2] = { { of, at, count / 2, paths },
				     { of, at + count / 2, count - count / 2, paths } };
	pthread_t other;

	assert_int_equal(pthread_create(&other, NULL, trace_some, &halves[0]), 0);
	trace_some(&halves[1]);
	pthread_join(other, NULL);
}

double lit_cpu_milliseconds(void)
{
	struct timespec now;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

int lit_open(const char *name)
{
	const struct target_params params = { .kind = TARGET_HEADLESS, .width = 16, .height = 16, .gpu = -1 };
	const struct truth_spot spot = bench_spot();

	gr_log_init(name, GR_LOG_WARNING);
	if (target_create(&lit_room.target, &params) != GR_OK) {
		printf("# no OpenGL 4.5 here: skipped\n");
		return 77;
	}
	printf("# %s\n", target_renderer_name(lit_room.target));
	lit_room.scene = room_cornell();
	if (truth_init(&lit_room.truth, lit_room.scene, &spot) != GR_OK)
		return 1;
	lit_room.count = truth_points(&lit_room.truth, 1, 0.02f, lit_room.samples, LIT_POINTS);
	return 0;
}

void lit_close(void)
{
	for (int i = 0; i < 3; i++)
		bench_probe_destroy(&lookers[i].probe);
	truth_finish(&lit_room.truth);
	room_free(&lit_room.scene);
	target_destroy(&lit_room.target);
}
