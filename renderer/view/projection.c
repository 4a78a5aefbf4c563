#include "renderer/view/projection.h"

#include "base/result.h"

#include <math.h>

static double dot3(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void sub3(const vec3 a, const vec3 b, double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = (double)a[i] - (double)b[i];
}

static void cross3(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

/* False when there is no direction in v, or it is not finite. */
static bool unit3(double v[3])
{
	double length = sqrt(dot3(v, v));

	if (!(length > 1e-9) || !isfinite(length))
		return false;
	for (int i = 0; i < 3; i++)
		v[i] /= length;
	return true;
}

static bool finite3(const vec3 v)
{
	return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static bool clip_range_ok(float near_m, float far_m)
{
	return isfinite(near_m) && isfinite(far_m) && near_m > 0 && far_m > near_m;
}

/* Fills the matrices from axes, frustum and near; `far` and `eye` are the rest. */
static void fill_matrices(struct projection *p, const vec3 eye, double far)
{
	double n = p->near_m;
	const double *axes[3] = { p->right, p->up, p->back };
	const double e[3] = { eye[0], eye[1], eye[2] };
	double v[4][4] = { { 0 } }; /* [column][row], as cglm */
	double f[4][4] = { { 0 } };

	for (int row = 0; row < 3; row++) {
		for (int col = 0; col < 3; col++)
			v[col][row] = axes[row][col];
		v[3][row] = -dot3(axes[row], e);
	}
	v[3][3] = 1;
	f[0][0] = 2 * n / (p->r - p->l);
	f[1][1] = 2 * n / (p->t - p->b);
	f[2][0] = (p->r + p->l) / (p->r - p->l);
	f[2][1] = (p->t + p->b) / (p->t - p->b);
	f[2][2] = -(far + n) / (far - n);
	f[2][3] = -1;
	f[3][2] = -2 * far * n / (far - n);
	for (int col = 0; col < 4; col++)
		for (int row = 0; row < 4; row++) {
			double sum = 0;

			for (int k = 0; k < 4; k++)
				sum += f[k][row] * v[col][k];
			p->view[col][row] = (float)v[col][row];
			p->projection[col][row] = (float)f[col][row];
			p->view_projection[col][row] = (float)sum;
		}
}

int projection_off_axis(const struct projection_wall *wall, const vec3 eye, float near_m,
			float far_m, struct projection *out)
{
	struct projection p = { .near_m = near_m };
	double side[3], va[3], vb[3], vc[3], scale;

	if (!clip_range_ok(near_m, far_m) || !finite3(eye) || !finite3(wall->lower_left) ||
	    !finite3(wall->lower_right) || !finite3(wall->upper_left))
		return GR_ERR_RANGE;
	sub3(wall->lower_right, wall->lower_left, p.right);
	sub3(wall->upper_left, wall->lower_left, side);
	if (!unit3(p.right))
		return GR_ERR_RANGE;
	cross3(p.right, side, p.back);
	if (!unit3(p.back))
		return GR_ERR_RANGE;
	cross3(p.back, p.right, p.up);
	sub3(wall->lower_left, eye, va);
	sub3(wall->lower_right, eye, vb);
	sub3(wall->upper_left, eye, vc);
	p.distance = -dot3(va, p.back);
	if (!(p.distance >= PROJECTION_MIN_DISTANCE))
		return GR_ERR_RANGE;
	scale = p.near_m / p.distance;
	p.l = dot3(p.right, va) * scale;
	p.r = dot3(p.right, vb) * scale;
	p.b = dot3(p.up, va) * scale;
	p.t = dot3(p.up, vc) * scale;
	fill_matrices(&p, eye, far_m);
	*out = p;
	return GR_OK;
}

int projection_camera(const vec3 position, const vec3 target, const vec3 up, float vfov_rad,
		      float aspect, float near_m, float far_m, struct projection *out)
{
	struct projection p = { .near_m = near_m };
	const double up_given[3] = { up[0], up[1], up[2] };

	if (!clip_range_ok(near_m, far_m) || !finite3(position) || !finite3(target) ||
	    !finite3(up) || !(vfov_rad > 0 && (double)vfov_rad < M_PI) || !isfinite(aspect) ||
	    !(aspect > 0))
		return GR_ERR_RANGE;
	sub3(position, target, p.back);
	if (!unit3(p.back))
		return GR_ERR_RANGE;
	cross3(up_given, p.back, p.right);
	if (!unit3(p.right))
		return GR_ERR_RANGE;
	cross3(p.back, p.right, p.up);
	p.t = p.near_m * tan(0.5 * (double)vfov_rad);
	p.b = -p.t;
	p.r = p.t * (double)aspect;
	p.l = -p.r;
	fill_matrices(&p, position, far_m);
	*out = p;
	return GR_OK;
}
