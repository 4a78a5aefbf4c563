/*
 * How long work (baking, waiting for another process that bakes) tells whoever
 * asked for it that it goes on, and asks whether it shall.
 */
#ifndef GROTTO_RENDERER_ALIVE_H
#define GROTTO_RENDERER_ALIVE_H

#include <stdbool.h>

struct alive {
	/* Called by the thread that works, a few times a second; false ends the work. NULL: nobody asks. */
	bool (*go_on)(void *ctx);
	void *ctx;
};

static inline bool alive_go_on(struct alive alive)
{
	return !alive.go_on || alive.go_on(alive.ctx);
}

#endif
