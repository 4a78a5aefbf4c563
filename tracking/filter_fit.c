/* No filter: the last sample as it is, and the slope of a line through the last 50 ms. */
#include "tracking/filter_private.h"

#include "base/clock.h"

#include <string.h>

#define FIT_NS (50 * GR_NS_PER_MS)

static void keep(struct track_fit *fit, const struct track_seen *seen)
{
	const size_t at = fit->count++ % TRACK_FIT_SAMPLES;

	fit->time_ns[at] = seen->time_ns;
	memcpy(fit->p[at], seen->p, sizeof seen->p);
	fit->q[at] = seen->q;
}

static void begin(struct track_filter *f, const struct track_seen *seen)
{
	f->of.fit.count = 0;
	keep(&f->of.fit, seen);
}

/* Least squares over the last FIT_NS, and over two samples at least. */
static void step(struct track_filter *f, const struct track_seen *seen)
{
	struct track_fit *fit = &f->of.fit;
	double n = 0, st = 0, stt = 0, sx[6] = { 0 }, stx[6] = { 0 }, spread;
	const uint64_t kept = fit->count + 1 < TRACK_FIT_SAMPLES ? fit->count + 1 : TRACK_FIT_SAMPLES;

	keep(fit, seen);
	memcpy(f->p, seen->p, sizeof f->p);
	f->q = seen->q;
	for (uint64_t back = 0; back < kept; back++) {
		const size_t at = (fit->count - 1 - back) % TRACK_FIT_SAMPLES;
		const int64_t age_ns = seen->time_ns - fit->time_ns[at];
		const double t = -(double)age_ns * 1e-9;
		double x[6];

		if (back >= 2 && age_ns > FIT_NS)
			break;
		for (int i = 0; i < 3; i++)
			x[i] = fit->p[at][i] - seen->p[i];
		rotation_between(&seen->q, &fit->q[at], x + 3);
		n += 1;
		st += t;
		stt += t * t;
		for (int i = 0; i < 6; i++) {
			sx[i] += x[i];
			stx[i] += t * x[i];
		}
	}
	spread = n * stt - st * st; /* over 0: the times of two samples differ */
	for (int i = 0; i < 3; i++) {
		f->v[i] = (n * stx[i] - st * sx[i]) / spread;
		f->w[i] = (n * stx[i + 3] - st * sx[i + 3]) / spread;
	}
}

const struct track_filter_ops track_fit_ops = { begin, step };
