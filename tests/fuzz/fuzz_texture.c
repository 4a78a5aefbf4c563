/* PNG and JPEG textures from outside. */
#include "renderer/scene/import.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gr_diag diag = { 0 };
	struct scene_image image = { 0 };

	texture_decode(data, size, "fuzz", &image, &diag, "fuzz");
	free(image.rgba);
	gr_diag_finish(&diag);
	return 0;
}
