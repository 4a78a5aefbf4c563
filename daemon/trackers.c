#include "daemon/trackers.h"

#include "base/log.h"
#include "base/result.h"
#include "config/config_text.h"
#include "daemon/tracker_devices.h"
#include "daemon/tracker_filter.h"
#include "tracking/replay.h"
#include "tracking/sim.h"

#include <errno.h>
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

static int open_device(struct tracker *out, const struct layout *layout,
		       const struct layout_tracker *tracker, struct gr_diag *diag)
{
	int r = tracker_device_create(&out->device, layout, tracker, diag);

	return r < 0 ? r : tracker_bindings(out->bindings, layout, tracker, out->device->ops, diag);
}

static int open_one(struct tracker *out, const struct layout *layout,
		    const struct layout_tracker *tracker, struct gr_diag *diag)
{
	out->of = tracker;
	tracker_stats_init(&out->stats);
	switch (tracker->kind) {
	case LAYOUT_TRACKER_SIM: return open_sim(&out->source, layout, tracker, diag);
	case LAYOUT_TRACKER_REPLAY: return open_replay(&out->source, layout, tracker, diag);
	case LAYOUT_TRACKER_WINDOW:
		return track_window_create(&out->source, &layout->start_head, &layout->start_wand);
	default: return open_device(out, layout, tracker, diag);
	}
}

/* What all devices together give of each body, and what is made of it. */
static void init_bodies(struct trackers *trackers)
{
	const struct layout *layout = trackers->layout;
	struct track_filter_params filters[TRACK_BODIES];
	unsigned parts[TRACK_BODIES] = { 0 };

	for (size_t i = 0; i < trackers->count; i++)
		for (size_t k = 0; k < trackers->all[i].of->binding_count; k++)
			parts[trackers->all[i].bindings[k].body] |=
				trackers->all[i].bindings[k].parts;
	track_assembly_init(&trackers->bodies[TRACK_HEAD], &layout->start_head, parts[TRACK_HEAD]);
	track_assembly_init(&trackers->bodies[TRACK_WAND], &layout->start_wand, parts[TRACK_WAND]);
	for (int body = 0; body < TRACK_BODIES; body++)
		filters[body] = tracker_filter_of(layout, (enum track_body)body);
	track_history_init(&trackers->history, filters);
}

int trackers_open(struct trackers *out, const struct layout *layout, struct gr_diag *diag)
{
	int r = GR_OK;

	memset(out, 0, sizeof *out);
	out->layout = layout;
	for (size_t i = 0; i < layout->tracker_count && r >= 0; i++) {
		if (out->count == TRACKERS_MAX) {
			gr_diag_add(diag, GR_DIAG_ERROR, layout->path, layout->trackers[i].line,
				    layout->trackers[i].name, "too many trackers; at most %d",
				    TRACKERS_MAX);
			r = GR_ERR_CONFIG;
			break;
		}
		r = open_one(&out->all[out->count++], layout, &layout->trackers[i], diag);
	}
	if (r < 0)
		trackers_close(out);
	else
		init_bodies(out);
	return r < 0 ? r : GR_OK;
}

int trackers_start(struct trackers *trackers)
{
	for (size_t i = 0; i < trackers->count; i++) {
		struct tracker *t = &trackers->all[i];

		if (t->device && track_device_start(t->device) < 0) {
			gr_error("tracker %s: no thread: %s", t->of->name, strerror(errno));
			return GR_ERR_IO;
		}
	}
	return GR_OK;
}

void trackers_close(struct trackers *trackers)
{
	for (size_t i = 0; i < trackers->count; i++) {
		track_source_destroy(&trackers->all[i].source);
		track_device_destroy(&trackers->all[i].device);
	}
	trackers->count = 0;
}

static void take(struct trackers *trackers, size_t i, const struct track_sample *sample,
		 int64_t now_ns)
{
	struct tracker *t = &trackers->all[i];
	const bool wanted = sample->body == TRACK_HEAD ? t->of->head : t->of->wand;
	const bool taken = wanted && track_history_add(&trackers->history, sample, now_ns) == GR_OK;

	tracker_stats_sample(&t->stats, sample->body, sample->valid);
	t->bodies[sample->body] = (struct tracker_body){ true, *sample, t->stats.heard_ns };
	if (trackers->tap.sample)
		trackers->tap.sample(trackers->tap.ctx, i, sample, taken);
}

static void poll_source(struct trackers *trackers, size_t i, int64_t now_ns, int64_t monotonic_ns)
{
	struct tracker *t = &trackers->all[i];
	struct track_sample samples[POLL_BATCH];

	for (int round = 0; round < POLL_ROUNDS; round++) {
		int n = track_poll(t->source, now_ns, samples, POLL_BATCH);

		for (int k = 0; k < n; k++) {
			tracker_stats_heard(&t->stats, samples[k].body, monotonic_ns);
			take(trackers, i, &samples[k], now_ns);
		}
		if (n < POLL_BATCH)
			break;
	}
}

/* A report of a sensor, to all that is bound to that sensor. */
static void take_report(struct trackers *trackers, size_t i, const struct track_report *report,
			int64_t now_ns)
{
	struct tracker *t = &trackers->all[i];
	struct track_sample sample;

	tracker_stats_heard(&t->stats, report->sensor, report->arrived_ns);
	if (report->has & TRACK_BATTERY)
		t->stats.battery = report->battery;
	for (size_t k = 0; k < t->of->binding_count; k++) {
		struct track_binding *binding = &t->bindings[k];

		if (binding->sensor != report->sensor)
			continue;
		t->sensors[k].reports++;
		t->sensors[k].last = *report;
		if (track_bind(binding, &trackers->bodies[binding->body], report, &sample))
			take(trackers, i, &sample, now_ns);
	}
}

static void poll_device(struct trackers *trackers, size_t i, int64_t now_ns, int64_t monotonic_ns)
{
	struct tracker *t = &trackers->all[i];
	struct track_report reports[POLL_BATCH];

	for (int round = 0; round < POLL_ROUNDS; round++) {
		int n = track_device_take(t->device, &t->reader, reports, POLL_BATCH);

		for (int k = 0; k < n; k++) {
			struct track_report on_scale = reports[k];

			on_scale.time_ns += now_ns - monotonic_ns;
			take_report(trackers, i, &on_scale, now_ns);
		}
		if (n < POLL_BATCH)
			break;
	}
}

void trackers_poll(struct trackers *trackers, int64_t now_ns, int64_t monotonic_ns)
{
	for (size_t i = 0; i < trackers->count; i++) {
		if (trackers->all[i].device)
			poll_device(trackers, i, now_ns, monotonic_ns);
		else
			poll_source(trackers, i, now_ns, monotonic_ns);
		tracker_stats_tick(&trackers->all[i].stats, monotonic_ns);
	}
}

void trackers_window_input(struct trackers *trackers, unsigned node,
			   const struct track_window_input *input, int64_t now_ns)
{
	for (size_t i = 0; i < trackers->count; i++)
		if (trackers->all[i].of->kind == LAYOUT_TRACKER_WINDOW)
			track_window_feed(trackers->all[i].source, node, input, now_ns);
}

/* input: of the wand; a wand that is lost holds no button down. */
static void sample_body(const struct trackers *trackers, enum track_body body, int64_t photon_ns,
			struct master_body *out, struct master_input *input)
{
	struct track_sample sample;
	bool tracked = false;

	if (!track_history_at(&trackers->history, body, photon_ns, TRACKERS_STALE_NS,
			      &sample, &tracked)) {
		out->tracked = false;
		return;
	}
	out->T_room_body = sample.T_room_body;
	out->tracked = tracked;
	if (!input || !tracked)
		return;
	input->buttons = sample.buttons;
	for (uint32_t i = 0; i < sample.axis_count && i < TRACK_AXES; i++)
		input->axes[i] = sample.axes[i];
}

void trackers_sample(const struct trackers *trackers, int64_t photon_ns, struct master_input *input)
{
	input->buttons = 0;
	memset(input->axes, 0, sizeof input->axes);
	sample_body(trackers, TRACK_HEAD, photon_ns, &input->head, NULL);
	sample_body(trackers, TRACK_WAND, photon_ns, &input->wand, input);
}
