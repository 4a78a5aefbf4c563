#include "tracking/source.h"

#include "base/clock.h"
#include "base/result.h"

#include <string.h>

static const struct track_sample *nth_last(const struct track_history *h, enum track_body body,
					   uint64_t back)
{
	return &h->ring[body][(h->count[body] - 1 - back) % TRACK_HISTORY];
}

static uint64_t kept(const struct track_history *h, enum track_body body)
{
	return h->count[body] < TRACK_HISTORY ? h->count[body] : TRACK_HISTORY;
}

void track_history_init(struct track_history *history,
			const struct track_filter_params params[TRACK_BODIES])
{
	memset(history, 0, sizeof *history);
	for (int body = 0; body < TRACK_BODIES; body++)
		track_filter_init(&history->filters[body], &params[body]);
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
	if (sample->valid) {
		/* refused by the gate: where the body was expected */
		(void)track_filter_add(&history->filters[body], sample->time_ns, &sample->T_room_body);
		(void)track_filter_at(&history->filters[body], sample->time_ns,
				      &kept_sample.T_room_body);
	} else {
		kept_sample.T_room_body = GR_POSE_IDENTITY; /* says nothing, is never read */
	}
	/* A long drop-out takes one place, or it would push out the last good samples. */
	if (!sample->valid && history->count[body] && !nth_last(history, body, 0)->valid)
		history->count[body]--;
	history->ring[body][history->count[body]++ % TRACK_HISTORY] = kept_sample;
	return GR_OK;
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
		      int64_t stale_ns, struct track_sample *out, bool *tracked)
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
		(void)track_filter_at(&history->filters[body], time_ns, &pose);
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
