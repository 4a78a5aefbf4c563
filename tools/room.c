#include "tools/room.h"

#include "base/result.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define ROOM_GREY 40

int room_picture_create(struct room_picture *out, int width, int height)
{
	*out = (struct room_picture){ width, height, NULL };
	if (width < 1 || height < 1 || width > 65536 || height > 65536)
		return GR_ERR_RANGE;
	out->rgb = malloc((size_t)width * (size_t)height * 3);
	if (!out->rgb)
		return GR_ERR_NOMEM;
	memset(out->rgb, ROOM_GREY, (size_t)width * (size_t)height * 3);
	return GR_OK;
}

void room_picture_finish(struct room_picture *picture)
{
	free(picture->rgb);
	*picture = (struct room_picture){ 0 };
}

/* Pixels x0..x0+width-1, y0..y0+height-1 of a picture. */
struct window {
	const struct room_picture *picture;
	int x0, y0, width, height;
};

static const uint8_t *window_pixel(const struct window *w, int x, int y)
{
	x = x < 0 ? 0 : x >= w->width ? w->width - 1 : x;
	y = y < 0 ? 0 : y >= w->height ? w->height - 1 : y;
	return w->picture->rgb + 3 * ((size_t)(w->y0 + y) * (size_t)w->picture->width +
				      (size_t)(w->x0 + x));
}

/* Bilinear at (u, v), 0..1 from the window's lower left; adds to sum. */
static void window_sample(const struct window *w, double u, double v, double sum[3])
{
	double x = u * w->width - 0.5, y = (1 - v) * w->height - 0.5;
	double fx = x - floor(x), fy = y - floor(y);
	int ix = (int)floor(x), iy = (int)floor(y);
	const uint8_t *p00 = window_pixel(w, ix, iy), *p10 = window_pixel(w, ix + 1, iy);
	const uint8_t *p01 = window_pixel(w, ix, iy + 1), *p11 = window_pixel(w, ix + 1, iy + 1);

	for (int c = 0; c < 3; c++)
		sum[c] += (p00[c] * (1 - fx) + p10[c] * fx) * (1 - fy) +
			  (p01[c] * (1 - fx) + p11[c] * fx) * fy;
}

/* How many samples a side a pixel needs so that none of the source is skipped. */
static int samples_for(double source_pixels, double pixels)
{
	double ratio = ceil(source_pixels / fmax(pixels, 1) - 1e-3);

	return ratio < 1 ? 1 : ratio > 8 ? 8 : (int)ratio;
}

static struct window eye_window(const struct room_picture *source, enum room_eye eye)
{
	struct window w = { source, 0, 0, source->width, source->height };

	if (eye == ROOM_LEFT_HALF)
		w.width = source->width > 1 ? source->width / 2 : 1;
	else if (eye == ROOM_TOP_HALF)
		w.height = source->height > 1 ? source->height / 2 : 1;
	return w;
}

static uint8_t mean_byte(double sum, int samples)
{
	return (uint8_t)lrint(fmin(sum / samples, 255));
}

void room_add_part(struct room_picture *wall, const float part[4],
		   const struct room_picture *source, enum room_eye eye)
{
	struct window w = eye_window(source, eye);
	int x0 = (int)lrint((double)part[0] * wall->width);
	int x1 = (int)lrint((double)part[2] * wall->width);
	int y0 = (int)lrint((1 - (double)part[3]) * wall->height);
	int y1 = (int)lrint((1 - (double)part[1]) * wall->height);
	int n = samples_for(fmax((double)w.width / (x1 - x0), (double)w.height / (y1 - y0)), 1);

	if (!wall->rgb || !source->rgb || x0 < 0 || y0 < 0 || x1 > wall->width ||
	    y1 > wall->height)
		return;
	for (int y = y0; y < y1; y++)
		for (int x = x0; x < x1; x++) {
			uint8_t *to = wall->rgb + 3 * ((size_t)y * (size_t)wall->width + (size_t)x);
			double sum[3] = { 0, 0, 0 };

			for (int k = 0; k < n * n; k++)
				window_sample(&w, (x - x0 + (k % n + 0.5) / n) / (x1 - x0),
					      1 - (y - y0 + (k / n + 0.5) / n) / (y1 - y0), sum);
			for (int c = 0; c < 3; c++)
				to[c] = mean_byte(sum[c], n * n);
		}
}

static double densest(const struct unfold_place *places, const struct room_picture *walls,
		      size_t count)
{
	double density = 0;

	for (size_t i = 0; i < count; i++)
		if (walls[i].rgb)
			density = fmax(density, fmax(walls[i].width / places[i].width,
						     walls[i].height / places[i].height));
	return density;
}

static void draw_wall(struct room_picture *out, double density, const struct unfold_place *place,
		      const struct room_picture *wall)
{
	struct window w = { wall, 0, 0, wall->width, wall->height };
	struct unfold_box box = unfold_place_box(place);
	int x0 = (int)floor(box.x0 * density), x1 = (int)ceil(box.x1 * density);
	int y0 = (int)floor(box.y0 * density), y1 = (int)ceil(box.y1 * density);
	int n = samples_for(fmax(wall->width / place->width, wall->height / place->height),
			    density);

	if (x1 > out->width)
		x1 = out->width;
	if (y1 > out->height)
		y1 = out->height;
	for (int y = y0; y < y1; y++)
		for (int x = x0; x < x1; x++) {
			size_t row = (size_t)(out->height - 1 - y);
			uint8_t *to = out->rgb + 3 * (row * (size_t)out->width + (size_t)x);
			double sum[3] = { 0, 0, 0 };
			int inside = 0;

			for (int k = 0; k < n * n; k++) {
				double at[2] = { (x + (k % n + 0.5) / n) / density,
						 (y + (k / n + 0.5) / n) / density };
				double u, v;

				unfold_wall_point(place, at, &u, &v);
				if (u < 0 || u > 1 || v < 0 || v > 1)
					continue;
				window_sample(&w, u, v, sum);
				inside++;
			}
			for (int c = 0; c < 3 && inside > 0; c++)
				to[c] = mean_byte(sum[c], inside);
		}
}

int room_compose(const struct unfold_place *places, const double size[2],
		 const struct room_picture *walls, size_t count, int max_side,
		 struct room_picture *out)
{
	double density = densest(places, walls, count);
	double longest = fmax(size[0], size[1]);
	int result;

	*out = (struct room_picture){ 0 };
	if (density <= 0 || !isfinite(longest) || longest <= 0 || max_side < 1)
		return GR_ERR_RANGE;
	if (density * longest > max_side)
		density = max_side / longest;
	result = room_picture_create(out, (int)fmax(rint(size[0] * density), 1),
				     (int)fmax(rint(size[1] * density), 1));
	if (result != GR_OK)
		return result;
	for (size_t i = 0; i < count; i++)
		if (walls[i].rgb)
			draw_wall(out, density, &places[i], &walls[i]);
	return GR_OK;
}
