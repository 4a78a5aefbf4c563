#include "tracking/filter.h"

#include "base/clock.h"
#include "base/result.h"
#include "tracking/filter_private.h"

#include <math.h>
#include <string.h>

static const struct track_filter_ops *const ops[TRACK_FILTER_KINDS] = {
	[TRACK_FILTER_NONE] = &track_fit_ops,
	[TRACK_FILTER_ONE_EURO] = &track_one_euro_ops,
	[TRACK_FILTER_EXPONENTIAL] = &track_exponential_ops,
	[TRACK_FILTER_KALMAN] = &track_kalman_ops,
};

const char *track_filter_name(enum track_filter_kind kind)
{
	static const char *const names[TRACK_FILTER_KINDS] = { "none", "one-euro", "exponential", "kalman" };

	return (unsigned)kind < TRACK_FILTER_KINDS ? names[kind] : "unknown";
}

struct track_filter_params track_filter_defaults(enum track_filter_kind kind)
{
	return (struct track_filter_params){
		.kind = kind,
		.position = { .noise = 0.3e-3, .rest = 1e-7, .move = 5, .cutoff_hz = 1, .beta = 60,
			      .slope_hz = 6, .tau_s = 0.02, .gate = 0.05, .gate_speed = 10 },
		.orientation = { .noise = 0.1 * M_PI / 180, .rest = 1e-6, .move = 100, .cutoff_hz = 1, .beta = 10,
				 .slope_hz = 6, .tau_s = 0.02, .gate = 0.3, .gate_speed = 30 },
		.gate_hold_s = 0.05,
		.ahead_s = 0.06,
		.decay_s = 0.06,
		.gap_s = 0.25,
		.blend_s = 0.2,
	};
}

double track_follow(double dt, double tau_s)
{
	return tau_s > 0 ? -expm1(-dt / tau_s) : 1;
}

void track_filter_init(struct track_filter *f, const struct track_filter_params *params)
{
	*f = (struct track_filter){ .params = *params, .q = ROTATION_NONE };
}

static double seconds(int64_t ns)
{
	return (double)ns * 1e-9;
}

static double length(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* For how many seconds along the velocity, t after the last sample; see the header. */
static double along(const struct track_filter_params *p, double t)
{
	const double over = t - p->ahead_s;

	if (t < -p->ahead_s)
		return -p->ahead_s;
	if (over <= 0)
		return t;
	if (!(p->decay_s > 0))
		return 0;
	return (p->ahead_s + (1 + p->ahead_s / p->decay_s) * over) * exp(-over / p->decay_s);
}

/* Without the blend: where the filter sees the body. */
static void estimate(const struct track_filter *f, int64_t time_ns, double p[3], struct rotation *q)
{
	const double g = along(&f->params, seconds(time_ns - f->time_ns));
	double turn[3];

	for (int i = 0; i < 3; i++) {
		p[i] = f->p[i] + f->v[i] * g;
		turn[i] = f->w[i] * g;
	}
	*q = rotation_by(&f->q, turn);
}

/* How much of the blend is left: 1 to 0 without a jump of the velocity. */
static double blend_left(const struct track_filter *f, int64_t time_ns)
{
	const double t = seconds(time_ns - f->blend_from_ns) / f->params.blend_s;

	if (!f->blending || t >= 1)
		return 0;
	return t <= 0 ? 1 : 1 - t * t * (3 - 2 * t);
}

static void shown(const struct track_filter *f, int64_t time_ns, double p[3], struct rotation *q)
{
	const double left = blend_left(f, time_ns);
	double turn[3];

	estimate(f, time_ns, p, q);
	if (left == 0)
		return;
	for (int i = 0; i < 3; i++) {
		p[i] += left * f->blend_p[i];
		turn[i] = left * f->blend_q[i];
	}
	*q = rotation_by(q, turn);
}

bool track_filter_at(const struct track_filter *f, int64_t time_ns, struct gr_pose *out)
{
	double p[3];
	struct rotation q;

	if (!f->begun)
		return false;
	shown(f, time_ns, p, &q);
	for (int i = 0; i < 3; i++)
		out->p[i] = (float)p[i];
	rotation_to(&q, out->q);
	return true;
}

/* Begins anew at a sample; what was shown goes over to it. */
static void begin(struct track_filter *f, const struct track_seen *seen)
{
	double p[3];
	struct rotation q;

	if (f->begun && f->params.blend_s > 0) {
		shown(f, seen->time_ns, p, &q);
		for (int i = 0; i < 3; i++)
			f->blend_p[i] = p[i] - seen->p[i];
		rotation_between(&seen->q, &q, f->blend_q);
		f->blend_from_ns = seen->time_ns;
		f->blending = true;
	}
	f->restarts += f->begun;
	f->begun = true;
	memcpy(f->p, seen->p, sizeof f->p);
	f->q = seen->q;
	memset(f->v, 0, sizeof f->v);
	memset(f->w, 0, sizeof f->w);
	ops[f->params.kind]->begin(f, seen);
}

static bool within(const struct track_filter_tune *tune, double distance, double dt)
{
	return tune->gate <= 0 || distance <= tune->gate + tune->gate_speed * dt;
}

static bool near(const struct track_filter *f, const struct track_seen *seen, const double p[3],
		 const struct rotation *q, double dt)
{
	double to[3], turn[3];

	for (int i = 0; i < 3; i++)
		to[i] = seen->p[i] - p[i];
	rotation_between(q, &seen->q, turn);
	return within(&f->params.position, length(to), dt) &&
	       within(&f->params.orientation, length(turn), dt);
}

/* A body cannot be there; but when samples go on to say so, it is. */
static bool believed_at_last(struct track_filter *f, const struct track_seen *seen)
{
	const bool agrees = f->refusing && near(f, seen, f->refused_p, &f->refused_q,
						seconds(seen->time_ns - f->refused_ns));

	if (!agrees)
		f->refused_since_ns = seen->time_ns;
	f->refusing = true;
	f->refused_ns = seen->time_ns;
	memcpy(f->refused_p, seen->p, sizeof f->refused_p);
	f->refused_q = seen->q;
	return seconds(seen->time_ns - f->refused_since_ns) >= f->params.gate_hold_s;
}

int track_filter_add(struct track_filter *f, int64_t time_ns, const struct gr_pose *pose)
{
	struct track_seen seen = { .time_ns = time_ns };
	double p[3];
	struct rotation q;

	if (!gr_pose_valid(pose))
		return GR_ERR_FORMAT;
	if (f->begun && time_ns <= f->time_ns)
		return GR_ERR_RANGE;
	for (int i = 0; i < 3; i++)
		seen.p[i] = (double)pose->p[i];
	seen.q = rotation_from(pose->q);
	seen.dt = f->begun ? seconds(time_ns - f->time_ns) : 0;
	if (!f->begun || seen.dt > f->params.gap_s) {
		begin(f, &seen);
	} else {
		estimate(f, time_ns, p, &q);
		if (near(f, &seen, p, &q, seen.dt)) {
			ops[f->params.kind]->step(f, &seen);
		} else if (believed_at_last(f, &seen)) {
			begin(f, &seen);
		} else {
			f->gated++;
			return GR_NOTHING;
		}
	}
	f->refusing = false;
	f->time_ns = time_ns;
	return GR_OK;
}
