/*
 * Saves what a node drew, for `grotto demo` and for people who want to see:
 * NODE-FRAME.png (encoded as shown), and with exr NODE-FRAME.exr, for a second
 * eye NODE-FRAME-right.exr (scene-linear radiance). Reading back happens on
 * the GL thread; packing and writing on a thread of its own, so that the next
 * frame need not wait for it, unless the pictures come faster than they can
 * be written.
 *
 * Thread: all functions on the GL thread.
 */
#ifndef GROTTO_DAEMON_PICTURES_H
#define GROTTO_DAEMON_PICTURES_H

#include "renderer/renderer.h"

#include <stdbool.h>
#include <stdint.h>

#define PICTURES_EYES 2

struct pictures_params {
	const char *dir;  /* made when it is missing (not its parents) */
	const char *name; /* the node's */
	int width, height; /* of the target, pixels */
	int radiance_eyes; /* EXR files a frame: 0, 1 or 2 */
};

struct pictures;
int pictures_create(struct pictures **out, const struct pictures_params *params);
/* Reads back the picture that was drawn last and hands it over as that of `frame`. */
int pictures_save(struct pictures *pictures, struct renderer *renderer, uint64_t frame);
/* Waits until all is written. Returns GR_OK, or the first failure of any picture. */
int pictures_finish(struct pictures *pictures, uint64_t *out_saved);
void pictures_destroy(struct pictures **pictures);

#endif
