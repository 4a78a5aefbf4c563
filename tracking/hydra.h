/*
 * Razer Hydra (USB 1532:0300): two wands, magnetic, 250 Hz. Sensors "left" and
 * "right".
 *
 * What of this is known how. Report layout, units, CRC and sequence numbers:
 * from 4,775 reports that R. Pavlik captured (rpavlik/razer-hydra-hid-protocol)
 * and from the drivers of VRPN (vrpn_Tracker_RazerHydra.C) and ROS
 * (aleeper/razer_hydra), which read the same places. Mode switch, hemispheres,
 * buttons: from both drivers. Axes of the base (X right, Y towards the user, Z
 * down): from the ROS driver. That the orientation is given about axes of
 * which Y and Z point the other way: from notes of ours alone, see
 * hydra_decode.c. Nothing here was tried on a real device.
 *
 * The solution of a dipole's field is good up to its sign: as a wand passes
 * the base, all three coordinates may change theirs from one report to the
 * next, the orientation does not. Which of the two a wand is at is found once
 * (left wand left of the base, right wand right of it, as they are when
 * docked), then the shorter step is taken each time.
 */
#ifndef GROTTO_TRACKING_HYDRA_H
#define GROTTO_TRACKING_HYDRA_H

#include "tracking/device.h"

#define TRACK_HYDRA_WANDS 2
#define TRACK_HYDRA_BYTES 52
#define TRACK_HYDRA_PERIOD_NS (4 * GR_NS_PER_MS)

struct track_hydra_wand {
	uint8_t sequence;    /* +1 each 4 ms */
	int16_t place_mm[3]; /* x y z, of either sign together */
	int16_t turn[4];     /* w x y z, 1 is 32768 */
	uint8_t buttons;     /* as the device has them, bit 7 always set */
	int16_t stick[2];    /* x right +, y up +, 1 is 32768 */
	uint8_t trigger;
};

struct track_hydra_report {
	struct track_hydra_wand wands[TRACK_HYDRA_WANDS]; /* left, right */
};

/* GR_OK, -TRACK_FAULT_LENGTH, -TRACK_FAULT_FORMAT, -TRACK_FAULT_CHECKSUM. */
int track_hydra_decode(const uint8_t *bytes, size_t len, struct track_hydra_report *out);

/* From one report to the next. All zero at the start. */
struct track_hydra_state {
	bool started;
	uint64_t sequence[TRACK_HYDRA_WANDS]; /* unwrapped */
	int64_t arrived_ns;
	int sign[TRACK_HYDRA_WANDS]; /* of the coordinates; 0: not found yet */
	int32_t last_mm[TRACK_HYDRA_WANDS][3];
};

/*
 * Both wands of a report that arrived at arrived_ns. Returns how many reports
 * are missing before it.
 */
uint64_t track_hydra_reports(struct track_hydra_state *state, const struct track_hydra_report *raw,
			     int64_t arrived_ns, struct track_report out[TRACK_HYDRA_WANDS]);

/* The feature report that switches the mode, with its number in front. */
#define TRACK_HYDRA_FEATURE_BYTES 91
void track_hydra_mode(bool motion, uint8_t out[TRACK_HYDRA_FEATURE_BYTES]);

/* Borrowed while the device is made. */
struct track_hydra_params {
	const char *serial; /* NULL: any */
	int number;	    /* of several, in the order of their nodes */
};
/* GR_OK, GR_ERR_NOMEM, GR_ERR_IO, GR_ERR_RANGE (serial too long). */
int track_hydra_create(struct track_device **out, const struct track_hydra_params *params,
		       const struct gr_clock *clock);

#endif
