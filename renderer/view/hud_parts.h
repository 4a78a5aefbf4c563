/*
 * What the HUD beside the wand consists of (seed 004, "User Interaction",
 * section 3): boxes and cones in the room. On the wand's left the symbols of
 * the three input layouts, arrows, a cone and a cube, the one in use white and
 * with a mark beside it; the cone has the torch's colour and angle. On its
 * right a bar, with a letter, for each value that the layout in use changes.
 * While lighting is in use a second cone stands where the torch is.
 *
 * Where it is follows from the wand alone, not from the eye or the wall: so
 * it is one thing on all walls and in both eyes. Pure, any thread; no
 * allocation.
 */
#ifndef GROTTO_RENDERER_VIEW_HUD_PARTS_H
#define GROTTO_RENDERER_VIEW_HUD_PARTS_H

#include "renderer/frame.h"

#include <stddef.h>

#define HUD_PARTS_MOST 64

/*
 * A box is -0.5..0.5 along its axes; a cone has its tip at 0 and opens along
 * -Z, to radius 1 at z = -1.
 */
enum hud_shape { HUD_BOX, HUD_CONE, HUD_SHAPES };

struct hud_part {
	mat4 T_room_part; /* affine, right-handed */
	vec4 color;       /* as the display has it, 0..1; a: opacity */
	enum hud_shape shape;
};

/* Compared bit by bit to see whether the HUD is another: zeroed before it is filled. */
struct hud_view {
	struct gr_pose T_room_wand;
	float scale;
	enum frame_hand_mode mode;
	bool quality, refines;
	bool has_torch, torch_on;
	struct gr_pose T_room_scene; /* with a torch, while lighting */
	vec3 torch_position, torch_direction; /* likewise; scene */
	vec3 torch_intensity;
	float torch_half_angle; /* radians; 0: it shines all around */
	float torch_hue;        /* turns */
	float absorption_per_m, scattering_per_m;
	float incremental; /* of the thesis' light; negative: there is none */
	char work;         /* letter of what `work_share` is of: 'P' steps, 'G' gathers, 0: neither */
	float work_share;  /* 0..1 */
};

/* At most HUD_PARTS_MOST; returns how many. */
size_t hud_parts(const struct hud_view *view, struct hud_part parts[HUD_PARTS_MOST]);
/*
 * A dark body around one that is opaque, to be drawn before all parts: white
 * stands out from white, too. `margin`: metres on each side. False: it has none.
 */
bool hud_part_rim(const struct hud_part *part, float margin, struct hud_part *out);
/* Farthest from `eye` (room) first, so that what is in front is drawn over what is behind. */
void hud_parts_sort(struct hud_part *parts, size_t count, const vec3 eye);

#endif
