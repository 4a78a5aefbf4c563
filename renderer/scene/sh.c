#include "renderer/scene/sh.h"

#include <math.h>
#include <string.h>

/*
 * Directions and weights that integrate all products of two functions of the
 * largest order exactly: Gauss and Legendre's 8 heights, 16 around each.
 */
#define HEIGHTS 8
#define AROUND 16

static const double gauss[HEIGHTS / 2][2] = {
	{ 0.1834346424956498, 0.3626837833783620 },
	{ 0.5255324099163290, 0.3137066458778873 },
	{ 0.7966664774136267, 0.2223810344533745 },
	{ 0.9602898564975363, 0.1012285362903763 },
};

/* Direction i of HEIGHTS * AROUND; returns its weight, steradians. */
static double node(int i, double out[3])
{
	const double *g = gauss[i / AROUND / 2];
	const double z = i / AROUND % 2 ? -g[0] : g[0], r = sqrt(1 - z * z);
	const double p = 2 * M_PI * (i % AROUND) / AROUND;

	out[0] = r * cos(p);
	out[1] = r * sin(p);
	out[2] = z;
	return g[1] * 2 * M_PI / AROUND;
}

/* sqrt((2l + 1) / 4 pi (l - m)! / (l + m)!), and sqrt(2) of it but for m = 0. */
static double norm(int l, int m)
{
	double value = (2 * l + 1) / (4 * M_PI) * (m ? 2 : 1);

	for (int k = l - m + 1; k <= l + m; k++)
		value /= k;
	return sqrt(value);
}

void sh_basis(int order, const double direction[3], double *out)
{
	const double x = direction[0], y = direction[1], z = direction[2];
	/* sin^m theta times cos and sin of m phi; Legendre's functions over sin^m, from (m, m) up */
	double c = 1, s = 0, first = 1;

	for (int m = 0; m < order; m++) {
		double before = 0, p = first;

		for (int l = m; l < order; l++) {
			const double value = norm(l, m) * p;
			const double next = ((2 * l + 1) * z * p - (l + m) * before) / (l - m + 1);

			if (m)
				out[l * l + l - m] = value * s;
			out[l * l + l + m] = value * c;
			before = p;
			p = next;
		}
		first *= 2 * m + 1;
		p = x * c - y * s;
		s = x * s + y * c;
		c = p;
	}
}

static void add(int count, const double *basis, const double *value, double weight, double (*out)[3])
{
	for (int i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			out[i][k] += basis[i] * weight * value[k];
}

/* The same from everywhere, or from above only: then in slices of the half sphere, each exact. */
static void project_constant(const struct environment_pixels *e, int order, double (*out)[3])
{
	const double value[3] = { (double)e->constant[0], (double)e->constant[1],
				  (double)e->constant[2] };
	double basis[SH_COUNT_MAX], d[3];

	for (int i = 0; i < HEIGHTS * AROUND; i++) {
		double weight = node(i, d), up = d[2];

		/* nodes about +Y, over all heights or the upper half of them */
		if (e->upper_only) {
			double r = hypot(d[0], d[1]), high = (1 + up) / 2;
			double wide = sqrt(1 - high * high) / r;

			d[0] *= wide;
			d[1] *= wide;
			up = high;
			weight /= 2;
		}
		const double turned[3] = { d[1], up, d[0] };

		sh_basis(order, turned, basis);
		add(order * order, basis, value, weight, out);
	}
}

static void project_row(const struct environment_pixels *e, int order, int row, double (*out)[3])
{
	const double v = (row + 0.5) / e->height;
	double top = cos(M_PI * row / e->height), bottom = cos(M_PI * (row + 1) / e->height);
	double y = cos(M_PI * v), weight, r, basis[SH_COUNT_MAX];

	if (e->upper_only && bottom < 1e-12) {
		if (top < 1e-12)
			return;
		if (bottom < -1e-12) {
			bottom = 0;
			y = top / 2;
		}
	}
	weight = (top - bottom) * 2 * M_PI / e->width;
	r = sqrt(1 - y * y);
	for (int x = 0; x < e->width; x++) {
		/* the heading turns counter-clockwise from above, so the picture's angle falls by it */
		const double p = 2 * M_PI * ((x + 0.5) / e->width - 0.5) - (double)e->heading_rad;
		const double d[3] = { r * cos(p), y, r * sin(p) };
		const float *rgb = e->rgb + 3 * ((size_t)row * (size_t)e->width + (size_t)x);
		const double value[3] = { (double)rgb[0], (double)rgb[1], (double)rgb[2] };

		sh_basis(order, d, basis);
		add(order * order, basis, value, weight, out);
	}
}

void sh_project(const struct environment_pixels *environment, int order, double (*out)[3])
{
	memset(out, 0, (size_t)(order * order) * sizeof *out);
	if (!environment->rgb) {
		project_constant(environment, order, out);
		return;
	}
	for (int row = 0; row < environment->height; row++)
		project_row(environment, order, row, out);
}

void sh_radiance(int order, const double (*in)[3], const double direction[3], double out[3])
{
	double basis[SH_COUNT_MAX];

	sh_basis(order, direction, basis);
	out[0] = out[1] = out[2] = 0;
	for (int i = 0; i < order * order; i++)
		for (int k = 0; k < 3; k++)
			out[k] += in[i][k] * basis[i];
}

void sh_rotation(int order, const double rotation[9], double *matrix)
{
	const double *r = rotation;
	double to[SH_COUNT_MAX], from[SH_COUNT_MAX];

	memset(matrix, 0, SH_ROTATION_MAX * sizeof *matrix);
	for (int i = 0; i < HEIGHTS * AROUND; i++) {
		double d[3], before[3], weight = node(i, d), *at = matrix;

		/* what comes from d came from R^T d */
		for (int k = 0; k < 3; k++)
			before[k] = r[k] * d[0] + r[3 + k] * d[1] + r[6 + k] * d[2];
		sh_basis(order, d, to);
		sh_basis(order, before, from);
		for (int l = 0; l < order; l++)
			for (int row = l * l; row < (l + 1) * (l + 1); row++)
				for (int column = l * l; column < (l + 1) * (l + 1); column++)
					*at++ += weight * to[row] * from[column];
	}
}

void sh_rotate(int order, const double rotation[9], const double (*in)[3], double (*out)[3])
{
	double matrix[SH_ROTATION_MAX], sum[SH_COUNT_MAX][3] = { { 0 } };
	const double *at = matrix;

	sh_rotation(order, rotation, matrix);
	for (int l = 0; l < order; l++)
		for (int row = l * l; row < (l + 1) * (l + 1); row++)
			for (int column = l * l; column < (l + 1) * (l + 1); column++, at++)
				for (int k = 0; k < 3; k++)
					sum[row][k] += *at * in[column][k];
	memcpy(out, sum, (size_t)(order * order) * sizeof *out);
}

/* Of the cosine's lobe. */
static double cosine_band(int l)
{
	double value = 2 * M_PI / ((l + 2) * (l - 1));

	if (l == 1)
		return 2 * M_PI / 3;
	if (l % 2)
		return 0;
	/* l! / (2^l (l/2)!^2), and the sign of every second */
	for (int k = 1; k <= l / 2; k++)
		value *= (2 * k - 1) / (2.0 * k);
	return l / 2 % 2 ? value : -value;
}

void sh_irradiance(int order, const double (*in)[3], const double normal[3], double out[3])
{
	double basis[SH_COUNT_MAX];

	sh_basis(order, normal, basis);
	out[0] = out[1] = out[2] = 0;
	for (int l = 0; l < order; l++)
		for (int i = l * l; i < (l + 1) * (l + 1); i++)
			for (int k = 0; k < 3; k++)
				out[k] += cosine_band(l) * basis[i] * in[i][k];
}
