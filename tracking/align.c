#include "tracking/align_private.h"

#include "base/result.h"

#include <math.h>
#include <string.h>

#define TURNS_MOST 200

void align_apply(const struct align_fit *fit, const double base[3], const double arm[3],
		 double out[3])
{
	double body[3];

	for (int i = 0; i < 3; i++)
		body[i] = fit->scale * base[i] + arm[i];
	dmat3_apply(&fit->R, body, out);
	for (int i = 0; i < 3; i++)
		out[i] += fit->t[i];
}

/* Means over a subset. */
struct means {
	double room[3], base[3], arm[3];
};

static struct means means_of(const struct align_point *points, const struct align_subset *subset)
{
	struct means m = { 0 };

	for (size_t k = 0; k < subset->count; k++) {
		const struct align_point *p = &points[subset->of[k]];

		for (int i = 0; i < 3; i++) {
			m.room[i] += p->room[i] / (double)subset->count;
			m.base[i] += p->base[i] / (double)subset->count;
			m.arm[i] += p->arm[i] / (double)subset->count;
		}
	}
	return m;
}

/* Umeyama's rotation for a scale: of the cross-covariance U D V^T it is U S V^T. */
static struct dmat3 best_turn(const struct align_point *points, const struct align_subset *subset,
			     const struct means *mean, double scale)
{
	struct dmat3 cross = { 0 }, v;
	struct svd3 d;

	for (size_t k = 0; k < subset->count; k++) {
		const struct align_point *p = &points[subset->of[k]];

		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				cross.m[i][j] += (p->room[i] - mean->room[i]) *
						 (scale * (p->base[j] - mean->base[j]) + p->arm[j] -
						  mean->arm[j]);
	}
	d = svd3(&cross);
	/* S: the reflection, where one would be better, goes to the direction that says least. */
	if (dmat3_det(&d.u) * dmat3_det(&d.v) < 0)
		for (int i = 0; i < 3; i++)
			d.u.m[i][2] = -d.u.m[i][2];
	v = dmat3_transposed(&d.v);
	return dmat3_mul(&d.u, &v);
}

/* The best scale for a rotation. */
static double best_scale(const struct align_point *points, const struct align_subset *subset,
			 const struct means *mean, const struct dmat3 *R)
{
	double along = 0, squares = 0;

	for (size_t k = 0; k < subset->count; k++) {
		const struct align_point *p = &points[subset->of[k]];
		double room[3], base;

		for (int i = 0; i < 3; i++)
			room[i] = p->room[i] - mean->room[i];
		dmat3_apply_transposed(R, room, room);
		for (int i = 0; i < 3; i++) {
			base = p->base[i] - mean->base[i];
			along += (room[i] - (p->arm[i] - mean->arm[i])) * base;
			squares += base * base;
		}
	}
	return squares > 0 ? along / squares : 0;
}

/* How far the points are spread in the room for how far by the device: to begin with. */
static double rough_scale(const struct align_point *points, const struct align_subset *subset)
{
	double room[3], base[3], middle[3];

	align_spread(points, subset, true, room, middle);
	align_spread(points, subset, false, base, middle);
	return base[0] > 0 ? room[0] / base[0] : 1;
}

bool align_least_squares(const struct align_point *points, size_t count,
			 const struct align_subset *subset, bool scale, struct align_fit *out)
{
	const struct means mean = means_of(points, subset);
	double body[3];

	out->scale = scale ? rough_scale(points, subset) : 1;
	for (int turn = 0; turn < TURNS_MOST; turn++) {
		const double before = out->scale;

		out->R = best_turn(points, subset, &mean, out->scale);
		if (scale)
			out->scale = best_scale(points, subset, &mean, &out->R);
		if (!(out->scale > 0) || fabs(out->scale - before) <= 1e-13 * before)
			break;
	}
	for (int i = 0; i < 3; i++)
		body[i] = out->scale * mean.base[i] + mean.arm[i];
	dmat3_apply(&out->R, body, body);
	for (int i = 0; i < 3; i++)
		out->t[i] = mean.room[i] - body[i];
	for (size_t k = 0; k < count; k++) {
		double found[3], square = 0;

		align_apply(out, points[k].base, points[k].arm, found);
		for (int i = 0; i < 3; i++)
			square += (found[i] - points[k].room[i]) * (found[i] - points[k].room[i]);
		out->residual_m[k] = sqrt(square);
	}
	return out->scale > 0;
}

double align_squares(const struct align_fit *fit, const struct align_subset *subset)
{
	double squares = 0;

	for (size_t k = 0; k < subset->count; k++)
		squares += fit->residual_m[subset->of[k]] * fit->residual_m[subset->of[k]];
	return squares;
}

double align_noise(const struct align_fit *fit, const struct align_subset *subset, bool scale)
{
	const double free = 3 * (double)subset->count - (scale ? 7 : 6);

	return free > 0 ? sqrt(align_squares(fit, subset) / free) : 0;
}

/* The scatter matrix about the middle; its singular values are sums of squares along its main axes. */
static struct svd3 scatter_of(const struct align_point *points, const struct align_subset *subset, bool room,
			      double middle[3])
{
	const struct means mean = means_of(points, subset);
	struct dmat3 scatter = { 0 };

	memcpy(middle, room ? mean.room : mean.base, 3 * sizeof *middle);
	for (size_t k = 0; k < subset->count; k++) {
		const struct align_point *p = &points[subset->of[k]];
		const double *at = room ? p->room : p->base;

		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				scatter.m[i][j] += (at[i] - middle[i]) * (at[j] - middle[j]);
	}
	return svd3(&scatter);
}

void align_spread(const struct align_point *points, const struct align_subset *subset, bool room,
		  double out_m[3], double middle[3])
{
	const struct svd3 d = scatter_of(points, subset, room, middle);

	for (int i = 0; i < 3; i++)
		out_m[i] = sqrt(d.s[i] / (double)subset->count);
}

double align_leverage(const struct align_point *points, const struct align_subset *subset, bool scale,
		      const double at[3])
{
	double middle[3], y[3], leverage = 1 / (double)subset->count;
	const struct svd3 d = scatter_of(points, subset, true, middle);

	for (int i = 0; i < 3; i++)
		y[i] = at[i] - middle[i];
	dmat3_apply_transposed(&d.u, y, y);
	/* A turn about one axis, uncertain by the other two's squares, moves by the distance from it. */
	for (int k = 0; k < 3; k++) {
		const int i = (k + 1) % 3, j = (k + 2) % 3;

		leverage += (y[i] * y[i] + y[j] * y[j]) / (d.s[i] + d.s[j]);
	}
	if (scale)
		leverage += (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) / (d.s[0] + d.s[1] + d.s[2]);
	return leverage;
}
