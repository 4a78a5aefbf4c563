/* EXR files from outside. */
#include "renderer/image/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gr_diag diag = { 0 };
	struct image image;

	image_decode_exr(data, size, "fuzz.exr", &image, &diag);
	image_finish(&image);
	gr_diag_finish(&diag);
	return 0;
}
