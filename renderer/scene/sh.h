/*
 * Light from all around in real spherical harmonics: the basis of physics
 * without the sign of Condon and Shortley, its axis +Z (Y 1,-1 along +Y, Y 1,0
 * along +Z, Y 1,1 along +X), coefficient (l, m) at l^2 + l + m. Of order n there
 * are the bands 0 to n - 1, n^2 coefficients.
 *
 * Sums in double; the GPU's side is renderer/view/env_sh.h. Pure; any thread.
 */
#ifndef GROTTO_RENDERER_SCENE_SH_H
#define GROTTO_RENDERER_SCENE_SH_H

#include "renderer/scene/environment.h"

#define SH_ORDER_MAX 8
#define SH_COUNT_MAX (SH_ORDER_MAX * SH_ORDER_MAX)

/* All n^2 functions in a unit direction. order 1..SH_ORDER_MAX, here and below. */
void sh_basis(int order, const double direction[3], double *out);
/*
 * Coefficients of radiance, W/(m^2 sr) per band. Of a picture the sum over its
 * pixels, each its value in its middle's direction times its exact solid angle;
 * heading and upper_only as the environment has them.
 */
void sh_project(const struct environment_pixels *environment, int order, double (*out)[3]);
/*
 * Of the light turned by a rotation (row major, what came from d comes from R d),
 * exactly; in and out may be the same.
 */
void sh_rotate(int order, const double rotation[9], const double (*in)[3], double (*out)[3]);
/*
 * The same as a matrix: the bands one after another, each (2l + 1)^2 row major, so that
 * out = matrix x in; SH_ROTATION_MAX values at most.
 */
#define SH_ROTATION_MAX 680
void sh_rotation(int order, const double rotation[9], double *matrix);
/* Radiance from there as the coefficients have it: may be below 0, where the light changes fast. */
void sh_radiance(int order, const double (*in)[3], const double direction[3], double out[3]);
/*
 * Irradiance of a surface with that normal that nothing shades, W/m^2 (Ramamoorthi and
 * Hanrahan 2001, "An Efficient Representation for Irradiance Environment Maps",
 * equations 7 to 9).
 */
void sh_irradiance(int order, const double (*in)[3], const double normal[3], double out[3]);

#endif
