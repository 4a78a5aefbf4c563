#include "tracking/dmat3.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#define SWEEPS 40 /* six do for what is measured */

struct dmat3 dmat3_mul(const struct dmat3 *a, const struct dmat3 *b)
{
	struct dmat3 out;

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			out.m[i][k] = a->m[i][0] * b->m[0][k] + a->m[i][1] * b->m[1][k] +
				      a->m[i][2] * b->m[2][k];
	return out;
}

struct dmat3 dmat3_transposed(const struct dmat3 *a)
{
	struct dmat3 out;

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			out.m[i][k] = a->m[k][i];
	return out;
}

static void cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double dmat3_det(const struct dmat3 *a)
{
	double c[3];

	cross(a->m[1], a->m[2], c);
	return dot(a->m[0], c);
}

void dmat3_apply(const struct dmat3 *a, const double v[3], double out[3])
{
	const double x = v[0], y = v[1], z = v[2];

	for (int i = 0; i < 3; i++)
		out[i] = a->m[i][0] * x + a->m[i][1] * y + a->m[i][2] * z;
}

void dmat3_apply_transposed(const struct dmat3 *a, const double v[3], double out[3])
{
	const double x = v[0], y = v[1], z = v[2];

	for (int i = 0; i < 3; i++)
		out[i] = a->m[0][i] * x + a->m[1][i] * y + a->m[2][i] * z;
}

struct dmat3 dmat3_from_rotation(const struct rotation *r)
{
	const double x = r->q[0], y = r->q[1], z = r->q[2], w = r->q[3];

	return (struct dmat3){ {
		{ 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y) },
		{ 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x) },
		{ 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y) },
	} };
}

void dmat3_angles(const struct dmat3 *turn, double out[3])
{
	const double (*m)[3] = turn->m;
	const double level = hypot(m[0][2], m[2][2]); /* cosine of the pitch */
	double c, s;

	out[0] = level > 1e-9 ? atan2(m[0][2], m[2][2]) : atan2(-m[2][0], m[0][0]);
	out[1] = atan2(-m[1][2], level);
	/* What the heading leaves: where that is loose, near the pole, the two agree all the same. */
	c = cos(out[0]);
	s = sin(out[0]);
	out[2] = atan2(s * m[2][1] - c * m[0][1], c * m[0][0] - s * m[2][0]);
}

/* ---- singular values ---- */

/* Turns columns p and q of b, and of v, so that those of b are at right angles; false: they were. */
static bool turn_columns(struct dmat3 *b, struct dmat3 *v, int p, int q)
{
	double alpha = 0, beta = 0, gamma = 0, zeta, t, c, s;

	for (int i = 0; i < 3; i++) {
		alpha += b->m[i][p] * b->m[i][p];
		beta += b->m[i][q] * b->m[i][q];
		gamma += b->m[i][p] * b->m[i][q];
	}
	if (!(fabs(gamma) > DBL_EPSILON * sqrt(alpha) * sqrt(beta)))
		return false;
	zeta = (beta - alpha) / (2 * gamma);
	t = copysign(1, zeta) / (fabs(zeta) + hypot(1, zeta));
	c = 1 / hypot(1, t);
	s = c * t;
	for (int i = 0; i < 3; i++) {
		const double bp = b->m[i][p], vp = v->m[i][p];

		b->m[i][p] = c * bp - s * b->m[i][q];
		b->m[i][q] = s * bp + c * b->m[i][q];
		v->m[i][p] = c * vp - s * v->m[i][q];
		v->m[i][q] = s * vp + c * v->m[i][q];
	}
	return true;
}

/* Any unit vector at right angles to u. */
static void perpendicular(const double u[3], double out[3])
{
	int least = 0;
	double axis[3] = { 0 }, n;

	for (int i = 1; i < 3; i++)
		if (fabs(u[i]) < fabs(u[least]))
			least = i;
	axis[least] = 1;
	cross(u, axis, out);
	n = sqrt(dot(out, out));
	for (int i = 0; i < 3; i++)
		out[i] /= n;
}

/* The columns of u from those of b, whose lengths s are; rows here, for cross(). */
static void make_u(const double b[3][3], const double s[3], double u[3][3])
{
	const double none = s[0] * 4 * DBL_EPSILON;

	for (int k = 0; k < 3; k++) {
		if (s[k] > none) {
			for (int i = 0; i < 3; i++)
				u[k][i] = b[k][i] / s[k];
		} else if (k == 0) {
			u[0][0] = 1;
			u[0][1] = u[0][2] = 0;
		} else if (k == 1) {
			perpendicular(u[0], u[1]);
		} else {
			cross(u[0], u[1], u[2]);
		}
	}
}

struct svd3 svd3(const struct dmat3 *a)
{
	struct dmat3 b = *a, v = DMAT3_IDENTITY, u, sorted_b, sorted_v;
	struct svd3 out;
	double s[3];
	int order[3] = { 0, 1, 2 };
	bool turned = true;

	for (int sweep = 0; turned && sweep < SWEEPS; sweep++) {
		turned = turn_columns(&b, &v, 0, 1);
		turned = turn_columns(&b, &v, 0, 2) || turned;
		turned = turn_columns(&b, &v, 1, 2) || turned;
	}
	b = dmat3_transposed(&b);
	v = dmat3_transposed(&v);
	for (int k = 0; k < 3; k++)
		s[k] = sqrt(dot(b.m[k], b.m[k]));
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < 2; k++)
			if (s[order[k]] < s[order[k + 1]]) {
				const int t = order[k];

				order[k] = order[k + 1];
				order[k + 1] = t;
			}
	for (int k = 0; k < 3; k++) {
		memcpy(sorted_b.m[k], b.m[order[k]], sizeof sorted_b.m[k]);
		memcpy(sorted_v.m[k], v.m[order[k]], sizeof sorted_v.m[k]);
		out.s[k] = s[order[k]];
	}
	make_u(sorted_b.m, out.s, u.m);
	out.u = dmat3_transposed(&u);
	out.v = dmat3_transposed(&sorted_v);
	return out;
}
