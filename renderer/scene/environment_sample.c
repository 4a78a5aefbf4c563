/* Directions by luminance times solid angle: two rising sums, over rows and within each. */
#include "renderer/scene/environment_private.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>

static double luminance(const float rgb[3])
{
	return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

/* Mean over the pixel's square in u and v of what is linear between its neighbours. */
static void pixel_mean(const struct environment *e, int x, int y, float out[3])
{
	static const float share[3] = { 0.125f, 0.75f, 0.125f };

	out[0] = out[1] = out[2] = 0;
	for (int dy = -1; dy <= 1; dy++) {
		for (int dx = -1; dx <= 1; dx++) {
			const float *p = environment_pixel(e, x + dx, y + dy);

			for (int c = 0; c < 3; c++)
				out[c] += share[dy + 1] * share[dx + 1] * p[c];
		}
	}
}

static void row_edges(const struct environment *e, int y, double *top, double *bottom)
{
	environment_edges(e, y, e->height, top, bottom);
}

static double pixel_solid_angle(const struct environment *e, int y)
{
	double top, bottom;

	row_edges(e, y, &top, &bottom);
	return 2 * M_PI / e->width * (top - bottom);
}

int environment_build_sums(struct environment *environment)
{
	struct environment *e = environment;
	size_t width = (size_t)e->width, height = (size_t)e->height;

	e->in_row = calloc((width + 1) * height, sizeof *e->in_row);
	e->rows = calloc(height + 1, sizeof *e->rows);
	if (!e->in_row || !e->rows)
		return GR_ERR_NOMEM;
	for (int y = 0; y < e->height; y++) {
		double *sums = e->in_row + (width + 1) * (size_t)y;
		double solid_angle = pixel_solid_angle(e, y);

		for (int x = 0; x < e->width; x++) {
			float mean[3];

			pixel_mean(e, x, y, mean);
			sums[x + 1] = sums[x] + luminance(mean) * solid_angle;
		}
		e->rows[y + 1] = e->rows[y] + sums[width];
	}
	return GR_OK;
}

static bool is_even(const struct environment *e)
{
	return !e->width || !(e->rows[e->height] > 0);
}

/* Index of the step of rising sums in which `value` lies; steps of no height are left out. */
static int find_step(const double *sums, int count, double value)
{
	int low = 0, high = count;

	while (high - low > 1) {
		int middle = (low + high) / 2;

		if (sums[middle] <= value)
			low = middle;
		else
			high = middle;
	}
	/* value at the very end, by rounding */
	while (low > 0 && !(sums[low + 1] > sums[low]))
		low--;
	return low;
}

static double within(double low, double high, double value)
{
	double share = (value - low) / (high - low);

	return share < 0 ? 0 : share > 1 ? 1 : share;
}

static float sample_evenly(const struct environment *e, double u1, double u2, float direction[3])
{
	double y = e->upper_only ? 1 - u1 : 1 - 2 * u1; /* above 0 with upper_only */
	double r = sqrt(fmax(0, 1 - y * y));

	direction[0] = (float)(r * cos(2 * M_PI * u2));
	direction[1] = (float)y;
	direction[2] = (float)(r * sin(2 * M_PI * u2));
	return (float)((e->upper_only ? 2 : 1) / (4 * M_PI));
}

float environment_sample(const struct environment *environment, double u1, double u2,
			 float direction[3], float radiance[3])
{
	const struct environment *e = environment;
	double top, bottom, y, r, p, share;
	const double *sums;
	int row, column;
	float pdf;

	if (is_even(e)) {
		pdf = sample_evenly(e, u1, u2, direction);
		environment_radiance(e, direction, radiance);
		return pdf;
	}
	u1 *= e->rows[e->height];
	row = find_step(e->rows, e->height, u1);
	sums = e->in_row + (size_t)(e->width + 1) * (size_t)row;
	share = within(e->rows[row], e->rows[row + 1], u1);
	u2 *= sums[e->width];
	column = find_step(sums, e->width, u2);
	row_edges(e, row, &top, &bottom);
	y = top + share * (bottom - top);
	if (e->upper_only)
		y = fmax(y, 1e-9); /* the last row's lower edge is the horizon, whence nothing comes */
	p = 2 * M_PI * ((column + within(sums[column], sums[column + 1], u2)) / e->width - 0.5);
	r = sqrt(fmax(0, 1 - y * y));
	direction[0] = (float)(r * (e->turn[0] * cos(p) + e->turn[1] * sin(p)));
	direction[1] = (float)y;
	direction[2] = (float)(r * (e->turn[0] * sin(p) - e->turn[1] * cos(p)));
	environment_look(e, p / (2 * M_PI) + 0.5, acos(y) / M_PI, radiance);
	return (float)((sums[column + 1] - sums[column]) /
		       (e->rows[e->height] * pixel_solid_angle(e, row)));
}

float environment_pdf(const struct environment *environment, const float direction[3])
{
	const struct environment *e = environment;
	const double *sums;
	double u, v;
	int x, y;

	if (e->upper_only && !(direction[1] > 0))
		return 0;
	if (is_even(e))
		return (float)((e->upper_only ? 2 : 1) / (4 * M_PI));
	environment_place(e, direction, &u, &v);
	x = (int)(u * e->width);
	y = (int)(v * e->height);
	x = x < e->width ? x : e->width - 1;
	y = y < e->height ? y : e->height - 1;
	sums = e->in_row + (size_t)(e->width + 1) * (size_t)y;
	if (!(pixel_solid_angle(e, y) > 0))
		return 0;
	return (float)((sums[x + 1] - sums[x]) / (e->rows[e->height] * pixel_solid_angle(e, y)));
}
