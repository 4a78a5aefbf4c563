/*
 * In the hand (seed 004, "User Interaction"): what the wand's buttons and axes
 * do. Three input layouts follow each other in a ring:
 *
 *   navigation  fly: the room moves where the wand points, at the thesis'
 *               v = 1.4 m/s (d / 0.4 m)^2.5, d the distance of wand and head
 *               on the floor plan; drag: the scene turns with the wand, about
 *               the head; reset; the wand's lamps on and off
 *   lighting    the torch goes with the wand while its button is held and
 *               stays where it is let go; intensity, hue, saturation
 *   settings    steps (or gathers) a frame, absorption, scattering, quality
 *
 * Which button and axis does what is the layout's (`hand`). Constants are in
 * seconds: what comes out does not depend on the frame rate. Pure: a step of
 * time and the input in, room and settings out; no clock, no randomness.
 */
#ifndef GROTTO_DAEMON_HAND_H
#define GROTTO_DAEMON_HAND_H

#include "config/layout.h"
#include "config/scene_file.h"
#include "daemon/master_input.h"
#include "daemon/master_settings.h"

#define HAND_STEP_MOST_NS (100 * INT64_C(1000000)) /* a stall must not become a leap */
#define HAND_ARM_M 0.4f                            /* from the head: walking speed */
#define HAND_WALK_M_S 1.4f
#define HAND_REACH_MOST_M 1.0f  /* further does not fly faster */
#define HAND_AXIS_DEAD 0.15f    /* of an axis: at rest within */
#define HAND_OCTAVES_PER_S 1.5f /* the torch's intensity doubles so often in a second */
#define HAND_INTENSITY_LEAST 1e-2f
#define HAND_INTENSITY_MOST 1e5f
#define HAND_HUE_PER_S 0.25f /* at full tilt: turns a second */
#define HAND_SATURATION_PER_S 0.5f
#define HAND_MEDIUM_PER_S 0.2f /* 1/m a second */
#define HAND_MEDIUM_MOST 1.0f  /* 1/m: nothing gets through a metre of it */
#define HAND_REST_NS (150 * INT64_C(1000000)) /* the light rests when nothing of it has changed for so long */
#define HAND_REFINE 4 /* times the steps and gathers while it rests */

/* PARAM_HAND_MODE. */
enum hand_mode { HAND_NAVIGATION, HAND_LIGHTING, HAND_SETTINGS, HAND_MODES };
/* "navigation", "lighting", "settings". Never NULL. */
const char *hand_mode_name(enum hand_mode mode);

/* Bits of PARAM_HAND_FLAGS. */
#define HAND_FLAG_HUD 1u
#define HAND_FLAG_QUALITY 2u
#define HAND_FLAG_PUT_DOWN 4u

/* What lights the scene; what is said of lamps that are off is 0. */
struct hand_light {
	uint32_t on;
	float position[3 * PARAM_MAX_LAMPS], direction[3 * PARAM_MAX_LAMPS];
	float intensity[3 * PARAM_MAX_LAMPS];
	float absorption, scattering;
};

struct hand {
	const struct layout_hand *bindings;
	const struct scene_file *scene;
	int torch; /* the lamp that lighting is about, -1: the scene has none */
	uint32_t buttons; /* of the frame before */
	bool lost;	  /* the wand was, in the frame before */
	uint32_t stale;   /* of these, pressed for the layout before this one, and not let go since */
	enum hand_mode mode;
	bool quality;
	bool put_down; /* the torch is where the hand put it, not where the scene file does: */
	vec3 position, direction; /* scene */
	float hue; /* of the torch, kept where it is grey; turns */
	struct {
		bool on;
		versor wand, room; /* when it began: of T_room_wand, T_scene_room */
	} drag;
	struct {
		bool on;
		vec3 velocity; /* of the frame before, scene */
	} flight;
	struct hand_light light;
	int64_t rest_ns;
};

/* Both are borrowed. */
void hand_init(struct hand *hand, const struct layout_hand *bindings, const struct scene_file *scene);
/*
 * One frame. GR_OK; GR_ERR_RANGE and nothing changed for an axis outside of
 * -1..1, a pose that is none or further than TRACK_PLACE_MAX_M away, a step
 * below 0. While the wand is not tracked nothing happens, and what is held then
 * is not pressed anew when it comes back.
 */
int hand_step(struct hand *hand, const struct master_input *input, struct master_settings *settings,
	      struct gr_pose *T_scene_room);
/* From parameters in which the lamps are those of the frame. */
void hand_light_of(const struct param_state *params, struct hand_light *out);
/*
 * The factor on steps and gathers (PARAM_GI_REFINE), from the light of this
 * frame: HAND_REFINE while quality is on and the light rests, else 1.
 */
uint32_t hand_refine(struct hand *hand, const struct hand_light *light, int64_t step_ns);

/*
 * What it shows into the parameters, for `frame`, after the lamps; GR_ERR_RANGE
 * names the parameter in *refused.
 */
int hand_write(struct hand *hand, int64_t step_ns, struct param_state *params, uint64_t frame,
	       const char **refused);
/* Goes on from the parameters of another master's frame. */
void hand_adopt(struct hand *hand, const struct param_state *params);

/* Speed in m/s for a wand this far from the head, metres. */
float hand_fly_speed(float distance_m);

#endif
