/*
 * The motion of one body of a recorded tracker log (docs/tracking.md), as a
 * truth to compare filters with: between two samples mixed, and where the
 * device had lost it, as the last sample before.
 */
#ifndef GROTTO_TOOLS_BENCH_LOGGED_H
#define GROTTO_TOOLS_BENCH_LOGGED_H

#include "base/diag.h"
#include "tools/bench/predict.h"
#include "tracking/source.h"

struct logged;
/* GR_OK; GR_ERR_CONFIG with a line in diag when the log or the body in it is none; GR_ERR_NOMEM. */
int logged_open(struct logged **out, const char *path, enum track_body body, struct gr_diag *diag);
void logged_destroy(struct logged **logged);
struct predict_motion logged_motion(const struct logged *logged);
/* Of its samples: the median of what lies between two, as a rate. */
double logged_rate_hz(const struct logged *logged);

#endif
