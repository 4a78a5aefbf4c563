#include "tools/bench/stats.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

void stats_sort(double *values, size_t count)
{
	if (count)
		qsort(values, count, sizeof *values, ascending);
}

double stats_quantile(const double *sorted, size_t count, double share)
{
	double at, below;
	size_t i;

	if (!count || !(share >= 0 && share <= 1))
		return NAN;
	at = share * (double)(count - 1);
	below = floor(at);
	i = (size_t)below;
	if (i + 1 >= count)
		return sorted[count - 1];
	return sorted[i] + (at - below) * (sorted[i + 1] - sorted[i]);
}

struct stats_spread stats_spread(double *values, size_t count)
{
	struct stats_spread spread = { .count = count };

	stats_sort(values, count);
	spread.median = stats_quantile(values, count, 0.5);
	spread.p10 = stats_quantile(values, count, 0.1);
	spread.p90 = stats_quantile(values, count, 0.9);
	return spread;
}

struct sums {
	double weight, truth, found, square;
	size_t points, nonfinite;
};

/* One point: false when a band is not finite. */
static bool add_point(struct sums *sums, const float *found, const double *truth, size_t bands,
		      double weight)
{
	for (size_t c = 0; c < bands; c++) {
		if (!isfinite(found[c])) {
			sums->nonfinite++;
			return false;
		}
	}
	for (size_t c = 0; c < bands; c++) {
		double off = (double)found[c] - truth[c];

		sums->weight += weight;
		sums->truth += weight * truth[c];
		sums->found += weight * (double)found[c];
		sums->square += weight * off * off;
	}
	sums->points++;
	return true;
}

static double relative_error(const float *found, const double *truth, size_t bands, double least)
{
	double f = 0, t = 0;

	for (size_t c = 0; c < bands; c++) {
		f += (double)found[c] / (double)bands;
		t += truth[c] / (double)bands;
	}
	return fabs(f - t) / fmax(t, least);
}

int stats_compare(const float *found, const double *truth, const double *weights, size_t count,
		  size_t bands, double *scratch, struct stats_error *out)
{
	struct sums sums = { 0 };
	size_t kept = 0;

	*out = (struct stats_error){ .mean = NAN, .bias = NAN, .nrmse = NAN, .p95 = NAN };
	for (size_t k = 0; k < count; k++)
		add_point(&sums, found + bands * k, truth + bands * k, bands,
			  weights ? weights[k] : 1);
	out->count = sums.points;
	out->nonfinite = sums.nonfinite;
	if (!(sums.weight > 0) || !(sums.truth > 0))
		return GR_NOTHING;
	out->mean = sums.truth / sums.weight;
	out->bias = sums.found / sums.truth - 1;
	out->nrmse = sqrt(sums.square / sums.weight) / out->mean;
	for (size_t k = 0; k < count; k++) {
		double error = relative_error(found + bands * k, truth + bands * k, bands,
					      STATS_DARK * out->mean);

		if (isfinite(error))
			scratch[kept++] = error;
	}
	stats_sort(scratch, kept);
	out->p95 = stats_quantile(scratch, kept, 0.95);
	return GR_OK;
}

struct stats_flicker stats_flicker(const float *series, size_t frames, size_t points)
{
	struct stats_flicker flicker = { NAN, NAN };
	double sum = 0, worst = 0, total = 0;

	if (frames < 3 || !points)
		return flicker;
	for (size_t i = 0; i < frames * points; i++)
		sum += (double)series[i];
	sum /= (double)(frames * points);
	if (!(sum > 0))
		return flicker;
	for (size_t f = 1; f + 1 < frames; f++) {
		for (size_t k = 0; k < points; k++) {
			const float *at = series + f * points + k;
			double second = fabs((double)at[points] - 2 * (double)at[0] +
					     (double)*(at - points));

			worst = fmax(worst, second);
			total += second;
		}
	}
	flicker.worst = worst / sum;
	flicker.mean = total / (double)((frames - 2) * points) / sum;
	return flicker;
}

size_t stats_frames_within(const double *errors, size_t frames, double bound)
{
	size_t first = frames;

	while (first > 0 && errors[first - 1] <= bound)
		first--;
	return first < frames ? first + 1 : 0;
}

static bool finite_point(const struct stats_point *p)
{
	return isfinite(p->cost) && isfinite(p->error);
}

static bool beats(const struct stats_point *a, const struct stats_point *b, bool earlier)
{
	if (!finite_point(a) || a->cost > b->cost || a->error > b->error)
		return false;
	return a->cost < b->cost || a->error < b->error || earlier;
}

size_t stats_pareto(const struct stats_point *points, size_t count, size_t *out_indices)
{
	size_t found = 0;

	for (size_t i = 0; i < count; i++) {
		bool stays = finite_point(&points[i]);
		size_t at;

		for (size_t j = 0; j < count && stays; j++)
			stays = j == i || !beats(&points[j], &points[i], j < i);
		if (!stays)
			continue;
		for (at = found; at > 0 && points[out_indices[at - 1]].cost > points[i].cost; at--)
			out_indices[at] = out_indices[at - 1];
		out_indices[at] = i;
		found++;
	}
	return found;
}
