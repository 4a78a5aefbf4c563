/* PNG and JPEG to 8 bit RGBA. Sizes are known before a byte is allocated. */
#include "renderer/scene/import.h"

#include "base/result.h"

#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h> /* wants stdio.h before it */

static int check_size(size_t width, size_t height, const char *what, struct gr_diag *diag,
		      const char *path)
{
	if (width >= 1 && height >= 1 && width <= IMPORT_MAX_IMAGE_SIDE &&
	    height <= IMPORT_MAX_IMAGE_SIDE)
		return GR_OK;
	gr_diag_add(diag, GR_DIAG_ERROR, path, 0, what, "%zu x %zu pixels; 1 to %d a side are accepted",
		    width, height, IMPORT_MAX_IMAGE_SIDE);
	return GR_ERR_CONFIG;
}

static int decode_png(const uint8_t *bytes, size_t len, const char *what, struct scene_image *out,
		      struct gr_diag *diag, const char *path)
{
	png_image image;
	int result;

	memset(&image, 0, sizeof image);
	image.version = PNG_IMAGE_VERSION;
	if (!png_image_begin_read_from_memory(&image, bytes, len)) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, what, "not a readable PNG: %s", image.message);
		return GR_ERR_CONFIG;
	}
	result = check_size(image.width, image.height, what, diag, path);
	if (result != GR_OK) {
		png_image_free(&image);
		return result;
	}
	image.format = PNG_FORMAT_RGBA;
	out->width = (int)image.width;
	out->height = (int)image.height;
	out->rgba = malloc(PNG_IMAGE_SIZE(image));
	if (!out->rgba) {
		png_image_free(&image);
		return GR_ERR_NOMEM;
	}
	if (!png_image_finish_read(&image, NULL, out->rgba, 0, NULL)) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, what, "PNG is damaged or cut off: %s",
			    image.message);
		free(out->rgba);
		out->rgba = NULL;
		return GR_ERR_CONFIG;
	}
	return GR_OK;
}

struct jpeg_faults {
	struct jpeg_error_mgr base; /* first: libjpeg knows only this */
	jmp_buf leave;
	char text[JMSG_LENGTH_MAX];
};

static void jpeg_leave(j_common_ptr info)
{
	struct jpeg_faults *faults = (struct jpeg_faults *)info->err;

	faults->base.format_message(info, faults->text);
	longjmp(faults->leave, 1);
}

/* A cut-off JPEG is only a warning to libjpeg, which would paint the rest grey. */
static void jpeg_message(j_common_ptr info, int level)
{
	if (level < 0)
		jpeg_leave(info);
}

static void jpeg_rows(struct jpeg_decompress_struct *info, struct scene_image *out, uint8_t *row)
{
	while (info->output_scanline < info->output_height) {
		uint8_t *to = out->rgba + (size_t)info->output_scanline * (size_t)out->width * 4;
		JSAMPROW rows[1] = { row };

		jpeg_read_scanlines(info, rows, 1);
		for (size_t x = 0; x < (size_t)out->width; x++) {
			memcpy(to + 4 * x, row + 3 * x, 3);
			to[4 * x + 3] = 255;
		}
	}
}

static int decode_jpeg(const uint8_t *bytes, size_t len, const char *what, struct scene_image *out,
		       struct gr_diag *diag, const char *path)
{
	struct jpeg_decompress_struct info;
	struct jpeg_faults faults;
	uint8_t *volatile row = NULL;
	volatile int result = GR_OK;

	memset(&info, 0, sizeof info);
	info.err = jpeg_std_error(&faults.base);
	faults.base.error_exit = jpeg_leave;
	faults.base.emit_message = jpeg_message;
	if (setjmp(faults.leave)) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, what, "JPEG is damaged or cut off: %s",
			    faults.text);
		result = GR_ERR_CONFIG;
		goto out;
	}
	jpeg_create_decompress(&info);
	jpeg_mem_src(&info, bytes, (unsigned long)len);
	jpeg_read_header(&info, TRUE);
	result = check_size(info.image_width, info.image_height, what, diag, path);
	if (result != GR_OK)
		goto out;
	info.out_color_space = JCS_RGB;
	/* The slow integer method gives the same bytes on every machine. */
	info.dct_method = JDCT_ISLOW;
	jpeg_start_decompress(&info);
	out->width = (int)info.output_width;
	out->height = (int)info.output_height;
	out->rgba = malloc((size_t)out->width * (size_t)out->height * 4);
	row = malloc((size_t)out->width * 3);
	if (!out->rgba || !row) {
		result = GR_ERR_NOMEM;
		goto out;
	}
	jpeg_rows(&info, out, row);
	jpeg_finish_decompress(&info);
out:
	jpeg_destroy_decompress(&info);
	free(row);
	if (result != GR_OK) {
		free(out->rgba);
		out->rgba = NULL;
	}
	return result;
}

int texture_decode(const uint8_t *bytes, size_t len, const char *what, struct scene_image *out,
		   struct gr_diag *diag, const char *path)
{
	static const uint8_t png[] = { 0x89, 'P', 'N', 'G' };
	static const uint8_t jpeg[] = { 0xff, 0xd8, 0xff };

	out->rgba = NULL;
	if (len >= sizeof png && memcmp(bytes, png, sizeof png) == 0)
		return decode_png(bytes, len, what, out, diag, path);
	if (len >= sizeof jpeg && memcmp(bytes, jpeg, sizeof jpeg) == 0)
		return decode_jpeg(bytes, len, what, out, diag, path);
	gr_diag_add(diag, GR_DIAG_ERROR, path, 0, what,
		    "neither PNG nor JPEG (%zu bytes); textures are read in these two forms", len);
	return GR_ERR_CONFIG;
}
