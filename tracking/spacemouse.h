/*
 * 3Dconnexion's SpaceMouse family: a cap that is pushed and turned, for desks
 * without tracking. It measures no pose; how far the cap is pushed is the
 * speed at which a pose moves, that of the driver's one sensor, "cap".
 *
 * What of this is known how. Products, reports 1 to 3, the newer one with all
 * six values, 0x17, the full scale of 350: from spacenavd (src/dev.c,
 * dev_usb*.c) and VRPN (vrpn_3DConnexion.C), through notes of ours. Axes (X
 * right, Y towards the user, Z down, turns right handed about each): the
 * translations from spacenavd's swap and signs, the turns from memory. That a
 * release can be missed: from the same notes. Nothing was tried on a real
 * device.
 *
 * The axes of the base: right, up, towards the user.
 */
#ifndef GROTTO_TRACKING_SPACEMOUSE_H
#define GROTTO_TRACKING_SPACEMOUSE_H

#include "tracking/device.h"

#define TRACK_SPACEMOUSE_BUTTONS 31
extern const char *const track_spacemouse_buttons[TRACK_SPACEMOUSE_BUTTONS + 1];

/* One of its reports: a device says its state in parts. */
struct track_spacemouse_report {
	bool moves, turns, presses; /* which of these are there */
	int16_t move[3], turn[3];   /* the device's axes, 350 is full */
	uint32_t buttons;
};
/*
 * GR_OK; GR_NOTHING: about its battery; -TRACK_FAULT_LENGTH,
 * -TRACK_FAULT_FORMAT (no report of this number).
 */
int track_spacemouse_decode(const uint8_t *bytes, size_t len, struct track_spacemouse_report *out);

struct track_spacemouse_motion {
	float speed_m_s, turn_rad_s; /* with the cap pushed and turned all the way */
	float reach_m;		     /* how far from the base's origin it goes, each axis */
	uint32_t home;		     /* buttons that take it back to the origin */
};
/* How long a report stands for: a cap that is held is never quite still, so this is a release that
 * got lost. */
#define TRACK_SPACEMOUSE_HOLD_NS (500 * GR_NS_PER_MS)

/* From one moment to the next. All zero at the start. */
struct track_spacemouse_state {
	float move[3], turn[3]; /* -1..1, base's axes */
	uint32_t buttons;
	float place_m[3];
	float heading_rad, pitch_rad,
		roll_rad; /* about the base's Y, then its own X, then its own Z */
	int64_t heard_ns; /* when it last said how the cap is */
	int64_t now_ns;	  /* up to which it has moved; 0: not begun */
};
/* Takes a report that arrived at now_ns, after it was moved to then. */
void track_spacemouse_take(struct track_spacemouse_state *state,
			   const struct track_spacemouse_motion *motion,
			   const struct track_spacemouse_report *report, int64_t now_ns);
/*
 * Moves on to now_ns. Pushed, it goes along the base's axes turned by its
 * heading; forward stays level. Speed grows with the square of the way, with
 * nothing in the first 5 %. A step is at most 0.1 s: a thread that was held up
 * must not throw anybody across the room.
 */
void track_spacemouse_move(struct track_spacemouse_state *state,
			   const struct track_spacemouse_motion *motion, int64_t now_ns);
/* Whether the cap is off its middle. */
bool track_spacemouse_moves(const struct track_spacemouse_state *state);
/* In the common form; axes are right, up, back and the turns about them. */
void track_spacemouse_pose(const struct track_spacemouse_state *state, struct track_report *out);

/* Borrowed while the device is made. */
struct track_spacemouse_params {
	const char *serial, *path; /* NULL: any; path: of the USB bus */
	int number;		   /* of several that fit */
	struct track_spacemouse_motion motion;
};
/* GR_OK, GR_ERR_NOMEM, GR_ERR_IO, GR_ERR_RANGE (a text too long). */
int track_spacemouse_create(struct track_device **out, const struct track_spacemouse_params *params,
			    const struct gr_clock *clock);

#endif
