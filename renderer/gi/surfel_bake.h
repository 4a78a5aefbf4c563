/*
 * Computes a surfel set from a scene, once, on the CPU (Embree, all cores).
 *
 * 1. points: spread evenly by area over every side that can be seen: the
 *    fronts, and the backs of what is two-sided. Every connected piece of the
 *    model has some.
 * 2. surfels: a Poisson-disc subset of the points, in random order; a point is
 *    left out when a surfel stands within the spacing on the same side of the
 *    same surface, with no wall in between. So each point has a surfel near it,
 *    the nearest of which it belongs to: its patch.
 * 3. reach: how far one sees along the surface from each surfel; points that no
 *    surfel would be heard at become surfels, too.
 * 4. links, fixed light, probes.
 *
 * The result depends on scene, params' numbers and the baker's version alone:
 * bit-equal for any number of threads.
 *
 * Thread safety: one thread calls; the work runs on others.
 */
#ifndef GROTTO_RENDERER_GI_SURFEL_BAKE_H
#define GROTTO_RENDERER_GI_SURFEL_BAKE_H

#include "base/diag.h"
#include "config/scene_file.h"
#include "renderer/gi/surfel_set.h"
#include "renderer/scene/scene.h"

#include <stdbool.h>

/* Grows when equal input no longer gives equal sets. */
#define SURFEL_BAKE_VERSION 5

#define SURFEL_MOST ((size_t)1 << 17)       /* surfels of a set */
#define SURFEL_LINKS_MOST ((size_t)1 << 28) /* links of all surfels, or of all probes */
/* Spacing 0: such that the scene's sides would hold about this many (surfel_bake.c). */
#define SURFEL_USUAL 6000

struct surfel_bake_params {
	float spacing_m; /* least distance between surfels; 0: from the scene's area */
	int links;       /* a surfel: 16..4096 */
	int taps;        /* a surfel: 1..64 */
	int probes;      /* cells along the longest side of the scene, 1..64; 0: none */
	float absorption_per_m, scattering_per_m; /* of the air that fixed light goes through */
	int threads;     /* 0: all cores */
	uint64_t seed;
	/*
	 * Called about four times a second from the calling thread; NULL: not. What
	 * is done now, 0..1 of all, seconds left as far as known (negative: not).
	 * false stops.
	 */
	bool (*progress)(void *ctx, const char *stage, double done, double seconds_left);
	void *ctx;
};
#define SURFEL_BAKE_PARAMS \
	{ .links = 256, .taps = 64, .probes = 8, .seed = 1 }
/* From a scene file's settings. */
void surfel_bake_params_of(const struct scene_file *file, struct surfel_bake_params *out);

/*
 * file may be NULL; of it, what lights the scene from outside counts. A scene
 * without any surface gives an empty set. What cannot be is said in diag:
 * GR_ERR_RANGE. GR_NOTHING when progress has stopped it; GR_ERR_NOMEM.
 */
int surfel_bake(struct surfel_set **out, const struct scene *scene, const struct scene_file *file,
		const struct surfel_bake_params *params, struct gr_diag *diag);

#endif
