#include "renderer/tone/adapt.h"

#include "base/result.h"

#include <math.h>

/* Neural time constants, s; and of the pigments the time and the half-bleaching level, s and cd/m^2. */
#define CONE_NEURAL_S 0.080
#define ROD_NEURAL_S 0.150
#define CONE_PIGMENT_S 110.0
#define ROD_PIGMENT_S 400.0
#define CONE_PIGMENT_HALF 2e6
#define ROD_PIGMENT_HALF 0.04

static double level_of(double luminance)
{
	return fmin(fmax(luminance, ADAPT_LEVEL_MIN), ADAPT_LEVEL_MAX);
}

/*
 * Where one is after that many time constants on the way. Measured from the end that
 * is nearer, so that neither a short step nor a long one loses the smaller of the two.
 */
static double towards(double from, double to, double times)
{
	return times < 1 ? from - (to - from) * expm1(-times) : to + (from - to) * exp(-times);
}

static double settled_pigment(double level, double half)
{
	return half / (half + level);
}

int adapt_settle(struct adapt_state *state, double level)
{
	if (!(level >= 0))
		return GR_ERR_RANGE;
	level = level_of(level);
	*state = (struct adapt_state){
		.cone = level,
		.rod = level,
		.cone_pigment = settled_pigment(level, CONE_PIGMENT_HALF),
		.rod_pigment = settled_pigment(level, ROD_PIGMENT_HALF),
	};
	return GR_OK;
}

static double step_pigment(double now, double level, double half, double time_s, double dt_s)
{
	return towards(now, settled_pigment(level, half), dt_s / time_s * (1 + level / half));
}

int adapt_step(struct adapt_state *state, const struct adapt_params *params, double goal,
	       double dt_s)
{
	if (!(goal >= 0) || !(dt_s >= 0))
		return GR_ERR_RANGE;
	goal = level_of(goal);
	if (params->model == ADAPT_EXPONENTIAL) {
		const double log_level = towards(log(state->cone), log(goal), dt_s / params->time_s);

		return adapt_settle(state, exp(log_level));
	}
	state->cone = towards(state->cone, goal, dt_s / CONE_NEURAL_S);
	state->rod = towards(state->rod, goal, dt_s / ROD_NEURAL_S);
	state->cone_pigment = step_pigment(state->cone_pigment, goal, CONE_PIGMENT_HALF,
					   CONE_PIGMENT_S, dt_s);
	state->rod_pigment = step_pigment(state->rod_pigment, goal, ROD_PIGMENT_HALF, ROD_PIGMENT_S,
					  dt_s);
	return GR_OK;
}

int adapt_sample_add(struct adapt_sample *sample, double luminance, double solid_angle)
{
	if (!isfinite(luminance) || !(solid_angle > 0) || !isfinite(solid_angle))
		return GR_NOTHING;
	sample->log_sum += solid_angle * log(level_of(luminance));
	sample->max = fmax(sample->max, luminance);
	sample->solid_angle += solid_angle;
	return GR_OK;
}

int adapt_merge(const struct adapt_sample *samples, size_t count, double *goal, double *max)
{
	double sum = 0, most = 0, solid_angle = 0;

	for (size_t i = 0; i < count; i++) {
		if (!isfinite(samples[i].max))
			return GR_NOTHING;
		sum += samples[i].log_sum;
		most = fmax(most, samples[i].max);
		solid_angle += samples[i].solid_angle;
	}
	if (!(solid_angle > 0) || !isfinite(sum / solid_angle))
		return GR_NOTHING;
	*goal = level_of(exp(sum / solid_angle));
	*max = most;
	return GR_OK;
}
