/*
 * White-noise acceleration (Bar-Shalom, Li, Kirubarajan 2001, 6.2.2) for three
 * models, a body that rests, one that moves softly and one that moves as it can,
 * which differ in the density of the noise alone; the interacting multiple
 * models of Blom and Bar-Shalom (1988) weigh them. The three axes share one covariance: nothing prefers an
 * axis, and so a turn does not change it.
 *
 * Orientation: the same for a rotation vector relative to a reference that is
 * moved to the mean after each step (a multiplicative error state; Markley
 * 2003), with the rate in the body's frame.
 */
#include "tracking/filter_private.h"

#include <math.h>
#include <string.h>

/*
 * The chance in a second that a body goes over to a quicker model, and to a
 * slower one: far lower than what a hand does, so that one who rests is let rest.
 * What moves is found out by the samples within some 10 ms.
 */
#define BEGINS_PER_S 0.05
#define ENDS_PER_S 0.25
/* Density of a soft movement, of that of a quick one. */
#define SOFT 0.01
/* At the first sample nothing is known of the velocity: so many units a second, squared. */
#define UNKNOWN_VV 4.0
#define WEIGHT_LEAST 1e-6

static void begin_models(struct track_model *models, const double *x, double noise)
{
	for (int m = 0; m < TRACK_MODELS; m++) {
		models[m] = (struct track_model){ .xx = noise * noise, .vv = UNKNOWN_VV,
						  .weight = 1.0 / TRACK_MODELS };
		if (x)
			memcpy(models[m].mean.x, x, sizeof models[m].mean.x);
	}
}

static void begin(struct track_filter *f, const struct track_seen *seen)
{
	begin_models(f->of.kalman.position, seen->p, f->params.position.noise);
	begin_models(f->of.kalman.orientation, NULL, f->params.orientation.noise);
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The mean of models, each with its share; the spread of the means adds to the covariance. */
static struct track_model blend(const struct track_model *models, const double *shares)
{
	struct track_model out = { 0 };

	for (int m = 0; m < TRACK_MODELS; m++)
		for (int i = 0; i < 3; i++) {
			out.mean.x[i] += shares[m] * models[m].mean.x[i];
			out.mean.v[i] += shares[m] * models[m].mean.v[i];
		}
	for (int m = 0; m < TRACK_MODELS; m++) {
		double dx[3], dv[3];

		for (int i = 0; i < 3; i++) {
			dx[i] = models[m].mean.x[i] - out.mean.x[i];
			dv[i] = models[m].mean.v[i] - out.mean.v[i];
		}
		out.xx += shares[m] * (models[m].xx + dot(dx, dx) / 3);
		out.xv += shares[m] * (models[m].xv + dot(dx, dv) / 3);
		out.vv += shares[m] * (models[m].vv + dot(dv, dv) / 3);
	}
	return out;
}

/* The chance that model `from` becomes `to`; up, down: to one that is quicker, or slower. */
static double becomes(int from, int to, double up, double down)
{
	if (from != to)
		return to > from ? up : down;
	return 1 - (TRACK_MODELS - 1 - from) * up - from * down;
}

/* What each model starts from: a share of the other, as often as one becomes the other. */
static void interact(struct track_model *models, double dt)
{
	const double up = -expm1(-BEGINS_PER_S * dt), down = -expm1(-ENDS_PER_S * dt);
	struct track_model mixed[TRACK_MODELS];

	for (int to = 0; to < TRACK_MODELS; to++) {
		double shares[TRACK_MODELS], total = 0;

		for (int from = 0; from < TRACK_MODELS; from++)
			total += shares[from] = becomes(from, to, up, down) * models[from].weight;
		for (int from = 0; from < TRACK_MODELS; from++)
			shares[from] /= total;
		mixed[to] = blend(models, shares);
		mixed[to].weight = total;
	}
	memcpy(models, mixed, sizeof mixed);
}

/* dt on, with accelerations of density q. */
static void predict(struct track_model *m, double dt, double q)
{
	for (int i = 0; i < 3; i++)
		m->mean.x[i] += m->mean.v[i] * dt;
	m->xx += dt * (2 * m->xv + dt * m->vv) + q * dt * dt * dt / 3;
	m->xv += dt * m->vv + q * dt * dt / 2;
	m->vv += q * dt;
}

/* The sample at `seen`; weighs the model by the sample's likelihood (its logarithm is returned). */
static double update(struct track_model *m, const double seen[3], double noise)
{
	const double s = m->xx + noise * noise, kx = m->xx / s, kv = m->xv / s;
	double miss[3];

	for (int i = 0; i < 3; i++) {
		miss[i] = seen[i] - m->mean.x[i];
		m->mean.x[i] += kx * miss[i];
		m->mean.v[i] += kv * miss[i];
	}
	m->vv -= kv * m->xv;
	m->xv -= kx * m->xv;
	m->xx -= kx * m->xx;
	return -1.5 * log(s) - dot(miss, miss) / (2 * s);
}

static void weigh(struct track_model *models, const double *likelihood)
{
	double most = likelihood[0], total = 0;

	for (int m = 1; m < TRACK_MODELS; m++)
		most = fmax(most, likelihood[m]);
	for (int m = 0; m < TRACK_MODELS; m++) {
		models[m].weight = fmax(models[m].weight * exp(likelihood[m] - most), WEIGHT_LEAST);
		total += models[m].weight;
	}
	for (int m = 0; m < TRACK_MODELS; m++)
		models[m].weight /= total;
}

/* One sample for one of position and orientation; the mean of the models. */
static struct track_axes step_models(struct track_model *models, const struct track_filter_tune *tune,
				     double dt, const double seen[3])
{
	const double densities[TRACK_MODELS] = { tune->rest, tune->move * SOFT, tune->move };
	double likelihood[TRACK_MODELS], shares[TRACK_MODELS];

	interact(models, dt);
	for (int m = 0; m < TRACK_MODELS; m++) {
		predict(&models[m], dt, densities[m]);
		likelihood[m] = update(&models[m], seen, tune->noise);
	}
	weigh(models, likelihood);
	for (int m = 0; m < TRACK_MODELS; m++)
		shares[m] = models[m].weight;
	return blend(models, shares).mean;
}

static void step(struct track_filter *f, const struct track_seen *seen)
{
	struct track_model *turns = f->of.kalman.orientation;
	struct track_axes mean;
	double turn[3];

	mean = step_models(f->of.kalman.position, &f->params.position, seen->dt, seen->p);
	memcpy(f->p, mean.x, sizeof f->p);
	memcpy(f->v, mean.v, sizeof f->v);

	rotation_between(&f->q, &seen->q, turn);
	mean = step_models(turns, &f->params.orientation, seen->dt, turn);
	f->q = rotation_by(&f->q, mean.x);
	memcpy(f->w, mean.v, sizeof f->w);
	for (int m = 0; m < TRACK_MODELS; m++)
		for (int i = 0; i < 3; i++)
			turns[m].mean.x[i] -= mean.x[i]; /* the new reference */
}

const struct track_filter_ops track_kalman_ops = { begin, step };
