/* A headless target for tests; without OpenGL 4.5 the program ends with 77. */
#ifndef GROTTO_TESTS_GL_H
#define GROTTO_TESTS_GL_H

#include "renderer/gl/target.h"

#include <stdio.h>
#include <stdlib.h>

static inline struct target *gl_target_or_skip(int width, int height)
{
	const struct target_params params = {
		.kind = TARGET_HEADLESS, .width = width, .height = height, .gpu = -1,
		.debug = true,
	};
	struct target *target;

	if (target_create(&target, &params) != 0) {
		printf("skipped: no OpenGL 4.5 core without a display here\n");
		exit(77);
	}
	return target;
}

#endif
