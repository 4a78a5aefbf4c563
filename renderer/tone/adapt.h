/*
 * How an eye gets used to what it sees: Pattanaik, Tumblin, Yee and Greenberg
 * 2000, "Time-Dependent Visual Adaptation for Realistic Image Display",
 * section 4.
 *
 * Two things change. Neurons follow the light within a fraction of a second:
 * the levels, which go towards it exponentially, cones with 80 ms, rods with
 * 150 ms. Pigment bleaches in light and grows again in minutes:
 *
 *     dp/dt = (1 - p) / t - p G / (t K),  t = 110 s, K = 2e6 cd/m^2 (cones)
 *                                         t = 400 s, K = 0.04 cd/m^2 (rods)
 *
 * with p the share that is not bleached and G the light. Both are solved in
 * closed form for a light that stays as it is over a step, so a step of any
 * length is stable and two steps are as good as one. (pfstmo_pattanaik00 takes
 * one explicit step a frame for p instead, which for rods at 16 frames a second
 * breaks down above 512 cd/m^2.)
 *
 * Pure; any thread. One process of the room has the state, and sends it to all.
 */
#ifndef GROTTO_RENDERER_TONE_ADAPT_H
#define GROTTO_RENDERER_TONE_ADAPT_H

#include <stddef.h>
#include <stdint.h>

/* Levels that are told apart, cd/m^2. Light below and above counts as these. */
#define ADAPT_LEVEL_MIN 1e-6
#define ADAPT_LEVEL_MAX 1e9

struct adapt_state {
	double cone, rod;               /* level, cd/m^2 */
	double cone_pigment, rod_pigment; /* share that is not bleached, 0..1 */
};

enum adapt_model {
	ADAPT_PATTANAIK,   /* as above */
	ADAPT_EXPONENTIAL, /* both levels exponentially in log luminance, pigment always settled */
};

struct adapt_params {
	enum adapt_model model;
	double time_s; /* ADAPT_EXPONENTIAL: until 1/e of a change is left; above 0 */
};
#define ADAPT_PARAMS_DEFAULT { .model = ADAPT_PATTANAIK, .time_s = 0.5 }

/* As after an hour under a light of `level` cd/m^2. GR_ERR_RANGE: NaN or below 0, unchanged. */
int adapt_settle(struct adapt_state *state, double level);
/*
 * dt_s under a light of `goal` cd/m^2. dt_s from 0, which changes nothing, to
 * infinity, which settles. GR_ERR_RANGE: the goal is NaN or below 0, or dt_s
 * is; the state stays.
 */
int adapt_step(struct adapt_state *state, const struct adapt_params *params, double goal,
	       double dt_s);

/* What a wall tells of the region looked at: to be added up over walls. */
struct adapt_sample {
	double log_sum;     /* of log(cd/m^2), natural, each within the levels above, times solid angle */
	double solid_angle; /* of what is in log_sum, sr; 0: nothing of this wall is looked at */
	double max;         /* cd/m^2 of the whole wall */
};
/* One more piece. What is not finite, or has no size, is left out; GR_NOTHING then. */
int adapt_sample_add(struct adapt_sample *sample, double luminance, double solid_angle);
/*
 * Goal (log average) and maximum over all walls. GR_NOTHING: no wall has anything
 * in the region, or a sum is not finite; *goal and *max stay.
 */
int adapt_merge(const struct adapt_sample *samples, size_t count, double *goal, double *max);

#endif
