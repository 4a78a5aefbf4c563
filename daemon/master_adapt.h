/*
 * The room's eye: from what its walls say is looked at (renderer/tone/gaze.h) to what the
 * eye is used to, the same on all walls in the same frame (seed 003 section 5.4). A wall
 * that says nothing new counts with what it said last; while nothing at all is looked at,
 * between walls, behind the room, the eye goes on towards what it saw last.
 *
 * Pure: time is handed in. Scene time, so that a room that stands still keeps its eye.
 */
#ifndef GROTTO_DAEMON_MASTER_ADAPT_H
#define GROTTO_DAEMON_MASTER_ADAPT_H

#include "config/scene_file.h"
#include "protocol/master.h"
#include "protocol/params.h"
#include "renderer/tone/adapt.h"

struct master_adapt {
	bool on;	    /* the scene's eye gets used to what it sees */
	struct adapt_params params;
	struct adapt_state eye;
	double goal;        /* cd/m^2; 0: nothing has been seen yet */
	double max, max_goal; /* what Drago's curve makes white, cd/m^2; max_goal 0 like goal */
	float set_level;    /* adaptation, as last set by a person */
	struct adapt_sample samples[FDP_MAX_NODES]; /* of nodes, the last; all 0: none */
};

void master_adapt_init(struct master_adapt *adapt, const struct scene_tone *tone);
/* Goes on with the eye of another master's frame. */
void master_adapt_adopt(struct master_adapt *adapt, const struct param_state *params);
/* A wall has said so. What is not finite, or is no sum of levels, changes nothing: GR_ERR_RANGE. */
int master_adapt_take(struct master_adapt *adapt, unsigned node, const struct adapt_sample *sample);
/* It is out of the room; what it said counts no more. */
void master_adapt_forget(struct master_adapt *adapt, unsigned node);
/*
 * dt_ns of the room's time, none below 0. `level` is the setting: when a person
 * changes it the eye is used to that at once, and goes on from there.
 */
void master_adapt_step(struct master_adapt *adapt, float level, int64_t dt_ns);
/* ADAPTATION, PIGMENT and LUMINANCE_MAX of the frame, over what the settings say. GR_OK, GR_ERR_RANGE. */
int master_adapt_apply(const struct master_adapt *adapt, struct param_state *params, uint64_t frame);

#endif
