#include "daemon/trackers.h"

#include "base/result.h"
#include "config/config_text.h"
#include "tracking/replay.h"
#include "tracking/sim.h"

#include <stdlib.h>
#include <string.h>

#define POLL_BATCH 32
#define POLL_ROUNDS 64 /* a source that never runs dry must not stop the frame */

static int open_sim(struct track_source **out, const struct layout *layout,
		    const struct layout_tracker *tracker, struct gr_diag *diag)
{
	struct track_sim_params params = {
		.start_head = layout->start_head,
		.start_wand = layout->start_wand,
		.rate_hz = tracker->sim.rate_hz,
		.noise_position_m = tracker->sim.noise_position_m,
		.noise_angle_rad = tracker->sim.noise_angle_rad,
		.latency_ns = tracker->sim.latency_ns,
		.dropout_per_s = tracker->sim.dropout_per_s,
		.dropout_ns = tracker->sim.dropout_ns,
		.seed = tracker->sim.seed,
		.walk_radius_m = tracker->sim.walk_radius_m,
		.walk_speed_m_s = tracker->sim.walk_speed_m_s,
		.head = tracker->head,
		.wand = tracker->wand,
	};

	memcpy(params.room_min, layout->room_min, sizeof params.room_min);
	memcpy(params.room_max, layout->room_max, sizeof params.room_max);
	return track_sim_create(out, &params, diag);
}

static int open_replay(struct track_source **out, const struct layout *layout,
		       const struct layout_tracker *tracker, struct gr_diag *diag)
{
	char *path = config_text_beside(layout->path, tracker->file);
	int r = path ? track_replay_create(out, path, tracker->loop, diag) : GR_ERR_NOMEM;

	free(path);
	return r;
}

int trackers_open(struct trackers *out, const struct layout *layout, struct gr_diag *diag)
{
	memset(out, 0, sizeof *out);
	out->layout = layout;
	track_history_init(&out->history);
	for (size_t i = 0; i < layout->tracker_count; i++) {
		const struct layout_tracker *tracker = &layout->trackers[i];
		int r;

		if (out->count == TRACKERS_MAX) {
			gr_diag_add(diag, GR_DIAG_ERROR, layout->path, tracker->line, tracker->name,
				    "too many trackers; at most %d", TRACKERS_MAX);
			trackers_close(out);
			return GR_ERR_CONFIG;
		}
		r = tracker->kind == LAYOUT_TRACKER_SIM ?
			    open_sim(&out->sources[out->count], layout, tracker, diag) :
			    open_replay(&out->sources[out->count], layout, tracker, diag);
		if (r < 0) {
			trackers_close(out);
			return r;
		}
		out->of[out->count++] = tracker;
	}
	return GR_OK;
}

void trackers_close(struct trackers *trackers)
{
	for (size_t i = 0; i < trackers->count; i++)
		track_source_destroy(&trackers->sources[i]);
	trackers->count = 0;
}

static void take(struct trackers *trackers, size_t i, const struct track_sample *sample,
		 int64_t now_ns)
{
	const struct layout_tracker *tracker = trackers->of[i];
	const bool wanted = sample->body == TRACK_HEAD ? tracker->head : tracker->wand;
	const bool taken = wanted && track_history_add(&trackers->history, sample, now_ns) == GR_OK;

	if (trackers->tap.sample)
		trackers->tap.sample(trackers->tap.ctx, i, sample, taken);
}

void trackers_poll(struct trackers *trackers, int64_t now_ns)
{
	struct track_sample samples[POLL_BATCH];

	for (size_t i = 0; i < trackers->count; i++) {
		for (int round = 0; round < POLL_ROUNDS; round++) {
			int n = track_poll(trackers->sources[i], now_ns, samples, POLL_BATCH);
			for (int k = 0; k < n; k++)
				take(trackers, i, &samples[k], now_ns);
			if (n < POLL_BATCH)
				break;
		}
	}
}

static void sample_body(const struct trackers *trackers, enum track_body body, int64_t photon_ns,
			struct master_body *out, uint32_t *buttons)
{
	struct track_sample sample;
	bool tracked = false;

	if (!track_history_at(&trackers->history, body, photon_ns, TRACKERS_AHEAD_NS,
			      TRACKERS_STALE_NS, &sample, &tracked)) {
		out->tracked = false;
		return;
	}
	out->T_room_body = sample.T_room_body;
	out->tracked = tracked;
	/* A wand that is lost holds no button down. */
	if (buttons)
		*buttons = tracked ? sample.buttons : 0;
}

void trackers_sample(const struct trackers *trackers, int64_t photon_ns,
		     struct master_input *input)
{
	sample_body(trackers, TRACK_HEAD, photon_ns, &input->head, NULL);
	sample_body(trackers, TRACK_WAND, photon_ns, &input->wand, &input->buttons);
}
