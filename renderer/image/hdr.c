/*
 * Radiance pictures (.hdr, .pic): 32-bit RGBE, flat or run-length encoded in
 * either of the two ways; Ward, "Real Pixels", Graphics Gems II, 1991, and
 * Radiance's color.c.
 */
#include "renderer/image/image.h"

#include "base/result.h"
#include "renderer/image/read_file.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define HDR_MAX_FILE ((size_t)1 << 30)
#define LINE_MAX_BYTES 512
#define HEAD_MAX_LINES 1000

struct hdr {
	const uint8_t *at, *end;
	const char *name;
	struct gr_diag *diag;
	double exposure; /* what the pixels have been multiplied with */
};

static int refuse(const struct hdr *hdr, const char *text)
{
	gr_diag_add(hdr->diag, GR_DIAG_ERROR, hdr->name, 0, NULL, "%s", text);
	return GR_ERR_CONFIG;
}

/* The next line of the header without its end; false at the end of the file or of patience. */
static bool next_line(struct hdr *hdr, char line[LINE_MAX_BYTES])
{
	const size_t left = (size_t)(hdr->end - hdr->at);
	const uint8_t *end = left ? memchr(hdr->at, '\n', left < LINE_MAX_BYTES ? left : LINE_MAX_BYTES)
				  : NULL;
	size_t len;

	if (!end)
		return false;
	len = (size_t)(end - hdr->at);
	memcpy(line, hdr->at, len);
	line[len] = 0;
	hdr->at = end + 1;
	return true;
}

static int read_head(struct hdr *hdr)
{
	char line[LINE_MAX_BYTES];
	bool known = false;

	if (!next_line(hdr, line) || line[0] != '#' || line[1] != '?')
		return refuse(hdr, "not a Radiance picture: it does not begin with #?");
	hdr->exposure = 1;
	for (int i = 0; next_line(hdr, line); i++) {
		double exposure;

		if (!line[0]) {
			if (!known)
				return refuse(hdr, "its FORMAT is not 32-bit_rle_rgbe; of the others none is read");
			return GR_OK;
		}
		if (i == HEAD_MAX_LINES)
			break;
		if (!strncmp(line, "FORMAT=", 7))
			known = !strcmp(line + 7, "32-bit_rle_rgbe");
		if (strncmp(line, "EXPOSURE=", 9))
			continue;
		exposure = strtod(line + 9, NULL);
		hdr->exposure *= exposure;
		if (!(hdr->exposure > 0) || !isfinite(hdr->exposure))
			return refuse(hdr, "an EXPOSURE that is not above 0");
	}
	return refuse(hdr, "its header does not end");
}

/* "-Y height +X width": the top row first, from left to right. */
static int read_size(struct hdr *hdr, int *width, int *height)
{
	char line[LINE_MAX_BYTES], *at;
	long y, x;

	if (!next_line(hdr, line))
		return refuse(hdr, "it ends before its size");
	if (strncmp(line, "-Y ", 3))
		return refuse(hdr, "its size is not written as -Y height +X width; turned pictures are not read");
	y = strtol(line + 3, &at, 10);
	if (strncmp(at, " +X ", 4))
		return refuse(hdr, "its size is not written as -Y height +X width; turned pictures are not read");
	x = strtol(at + 4, &at, 10);
	if (*at || y < 1 || x < 1 || y > IMAGE_MAX_SIDE || x > IMAGE_MAX_SIDE)
		return refuse(hdr, "its size is no size of a picture");
	*width = (int)x;
	*height = (int)y;
	return GR_OK;
}

/* The newer code: each of the four bytes' planes by itself. */
static bool read_planes(struct hdr *hdr, uint8_t *row, int width)
{
	for (int plane = 0; plane < 4; plane++)
		for (int x = 0; x < width;) {
			int count;

			if (hdr->end - hdr->at < 2)
				return false;
			count = *hdr->at++;
			if (count > 128) {
				count -= 128;
				if (count > width - x)
					return false;
				for (int i = 0; i < count; i++)
					row[4 * (x + i) + plane] = *hdr->at;
				hdr->at++;
			} else {
				if (!count || count > width - x || count > hdr->end - hdr->at)
					return false;
				for (int i = 0; i < count; i++)
					row[4 * (x + i) + plane] = *hdr->at++;
			}
			x += count;
		}
	return true;
}

/* Pixels as they are, and the older code: 1 1 1 n repeats the last, more digits if it goes on. */
static bool read_pixels(struct hdr *hdr, uint8_t *row, int width)
{
	int shift = 0;

	for (int x = 0; x < width;) {
		const uint8_t *p = hdr->at;

		if (hdr->end - p < 4)
			return false;
		hdr->at += 4;
		if (p[0] != 1 || p[1] != 1 || p[2] != 1) {
			memcpy(row + 4 * x++, p, 4);
			shift = 0;
			continue;
		}
		if (!x || shift > 16 || (long)p[3] << shift > width - x)
			return false;
		for (int count = p[3] << shift; count > 0; count--, x++)
			memcpy(row + 4 * x, row + 4 * (x - 1), 4);
		shift += 8;
	}
	return true;
}

static bool read_row(struct hdr *hdr, uint8_t *row, int width)
{
	const uint8_t *p = hdr->at;
	const bool planes = width >= 8 && width < 32768 && hdr->end - p >= 4 && p[0] == 2 && p[1] == 2 &&
			    p[2] < 128 && (p[2] << 8 | p[3]) == width;

	if (!planes)
		return read_pixels(hdr, row, width);
	hdr->at += 4;
	return read_planes(hdr, row, width);
}

/* Each byte stands for what lies between it and the next, so for the middle. */
static void convert(const struct hdr *hdr, const uint8_t *row, int width, float *out)
{
	for (int x = 0; x < width; x++) {
		const uint8_t *p = row + 4 * x;
		const double scale = p[3] ? ldexp(1 / hdr->exposure, p[3] - 136) : 0;

		for (int c = 0; c < 3; c++)
			out[3 * x + c] = (float)((p[c] + 0.5) * scale);
	}
}

int image_decode_hdr(const uint8_t *bytes, size_t len, const char *name, struct image *out,
		     struct gr_diag *diag)
{
	struct hdr hdr = { .at = bytes, .end = bytes + len, .name = name, .diag = diag };
	int width, height, result;
	uint8_t *row;

	memset(out, 0, sizeof *out);
	result = read_head(&hdr);
	if (result == GR_OK)
		result = read_size(&hdr, &width, &height);
	if (result != GR_OK)
		return result;
	/* a row takes 4 bytes at least, so a short file gets no memory for a large picture */
	if ((hdr.end - hdr.at) / 4 < height)
		return refuse(&hdr, "it ends before its last row");
	result = image_create(out, width, height, 3);
	row = result == GR_OK ? malloc(4 * (size_t)width) : NULL;
	if (result == GR_OK && !row)
		result = GR_ERR_NOMEM;
	for (int y = 0; y < height && result == GR_OK; y++) {
		if (read_row(&hdr, row, width))
			convert(&hdr, row, width, out->data + 3 * (size_t)y * (size_t)width);
		else
			result = refuse(&hdr, "a row is damaged, or the file ends in it");
	}
	free(row);
	if (result != GR_OK)
		image_finish(out);
	return result;
}

int image_decode_light(const uint8_t *bytes, size_t len, const char *name, struct image *out,
		       struct gr_diag *diag)
{
	static const uint8_t exr[4] = { 0x76, 0x2f, 0x31, 0x01 };

	if (len >= 2 && bytes[0] == '#' && bytes[1] == '?')
		return image_decode_hdr(bytes, len, name, out, diag);
	if (len >= 4 && !memcmp(bytes, exr, 4))
		return image_decode_exr(bytes, len, name, out, diag);
	memset(out, 0, sizeof *out);
	gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL,
		    "neither OpenEXR nor a Radiance picture, by its first bytes");
	return GR_ERR_CONFIG;
}

int image_read_light(const char *path, struct image *out, struct gr_diag *diag)
{
	uint8_t *bytes;
	size_t len;
	int result = read_file(path, HDR_MAX_FILE, &bytes, &len, diag, "picture");

	memset(out, 0, sizeof *out);
	if (result != GR_OK)
		return result;
	result = image_decode_light(bytes, len, path, out, diag);
	free(bytes);
	return result;
}
