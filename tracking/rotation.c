#include "tracking/rotation.h"

#include <math.h>

static struct rotation unit(struct rotation r)
{
	const double n = sqrt(r.q[0] * r.q[0] + r.q[1] * r.q[1] + r.q[2] * r.q[2] + r.q[3] * r.q[3]);

	for (int i = 0; i < 4; i++)
		r.q[i] /= n;
	return r;
}

struct rotation rotation_from(const float q[4])
{
	return unit((struct rotation){ { (double)q[0], (double)q[1], (double)q[2], (double)q[3] } });
}

void rotation_to(const struct rotation *r, float out[4])
{
	for (int i = 0; i < 4; i++)
		out[i] = (float)r->q[i];
}

struct rotation rotation_mul(const struct rotation *a, const struct rotation *b)
{
	const double *p = a->q, *q = b->q;

	return unit((struct rotation){ {
		p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1],
		p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0],
		p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3],
		p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2],
	} });
}

struct rotation rotation_exp(const double v[3])
{
	const double angle = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	/* sin(a / 2) / a, whose series has no more terms that count below 1e-4 */
	const double scale = angle < 1e-4 ? 0.5 - angle * angle / 48 : sin(angle / 2) / angle;

	return (struct rotation){ { v[0] * scale, v[1] * scale, v[2] * scale, cos(angle / 2) } };
}

void rotation_between(const struct rotation *a, const struct rotation *b, double out[3])
{
	const struct rotation back = { { -a->q[0], -a->q[1], -a->q[2], a->q[3] } };
	const struct rotation d = rotation_mul(&back, b);
	const double sine = sqrt(d.q[0] * d.q[0] + d.q[1] * d.q[1] + d.q[2] * d.q[2]);
	/* q and -q are the same turn: w >= 0 has the shorter arc */
	const double sign = d.q[3] < 0 ? -1 : 1;
	const double scale = sine < 1e-12 ? 2 * sign : sign * 2 * atan2(sine, fabs(d.q[3])) / sine;

	for (int i = 0; i < 3; i++)
		out[i] = d.q[i] * scale;
}

struct rotation rotation_by(const struct rotation *a, const double v[3])
{
	const struct rotation turn = rotation_exp(v);

	return rotation_mul(a, &turn);
}
