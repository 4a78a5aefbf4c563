/*
 * What one frame shows: plain values, filled by the daemon from the applied
 * parameters (or by a tool by hand). The renderer keeps no other truth.
 */
#ifndef GROTTO_RENDERER_FRAME_H
#define GROTTO_RENDERER_FRAME_H

#include "base/pose.h"
#include "config/scene_file.h"
#include "renderer/tone/curve.h"

#include <stdbool.h>
#include <stdint.h>

/* A lamp as it is in this frame; kind, cone and radius are the scene file's. */
struct frame_lamp {
	bool on;
	vec3 position;  /* scene, metres */
	vec3 direction; /* scene, unit */
	vec3 intensity; /* W/sr, directional: W/m^2 */
};

/* What the hand does, for the HUD beside the wand (seed 004, "User Interaction"). */
enum frame_hand_mode { FRAME_HAND_NAVIGATION, FRAME_HAND_LIGHTING, FRAME_HAND_SETTINGS, FRAME_HAND_MODES };
struct frame_hand {
	bool shown; /* else nothing of it is drawn */
	struct gr_pose T_room_wand;
	float scale; /* of the HUD, > 0 */
	enum frame_hand_mode mode;
	int torch; /* lamp that lighting is about, -1: none */
	float torch_hue; /* turns, also where it is grey */
	bool quality;
};

struct render_frame {
	uint64_t frame;
	struct gr_pose T_scene_room;
	struct gr_pose T_room_head;
	float eye_separation_m;
	struct frame_lamp lamps[SCENE_MAX_LAMPS]; /* as many as the scene file has */
	bool gi_on;
	uint64_t gi_epoch; /* a change restarts the light at its steady state */
	int gi_steps, gi_gathers; /* gathers 0: as the scene file has it */
	int gi_refine; /* so many times the steps and gathers are done, >= 1 */
	float gi_incremental;
	float absorption_per_m, scattering_per_m;
	float exposure;
	enum scene_curve curve;
	float adaptation[2], pigment[2]; /* of cones and rods, renderer/tone/adapt.h */
	float luminance_max;             /* cd/m^2 */
	float tone_bias;
	float gamma_encode; /* gamma_end_to_end / gamma_display, seed 004 section 3.3.6 */
	bool srgb;
	struct frame_hand hand;
};

/*
 * The frame that a scene file describes, before anything moves: head 1.7 m
 * above the room's origin, eyes 65 mm apart; a lamp on an orbit is at the
 * centre plus its radius along +x; lamps of wand and head are at the head.
 */
void render_frame_init(struct render_frame *frame, const struct scene_file *file);
/* How its pictures are to be shown. */
struct tone_look render_frame_look(const struct render_frame *frame);

#endif
