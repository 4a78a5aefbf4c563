#include "tracking/lever.h"

#include "base/result.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS 20
#define SLIP_M 0.005
#define SLIP_SIGMAS 4.0
#define KEEP_SHARE 0.7 /* of a pivot's samples */
#define WRONG_M 0.01
#define WRONG_TIMES 5.0
#define DEG (180 / M_PI)

static int refuse(struct lever_fit *out, enum lever_fault fault, char *why, size_t size,
		  const char *format, ...) __attribute__((format(printf, 5, 6)));
static int refuse(struct lever_fit *out, enum lever_fault fault, char *why, size_t size,
		  const char *format, ...)
{
	va_list args;

	out->fault = fault;
	va_start(args, format);
	vsnprintf(why, size, format, args);
	va_end(args);
	return fault == LEVER_SLIPPED || fault == LEVER_TOO_LONG ? GR_ERR_MISMATCH : GR_ERR_RANGE;
}

static double distance(const double a[3], const double b[3])
{
	return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static bool finite_sample(const struct lever_sample *s)
{
	for (int i = 0; i < 3; i++)
		if (!isfinite(s->p[i]))
			return false;
	for (int i = 0; i < 4; i++)
		if (!isfinite(s->q.q[i]))
			return false;
	return true;
}

static bool check_length(const double arm[3])
{
	const double none[3] = { 0 };

	return distance(arm, none) <= LEVER_ARM_MOST_M;
}

/* ---- pivot ---- */

/* What the tip's samples add up to. */
struct sums {
	struct dmat3 R;
	double p[3], Rp[3]; /* means of p and of R^T p */
	size_t count;
};

static struct sums add_up(const struct lever_sample *samples, const bool *out_of, size_t count)
{
	struct sums s = { 0 };
	double n;

	for (size_t k = 0; k < count; k++)
		s.count += !out_of[k];
	n = (double)s.count;
	for (size_t k = 0; k < count; k++) {
		const struct dmat3 R = dmat3_from_rotation(&samples[k].q);
		double back[3];

		if (out_of[k])
			continue;
		dmat3_apply_transposed(&R, samples[k].p, back);
		for (int i = 0; i < 3; i++) {
			s.p[i] += samples[k].p[i] / n;
			s.Rp[i] += back[i] / n;
			for (int j = 0; j < 3; j++)
				s.R.m[i][j] += R.m[i][j] / n;
		}
	}
	return s;
}

/* False: not turned enough. */
static bool solve(const struct sums *s, struct lever_fit *out)
{
	const struct dmat3 back = dmat3_transposed(&s->R);
	struct dmat3 normal = dmat3_mul(&back, &s->R);
	double right[3], mean[3];
	struct svd3 d;

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			normal.m[i][k] = (i == k) - normal.m[i][k];
	d = svd3(&normal);
	for (int k = 0; k < 3; k++) {
		out->turned_rad[k] = sqrt(d.s[k]);
		out->least_turned[k] = d.v.m[k][2];
	}
	if (!(out->turned_rad[2] >= LEVER_TURN_LEAST))
		return false;
	/* -mean((R_i - R)^T (p_i - p)) = R^T p - mean(R_i^T p_i) */
	dmat3_apply_transposed(&s->R, s->p, mean);
	for (int i = 0; i < 3; i++)
		right[i] = mean[i] - s->Rp[i];
	dmat3_apply_transposed(&d.u, right, right);
	for (int i = 0; i < 3; i++)
		right[i] /= d.s[i];
	dmat3_apply(&d.v, right, out->arm);
	dmat3_apply(&s->R, out->arm, out->tip);
	for (int i = 0; i < 3; i++)
		out->tip[i] += s->p[i];
	return true;
}

static double residual(const struct lever_sample *sample, const struct lever_fit *fit)
{
	const struct dmat3 R = dmat3_from_rotation(&sample->q);
	double at[3];

	dmat3_apply(&R, fit->arm, at);
	for (int i = 0; i < 3; i++)
		at[i] += sample->p[i];
	return distance(at, fit->tip);
}

/* Residuals of the used; then which are used by them. True: others than before. */
static bool sort_out(const struct lever_sample *samples, bool *out_of, size_t count,
		     struct lever_fit *out)
{
	double squares = 0, limit;
	bool changed = false;

	out->most_m = 0;
	out->used = 0;
	for (size_t k = 0; k < count; k++) {
		const double r = residual(&samples[k], out);

		if (out_of[k])
			continue;
		out->used++;
		squares += r * r;
		out->most_m = fmax(out->most_m, r);
	}
	out->rms_m = sqrt(squares / (double)out->used);
	limit = fmax(SLIP_M, SLIP_SIGMAS * out->rms_m / sqrt(3));
	for (size_t k = 0; k < count; k++) {
		const bool now = residual(&samples[k], out) > limit;

		changed = changed || now != out_of[k];
		out_of[k] = now;
	}
	return changed;
}

static int refuse_turn(struct lever_fit *out, char *why, size_t size)
{
	const double *d = out->least_turned;

	return refuse(out, LEVER_NOT_TURNED, why, size,
		      "turned too little: by %.0f, %.0f and %.0f degrees (rms) about its axes, each must be "
		      "%.0f; along (%.1f %.1f %.1f) of the sensor's frame the arm cannot be told: tilt it "
		      "further that way round",
		      out->turned_rad[0] * DEG, out->turned_rad[1] * DEG, out->turned_rad[2] * DEG,
		      LEVER_TURN_LEAST * DEG, d[0], d[1], d[2]);
}

static int pivot(const struct lever_sample *samples, bool *out_of, size_t count,
		 struct lever_fit *out, char *why, size_t size)
{
	bool changed = true;

	for (int round = 0; changed && round < ROUNDS; round++) {
		const struct sums sums = add_up(samples, out_of, count);

		if (!solve(&sums, out))
			return refuse_turn(out, why, size);
		changed = sort_out(samples, out_of, count, out);
	}
	if ((double)out->used < KEEP_SHARE * (double)count || out->rms_m > LEVER_RMS_MOST_M)
		return refuse(out, LEVER_SLIPPED, why, size,
			      "the tip did not stay where it was: %.1f mm rms (at most %.0f), %zu of %zu "
			      "samples left out",
			      out->rms_m * 1e3, LEVER_RMS_MOST_M * 1e3, count - out->used, count);
	if (!check_length(out->arm))
		return refuse(out, LEVER_TOO_LONG, why, size,
			      "an arm of over %.0f m: are the lengths metres?", LEVER_ARM_MOST_M);
	out->error_m = out->rms_m / sqrt(3 * (double)out->used) / out->turned_rad[2];
	return GR_OK;
}

int lever_pivot(const struct lever_sample *samples, size_t count, struct lever_fit *out, char *why,
		size_t size)
{
	bool *out_of;
	int r;

	memset(out, 0, sizeof *out);
	if (count < LEVER_LEAST || count > LEVER_SAMPLES)
		return refuse(out, LEVER_COUNT, why, size, "%zu samples: from %d to %d are needed", count,
			      LEVER_LEAST, LEVER_SAMPLES);
	for (size_t k = 0; k < count; k++)
		if (!finite_sample(&samples[k]))
			return refuse(out, LEVER_NOT_FINITE, why, size,
				      "not all of the numbers are finite");
	out_of = calloc(count, sizeof *out_of);
	if (!out_of)
		return GR_ERR_NOMEM;
	r = pivot(samples, out_of, count, out, why, size);
	free(out_of);
	return r;
}

/* ---- known points ---- */

/* Mean of the arms that are not wrong, nor number `without`. */
static void mean_arm(const double (*arms)[3], const struct lever_fit *fit, size_t count,
		     size_t without, double out[3])
{
	double n = 0;

	memset(out, 0, 3 * sizeof *out);
	for (size_t k = 0; k < count; k++) {
		if (fit->wrong[k] || k == without)
			continue;
		n++;
		for (int i = 0; i < 3; i++)
			out[i] += arms[k][i];
	}
	for (int i = 0; i < 3; i++)
		out[i] /= n;
}

static void measure(const double (*arms)[3], size_t count, struct lever_fit *out)
{
	double squares = 0;

	mean_arm(arms, out, count, count, out->arm);
	out->most_m = 0;
	for (size_t k = 0; k < count; k++) {
		out->residual_m[k] = distance(arms[k], out->arm);
		if (out->wrong[k])
			continue;
		squares += out->residual_m[k] * out->residual_m[k];
		out->most_m = fmax(out->most_m, out->residual_m[k]);
	}
	out->rms_m = sqrt(squares / (double)out->used);
}

/* The point that is furthest off, when it is wrong by the others; else `count`. */
static size_t find_wrong(const double (*arms)[3], size_t count, const struct lever_fit *fit)
{
	double others[3], squares = 0, most = -1;
	size_t worst = count;

	for (size_t k = 0; k < count; k++)
		if (!fit->wrong[k] && fit->residual_m[k] > most) {
			most = fit->residual_m[k];
			worst = k;
		}
	mean_arm(arms, fit, count, worst, others);
	for (size_t k = 0; k < count; k++)
		if (!fit->wrong[k] && k != worst)
			squares += distance(arms[k], others) * distance(arms[k], others);
	return distance(arms[worst], others) >
			       fmax(WRONG_M, WRONG_TIMES * sqrt(squares / (double)(fit->used - 1))) ?
		       worst :
		       count;
}

int lever_points(const struct lever_sample *samples, const double (*body)[3], size_t count, double most_m,
		 struct lever_fit *out, char *why, size_t size)
{
	double arms[LEVER_POINTS][3];

	memset(out, 0, sizeof *out);
	if (count < 1 || count > LEVER_POINTS)
		return refuse(out, LEVER_COUNT, why, size, "%zu points: from 1 to %d are needed", count,
			      LEVER_POINTS);
	for (size_t k = 0; k < count; k++) {
		const struct dmat3 R = dmat3_from_rotation(&samples[k].q);

		if (!finite_sample(&samples[k]) || !isfinite(body[k][0] + body[k][1] + body[k][2]))
			return refuse(out, LEVER_NOT_FINITE, why, size,
				      "not all of the numbers are finite");
		for (int i = 0; i < 3; i++)
			arms[k][i] = body[k][i] - samples[k].p[i];
		dmat3_apply_transposed(&R, arms[k], arms[k]);
	}
	out->used = count;
	measure(arms, count, out);
	/* With three left, of which two may agree; and more than half of all. */
	while (out->used > 2 && 2 * (out->used - 1) > count) {
		const size_t wrong = find_wrong(arms, count, out);

		if (wrong == count)
			break;
		out->wrong[wrong] = true;
		out->used--;
		measure(arms, count, out);
	}
	if (!(out->rms_m <= most_m))
		return refuse(out, LEVER_SLIPPED, why, size,
			      "the points do not agree on one arm: %.0f mm rms, at most %.0f; is the base "
			      "calibrated?",
			      out->rms_m * 1e3, most_m * 1e3);
	if (!check_length(out->arm))
		return refuse(out, LEVER_TOO_LONG, why, size,
			      "an arm of over %.0f m: is the base calibrated, are lengths metres?",
			      LEVER_ARM_MOST_M);
	out->error_m = out->rms_m / sqrt((double)out->used);
	return GR_OK;
}
