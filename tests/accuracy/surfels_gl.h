/*
 * What the GL tests of the relit surfels share: a Cornell-like room of 4 m with
 * points to look at, and methods under lamps with their shadow maps, without a
 * picture. Every program opens it once.
 */
#ifndef GROTTO_TESTS_SURFELS_GL_H
#define GROTTO_TESTS_SURFELS_GL_H

#include "renderer/gi/surfels_private.h"
#include "tools/bench/surfel_rig.h"
#include "tools/bench/truth.h"

#define LIT_POINTS 240

/* The room of most tests; its truth is not traced until lit_trace. */
extern struct lit_room {
	struct target *target;
	struct scene *scene;
	struct truth truth;
	struct truth_sample samples[LIT_POINTS];
	size_t count;
} lit_room;

/* A method under lamps. */
struct lit {
	struct surfel_rig rig;
	struct gi_method *method;
};

/* 0; 77: there is no OpenGL here, and it was said. */
int lit_open(const char *name);
void lit_close(void);

struct surfel_set *lit_bake(const struct scene *of, float spacing, int links, int taps, int probes);
struct gi_method *lit_method(const struct surfel_set *set, int gathers, bool probes);

/* Two gathers a frame; `lamps` spots alike. */
void lit_begin_with(struct lit *s, const struct scene *of, const struct surfel_set *set,
		    const struct truth_spot *spot, int lamps, bool probes);
void lit_end(struct lit *s);
void lit_frame(struct lit *s);
/* Waits for the GPU. */
struct gi_stats lit_stats(struct lit *s);
void lit_intensity(struct lit *s, int lamp, float red, float green, float blue);

/* Indirect irradiance at points, three values each; the second asserts that it is finite and gives the mean. */
void lit_look(const struct gi_method *method, const struct truth_sample *at, size_t count, float *found);
double lit_mean_at(const struct gi_method *method, const struct truth_sample *at, size_t count, float *found);
/* At the room's points. */
double lit_mean(struct lit *s, float *found);

/* Path tracing on two threads. */
void lit_trace(const struct truth *of, int paths, struct truth_sample *at, size_t count);

/* Of processors, all threads of this process: other work on the machine weighs little on it. */
double lit_cpu_milliseconds(void);

#endif
