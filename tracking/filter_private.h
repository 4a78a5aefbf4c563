/* What filter.c asks of each kind: to begin at a sample, and to step on to the next. */
#ifndef GROTTO_TRACKING_FILTER_PRIVATE_H
#define GROTTO_TRACKING_FILTER_PRIVATE_H

#include "tracking/filter.h"

/* A sample, in the filter's precision. */
struct track_seen {
	int64_t time_ns;
	double dt; /* seconds since the last that counted */
	double p[3];
	struct rotation q;
};

/* begin: p and q are set, v and w 0. step: sets p, v, q, w as of seen->time_ns. */
struct track_filter_ops {
	void (*begin)(struct track_filter *f, const struct track_seen *seen);
	void (*step)(struct track_filter *f, const struct track_seen *seen);
};
extern const struct track_filter_ops track_fit_ops, track_one_euro_ops, track_exponential_ops,
	track_kalman_ops;

/* By how much a low pass of this time constant follows in dt. */
double track_follow(double dt, double tau_s);

#endif
