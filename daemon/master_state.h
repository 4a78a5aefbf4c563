/*
 * From what the master knows (scene file, layout, tracked bodies, settings,
 * time) to the parameters of a frame. Pure: time and poses are handed in. What
 * the wand's buttons and axes do is hand.h's.
 */
#ifndef GROTTO_DAEMON_MASTER_STATE_H
#define GROTTO_DAEMON_MASTER_STATE_H

#include "config/layout.h"
#include "config/scene_file.h"
#include "daemon/hand.h"
#include "daemon/master_adapt.h"
#include "daemon/master_input.h"
#include "daemon/master_settings.h"
#include "protocol/params.h"

#define MASTER_TRACK_HEAD 1u
#define MASTER_TRACK_WAND 2u

struct master_state {
	const struct layout *layout;
	const struct scene_file *scene;
	struct master_settings settings;
	struct gr_pose T_scene_room;
	struct hand hand;
	struct master_adapt adapt;
	uint64_t epoch;   /* GI_EPOCH: frame number of the last restart of the light */
};

/* layout and scene must outlive the state. */
void master_state_init(struct master_state *state, const struct layout *layout,
		       const struct scene_file *scene);
/* Goes on from the parameters of another master's frame. */
void master_state_adopt(struct master_state *state, const struct param_state *params);
/* The input before any tracker speaks. */
void master_state_start_input(const struct master_state *state, struct master_input *input);

/* Where a lamp of the scene file is at `time_ns`; out in the scene frame. */
void master_lamp_place(const struct scene_lamp *lamp, const struct gr_pose *T_scene_head,
		       const struct gr_pose *T_scene_wand, int64_t time_ns, vec3 position,
		       vec3 direction);

/*
 * Sets all parameters of `frame`. Input that the hand refuses changes nothing
 * but poses and time; *refused is "wand" then. restart_light: the light begins at its
 * steady state on every node (GI_EPOCH). GR_OK; GR_ERR_RANGE when a value is
 * outside its parameter's range: that parameter keeps its old value and
 * *refused names it.
 */
int master_state_frame(struct master_state *state, const struct master_input *input,
		       bool restart_light, struct param_state *params, uint64_t frame,
		       const char **refused);

#endif
