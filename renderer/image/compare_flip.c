/*
 * LDR-FLIP: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild,
 * "FLIP: A Difference Evaluator for Alternating Images", HPG 2020. Sections and
 * constants are the paper's.
 */
#include "base/result.h"
#include "renderer/image/compare.h"
#include "renderer/image/convolve.h"
#include "renderer/tone/srgb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define QC 0.7
#define PC 0.4
#define PT 0.95
#define QF 0.5
#define FEATURE_DEGREES 0.082 /* width of an edge that is seen best */

/* Linear Rec.709 to XYZ (D65), and its inverse. */
static const double to_xyz[3][3] = {
	{ 10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794 },
	{ 2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897 },
	{ 1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382 },
};
static const double to_rgb[3][3] = {
	{ 3.241003233, -1.537398969, -0.498615882 },
	{ -0.969224252, 1.875929984, 0.041554226 },
	{ 0.055639420, -0.204011206, 1.057148977 },
};

static void transform(const double m[3][3], const double in[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = m[i][0] * in[0] + m[i][1] * in[1] + m[i][2] * in[2];
}

static double white(int i)
{
	return to_xyz[i][0] + to_xyz[i][1] + to_xyz[i][2];
}

/* The opponent space YCxCz, in which eyes are sharp by channel (section 4.1). */
static void rgb_to_opponent(const double rgb[3], double out[3])
{
	double xyz[3];

	transform(to_xyz, rgb, xyz);
	for (int i = 0; i < 3; i++)
		xyz[i] /= white(i);
	out[0] = 116 * xyz[1] - 16;
	out[1] = 500 * (xyz[0] - xyz[1]);
	out[2] = 200 * (xyz[1] - xyz[2]);
}

static void opponent_to_rgb(const double in[3], double rgb[3])
{
	double y = (in[0] + 16) / 116;
	double xyz[3] = { (y + in[1] / 500) * white(0), y * white(1), (y - in[2] / 200) * white(2) };

	transform(to_rgb, xyz, rgb);
	for (int i = 0; i < 3; i++)
		rgb[i] = rgb[i] < 0 ? 0 : rgb[i] > 1 ? 1 : rgb[i];
}

static double lab_curve(double t)
{
	const double d = 6.0 / 29;

	return t > d * d * d ? cbrt(t) : t / (3 * d * d) + 4.0 / 29;
}

/* CIELAB with Hunt's loss of colour in the dark (section 4.1.2). */
static void rgb_to_hunt(const double rgb[3], double out[3])
{
	double xyz[3], f[3], l;

	transform(to_xyz, rgb, xyz);
	for (int i = 0; i < 3; i++)
		f[i] = lab_curve(xyz[i] / white(i));
	l = 116 * f[1] - 16;
	out[0] = l;
	out[1] = 0.01 * l * 500 * (f[0] - f[1]);
	out[2] = 0.01 * l * 200 * (f[1] - f[2]);
}

static double hyab(const double a[3], const double b[3])
{
	return fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]);
}

/* Colour difference to 0..1 (section 4.1.3): the greatest that matters is green against blue. */
static double color_error(const double a[3], const double b[3])
{
	static const double green[3] = { 0, 1, 0 }, blue[3] = { 0, 0, 1 };
	double g[3], u[3], most, error, knee;

	rgb_to_hunt(green, g);
	rgb_to_hunt(blue, u);
	most = pow(hyab(g, u), QC);
	knee = PC * most;
	error = pow(hyab(a, b), QC);
	if (error < knee)
		return error * PT / knee;
	return fmin(PT + (error - knee) / (most - knee) * (1 - PT), 1);
}

/* One picture on its way: opponent planes, filtered, and its features. */
struct seen {
	float *opponent[3], *filtered[3], *edge, *point;
};

/* Contrast sensitivity of a channel as up to two Gaussians (table 1). */
struct sensitivity {
	double a[2], b[2];
};
static const struct sensitivity sensitivities[3] = {
	{ { 1, 0 }, { 0.0047, 1e-5 } },
	{ { 1, 0 }, { 0.0053, 1e-5 } },
	{ { 34.1, 13.5 }, { 0.04, 0.025 } },
};

static int radius_of(double pixels)
{
	int radius = (int)ceil(pixels);

	return radius < 1 ? 1 : radius > CONVOLVE_MAX_RADIUS ? CONVOLVE_MAX_RADIUS : radius;
}

static void filter_channel(const float *from, int width, int height, const struct sensitivity *s,
			   double pixels_per_degree, float *spare, float *part, float *to)
{
	int radius = radius_of(3 * sqrt(0.04 / (2 * M_PI * M_PI)) * pixels_per_degree);
	size_t count = (size_t)width * (size_t)height;
	struct kernel kernels[2];
	double height_of[2], total = 0;

	for (int k = 0; k < 2; k++) {
		/* exp(-pi^2 x^2 / b), x in degrees */
		double sigma = sqrt(s->b[k] / 2) / M_PI * pixels_per_degree, sum = 0;

		kernel_gaussian(&kernels[k], sigma, radius);
		for (int i = 0; i <= 2 * radius; i++)
			sum += kernels[k].at[i];
		height_of[k] = s->a[k] * sqrt(M_PI / s->b[k]);
		total += height_of[k] * sum * sum;
	}
	memset(to, 0, count * sizeof *to);
	for (int k = 0; k < 2; k++) {
		if (height_of[k] <= 0)
			continue;
		convolve(from, width, height, &kernels[k], &kernels[k], spare, part);
		for (size_t i = 0; i < count; i++)
			to[i] += (float)(height_of[k] / total) * part[i];
	}
}

/* What is above 0 adds up to 1, what is below to -1. */
static void balance(struct kernel *kernel)
{
	double above = 0, below = 0;

	for (int i = 0; i <= 2 * kernel->radius; i++) {
		above += fmax(kernel->at[i], 0);
		below += fmax(-kernel->at[i], 0);
	}
	for (int i = 0; i <= 2 * kernel->radius; i++)
		kernel->at[i] /= kernel->at[i] > 0 ? above : below > 0 ? below : 1;
}

/* Strength of edges and points in both directions (section 4.2). */
static void find_features(const float *y, int width, int height, double pixels_per_degree,
			  float *spare, float *const across_down[2], struct seen *out)
{
	double sigma = 0.5 * FEATURE_DEGREES * pixels_per_degree;
	size_t count = (size_t)width * (size_t)height;
	struct kernel plain, across, feature;

	kernel_gaussian(&plain, sigma, radius_of(3 * sigma));
	across = plain;
	balance(&across);
	for (int point = 0; point < 2; point++) {
		float *to = point ? out->point : out->edge;

		feature = plain;
		for (int i = -plain.radius; i <= plain.radius; i++)
			feature.at[i + plain.radius] *= point ? i * i / (sigma * sigma) - 1 : -i;
		balance(&feature);
		convolve(y, width, height, &feature, &across, spare, across_down[0]);
		convolve(y, width, height, &across, &feature, spare, across_down[1]);
		for (size_t i = 0; i < count; i++)
			to[i] = hypotf(across_down[0][i], across_down[1][i]);
	}
}

static void look_at(const struct image *shown, double pixels_per_degree, float *const work[3],
		    struct seen *out)
{
	size_t count = (size_t)shown->width * (size_t)shown->height;

	for (size_t i = 0; i < count; i++) {
		double rgb[3], opponent[3];

		for (size_t c = 0; c < 3; c++) {
			double v = (double)shown->data[3 * i + c];

			rgb[c] = isfinite(v) ? srgb_decode(v) : 0;
		}
		rgb_to_opponent(rgb, opponent);
		for (int c = 0; c < 3; c++)
			out->opponent[c][i] = (float)opponent[c];
	}
	for (int c = 0; c < 3; c++)
		filter_channel(out->opponent[c], shown->width, shown->height, &sensitivities[c],
			       pixels_per_degree, work[0], work[1], out->filtered[c]);
	for (size_t i = 0; i < count; i++)
		out->opponent[0][i] = (out->opponent[0][i] + 16) / 116;
	find_features(out->opponent[0], shown->width, shown->height, pixels_per_degree, work[0],
		      work + 1, out);
}

static double error_at(const struct seen *a, const struct seen *b, size_t i)
{
	double of_a[3], of_b[3], rgb[3], feature;

	for (int c = 0; c < 3; c++) {
		of_a[c] = (double)a->filtered[c][i];
		of_b[c] = (double)b->filtered[c][i];
	}
	opponent_to_rgb(of_a, rgb);
	rgb_to_hunt(rgb, of_a);
	opponent_to_rgb(of_b, rgb);
	rgb_to_hunt(rgb, of_b);
	feature = fmax(fabs((double)a->edge[i] - (double)b->edge[i]),
		       fabs((double)a->point[i] - (double)b->point[i]));
	feature = fmin(pow(feature / M_SQRT2, QF), 1);
	return pow(color_error(of_a, of_b), 1 - feature);
}

int compare_flip(const struct image *shown, const struct image *reference,
		 double pixels_per_degree, struct image *map)
{
	enum { SEEN = 8, WORK = 3, ALL = 2 * SEEN + WORK };
	size_t count = (size_t)shown->width * (size_t)shown->height;
	float *planes[ALL], *memory;
	struct seen seen[2];
	int result;

	memset(map, 0, sizeof *map);
	if (shown->width != reference->width || shown->height != reference->height ||
	    shown->channels != 3 || reference->channels != 3 || !(pixels_per_degree > 0) ||
	    pixels_per_degree > 1000)
		return GR_ERR_RANGE;
	result = image_create(map, shown->width, shown->height, 1);
	if (result != GR_OK)
		return result;
	memory = malloc(ALL * count * sizeof *memory);
	if (!memory) {
		image_finish(map);
		return GR_ERR_NOMEM;
	}
	for (int p = 0; p < ALL; p++)
		planes[p] = memory + (size_t)p * count;
	for (int k = 0; k < 2; k++) {
		memcpy(seen[k].opponent, planes + k * SEEN, sizeof seen[k].opponent);
		memcpy(seen[k].filtered, planes + k * SEEN + 3, sizeof seen[k].filtered);
		seen[k].edge = planes[k * SEEN + 6];
		seen[k].point = planes[k * SEEN + 7];
		look_at(k ? reference : shown, pixels_per_degree, planes + 2 * SEEN, &seen[k]);
	}
	for (size_t i = 0; i < count; i++) {
		const float *p = shown->data + 3 * i, *q = reference->data + 3 * i;

		map->data[i] = isfinite(p[0] + p[1] + p[2]) && isfinite(q[0] + q[1] + q[2])
				       ? (float)error_at(&seen[0], &seen[1], i)
				       : 1;
	}
	free(memory);
	return GR_OK;
}
