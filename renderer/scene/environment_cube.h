/*
 * Cube maps to the latitude-longitude pictures of environment.h.
 *
 * Six squares as they are seen from the middle, looking along -Z with +X to the
 * right: the one ahead is -Z, left -X, right +X, above +Y (its lower edge is the
 * one ahead's upper), below -Y (its upper edge the one ahead's lower), behind +Z.
 * In one picture they are a cross around the one ahead, which has the left one,
 * the right one, the upper and the lower at its sides; the one behind is right of
 * the right one (4 x 3 squares), or below the lower one and upside down (3 x 4).
 *
 * Pure; any thread.
 */
#ifndef GROTTO_RENDERER_SCENE_ENVIRONMENT_CUBE_H
#define GROTTO_RENDERER_SCENE_ENVIRONMENT_CUBE_H

#include "base/diag.h"
#include "renderer/image/image.h"

enum cube_face { CUBE_PX, CUBE_NX, CUBE_PY, CUBE_NY, CUBE_PZ, CUBE_NZ };

/*
 * Linear between the squares' pixels, over their edges, too. The picture is four
 * squares wide and two high, at most ENVIRONMENT_MAX_SIDE; where it is smaller
 * than that the mean is taken. GR_ERR_CONFIG, said in diag: not six squares of one
 * size and 1 or 3 channels.
 */
int cube_unfold(const struct image faces[6], const char *name, struct image *out,
		struct gr_diag *diag);
/* The same from a cross. */
int cube_unfold_cross(const struct image *cross, const char *name, struct image *out,
		      struct gr_diag *diag);

#endif
