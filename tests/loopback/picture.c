/*
 * picture FILE WIDTHxHEIGHT: fails when the PNG has another size or shows
 * next to nothing (fewer than 16 colours, or one colour on over 95 % of it).
 */
#include "base/diag.h"
#include "base/result.h"
#include "renderer/image/image.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int compare(const void *a, const void *b)
{
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;

	return (x > y) - (x < y);
}

static int judge(const char *path, const uint8_t *rgb, size_t count)
{
	uint32_t *colours = malloc(count * sizeof *colours);
	size_t distinct = 0, run = 0, longest = 0;

	if (!colours)
		return 1;
	for (size_t i = 0; i < count; i++)
		colours[i] = (uint32_t)rgb[3 * i] << 16 | (uint32_t)rgb[3 * i + 1] << 8 |
			     rgb[3 * i + 2];
	qsort(colours, count, sizeof *colours, compare);
	for (size_t i = 0; i < count; i++) {
		run = i > 0 && colours[i] == colours[i - 1] ? run + 1 : 1;
		distinct += run == 1;
		longest = run > longest ? run : longest;
	}
	free(colours);
	printf("%s: %zu pixels, %zu colours, the most frequent on %.1f %%\n", path, count, distinct,
	       100.0 * (double)longest / (double)count);
	return distinct < 16 || (double)longest > 0.95 * (double)count;
}

int main(int argc, char **argv)
{
	struct gr_diag diag = { 0 };
	uint8_t *rgb = NULL;
	int width, height, want_width, want_height;
	int status = 1;

	if (argc != 3 || sscanf(argv[2], "%dx%d", &want_width, &want_height) != 2)
		return 2;
	if (image_read_png(argv[1], &width, &height, &rgb, &diag) != GR_OK)
		gr_diag_log(&diag);
	else if (width != want_width || height != want_height)
		printf("%s: %dx%d, not %s\n", argv[1], width, height, argv[2]);
	else
		status = judge(argv[1], rgb, (size_t)width * (size_t)height);
	free(rgb);
	gr_diag_finish(&diag);
	return status;
}
