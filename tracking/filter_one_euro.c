/*
 * The one-euro filter (Casiez, Roussel, Vogel, CHI 2012). Speed is that of the
 * vector, so that it does not depend on the axes; the low passes are exact for
 * any dt.
 */
#include "tracking/filter_private.h"

#include <math.h>
#include <string.h>

static void keep(struct track_filter *f, const struct track_seen *seen)
{
	memcpy(f->of.last.p, seen->p, sizeof seen->p);
	f->of.last.q = seen->q;
}

static double tau_of(double cutoff_hz)
{
	return 1 / (2 * M_PI * cutoff_hz);
}

/*
 * The velocity follows what the samples moved, and not how far they are from
 * the output, as in the authors' code: that distance over dt grows with the rate.
 * Turns `step`, the way from the output to the sample, into what is made of it.
 */
static void follow(const struct track_filter_tune *tune, double dt, const double moved[3],
		   double velocity[3], double step[3])
{
	const double k = track_follow(dt, tau_of(tune->slope_hz));
	double share, speed2 = 0;

	for (int i = 0; i < 3; i++) {
		velocity[i] += k * (moved[i] / dt - velocity[i]);
		speed2 += velocity[i] * velocity[i];
	}
	share = track_follow(dt, tau_of(tune->cutoff_hz + tune->beta * sqrt(speed2)));
	for (int i = 0; i < 3; i++)
		step[i] *= share;
}

static void step(struct track_filter *f, const struct track_seen *seen)
{
	double moved[3], turned[3], to[3], turn[3];

	for (int i = 0; i < 3; i++) {
		moved[i] = seen->p[i] - f->of.last.p[i];
		to[i] = seen->p[i] - f->p[i];
	}
	rotation_between(&f->of.last.q, &seen->q, turned);
	rotation_between(&f->q, &seen->q, turn);
	follow(&f->params.position, seen->dt, moved, f->v, to);
	follow(&f->params.orientation, seen->dt, turned, f->w, turn);
	for (int i = 0; i < 3; i++)
		f->p[i] += to[i];
	f->q = rotation_by(&f->q, turn);
	keep(f, seen);
}

const struct track_filter_ops track_one_euro_ops = { keep, step };
