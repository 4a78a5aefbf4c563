/* Pictures of light from outside: OpenEXR and Radiance, by their first bytes. */
#include "renderer/image/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gr_diag diag = { 0 };
	struct image image;

	image_decode_light(data, size, "fuzz.exr", &image, &diag);
	image_finish(&image);
	gr_diag_finish(&diag);
	return 0;
}
