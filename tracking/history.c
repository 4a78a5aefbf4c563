#include "tracking/source.h"

#include "base/clock.h"
#include "base/result.h"

#include <math.h>
#include <string.h>

/*
 * The velocity is a straight line fitted through this much of the past: the
 * difference of the last two samples of a 1 kHz tracker with 1 mm of noise
 * would say 1.4 m/s of somebody who stands still.
 */
#define FIT_NS (50 * GR_NS_PER_MS)

static const struct track_sample *nth_last(const struct track_history *h, enum track_body body,
					   uint64_t back)
{
	return &h->ring[body][(h->count[body] - 1 - back) % TRACK_HISTORY];
}

static uint64_t kept(const struct track_history *h, enum track_body body)
{
	return h->count[body] < TRACK_HISTORY ? h->count[body] : TRACK_HISTORY;
}

void track_history_init(struct track_history *history)
{
	memset(history, 0, sizeof *history);
}

static int refusal(const struct track_history *h, const struct track_sample *sample, int64_t now_ns)
{
	if ((unsigned)sample->body >= TRACK_BODIES)
		return GR_ERR_RANGE;
	if (sample->valid && !gr_pose_valid(&sample->T_room_body))
		return GR_ERR_FORMAT;
	if (sample->time_ns > now_ns && sample->time_ns - now_ns > GR_NS_PER_S)
		return GR_ERR_RANGE;
	if (h->count[sample->body] && sample->time_ns <= nth_last(h, sample->body, 0)->time_ns)
		return GR_ERR_RANGE;
	return GR_OK;
}

int track_history_add(struct track_history *history, const struct track_sample *sample,
		      int64_t now_ns)
{
	int result = refusal(history, sample, now_ns);
	struct track_sample kept_sample = *sample;
	enum track_body body = sample->body;

	if (result != GR_OK) {
		history->dropped++;
		return result;
	}
	if (sample->valid)
		glm_quat_normalize(kept_sample.T_room_body.q);
	else
		kept_sample.T_room_body = GR_POSE_IDENTITY; /* says nothing, is never read */
	/* A long drop-out takes one place, or it would push out the last good samples. */
	if (!sample->valid && history->count[body] && !nth_last(history, body, 0)->valid)
		history->count[body]--;
	history->ring[body][history->count[body]++ % TRACK_HISTORY] = kept_sample;
	return GR_OK;
}

/* The turn from a to b as a rotation vector in a's frame, along the shorter arc. */
static void turn_between(const versor a, const versor b, vec3 out)
{
	versor inverse = { -a[0], -a[1], -a[2], a[3] };
	versor qb = { b[0], b[1], b[2], b[3] };
	versor d;
	float sine, scale;

	glm_quat_mul(inverse, qb, d);
	sine = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
	/* 2 atan2(s, w) / s tends to 2 / w; the sign of w picks the shorter arc. */
	if (sine < 1e-6f)
		scale = d[3] < 0 ? -2.0f : 2.0f;
	else
		scale = 2.0f * (d[3] < 0 ? atan2f(-sine, -d[3]) : atan2f(sine, d[3])) / sine;
	for (int i = 0; i < 3; i++)
		out[i] = d[i] * scale;
}

static void turn_by(const versor q, const vec3 turn, versor out)
{
	float angle = sqrtf(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
	float scale = angle < 1e-6f ? 0.5f : sinf(angle * 0.5f) / angle;
	versor d = { turn[0] * scale, turn[1] * scale, turn[2] * scale, cosf(angle * 0.5f) };
	versor from = { q[0], q[1], q[2], q[3] };

	glm_quat_mul(from, d, out);
	glm_quat_normalize(out);
}

/*
 * Velocity by least squares: slope of position and of turn relative to `last`
 * over the valid samples of the last FIT_NS, at least two of them. False when
 * there is only one.
 */
static bool velocity(const struct track_history *h, enum track_body body,
		     const struct track_sample *last, vec3 out_linear, vec3 out_angular)
{
	double n = 0, st = 0, stt = 0, sx[6] = { 0 }, stx[6] = { 0 };
	double spread;

	for (uint64_t back = 0; back < kept(h, body); back++) {
		const struct track_sample *s = nth_last(h, body, back);
		double t = (double)(s->time_ns - last->time_ns) * 1e-9;
		vec3 turn;

		if (!s->valid)
			continue;
		if (n >= 2 && last->time_ns - s->time_ns > FIT_NS)
			break;
		turn_between(last->T_room_body.q, s->T_room_body.q, turn);
		n += 1;
		st += t;
		stt += t * t;
		for (int i = 0; i < 6; i++) {
			double x = i < 3 ? (double)s->T_room_body.p[i] - last->T_room_body.p[i] :
					   turn[i - 3];
			sx[i] += x;
			stx[i] += t * x;
		}
	}
	spread = n * stt - st * st;
	if (n < 2 || !(spread > 0))
		return false;
	for (int i = 0; i < 3; i++) {
		out_linear[i] = (float)((n * stx[i] - st * sx[i]) / spread);
		out_angular[i] = (float)((n * stx[i + 3] - st * sx[i + 3]) / spread);
	}
	return true;
}

static void extrapolate(const struct track_history *h, enum track_body body,
			const struct track_sample *last, int64_t ahead_ns, struct gr_pose *out)
{
	float ahead_s = (float)((double)ahead_ns * 1e-9);
	vec3 linear, angular;

	*out = last->T_room_body;
	if (ahead_ns <= 0 || !velocity(h, body, last, linear, angular))
		return;
	for (int i = 0; i < 3; i++) {
		out->p[i] += linear[i] * ahead_s;
		angular[i] *= ahead_s;
	}
	turn_by(last->T_room_body.q, angular, out->q);
}

/* Buttons and axes do not mix: the newest at or before time_ns, lost pose or not. */
static const struct track_sample *input_at(const struct track_history *h, enum track_body body,
					   int64_t time_ns)
{
	const struct track_sample *s = nth_last(h, body, 0);

	for (uint64_t back = 0; back < kept(h, body); back++) {
		s = nth_last(h, body, back);
		if (s->time_ns <= time_ns)
			break;
	}
	return s;
}

bool track_history_at(const struct track_history *history, enum track_body body, int64_t time_ns,
		      int64_t max_ahead_ns, int64_t stale_ns, struct track_sample *out,
		      bool *tracked)
{
	const struct track_sample *after = NULL, *before = NULL, *last, *input;
	struct gr_pose pose;
	bool seen;

	/* The valid samples on both sides of time_ns; `after` ends as the oldest later one. */
	for (uint64_t back = 0; back < kept(history, body) && !before; back++) {
		const struct track_sample *s = nth_last(history, body, back);

		if (!s->valid)
			continue;
		if (s->time_ns <= time_ns)
			before = s;
		else
			after = s;
	}
	if (!before && !after)
		return false;
	if (before && after) {
		double part = (double)(time_ns - before->time_ns) /
			      (double)(after->time_ns - before->time_ns);
		gr_pose_mix(&before->T_room_body, &after->T_room_body, (float)part, &pose);
	} else if (before) {
		int64_t ahead = time_ns - before->time_ns;
		extrapolate(history, body, before, ahead < max_ahead_ns ? ahead : max_ahead_ns, &pose);
	} else {
		pose = after->T_room_body;
	}
	last = nth_last(history, body, 0);
	seen = last->valid && time_ns - last->time_ns < stale_ns;
	input = input_at(history, body, time_ns);
	*out = (struct track_sample){
		.time_ns = time_ns,
		.body = body,
		.T_room_body = pose,
		.buttons = input->buttons,
		.valid = seen,
		.axis_count = input->axis_count,
	};
	memcpy(out->axes, input->axes, sizeof out->axes);
	if (tracked)
		*tracked = seen;
	return true;
}

bool track_history_seen(const struct track_history *history, enum track_body body, int64_t *time_ns)
{
	for (uint64_t back = 0; back < kept(history, body); back++) {
		const struct track_sample *sample = nth_last(history, body, back);

		if (!sample->valid)
			continue;
		*time_ns = sample->time_ns;
		return true;
	}
	return false;
}
