/* What reading and writing EXR share. */
#ifndef GROTTO_RENDERER_IMAGE_EXR_PRIVATE_H
#define GROTTO_RENDERER_IMAGE_EXR_PRIVATE_H

#include "base/diag.h"
#include "renderer/image/image.h"

#include <openexr.h>

/* Where OpenEXRCore's messages go (its user_data). */
struct exr_bytes {
	const uint8_t *bytes;
	size_t len;
	char message[256]; /* the first that came */
};

void exr_keep_message(exr_const_context_t context, exr_result_t code, const char *message);

#endif
