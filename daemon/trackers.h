/*
 * The layout's trackers behind one question: where are head and wand at the
 * time at which the frame's light leaves the walls.
 *
 * Times are of the master's own scale: 0 when it started (or frame numbers
 * over the frame rate, with the frame clock), so that a simulated or replayed
 * visitor begins at the beginning. Nothing is allocated after opening.
 */
#ifndef GROTTO_DAEMON_TRACKERS_H
#define GROTTO_DAEMON_TRACKERS_H

#include "config/layout.h"
#include "daemon/master_state.h"
#include "daemon/tracker_stats.h"
#include "tracking/bind.h"
#include "tracking/device.h"
#include "tracking/source.h"
#include "tracking/window.h"

#define TRACKERS_MAX 8
#define TRACKERS_STALE_NS (500 * INT64_C(1000000)) /* older than this: not tracked */

struct json; /* daemon/json.h, whose names are those of json-c, too */

/* Told of every sample, as it came; taken: the history has it. */
struct trackers_tap {
	void (*sample)(void *ctx, size_t tracker, const struct track_sample *sample, bool taken);
	void *ctx;
};

/* One tracker of the layout: a source of samples, or a device with bindings. */
struct tracker {
	const struct layout_tracker *of;
	struct track_source *source;
	struct track_device *device;
	struct track_reader reader;
	struct track_binding bindings[LAYOUT_MAX_BINDINGS];
	struct tracker_stats stats;
	struct tracker_body {
		bool said;
		struct track_sample last; /* as it came, used or not */
		int64_t arrived_ns;	  /* CLOCK_MONOTONIC */
	} bodies[TRACK_BODIES];
	/* What the sensor of each binding said last, in the device's own frame. */
	struct tracker_sensor {
		uint64_t reports;
		struct track_report last;
	} sensors[LAYOUT_MAX_BINDINGS];
};

struct trackers {
	const struct layout *layout;
	struct trackers_tap tap; /* sample may be NULL */
	struct tracker all[TRACKERS_MAX];
	size_t count;
	struct track_assembly bodies[TRACK_BODIES];
	struct track_history history;
};

/*
 * Checks and makes ready; opens no device. Faults go to diag. The layout must
 * outlive the trackers.
 */
int trackers_open(struct trackers *out, const struct layout *layout, struct gr_diag *diag);
/* Starts the devices' threads: after privileges were given up, so that they open as whom they run.
 */
int trackers_start(struct trackers *trackers);
void trackers_close(struct trackers *trackers);
/*
 * Takes what the devices have at now_ns, which is monotonic_ns on
 * CLOCK_MONOTONIC. Never blocks.
 */
void trackers_poll(struct trackers *trackers, int64_t now_ns, int64_t monotonic_ns);
/* What is done at a node's window, for the layout's tracker of that kind; without one nothing. */
void trackers_window_input(struct trackers *trackers, unsigned node,
			   const struct track_window_input *input, int64_t now_ns);
/* Head, wand, its buttons and axes at photon_ns into `input`; a body never seen keeps its pose there. */
void trackers_sample(const struct trackers *trackers, int64_t photon_ns,
		     struct master_input *input);
/*
 * An array: for each tracker its state, rate, age, drop-outs, faults; with
 * `poses` what it said last of each body, and of each sensor, too. And one, "filters", of head and
 * wand: samples that the gate refused, times begun anew.
 */
void trackers_write_json(const struct trackers *trackers, struct json *json, const char *key,
			 int64_t monotonic_ns, bool poses);
/* An object of a whole answer: "ok" and the array "trackers". GR_OK, GR_ERR_RANGE (too long). */
int trackers_answer(const struct trackers *trackers, int64_t monotonic_ns, char *text, size_t size,
		    size_t *out_len);

#endif
