/*
 * A wand made of keyboard and mouse, for rooms with windows and no tracker:
 * what persons do at the nodes' windows is handed in, samples come out.
 *
 * The wand is where it is at the start; the pointer turns it (at the window's
 * edge by TRACK_WINDOW_HEADING and TRACK_WINDOW_PITCH), the wheel moves it
 * away from the head and back, by a factor of two every
 * TRACK_WINDOW_NOTCHES. Buttons and axes are those that the window says. While
 * nobody has touched a window the wand is not there.
 */
#ifndef GROTTO_TRACKING_WINDOW_H
#define GROTTO_TRACKING_WINDOW_H

#include "tracking/source.h"

#define TRACK_WINDOWS 64
#define TRACK_WINDOW_HEADING 0.7853982f /* radians */
#define TRACK_WINDOW_PITCH 0.5235988f
#define TRACK_WINDOW_NOTCHES 4.0f
#define TRACK_WINDOW_REACH_LEAST 0.25f /* times the distance at the start */
#define TRACK_WINDOW_REACH_MOST 4.0f
/* A window that says no more what is held holds nothing. */
#define TRACK_WINDOW_SILENT_NS INT64_C(500000000)

struct track_window_input {
	uint32_t buttons;
	float axes[2];    /* -1..1 */
	float pointer[2]; /* -1..1, right and up + */
	float wheel;      /* notches, away from the person + */
};

int track_window_create(struct track_source **out, const struct gr_pose *start_head,
			const struct gr_pose *start_wand);
/* What `window` (below TRACK_WINDOWS) says at now_ns, of the samples' scale. Numbers are in their ranges. */
void track_window_feed(struct track_source *source, unsigned window,
		       const struct track_window_input *input, int64_t now_ns);

#endif
