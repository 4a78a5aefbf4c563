/* Where points do not agree: what would make them. */
#include "tracking/align_private.h"

#include "base/result.h"

#include <math.h>
#include <string.h>

#define HINT_SHARE 0.25 /* another reading that leaves less of the residual than this is meant */
#define SLACK_M 0.005

/*
 * More points agree, and not much worse, or as many far better: points of one plane
 * agree with any mirror image of it.
 */
static bool better(const struct align_fit *other, const struct align_fit *fit, double most_m)
{
	if (!(other->rms_m <= most_m) || other->used < fit->used)
		return false;
	return other->used > fit->used ? other->rms_m <= 2 * fit->rms_m + SLACK_M :
					 other->rms_m < HINT_SHARE * fit->rms_m;
}

bool align_mirrored(const struct align_point *points, size_t count, const struct align_params *params,
		    const struct align_fit *fit, struct align_fit *other)
{
	struct align_point mirrored[ALIGN_POINTS];

	memcpy(mirrored, points, count * sizeof *points);
	for (size_t k = 0; k < count; k++)
		for (int i = 0; i < 3; i++) {
			mirrored[k].base[i] = -points[k].base[i];
			mirrored[k].arm[i] = -points[k].arm[i];
		}
	return align_consensus(mirrored, count, params, other) && better(other, fit, params->most_m);
}

/* Whether they agree with each point's measurement taken from `from` of it. */
static bool fits_ordered(const struct align_point *points, size_t count,
			 const struct align_params *params, const size_t from[ALIGN_POINTS],
			 const struct align_fit *fit)
{
	struct align_point ordered[ALIGN_POINTS];
	struct align_subset all = align_all(count);
	struct align_fit other;

	for (size_t k = 0; k < count; k++) {
		ordered[k] = points[from[k]];
		memcpy(ordered[k].room, points[k].room, sizeof ordered[k].room);
	}
	if (!align_least_squares(ordered, count, &all, params->scale, &other))
		return false;
	other.used = count;
	other.rms_m = sqrt(align_squares(&other, &all) / (double)count);
	return better(&other, fit, params->most_m);
}

/* Backwards, or begun with another point: what happens to who goes round a room. */
static const char *order_that_fits(const struct align_point *points, size_t count,
				   const struct align_params *params, const struct align_fit *fit,
				   size_t *out_first)
{
	size_t from[ALIGN_POINTS];

	for (size_t first = 0; first < count; first++)
		for (int back = 0; back < 2; back++) {
			for (size_t k = 0; k < count; k++)
				from[k] = (back ? first + count - k : first + k) % count;
			if ((first || back) && fits_ordered(points, count, params, from, fit)) {
				*out_first = first;
				return back ? "backwards" : "in their order";
			}
		}
	return NULL;
}

int align_explain(const struct align_point *points, size_t count, const struct align_params *params,
		  struct align_fit *out, char *why, size_t size)
{
	const struct align_params scaled = { .scale = true, .most_m = params->most_m };
	struct align_fit other;
	const char *order;
	size_t first;

	if (align_mirrored(points, count, params, out, &other)) {
		out->fault = ALIGN_MIRRORED;
		return align_say(why, size, GR_ERR_MISMATCH,
			   "the device's axes look left-handed: mirrored, %zu points agree to %.1f mm, as "
			   "they are to %.0f mm; set the device to right-handed axes",
			   other.used, other.rms_m * 1e3, out->rms_m * 1e3);
	}
	order = order_that_fits(points, count, params, out, &first);
	if (order) {
		out->fault = ALIGN_ORDER;
		return align_say(why, size, GR_ERR_MISMATCH,
			   "the points do not agree (%.0f mm), but they would if they had been taken %s "
			   "from point %zu on: measure them in the file's order",
			   out->rms_m * 1e3, order, first + 1);
	}
	if (!params->scale && align_consensus(points, count, &scaled, &other) &&
	    better(&other, out, params->most_m)) {
		out->fault = ALIGN_SCALE;
		return align_say(why, size, GR_ERR_MISMATCH,
			   "the points do not agree (%.0f mm), but they do to %.1f mm if a metre of the "
			   "device is %.4g m long: fit the scale as well, where that can be",
			   out->rms_m * 1e3, other.rms_m * 1e3, other.scale);
	}
	out->fault = ALIGN_DISAGREE;
	if (count == 4)
		return align_say(why, size, GR_ERR_MISMATCH,
			   "the 4 points do not agree (%.0f mm rms, at most %.0f): a fifth would show "
			   "which is wrong",
			   out->rms_m * 1e3, params->most_m * 1e3);
	return align_say(why, size, GR_ERR_MISMATCH,
		   "no %zu of the %zu points agree (%.0f mm rms, at most %.0f): is each measured where the "
		   "file says, are lengths metres?",
		   count - align_wrong_most(count), count, out->rms_m * 1e3, params->most_m * 1e3);
}
