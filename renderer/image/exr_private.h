/* What reading and writing EXR share. */
#ifndef GROTTO_RENDERER_IMAGE_EXR_PRIVATE_H
#define GROTTO_RENDERER_IMAGE_EXR_PRIVATE_H

#include "base/diag.h"
#include "renderer/image/image.h"

#include <openexr.h>

/* What is read (OpenEXRCore's user_data), and what it said of it. */
struct exr_bytes {
	const uint8_t *bytes;
	size_t len;
	char message[256]; /* the first that came */
};

/*
 * Where this thread's messages go until it listens to another; NULL ends it.
 * OpenEXRCore calls the handler with the context's lock held, so the handler
 * must not ask the context for anything: it would wait for itself.
 */
void exr_listen(struct exr_bytes *bytes);
void exr_keep_message(exr_const_context_t context, exr_result_t code, const char *message);

#endif
