#include "tools/bench/predict.h"

#include "tools/bench/random.h"
#include "tools/bench/stats.h"

#include <math.h>
#include <stdlib.h>

#define WARM_S 1.0
#define REST_S 11.0
#define DERIVE_S 1e-3 /* for the truth's velocity */

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The device's sample of the truth, as a driver hands it over. */
static struct gr_pose sample_of(const struct hand_pose *truth, const struct predict_samples *samples,
				struct bench_random *random)
{
	struct gr_pose pose;
	struct rotation q;
	double turn[3];

	for (int i = 0; i < 3; i++) {
		pose.p[i] = (float)(truth->p[i] + samples->noise_m * bench_random_normal(random));
		turn[i] = samples->noise_rad * bench_random_normal(random);
	}
	q = rotation_by(&truth->q, turn);
	rotation_to(&q, pose.q);
	return pose;
}

struct measured {
	double *metres, *radians; /* error of each */
	size_t count;
	double with, against; /* sums over the movement: of miss by velocity, of velocity squared */
};

/* What was shown for time t. */
static void judge(struct measured *m, const struct predict_motion *motion, double t, const struct gr_pose *shown)
{
	const struct hand_pose truth = motion->at(motion->ctx, t);
	const struct hand_pose before = motion->at(motion->ctx, t - DERIVE_S);
	const struct hand_pose after = motion->at(motion->ctx, t + DERIVE_S);
	const struct rotation q = rotation_from(shown->q);
	double miss[3], turn[3], velocity[3];

	for (int i = 0; i < 3; i++) {
		miss[i] = truth.p[i] - (double)shown->p[i];
		velocity[i] = (after.p[i] - before.p[i]) / (2 * DERIVE_S);
	}
	rotation_between(&truth.q, &q, turn);
	m->metres[m->count] = sqrt(dot(miss, miss));
	m->radians[m->count++] = sqrt(dot(turn, turn));
	m->with += dot(miss, velocity);
	m->against += dot(velocity, velocity);
}

static void spread(double *values, size_t count, double *rms, double *p99)
{
	double sum = 0;

	for (size_t i = 0; i < count; i++)
		sum += values[i] * values[i];
	stats_sort(values, count);
	*rms = count ? sqrt(sum / (double)count) : NAN;
	*p99 = stats_quantile(values, count, 0.99);
}

bool predict_measure(const struct predict_motion *motion, const struct predict_samples *samples,
		     const struct track_filter_params *params, double horizon_s, struct predict_error *out)
{
	const size_t most = (size_t)(motion->seconds * samples->rate_hz) + 1;
	struct bench_random random = bench_random_start(samples->seed);
	struct measured m = { .metres = malloc(most * sizeof *m.metres),
			      .radians = malloc(most * sizeof *m.radians) };
	struct track_filter filter;
	bool done = m.metres && m.radians;

	if (params)
		track_filter_init(&filter, params);
	for (size_t n = 0; done && n < most; n++) {
		const double t = (double)n / samples->rate_hz;
		const struct hand_pose truth = motion->at(motion->ctx, t);
		const int64_t time_ns = llrint(t * 1e9) + 1;
		struct gr_pose shown = sample_of(&truth, samples, &random);

		if (params) {
			track_filter_add(&filter, time_ns, &shown);
			track_filter_at(&filter, time_ns + llrint(horizon_s * 1e9), &shown);
		}
		if (t >= WARM_S && t + horizon_s <= motion->seconds)
			judge(&m, motion, t + horizon_s, &shown);
	}
	if (done) {
		spread(m.metres, m.count, &out->rms_m, &out->p99_m);
		spread(m.radians, m.count, &out->rms_rad, &out->p99_rad);
		out->lag_s = m.against > 0 ? m.with / m.against : NAN;
	}
	free(m.metres);
	free(m.radians);
	return done;
}

static struct hand_pose resting(const void *ctx, double t)
{
	(void)ctx;
	(void)t;
	return (struct hand_pose){ { 0.3, 1.4, -0.2 }, ROTATION_NONE };
}

struct predict_rest predict_rest(const struct predict_samples *samples,
				 const struct track_filter_params *params)
{
	const struct predict_motion motion = { resting, NULL, REST_S };
	struct predict_error error = { .rms_m = NAN, .rms_rad = NAN };

	predict_measure(&motion, samples, params, 0, &error);
	return (struct predict_rest){ error.rms_m / sqrt(3), error.rms_rad / sqrt(3) };
}
