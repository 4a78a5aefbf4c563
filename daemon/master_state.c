#include "daemon/master_state.h"

#include "base/result.h"

#include <math.h>
#include <string.h>

void master_state_init(struct master_state *state, const struct layout *layout,
		       const struct scene_file *scene)
{
	*state = (struct master_state){ .layout = layout, .scene = scene };
	master_settings_init(&state->settings, scene, layout->eye_separation_m);
	master_adapt_init(&state->adapt, &scene->tone);
	state->T_scene_room = scene->room;
	hand_init(&state->hand, &layout->hand, scene);
}

void master_state_adopt(struct master_state *state, const struct param_state *params)
{
	struct gr_pose room;

	memcpy(room.p, param_f32(params, PARAM_ROOM_POSITION), sizeof room.p);
	memcpy(room.q, param_f32(params, PARAM_ROOM_ROTATION), sizeof room.q);
	if (gr_pose_valid(&room)) /* else it was never set */
		state->T_scene_room = room;
	master_settings_read(&state->settings, params);
	master_adapt_adopt(&state->adapt, params);
	hand_adopt(&state->hand, params);
	memcpy(&state->epoch, param_get(params, PARAM_GI_EPOCH), sizeof state->epoch);
}

void master_state_start_input(const struct master_state *state, struct master_input *input)
{
	*input = (struct master_input){
		.head.T_room_body = state->layout->start_head,
		.wand.T_room_body = state->layout->start_wand,
	};
}

/*
 * Orbits in the horizontal plane, counter-clockwise seen from above; starts
 * on the side of the centre where the file puts the lamp, and turns with it,
 * so that a lamp that points at the centre keeps doing so.
 */
static void place_orbit(const struct scene_lamp *lamp, int64_t time_ns, vec3 position,
			vec3 direction)
{
	/* A negative period turns the other way, none at all stands still. */
	double period_ns = (double)lamp->orbit_period_s * 1e9, turns, start, angle;
	double x = lamp->position[0] - lamp->orbit_center[0];
	double z = lamp->position[2] - lamp->orbit_center[2];
	float c, s;

	turns = period_ns != 0 ? fmod((double)time_ns, period_ns) / period_ns : 0;
	start = x == 0 && z == 0 ? 0 : atan2(-z, x);
	angle = start + 2 * M_PI * turns;
	position[0] = lamp->orbit_center[0] + lamp->orbit_radius_m * (float)cos(angle);
	position[1] = lamp->orbit_center[1];
	position[2] = lamp->orbit_center[2] - lamp->orbit_radius_m * (float)sin(angle);
	c = (float)cos(2 * M_PI * turns);
	s = (float)sin(2 * M_PI * turns);
	direction[0] = c * lamp->direction[0] + s * lamp->direction[2];
	direction[1] = lamp->direction[1];
	direction[2] = c * lamp->direction[2] - s * lamp->direction[0];
}

void master_lamp_place(const struct scene_lamp *lamp, const struct gr_pose *T_scene_head,
		       const struct gr_pose *T_scene_wand, int64_t time_ns, vec3 position,
		       vec3 direction)
{
	const struct gr_pose *carrier = T_scene_wand;

	switch (lamp->mount) {
	case SCENE_MOUNT_ORBIT:
		place_orbit(lamp, time_ns, position, direction);
		return;
	case SCENE_MOUNT_HEAD:
		carrier = T_scene_head;
		/* fall through */
	case SCENE_MOUNT_WAND:
		gr_pose_point(carrier, lamp->position, position);
		gr_pose_direction(carrier, lamp->direction, direction);
		return;
	case SCENE_MOUNT_FIXED:
		break;
	}
	memcpy(position, lamp->position, sizeof(vec3));
	memcpy(direction, lamp->direction, sizeof(vec3));
}

struct setter {
	struct param_state *params;
	uint64_t frame;
	const char **refused;
	int result;
};

static void set(struct setter *setter, enum param_id id, const void *values)
{
	if (param_set(setter->params, id, values, setter->frame) < 0) {
		*setter->refused = param_info(id)->name;
		setter->result = GR_ERR_RANGE;
	}
}

static void set_pose(struct setter *setter, enum param_id position, enum param_id rotation,
		     const struct gr_pose *pose)
{
	set(setter, position, pose->p);
	set(setter, rotation, pose->q);
}

static void set_lamps(struct master_state *state, const struct master_input *input,
		      struct setter *setter)
{
	float positions[3 * PARAM_MAX_LAMPS] = { 0 }, directions[3 * PARAM_MAX_LAMPS] = { 0 };
	struct gr_pose T_scene_head, T_scene_wand;

	gr_pose_mul(&state->T_scene_room, &input->head.T_room_body, &T_scene_head);
	gr_pose_mul(&state->T_scene_room, &input->wand.T_room_body, &T_scene_wand);
	for (size_t i = 0; i < state->scene->lamp_count && i < PARAM_MAX_LAMPS; i++)
		master_lamp_place(&state->scene->lamps[i], &T_scene_head, &T_scene_wand,
				  input->time_ns, positions + 3 * i, directions + 3 * i);
	if (state->hand.put_down) {
		memcpy(positions + (ptrdiff_t)3 * state->hand.torch, state->hand.position, sizeof(vec3));
		memcpy(directions + (ptrdiff_t)3 * state->hand.torch, state->hand.direction, sizeof(vec3));
	}
	set(setter, PARAM_LAMP_POSITION, positions);
	set(setter, PARAM_LAMP_DIRECTION, directions);
	set(setter, PARAM_LAMP_ON, &state->settings.lamp_on);
}

/* Whether the parameters took the room's place. */
static bool room_kept(const struct param_state *params, const struct gr_pose *room)
{
	return memcmp(param_get(params, PARAM_ROOM_POSITION), room->p, sizeof room->p) == 0 &&
	       memcmp(param_get(params, PARAM_ROOM_ROTATION), room->q, sizeof room->q) == 0;
}

int master_state_frame(struct master_state *state, const struct master_input *input,
		       bool restart_light, struct param_state *params, uint64_t frame,
		       const char **refused)
{
	struct setter setter = { params, frame, refused, GR_OK };
	uint64_t time_ns = input->time_ns > 0 ? (uint64_t)input->time_ns : 0;
	uint32_t flags = (input->head.tracked ? MASTER_TRACK_HEAD : 0) |
			 (input->wand.tracked ? MASTER_TRACK_WAND : 0);
	struct gr_pose before = state->T_scene_room;

	if (hand_step(&state->hand, input, &state->settings, &state->T_scene_room) < 0) {
		*refused = "wand";
		setter.result = GR_ERR_RANGE;
	}
	if (restart_light)
		state->epoch = frame;
	set(&setter, PARAM_FRAME_TIME, &time_ns);
	set_pose(&setter, PARAM_ROOM_POSITION, PARAM_ROOM_ROTATION, &state->T_scene_room);
	if (!room_kept(params, &state->T_scene_room))
		state->T_scene_room = before; /* flown out of the world: stays at its rim */
	set_pose(&setter, PARAM_HEAD_POSITION, PARAM_HEAD_ROTATION, &input->head.T_room_body);
	set_pose(&setter, PARAM_WAND_POSITION, PARAM_WAND_ROTATION, &input->wand.T_room_body);
	set(&setter, PARAM_WAND_BUTTONS, &input->buttons);
	set(&setter, PARAM_TRACK_FLAGS, &flags);
	set(&setter, PARAM_GI_EPOCH, &state->epoch);
	set_lamps(state, input, &setter);
	if (master_settings_apply(&state->settings, params, frame, refused) < 0)
		setter.result = GR_ERR_RANGE;
	master_adapt_step(&state->adapt, state->settings.adaptation, input->step_ns);
	if (master_adapt_apply(&state->adapt, params, frame) < 0) {
		*refused = param_info(PARAM_ADAPTATION)->name;
		setter.result = GR_ERR_RANGE;
	}
	if (hand_write(&state->hand, input->step_ns, params, frame, refused) < 0)
		setter.result = GR_ERR_RANGE;
	return setter.result;
}
