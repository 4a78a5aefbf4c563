/* The room that hard cases are made of: 4 x 3 x 4 m, a block in it, lamps below the ceiling. */
#ifndef GROTTO_TESTS_HARD_ROOM_H
#define GROTTO_TESTS_HARD_ROOM_H

#include "renderer/image/image.h"
#include "renderer/renderer.h"
#include "tests/accuracy/hard/model.h"

#define HARD_PIXELS 32 /* a side of the camera's picture */
#define HARD_WALLS 6
#define HARD_POINTS (9 * HARD_WALLS)
#define HARD_LAMPS 2

extern const float hard_room[3]; /* its far corner; the other is the origin */

void hard_walls(struct model *model, int material);
void hard_block(struct model *model, int material, bool inside_out);
/* Walls of material 0, the block of 1. */
void hard_plain(struct model *model);

struct hard_scene {
	float scale;                 /* metres for a metre of the room */
	float intensity[HARD_LAMPS]; /* W/sr, for a room of 4 m; 0: no such lamp */
	int gathers, steps;          /* a frame */
	const char *more;            /* lines of the scene file */
};
/* With one camera, "in". gi.method is surfels. */
void hard_write_scene(const struct hard_scene *scene, const char *path, const char *model);

/* Nine a wall, none of them under the block. */
void hard_points(float scale, struct renderer_point points[HARD_POINTS]);
/* Mean of all values, every one of which must be finite and not negative. */
double hard_mean(const struct image *image);

#endif
