/*
 * Puts the pictures that the nodes drew together: parts to walls, walls to
 * the unfolded room. Works on encoded 8 bit RGB as it is (a picture to look
 * at, not to measure in); row 0 is the top.
 *
 * Pure functions on the caller's memory.
 */
#ifndef GROTTO_TOOLS_ROOM_H
#define GROTTO_TOOLS_ROOM_H

#include "tools/unfold.h"

#include <stdint.h>

struct room_picture {
	int width, height;
	uint8_t *rgb; /* 3 bytes a pixel, owned; NULL: nothing was drawn */
};

int room_picture_create(struct room_picture *out, int width, int height);
void room_picture_finish(struct room_picture *picture);

/* Where in a node's target the left (or only) eye is. */
enum room_eye { ROOM_WHOLE, ROOM_LEFT_HALF, ROOM_TOP_HALF };

/*
 * Scales the eye's part of `source` into `part` (x0 y0 x1 y1, 0..1 from the
 * lower left) of the wall's picture.
 */
void room_add_part(struct room_picture *wall, const float part[4],
		   const struct room_picture *source, enum room_eye eye);

/*
 * The unfolded room at the pixel density of its densest wall, but no side
 * longer than max_side. walls[i] belongs to places[i]; one without a picture
 * is left in the background's grey. GR_OK, GR_ERR_RANGE, GR_ERR_NOMEM.
 */
int room_compose(const struct unfold_place *places, const double size[2],
		 const struct room_picture *walls, size_t count, int max_side,
		 struct room_picture *out);

#endif
