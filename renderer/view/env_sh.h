/*
 * The light from all around in spherical harmonics (renderer/scene/sh.h) by the
 * GPU, for pictures and turns that change with every frame: three small compute
 * passes over a latitude-longitude texture, whose rows go through a Fourier series
 * of 2 n - 1 terms, so that a pixel costs as many, not n^2.
 *
 * GL thread only. Nothing is allocated after create.
 */
#ifndef GROTTO_RENDERER_VIEW_ENV_SH_H
#define GROTTO_RENDERER_VIEW_ENV_SH_H

#include "renderer/scene/sh.h"

struct env_sh;
/*
 * For pictures of that width and height, and that heading and upper_only; order
 * 2..SH_ORDER_MAX. GR_ERR_RANGE: no picture, or another order.
 */
int env_sh_create(struct env_sh **out, const struct environment_pixels *pixels, int order);
void env_sh_destroy(struct env_sh **env_sh);
/*
 * How the world stands from now on: what came from d comes from R d (row major, a
 * rotation), of a picture that was projected as well, which is not looked at again. The
 * same as before costs nothing. Enqueued, with a barrier for shaders.
 */
void env_sh_turn(struct env_sh *env_sh, const double rotation[9]);
/*
 * Of a texture of that size, RGB radiance, row 0 the top. Enqueued likewise. It costs by the
 * pixel; light without edges needs few: a sky of 128 x 64 is within 0.06 % at order 5.
 */
void env_sh_project(struct env_sh *env_sh, unsigned texture);
/* n^2 vec4 for shaders (std430): rgb as sh_project has them. */
unsigned env_sh_buffer(const struct env_sh *env_sh);
/* For tests: waits. */
void env_sh_read(const struct env_sh *env_sh, double (*out)[3]);

#endif
