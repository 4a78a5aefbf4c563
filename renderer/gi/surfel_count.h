/*
 * How many surfels a spacing gives a scene: they are placed, and nothing is
 * linked. What a plan is made with before anything is baked.
 *
 * Equal for any number of threads, and on every machine as far as surfel_bake is.
 * Thread safety: one thread calls; the work runs on others.
 */
#ifndef GROTTO_RENDERER_GI_SURFEL_COUNT_H
#define GROTTO_RENDERER_GI_SURFEL_COUNT_H

#include "renderer/scene/scene.h"

#include <stddef.h>

/*
 * spacing_m: above 0. threads 0: all cores. GR_OK; GR_ERR_RANGE: more than a set
 * may have (surfel_bake.h); GR_ERR_NOMEM.
 */
int surfel_count(const struct scene *scene, float spacing_m, int threads, size_t *out);

#endif
