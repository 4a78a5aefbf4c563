#include "tools/bench/logged.h"

#include "base/result.h"
#include "renderer/image/read_file.h"
#include "tools/bench/stats.h"
#include "tracking/replay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLES_LEAST 10

struct logged {
	size_t count;
	double rate_hz;
	struct logged_sample {
		double t, p[3];
		struct rotation q;
	} sample[];
};

static struct hand_pose at(const void *ctx, double t)
{
	const struct logged *logged = ctx;
	size_t low = 0, high = logged->count;
	const struct logged_sample *a, *b;
	struct hand_pose pose;
	double turn[3], part;

	while (low < high) {
		const size_t middle = (low + high) / 2;

		if (logged->sample[middle].t <= t)
			low = middle + 1;
		else
			high = middle;
	}
	a = &logged->sample[low > 0 ? low - 1 : 0];
	b = &logged->sample[low < logged->count ? low : logged->count - 1];
	part = b->t > a->t ? fmax((t - a->t) / (b->t - a->t), 0) : 0;
	rotation_between(&a->q, &b->q, turn);
	for (int i = 0; i < 3; i++) {
		pose.p[i] = a->p[i] + part * (b->p[i] - a->p[i]);
		turn[i] *= part;
	}
	pose.q = rotation_by(&a->q, turn);
	return pose;
}

static bool rate_of(struct logged *logged)
{
	double *gaps = malloc(logged->count * sizeof *gaps);

	if (!gaps)
		return false;
	for (size_t i = 1; i < logged->count; i++)
		gaps[i - 1] = logged->sample[i].t - logged->sample[i - 1].t;
	logged->rate_hz = 1 / stats_spread(gaps, logged->count - 1).median;
	free(gaps);
	return true;
}

static int build(struct logged **out, const struct track_sample *samples, size_t count,
		 enum track_body body, const char *path, struct gr_diag *diag)
{
	struct logged *logged = calloc(1, sizeof *logged + count * sizeof *logged->sample);

	if (!logged)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < count; i++) {
		struct logged_sample *to = &logged->sample[logged->count];

		if (samples[i].body != body || !samples[i].valid)
			continue;
		to->t = (double)samples[i].time_ns * 1e-9;
		for (int k = 0; k < 3; k++)
			to->p[k] = (double)samples[i].T_room_body.p[k];
		to->q = rotation_from(samples[i].T_room_body.q);
		logged->count++;
	}
	if (logged->count < SAMPLES_LEAST) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "has %zu good samples of the %s; it takes %d",
			    logged->count, track_body_name(body), SAMPLES_LEAST);
		free(logged);
		return GR_ERR_CONFIG;
	}
	if (!rate_of(logged)) {
		free(logged);
		return GR_ERR_NOMEM;
	}
	*out = logged;
	return GR_OK;
}

int logged_open(struct logged **out, const char *path, enum track_body body, struct gr_diag *diag)
{
	struct track_sample *samples;
	uint8_t *bytes;
	size_t len, count;
	int result = read_file(path, TRACK_REPLAY_MAX_BYTES, &bytes, &len, diag, "log");

	if (result != GR_OK)
		return result;
	result = track_replay_parse((const char *)bytes, len, path, &samples, &count, diag);
	free(bytes);
	if (result != GR_OK)
		return result == GR_ERR_FORMAT ? GR_ERR_CONFIG : result;
	result = build(out, samples, count, body, path, diag);
	free(samples);
	return result;
}

void logged_destroy(struct logged **logged)
{
	free(*logged);
	*logged = NULL;
}

struct predict_motion logged_motion(const struct logged *logged)
{
	return (struct predict_motion){ at, logged, logged->sample[logged->count - 1].t };
}

double logged_rate_hz(const struct logged *logged)
{
	return logged->rate_hz;
}
