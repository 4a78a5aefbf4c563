/*
 * Frames of a room in operation: trackers at the photon time, the visitor's
 * wand, settings. Times of trackers and scene are on the master's own scale:
 * 0 when it started, or frame number over rate with the frame clock.
 */
#ifndef GROTTO_DAEMON_LIVE_SOURCE_H
#define GROTTO_DAEMON_LIVE_SOURCE_H

#include "daemon/frame_source.h"
#include "daemon/master_state.h"
#include "daemon/trackers.h"

struct live_source {
	struct frame_source source;
	const struct layout *layout;
	struct trackers *trackers;
	struct master_state scene_state;
	struct master_input input;
	int64_t start_ns; /* zero of the scale, CLOCK_MONOTONIC; the master's to set when it starts */
	int64_t base_ns; /* scene time at zero: what the master before had come to */
	int64_t last_time_ns;
	int64_t polled_ns; /* when the trackers were asked last, CLOCK_MONOTONIC */
	bool frame_clock;
};

/* All are borrowed. */
void live_source_init(struct live_source *live, const struct layout *layout,
		      const struct scene_file *scene, struct trackers *trackers, bool frame_clock);

struct fdp_input;
struct fdp_glance;
/* What was done at a node's window; now_ns: CLOCK_MONOTONIC. */
void live_source_window_input(struct live_source *live, unsigned node, const struct fdp_input *input,
			      int64_t now_ns);

/* What the eye looks at of a node's wall. */
void live_source_glance(struct live_source *live, unsigned node, const struct fdp_glance *glance);
/* A node has left the room. */
void live_source_node_gone(struct live_source *live, unsigned node);

/*
 * Goes on from another master's frame, which was shown at about frame_ns: scene time
 * has gone on since. Frame numbers go on from `last`.
 */
void live_source_adopt(struct live_source *live, const struct param_state *params, uint64_t last,
		       int64_t frame_ns, int64_t now_ns);

#endif
