#include "renderer/scene/environment_cube.h"

#include "base/result.h"
#include "renderer/scene/environment.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Of a square as it is seen: to the right, down, and to its middle. */
static const signed char axes[6][3][3] = {
	[CUBE_PX] = { { 0, 0, 1 }, { 0, -1, 0 }, { 1, 0, 0 } },
	[CUBE_NX] = { { 0, 0, -1 }, { 0, -1, 0 }, { -1, 0, 0 } },
	[CUBE_PY] = { { 1, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } },
	[CUBE_NY] = { { 1, 0, 0 }, { 0, 0, 1 }, { 0, -1, 0 } },
	[CUBE_PZ] = { { -1, 0, 0 }, { 0, -1, 0 }, { 0, 0, 1 } },
	[CUBE_NZ] = { { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 } },
};

/* Where a direction meets the cube: the square, and -1..1 to the right and down. */
static int meet(const double d[3], double at[2])
{
	const int axis = fabs(d[0]) >= fabs(d[1]) && fabs(d[0]) >= fabs(d[2]) ? 0 :
			 fabs(d[1]) >= fabs(d[2]) ? 1 : 2;
	const int face = 2 * axis + (d[axis] < 0);

	for (int i = 0; i < 2; i++) {
		at[i] = 0;
		for (int k = 0; k < 3; k++)
			at[i] += axes[face][i][k] * d[k] / fabs(d[axis]);
	}
	return face;
}

static const float *pixel(const struct image faces[6], int face, int x, int y)
{
	const struct image *f = &faces[face];

	return f->data + (size_t)f->channels * ((size_t)y * (size_t)f->width + (size_t)x);
}

/* A pixel that may lie one beyond the square: its middle, folded over, on the next one. */
static const float *over_edge(const struct image faces[6], int face, int x, int y)
{
	const int n = faces[face].width;
	double d[3], at[2], right = (2 * x + 1.0) / n - 1, down = (2 * y + 1.0) / n - 1;
	int next;

	if (x >= 0 && x < n && y >= 0 && y < n)
		return pixel(faces, face, x, y);
	for (int k = 0; k < 3; k++)
		d[k] = axes[face][2][k] + axes[face][0][k] * right + axes[face][1][k] * down;
	next = meet(d, at);
	x = (int)fmin(fmax(floor((at[0] + 1) / 2 * n), 0), n - 1);
	y = (int)fmin(fmax(floor((at[1] + 1) / 2 * n), 0), n - 1);
	return pixel(faces, next, x, y);
}

static void look(const struct image faces[6], const double d[3], double rgb[3])
{
	double at[2], column, row, right, down;
	int face = meet(d, at), n = faces[face].width, x, y;

	column = (at[0] + 1) / 2 * n - 0.5;
	row = (at[1] + 1) / 2 * n - 0.5;
	x = (int)floor(column);
	y = (int)floor(row);
	right = column - x;
	down = row - y;
	for (int i = 0; i < 4; i++) {
		const float *p = over_edge(faces, face, x + i % 2, y + i / 2);
		double share = (i % 2 ? right : 1 - right) * (i / 2 ? down : 1 - down);

		for (int c = 0; c < 3; c++)
			rgb[c] += share * (double)p[faces[face].channels == 1 ? 0 : c];
	}
}

static int check(const struct image faces[6], const char *name, struct gr_diag *diag)
{
	for (int i = 0; i < 6; i++) {
		const struct image *f = &faces[i];

		if (f->width < 1 || f->width != f->height || f->width != faces[0].width ||
		    (f->channels != 1 && f->channels != 3)) {
			gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL,
				    "%d x %d pixels of %d channels; a cube has six squares of one size, of 1 or "
				    "3 channels", f->width, f->height, f->channels);
			return GR_ERR_CONFIG;
		}
	}
	return GR_OK;
}

int cube_unfold(const struct image faces[6], const char *name, struct image *out,
		struct gr_diag *diag)
{
	int result = check(faces, name, diag), width, parts;

	memset(out, 0, sizeof *out);
	if (result != GR_OK)
		return result;
	width = faces[0].width > ENVIRONMENT_MAX_SIDE / 4 ? ENVIRONMENT_MAX_SIDE : 4 * faces[0].width;
	/* the squares' pixels are smallest in the corners: two looks a side, and more when it shrinks */
	parts = 2 * ((4 * faces[0].width + width - 1) / width);
	result = image_create(out, width, width / 2, 3);
	for (int y = 0; y < width / 2 && result == GR_OK; y++)
		for (int x = 0; x < width; x++) {
			float *to = out->data + 3 * ((size_t)y * (size_t)width + (size_t)x);
			double rgb[3] = { 0 };

			for (int i = 0; i < parts * parts; i++) {
				double v = (y + (i / parts + 0.5) / parts) / (width / 2);
				double p = 2 * M_PI * ((x + (i % parts + 0.5) / parts) / width - 0.5);
				const double d[3] = { sin(M_PI * v) * cos(p), cos(M_PI * v),
						      sin(M_PI * v) * sin(p) };

				look(faces, d, rgb);
			}
			for (int c = 0; c < 3; c++)
				to[c] = (float)(rgb[c] / (parts * parts));
		}
	return result;
}

/* A square of the cross; upside down: turned by half a turn. */
static int cut(const struct image *cross, int column, int row, int side, bool turned, struct image *out)
{
	const size_t channels = (size_t)cross->channels;
	int result = image_create(out, side, side, cross->channels);

	for (int y = 0; y < side && result == GR_OK; y++)
		for (int x = 0; x < side; x++) {
			int from_x = column * side + (turned ? side - 1 - x : x);
			int from_y = row * side + (turned ? side - 1 - y : y);

			memcpy(out->data + channels * (size_t)(y * side + x),
			       cross->data + channels * ((size_t)from_y * (size_t)cross->width +
							 (size_t)from_x),
			       channels * sizeof *out->data);
		}
	return result;
}

int cube_unfold_cross(const struct image *cross, const char *name, struct image *out,
		      struct gr_diag *diag)
{
	/* Column and row; the one behind in the cross that lies, and in the one that stands. */
	static const int places[6][2] = { { 2, 1 }, { 0, 1 }, { 1, 0 }, { 1, 2 }, { 3, 1 }, { 1, 1 } };
	const bool stands = cross->height > cross->width;
	const int side = stands ? cross->width / 3 : cross->width / 4;
	struct image faces[6] = { { 0 } };
	int result = GR_OK;

	memset(out, 0, sizeof *out);
	if (side < 1 || cross->width != side * (stands ? 3 : 4) || cross->height != side * (stands ? 4 : 3)) {
		gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL,
			    "%d x %d pixels; a cross has 4 x 3 or 3 x 4 squares", cross->width, cross->height);
		return GR_ERR_CONFIG;
	}
	for (int i = 0; i < 6 && result == GR_OK; i++) {
		const bool turned = stands && i == CUBE_PZ;

		result = cut(cross, turned ? 1 : places[i][0], turned ? 3 : places[i][1], side, turned,
			     &faces[i]);
	}
	if (result == GR_OK)
		result = cube_unfold(faces, name, out, diag);
	for (int i = 0; i < 6; i++)
		image_finish(&faces[i]);
	return result;
}
