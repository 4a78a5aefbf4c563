/*
 * Double exponential smoothing (LaViola, "Double exponential smoothing: an
 * alternative to Kalman filter-based predictive tracking", 2003). S1 follows
 * the samples, S2 follows S1; the level is 2 S1 - S2 and the slope how far S2
 * went, which is a / (1 - a) (S1 - S2) without dividing by what may be 0. Turns are differences by the logarithm, along
 * the shorter arc.
 */
#include "tracking/filter_private.h"

#include <string.h>

static void begin(struct track_filter *f, const struct track_seen *seen)
{
	memcpy(f->of.smooth.p1, seen->p, sizeof seen->p);
	memcpy(f->of.smooth.p2, seen->p, sizeof seen->p);
	f->of.smooth.q1 = f->of.smooth.q2 = seen->q;
}

static void step_position(struct track_filter *f, const struct track_seen *seen)
{
	const double tau = f->params.position.tau_s, a = track_follow(seen->dt, tau);
	double *s1 = f->of.smooth.p1, *s2 = f->of.smooth.p2;

	for (int i = 0; i < 3; i++) {
		double step;

		s1[i] += a * (seen->p[i] - s1[i]);
		step = a * (s1[i] - s2[i]);
		s2[i] += step;
		f->p[i] = 2 * s1[i] - s2[i];
		f->v[i] = step / seen->dt;
	}
}

static struct rotation share_of(const struct rotation *from, const struct rotation *to, double share)
{
	double turn[3];

	rotation_between(from, to, turn);
	for (int i = 0; i < 3; i++)
		turn[i] *= share;
	return rotation_by(from, turn);
}

static void step_orientation(struct track_filter *f, const struct track_seen *seen)
{
	const double tau = f->params.orientation.tau_s, a = track_follow(seen->dt, tau);
	struct rotation *s1 = &f->of.smooth.q1, *s2 = &f->of.smooth.q2;
	double ahead[3], step[3];

	*s1 = share_of(s1, &seen->q, a);
	rotation_between(s2, s1, step);
	*s2 = share_of(s2, s1, a);
	rotation_between(s2, s1, ahead);
	f->q = rotation_by(s1, ahead);
	for (int i = 0; i < 3; i++)
		f->w[i] = a * step[i] / seen->dt;
}

static void step(struct track_filter *f, const struct track_seen *seen)
{
	step_position(f, seen);
	step_orientation(f, seen);
}

const struct track_filter_ops track_exponential_ops = { begin, step };
