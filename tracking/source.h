/*
 * Where head and wand are: samples, the sources that make them up (simulated,
 * replayed; devices come by tracking/device.h and bind.h), and the recent past
 * of each body, which the master asks for the pose at the time at which the
 * frame's photons leave the wall.
 *
 * Frame: room. Times: ns of the master's monotonic clock (or of the frame
 * clock of a demo). Thread: a source is polled by one thread.
 */
#ifndef GROTTO_TRACKING_SOURCE_H
#define GROTTO_TRACKING_SOURCE_H

#include "base/diag.h"
#include "base/pose.h"
#include "tracking/filter.h"
#include "tracking/report.h"

#include <stdbool.h>
#include <stdint.h>

enum track_body { TRACK_HEAD, TRACK_WAND, TRACK_BODIES };

struct track_sample {
	int64_t time_ns; /* when the body was there */
	enum track_body body;
	struct gr_pose T_room_body;
	uint32_t buttons; /* wand only */
	bool valid;       /* false: the device said it lost the body at time_ns */
	bool device_timed;
	int64_t device_ns; /* if so: the same moment by the device's own clock */
	uint32_t axis_count;
	float axes[TRACK_AXES]; /* wand only: -1..1, right and up +; triggers 0..1 */
};

struct track_source;

/* What a driver implements; tracking/sim.c and tracking/replay.c are examples. */
struct track_source_ops {
	const char *kind;
	/*
	 * Delivers samples that are available at `now`, oldest first, at most
	 * `room`; returns how many. Never blocks.
	 */
	int (*poll)(struct track_source *source, int64_t now_ns, struct track_sample *out, int room);
	/* File descriptor to wait on, or -1: poll by time. */
	int (*fd)(const struct track_source *source);
	/* When the next sample will be there (fd == -1), INT64_MAX when never. */
	int64_t (*next)(const struct track_source *source, int64_t now_ns);
	/* Frees the source itself as well. */
	void (*destroy)(struct track_source *source);
};

/* First member of every driver's own struct. */
struct track_source {
	const struct track_source_ops *ops;
};

int track_poll(struct track_source *source, int64_t now_ns, struct track_sample *out, int room);
int track_fd(const struct track_source *source);
int64_t track_next(const struct track_source *source, int64_t now_ns);
/* "head", "wand". Never NULL. */
const char *track_body_name(enum track_body body);
/* *source may be NULL; it is after. */
void track_source_destroy(struct track_source **source);

/*
 * The recent past of each body, filtered. Fixed size, no allocation. A valid
 * sample with a bad pose (GR_ERR_FORMAT), and one of an unknown body, not newer
 * than the last of its body or more than 1 s ahead of now (GR_ERR_RANGE) is
 * dropped and counted. The pose of a sample that is not valid is never read; a
 * run of such samples takes one place. A pose that the filter's gate refuses is
 * replaced by where the body was expected; its buttons count.
 */
#define TRACK_HISTORY 64
struct track_history {
	struct track_sample ring[TRACK_BODIES][TRACK_HISTORY]; /* poses are filtered */
	uint64_t count[TRACK_BODIES]; /* ever stored */
	uint64_t dropped;
	struct track_filter filters[TRACK_BODIES];
};
void track_history_init(struct track_history *history,
			const struct track_filter_params params[TRACK_BODIES]);
int track_history_add(struct track_history *history, const struct track_sample *sample,
		      int64_t now_ns);

/*
 * The pose at time_ns: between two samples mixed, before the oldest held, after
 * the newest as track_filter_at says. Samples that are not valid do not count
 * but for their buttons and axes; these do not mix.
 *
 * False, and *out and *tracked untouched, when the body was never seen.
 * out->valid and *tracked (may be NULL) tell whether the last sample was valid
 * and less than stale_ns older than time_ns.
 */
bool track_history_at(const struct track_history *history, enum track_body body, int64_t time_ns,
		      int64_t stale_ns, struct track_sample *out, bool *tracked);
/* When the body was last seen: the time of its last valid sample. False: never, as far as is known. */
bool track_history_seen(const struct track_history *history, enum track_body body,
			int64_t *time_ns);

#endif
