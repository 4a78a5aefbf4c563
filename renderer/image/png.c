#include "renderer/image/image.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/image/read_file.h"

#include <errno.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PNG_MAX_FILE ((size_t)1 << 30)

int image_write_png(const char *path, int width, int height, const uint8_t *rgb)
{
	png_image image;
	FILE *file;
	bool good;

	if (width < 1 || height < 1 || width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE)
		return GR_ERR_RANGE;
	file = fopen(path, "wb");
	if (!file) {
		gr_error("%s: cannot be written: %s", path, strerror(errno));
		return GR_ERR_IO;
	}
	memset(&image, 0, sizeof image);
	image.version = PNG_IMAGE_VERSION;
	image.width = (png_uint_32)width;
	image.height = (png_uint_32)height;
	image.format = PNG_FORMAT_RGB;
	good = png_image_write_to_stdio(&image, file, 0, rgb, 0, NULL);
	if (!good)
		gr_error("%s: cannot be written: %s", path, image.message);
	png_image_free(&image);
	if (fclose(file) != 0 && good) {
		gr_error("%s: cannot be written: %s", path, strerror(errno));
		good = false;
	}
	if (!good)
		remove(path);
	return good ? GR_OK : GR_ERR_IO;
}

static int decode(const uint8_t *bytes, size_t len, const char *path, png_image *image,
		  uint8_t **rgb, struct gr_diag *diag)
{
	if (!png_image_begin_read_from_memory(image, bytes, len)) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "not a readable PNG: %s",
			    image->message);
		return GR_ERR_CONFIG;
	}
	if (image->width > IMAGE_MAX_SIDE || image->height > IMAGE_MAX_SIDE ||
	    (size_t)image->width * image->height * 3 > IMAGE_MAX_SAMPLES) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "%u x %u pixels are too many",
			    image->width, image->height);
		return GR_ERR_CONFIG;
	}
	image->format = PNG_FORMAT_RGB;
	*rgb = malloc(PNG_IMAGE_SIZE(*image));
	if (!*rgb)
		return GR_ERR_NOMEM;
	/* Transparent pixels come over black. */
	if (png_image_finish_read(image, &(png_color){ 0, 0, 0 }, *rgb, 0, NULL))
		return GR_OK;
	gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "PNG is damaged or cut off: %s",
		    image->message);
	free(*rgb);
	*rgb = NULL;
	return GR_ERR_CONFIG;
}

int image_read_png(const char *path, int *width, int *height, uint8_t **rgb, struct gr_diag *diag)
{
	png_image image;
	uint8_t *bytes;
	size_t len;
	int result;

	*rgb = NULL;
	result = read_file(path, PNG_MAX_FILE, &bytes, &len, diag, "picture");
	if (result != GR_OK)
		return result;
	memset(&image, 0, sizeof image);
	image.version = PNG_IMAGE_VERSION;
	result = decode(bytes, len, path, &image, rgb, diag);
	*width = (int)image.width;
	*height = (int)image.height;
	png_image_free(&image);
	free(bytes);
	return result;
}
