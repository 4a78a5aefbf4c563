#include "renderer/image/image.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

int image_create(struct image *out, int width, int height, int channels)
{
	memset(out, 0, sizeof *out);
	if (width < 1 || height < 1 || channels < 1 || channels > 4 || width > IMAGE_MAX_SIDE ||
	    height > IMAGE_MAX_SIDE ||
	    (size_t)width * (size_t)height * (size_t)channels > IMAGE_MAX_SAMPLES)
		return GR_ERR_RANGE;
	out->data = calloc((size_t)width * (size_t)height * (size_t)channels, sizeof out->data[0]);
	if (!out->data)
		return GR_ERR_NOMEM;
	out->width = width;
	out->height = height;
	out->channels = channels;
	return GR_OK;
}

void image_finish(struct image *image)
{
	free(image->data);
	memset(image, 0, sizeof *image);
}
