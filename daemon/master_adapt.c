#include "daemon/master_adapt.h"

#include "base/result.h"

#include <math.h>
#include <string.h>

/* The white point follows the brightest so, in log luminance, that a lamp that comes into view is no flash. */
#define MAX_S 0.5
/* A node's cone may hold no more than the whole of it, but for the cells on its edge. */
#define CONE_SR_MOST 0.05

void master_adapt_init(struct master_adapt *adapt, const struct scene_tone *tone)
{
	*adapt = (struct master_adapt){
		.on = tone->adapt != SCENE_ADAPT_FIXED,
		.params = {
			.model = tone->adapt == SCENE_ADAPT_EXPONENTIAL ? ADAPT_EXPONENTIAL : ADAPT_PATTANAIK,
			.time_s = (double)tone->adapt_s,
		},
		.max = (double)tone->luminance_max,
		.set_level = tone->adaptation,
	};
	/* Cannot fail: a level of the scene file is above 0. */
	(void)adapt_settle(&adapt->eye, (double)tone->adaptation);
}

void master_adapt_adopt(struct master_adapt *adapt, const struct param_state *params)
{
	const float *level = param_f32(params, PARAM_ADAPTATION), *pigment = param_f32(params, PARAM_PIGMENT);

	adapt->eye = (struct adapt_state){ (double)level[0], (double)level[1], (double)pigment[0],
					   (double)pigment[1] };
	adapt->max = (double)*param_f32(params, PARAM_LUMINANCE_MAX);
	/* What master_settings_read takes for what was set. */
	adapt->set_level = level[0];
	adapt->goal = adapt->max_goal = 0;
}

int master_adapt_take(struct master_adapt *adapt, unsigned node, const struct adapt_sample *sample)
{
	const double sr = sample->solid_angle, mean = sr > 0 ? sample->log_sum / sr : 0;

	/* NaN is in no range. */
	if (node >= FDP_MAX_NODES || !(sr >= 0 && sr <= CONE_SR_MOST) ||
	    !(sample->max >= 0 && sample->max <= ADAPT_LEVEL_MAX * 1.01) || (sr == 0 && sample->log_sum != 0) ||
	    !(mean >= log(ADAPT_LEVEL_MIN) - 0.1 && mean <= log(ADAPT_LEVEL_MAX) + 0.1))
		return GR_ERR_RANGE;
	adapt->samples[node] = *sample;
	return GR_OK;
}

void master_adapt_forget(struct master_adapt *adapt, unsigned node)
{
	if (node < FDP_MAX_NODES)
		adapt->samples[node] = (struct adapt_sample){ 0 };
}

static void step_max(struct master_adapt *adapt, double dt_s)
{
	if (!(adapt->max_goal > 0))
		return;
	adapt->max = exp(log(adapt->max_goal) + (log(adapt->max) - log(adapt->max_goal)) * exp(-dt_s / MAX_S));
}

void master_adapt_step(struct master_adapt *adapt, float level, int64_t dt_ns)
{
	const double dt_s = dt_ns > 0 ? (double)dt_ns * 1e-9 : 0;
	double goal, max;

	if (!adapt->on)
		return;
	if (level != adapt->set_level) {
		adapt->set_level = level;
		(void)adapt_settle(&adapt->eye, (double)level);
	}
	if (adapt_merge(adapt->samples, FDP_MAX_NODES, &goal, &max) == GR_OK) {
		adapt->goal = goal;
		/* White is never darker than what the eye is used to. */
		adapt->max_goal = fmax(max, goal);
	}
	if (adapt->goal > 0)
		(void)adapt_step(&adapt->eye, &adapt->params, adapt->goal, dt_s);
	step_max(adapt, dt_s);
}

/* Within the parameter's range, which is wider than the levels'. */
static float within(enum param_id id, double value)
{
	const struct param_info *info = param_info(id);

	return (float)fmin(fmax(value, info->min), info->max);
}

int master_adapt_apply(const struct master_adapt *adapt, struct param_state *params, uint64_t frame)
{
	const float levels[2] = { within(PARAM_ADAPTATION, adapt->eye.cone),
				  within(PARAM_ADAPTATION, adapt->eye.rod) };
	const float pigment[2] = { (float)adapt->eye.cone_pigment, (float)adapt->eye.rod_pigment };
	const float max = within(PARAM_LUMINANCE_MAX, adapt->max);
	int r;

	if (!adapt->on)
		return GR_OK;
	r = param_set(params, PARAM_ADAPTATION, levels, frame);
	if (r >= 0)
		r = param_set(params, PARAM_PIGMENT, pigment, frame);
	if (r >= 0)
		r = param_set(params, PARAM_LUMINANCE_MAX, &max, frame);
	return r < 0 ? r : GR_OK;
}
