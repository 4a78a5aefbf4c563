/*
 * Which eyes a wall shows, where they are in the head and in the target.
 * Pure, any thread.
 */
#ifndef GROTTO_RENDERER_VIEW_EYES_H
#define GROTTO_RENDERER_VIEW_EYES_H

#include "renderer/frame.h"
#include "renderer/renderer.h"

#define EYES_MAX 2

/* Pictures that are drawn: 2 for the stereo kinds, else 1. */
int eyes_count(enum renderer_eyes eyes);
/* Position of picture `index` in the room: the head's pose times (-+ separation / 2, 0, 0). */
void eyes_position(enum renderer_eyes eyes, int index, const struct render_frame *frame,
		   vec3 out_room);

struct eyes_place {
	int buffer;     /* which framebuffer of the target: 1 only for the right eye of quad-buffer */
	int x, y;       /* lower left corner, pixels */
};
/* Left eye on the left of side-by-side and on top of top-bottom. */
struct eyes_place eyes_place(const struct renderer_params *params, int index);

#endif
