/* Which of the points agree, and how well. */
#include "tracking/align_private.h"

#include "base/result.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define PLACE_MOST_M 1000.0
#define NEAR_M 0.05       /* all of it within this is one place */
#define THIN_M 0.02       /* a line, when it is spread across by less, */
#define THIN_SHARE 0.05   /* or by less than this share of its length */
#define WRONG_FLOOR_M 0.01
#define WRONG_SIGMAS 6.0
#define GOOD_M 0.005      /* residuals like this need no other explanation */

int align_say(char *why, size_t size, int result, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	vsnprintf(why, size, format, args);
	va_end(args);
	return result;
}

struct align_subset align_all(size_t count)
{
	struct align_subset all = { .count = count };

	for (size_t i = 0; i < count; i++)
		all.of[i] = (unsigned char)i;
	return all;
}

/* ---- what cannot be a calibration ---- */

static enum align_fault check_numbers(const struct align_point *points, size_t count)
{
	enum align_fault fault = ALIGN_GOOD;

	for (size_t k = 0; k < count; k++) {
		const double *const of[] = { points[k].room, points[k].base, points[k].arm };

		for (int v = 0; v < 3; v++)
			for (int i = 0; i < 3; i++) {
				if (!isfinite(of[v][i]))
					return ALIGN_NOT_FINITE;
				if (fabs(of[v][i]) > PLACE_MOST_M)
					fault = ALIGN_TOO_FAR;
			}
	}
	return fault;
}

/* near: what is one place; a device whose metre is not known may have small ones. */
static enum align_fault check_spread(const double spread[3], double near)
{
	if (spread[0] < near)
		return ALIGN_COINCIDENT;
	if (spread[1] < THIN_SHARE * spread[0] || spread[1] < THIN_M / NEAR_M * near)
		return ALIGN_COLLINEAR;
	return ALIGN_GOOD;
}

static int refuse_spread(enum align_fault fault, const double spread[3], bool room, char *why,
			 size_t size)
{
	const char *whose = room ? "the points" : "the places that the device said";

	if (fault == ALIGN_COINCIDENT)
		return align_say(why, size, GR_ERR_RANGE,
			   "%s are all in one place (spread %.0f mm): take points that are metres "
			   "apart",
			   whose, spread[0] * 1e3);
	return align_say(why, size, GR_ERR_RANGE,
		   "%s are on a line (spread %.0f mm along it, %.0f mm across): no turn about it can be "
		   "told; take one well beside it",
		   whose, spread[0] * 1e3, spread[1] * 1e3);
}

/* GR_OK, or GR_ERR_RANGE with out->fault and why. */
static int check(const struct align_point *points, size_t count, bool scale, struct align_fit *out,
		 char *why, size_t size)
{
	double spread[3], middle[3];
	struct align_subset all;

	out->fault = ALIGN_COUNT;
	if (count < 3 || count > ALIGN_POINTS)
		return align_say(why, size, GR_ERR_RANGE,
			   "%zu point%s: at least 3 are needed, 4 or more show whether they agree, 5 "
			   "which does not; at most %d",
			   count, count == 1 ? "" : "s", ALIGN_POINTS);
	out->fault = check_numbers(points, count);
	if (out->fault == ALIGN_NOT_FINITE)
		return align_say(why, size, GR_ERR_RANGE, "not all of the numbers are finite");
	if (out->fault == ALIGN_TOO_FAR)
		return align_say(why, size, GR_ERR_RANGE, "a point is over %.0f m away; lengths are metres",
			   PLACE_MOST_M);
	all = align_all(count);
	align_spread(points, &all, true, spread, middle);
	out->fault = check_spread(spread, NEAR_M);
	if (out->fault != ALIGN_GOOD)
		return refuse_spread(out->fault, spread, true, why, size);
	align_spread(points, &all, false, spread, middle);
	out->fault = check_spread(spread, scale ? NEAR_M * 1e-3 : NEAR_M);
	return out->fault == ALIGN_GOOD ? GR_OK :
					  refuse_spread(out->fault, spread, false, why, size);
}

/* ---- which points agree ---- */

size_t align_wrong_most(size_t count)
{
	const size_t minority = (count - 1) / 2;

	return count < 5 ? 0 : count - 4 < minority ? count - 4 : minority;
}

/* The `most` points with the smallest residuals. */
static void nearest(const struct align_fit *fit, size_t count, size_t most,
		      struct align_subset *out)
{
	out->count = 0;
	for (size_t k = 0; k < count; k++) {
		size_t at = out->count;

		if (at == most && !(fit->residual_m[k] < fit->residual_m[out->of[at - 1]]))
			continue;
		if (at == most)
			at--;
		else
			out->count++;
		for (; at > 0 && fit->residual_m[out->of[at - 1]] > fit->residual_m[k]; at--)
			out->of[at] = out->of[at - 1];
		out->of[at] = (unsigned char)k;
	}
}

/* Three points that span a triangle, not a line. */
static bool spans(const struct align_point *points, const struct align_subset *triple)
{
	double spread[3], middle[3];

	align_spread(points, triple, true, spread, middle);
	return check_spread(spread, NEAR_M) == ALIGN_GOOD;
}

/* Squares of residuals, none counted for more than most_m: what is wrong is not to matter by how much. */
static double cost_of(const struct align_fit *fit, size_t count, double most_m)
{
	double cost = 0;

	for (size_t k = 0; k < count; k++) {
		const double r = fmin(fit->residual_m[k], most_m);

		cost += r * r;
	}
	return cost;
}

/* The points that are nearest by the best triple: so many that no more can be wrong. */
static struct align_subset best_subset(const struct align_point *points, size_t count,
				       const struct align_params *params)
{
	struct align_subset best = align_all(count), triple = { .count = 3 };
	double least = INFINITY;

	for (size_t a = 0; a + 2 < count; a++)
		for (size_t b = a + 1; b + 1 < count; b++)
			for (size_t c = b + 1; c < count; c++) {
				struct align_fit fit;
				double cost;

				triple.of[0] = (unsigned char)a;
				triple.of[1] = (unsigned char)b;
				triple.of[2] = (unsigned char)c;
				if (!spans(points, &triple) ||
				    !align_least_squares(points, count, &triple, params->scale, &fit))
					continue;
				cost = cost_of(&fit, count, params->most_m);
				if (cost < least) {
					least = cost;
					nearest(&fit, count, count - align_wrong_most(count), &best);
				}
			}
	return best;
}

/* Few points know little of their noise, and were chosen for having little. */
static double wrong_beyond(const struct align_fit *fit, const struct align_subset *subset, bool scale)
{
	const double free = 3 * (double)subset->count - (scale ? 7 : 6);

	return fmax(WRONG_FLOOR_M, WRONG_SIGMAS * (1 + 4 / free) * align_noise(fit, subset, scale));
}

/* The point that is nearest of those that are not in, its distance for how well it is foreseen; -1: all are. */
static int next_of(const struct align_point *points, size_t count, const struct align_fit *fit,
		   const struct align_subset *subset, const bool *in, bool scale, double *out_m)
{
	int next = -1;

	for (size_t k = 0; k < count; k++) {
		const double m = in[k] ? INFINITY :
					 fit->residual_m[k] /
						 sqrt(1 + align_leverage(points, subset, scale, points[k].room));

		if (in[k] || (next >= 0 && !(m < *out_m)))
			continue;
		next = (int)k;
		*out_m = m;
	}
	return next;
}

bool align_consensus(const struct align_point *points, size_t count,
		     const struct align_params *params, struct align_fit *out)
{
	const bool scale = params->scale;
	struct align_subset subset = best_subset(points, count, params);
	bool fits = align_least_squares(points, count, &subset, scale, out), in[ALIGN_POINTS] = { 0 };

	for (size_t k = 0; k < subset.count; k++)
		in[subset.of[k]] = true;
	while (fits) {
		double off_m = 0;
		const int next = next_of(points, count, out, &subset, in, scale, &off_m);

		if (next < 0 || off_m > wrong_beyond(out, &subset, scale))
			break;
		in[next] = true;
		subset.of[subset.count++] = (unsigned char)next;
		fits = align_least_squares(points, count, &subset, scale, out);
	}
	for (size_t k = 0; k < count; k++)
		out->wrong[k] = !in[k];
	out->used = subset.count;
	out->rms_m = sqrt(align_squares(out, &subset) / (double)subset.count);
	return fits;
}

/* ---- how good it is ---- */

static void judge(const struct align_point *points, size_t count, bool scale, struct align_fit *out)
{
	struct align_subset used = { 0 };
	double spread[3], squares[3], n, base[3], middle[3];

	out->most_m = 0;
	for (size_t k = 0; k < count; k++)
		if (!out->wrong[k]) {
			used.of[used.count++] = (unsigned char)k;
			out->most_m = fmax(out->most_m, out->residual_m[k]);
		}
	n = (double)used.count;
	align_spread(points, &used, true, spread, out->middle);
	align_spread(points, &used, false, base, middle);
	for (int i = 0; i < 3; i++)
		squares[i] = n * spread[i] * spread[i];
	out->noise_m = align_noise(out, &used, scale);
	/* A turn about an axis moves a point by its distance from that axis. */
	out->turn_rad = out->noise_m * sqrt(1 / (squares[0] + squares[1]) + 1 / (squares[0] + squares[2]) +
					    1 / (squares[1] + squares[2]));
	out->place_m = out->noise_m * sqrt(3 / n);
	out->scale_error = scale ? out->noise_m / sqrt(n * (base[0] * base[0] + base[1] * base[1] +
							    base[2] * base[2]))
				 : 0;
}

int align_fit(const struct align_point *points, size_t count, const struct align_params *params,
	      struct align_fit *out, char *why, size_t size)
{
	struct align_fit other;
	int r;

	memset(out, 0, sizeof *out);
	if (size)
		why[0] = '\0';
	r = check(points, count, params->scale, out, why, size);
	if (r < 0)
		return r;
	if (!align_consensus(points, count, params, out)) {
		out->rms_m = INFINITY;
		out->fault = ALIGN_SCALE;
		return align_say(why, size, GR_ERR_MISMATCH,
			   "no scale above 0 fits: are the points measured in the file's order?");
	}
	judge(points, count, params->scale, out);
	if (!(out->rms_m <= params->most_m) || out->used < 3)
		return align_explain(points, count, params, out, why, size);
	/* Of a mirrored device those points agree that lie in one plane, and so do they all where the
	 * room is flat enough. */
	if ((out->used < count || out->rms_m > GOOD_M) &&
	    align_mirrored(points, count, params, out, &other))
		return align_explain(points, count, params, out, why, size);
	return GR_OK;
}

int align_meant(const struct align_point *points, size_t count, const struct align_fit *fit, size_t of)
{
	const double near = fmax(WRONG_FLOOR_M, WRONG_SIGMAS * fit->noise_m);
	double at[3];

	align_apply(fit, points[of].base, points[of].arm, at);
	for (size_t k = 0; k < count; k++)
		if (hypot(hypot(at[0] - points[k].room[0], at[1] - points[k].room[1]),
			  at[2] - points[k].room[2]) <= near)
			return (int)k;
	return -1;
}
