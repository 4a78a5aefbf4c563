/*
 * From what the master knows (scene file, layout, tracked bodies, settings,
 * time) to the parameters of a frame. Pure: time and poses are handed in.
 *
 * The wand: while button 0 is held the room flies along the wand's direction
 * at v = 1.4 m/s (d / 0.4 m)^2.5, d the horizontal distance of wand and head
 * (seed 004, "User Interaction": an arm's length of 0.4 m is walking speed);
 * button 1 switches the lamps that the wand carries; button 2 takes the room
 * back to where the scene file put it.
 */
#ifndef GROTTO_DAEMON_MASTER_STATE_H
#define GROTTO_DAEMON_MASTER_STATE_H

#include "config/layout.h"
#include "config/scene_file.h"
#include "daemon/master_settings.h"
#include "protocol/params.h"

#define MASTER_BUTTON_FLY 1u
#define MASTER_BUTTON_TORCH 2u
#define MASTER_BUTTON_RESET 4u
#define MASTER_TRACK_HEAD 1u
#define MASTER_TRACK_WAND 2u

/* A body at the photon time; what a tracker never saw is at the layout's start pose. */
struct master_body {
	struct gr_pose T_room_body;
	bool tracked;
};

struct master_input {
	int64_t time_ns; /* scene time of the frame, >= 0 */
	int64_t step_ns; /* since the frame before, for navigation */
	struct master_body head, wand;
	uint32_t buttons;
};

struct master_state {
	const struct layout *layout;
	const struct scene_file *scene;
	struct master_settings settings;
	struct gr_pose T_scene_room;
	uint32_t buttons; /* of the frame before */
	uint64_t epoch;   /* GI_EPOCH: frame number of the last restart of the light */
};

/* layout and scene must outlive the state. */
void master_state_init(struct master_state *state, const struct layout *layout,
		       const struct scene_file *scene);
/* Goes on from the parameters of another master's frame. */
void master_state_adopt(struct master_state *state, const struct param_state *params);
/* The input before any tracker speaks. */
void master_state_start_input(const struct master_state *state, struct master_input *input);

/* Walking speed in m/s for a wand this far from the head, metres; at most that of 1 m. */
float master_fly_speed(float distance_m);

/* Where a lamp of the scene file is at `time_ns`; out in the scene frame. */
void master_lamp_place(const struct scene_lamp *lamp, const struct gr_pose *T_scene_head,
		       const struct gr_pose *T_scene_wand, int64_t time_ns, vec3 position,
		       vec3 direction);

/*
 * Sets all parameters of `frame`. restart_light: the light begins at its
 * steady state on every node (GI_EPOCH). GR_OK; GR_ERR_RANGE when a value is
 * outside its parameter's range: that parameter keeps its old value and
 * *refused names it.
 */
int master_state_frame(struct master_state *state, const struct master_input *input,
		       bool restart_light, struct param_state *params, uint64_t frame,
		       const char **refused);

#endif
