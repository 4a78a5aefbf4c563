/* Pictures that need no scene: for a wall whose node has no master. */
#ifndef GROTTO_RENDERER_GL_PATTERN_H
#define GROTTO_RENDERER_GL_PATTERN_H

#include "renderer/gl/target.h"

enum pattern {
	PATTERN_BLACK,
	/*
	 * A white frame on the outermost pixels, a grid of eighths, colour bars in
	 * the middle, and a square at the lower left: red for the left eye or the
	 * only one, cyan for the right. Shows which wall it is not, that the
	 * projector works, and whether all of the picture is on the screen.
	 */
	PATTERN_TEST,
};

/* Into all eyes of the target, which is not swapped. On the thread of the context. */
void pattern_draw(const struct target *target, enum pattern pattern);

#endif
