/*
 * Pictures in files. EXR through OpenEXRCore (scan lines, 32 bit float or
 * half, ZIP), Radiance pictures, PNG through libpng. Row 0 is the top everywhere.
 */
#ifndef GROTTO_RENDERER_IMAGE_IMAGE_H
#define GROTTO_RENDERER_IMAGE_IMAGE_H

#include "base/diag.h"

#include <stddef.h>
#include <stdint.h>

/* width * height * channels floats, interleaved. */
struct image {
	int width, height, channels; /* channels 1, 3 or 4; any number to be written with names */
	float *data;
};

/* Sides of at most this, and IMAGE_MAX_SAMPLES values in all: larger files are refused. */
#define IMAGE_MAX_SIDE 32768
#define IMAGE_MAX_SAMPLES ((size_t)1 << 28)

/* Zeroes. GR_ERR_RANGE or GR_ERR_NOMEM. */
int image_create(struct image *out, int width, int height, int channels);
void image_finish(struct image *image);

/*
 * Scene-linear, 32 bit float, ZIP. `channel_names`: one per channel, NULL for
 * R G B (A) or Y. Writers return GR_ERR_IO with the reason in the log; a file
 * that could not be finished is removed.
 */
int image_write_exr(const char *path, const struct image *image, const char *const *channel_names);
/*
 * Reads channels R G B (or Y, or the single channel there is) as float. A
 * missing, truncated or unsupported file is named in diag: GR_ERR_CONFIG.
 */
int image_read_exr(const char *path, struct image *out, struct gr_diag *diag);
/* The same from bytes; name is for diag. */
int image_decode_exr(const uint8_t *bytes, size_t len, const char *name, struct image *out,
		     struct gr_diag *diag);
/*
 * Radiance's RGBE (.hdr), any of its codings, the top row first; divided by the
 * EXPOSUREs of its header. 3 channels. GR_ERR_CONFIG as above.
 */
int image_decode_hdr(const uint8_t *bytes, size_t len, const char *name, struct image *out,
		     struct gr_diag *diag);
/* OpenEXR or Radiance, by the first bytes. */
int image_decode_light(const uint8_t *bytes, size_t len, const char *name, struct image *out,
		       struct gr_diag *diag);
int image_read_light(const char *path, struct image *out, struct gr_diag *diag);
/* rgb: 3 bytes a pixel, already encoded. */
int image_write_png(const char *path, int width, int height, const uint8_t *rgb);
/* *rgb is the caller's to free. */
int image_read_png(const char *path, int *width, int *height, uint8_t **rgb, struct gr_diag *diag);

#endif
