/*
 * What the lattice's GL tests share: a context, reflective shadow maps filled
 * from traced points, a frame.
 */
#ifndef GROTTO_TOOLS_BENCH_LPV_BENCH_H
#define GROTTO_TOOLS_BENCH_LPV_BENCH_H

#include "renderer/gi/gi.h"
#include "tools/bench/truth.h"

/* Uploads one layer into an existing set of textures; version grows. */
void bench_maps_init(struct rsm_set *set, int pixels, int layers);
void bench_maps_fill(struct rsm_set *set, int layer, const struct truth_texel *texels, float factor);
void bench_maps_finish(struct rsm_set *set);
/* A scene file with only what the lattice needs. */
void bench_file(struct scene_file *file, int lattice, int steps);
void bench_frame(struct render_frame *frame, const struct scene_file *file);

/* The spotlight of the Cornell-like room. */
struct truth_spot bench_spot(void);

/* gi_irradiance of the method at the samples, by a compute shader; 3 floats each. */
struct bench_probe;
int bench_probe_create(struct bench_probe **out, const struct gi_method *method);
void bench_probe_run(struct bench_probe *probe, const struct gi_method *method,
		     const struct truth_sample *samples, size_t count, float *found);
void bench_probe_destroy(struct bench_probe **probe);

#endif
