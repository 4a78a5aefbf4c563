/*
 * A.R.T. DTrack, DTrack2, DTRACK3: optical, one UDP datagram of ASCII lines
 * each frame. Sensors "body0" .. "body11" (lines 6d, 6di), "flystick0" ..
 * "flystick3" (6df, 6df2), "tool0" .. "tool3" (6dmt, 6dmt2), "joint0" ..
 * "joint11" (6dj, of the first human model). Other lines are passed by.
 *
 * What of this is known how. Lines and their fields: from A.R.T.'s own parser
 * (ar-tracking/DTrackSDK, src/DTrackParser.cpp) and VRPN's
 * (vrpn_Tracker_DTrack.C). That matrices are written by columns: from a frame
 * that was sent to a VRPN server. Times, ts2, that a lost Flystick stands there
 * with a matrix of zeros, and the signs of its stick: from the system user
 * manual, appendix B. For the stick of 6df2 the manual says that left and up
 * are +1, A.R.T.'s parser makes left -1 of the old format: a setting. Nothing
 * here was tried on a real controller.
 */
#ifndef GROTTO_TRACKING_DTRACK_H
#define GROTTO_TRACKING_DTRACK_H

#include "tracking/device.h"

#define TRACK_DTRACK_BYTES 65536 /* no datagram is longer */
#define TRACK_DTRACK_SILENCE_NS (3 * GR_NS_PER_S)
#define TRACK_DTRACK_BODY 0
#define TRACK_DTRACK_BODIES 12
#define TRACK_DTRACK_FLYSTICK 12
#define TRACK_DTRACK_FLYSTICKS 4
#define TRACK_DTRACK_TOOL 16
#define TRACK_DTRACK_TOOLS 4
#define TRACK_DTRACK_JOINT 20
#define TRACK_DTRACK_JOINTS 12
#define TRACK_DTRACK_SENSORS 32

struct track_dtrack_item {
	bool lost;
	bool has_input; /* buttons and axes mean something */
	bool hat;	/* the stick is made of an old Flystick's buttons: right and up are + */
	float quality;	/* 0..1, negative: not said */
	double place_mm[3];
	double turn[9]; /* by columns */
	uint32_t buttons;
	unsigned axis_count;
	float axes[TRACK_AXES];
};

struct track_dtrack_frame {
	uint32_t number; /* fr */
	bool has_ts, has_ts2;
	int64_t ts_ns;	    /* since midnight, UTC */
	int64_t ts2_ns;	    /* since 1970, UTC */
	int64_t latency_ns; /* of ts2: from the flash to the datagram */
	uint32_t listed;    /* sensors of the kinds of which there is a line */
	uint32_t present;   /* sensors that stand in one */
	unsigned beyond;    /* of a number that no sensor has */
	struct track_dtrack_item items[TRACK_DTRACK_SENSORS];
};

/*
 * GR_OK, -TRACK_FAULT_LENGTH (nothing, or too much), -TRACK_FAULT_FORMAT. All
 * of a datagram or nothing.
 */
int track_dtrack_decode(const uint8_t *bytes, size_t len, struct track_dtrack_frame *out);

/* What a room's calibration and its Flysticks mean. */
struct track_dtrack_setup {
	bool z_up;	   /* X right, Y away from the viewer, Z up; else Y up and Z towards him */
	bool stick_x_left; /* +1 of a 6df2 line is left */
	bool stick_y_down; /* and down */
};

/* From one frame to the next. All zero at the start. */
struct track_dtrack_state {
	bool started, has_time, by_ts2;
	uint32_t number;
	unsigned stale; /* frames of a lower number in a row */
	int64_t arrived_ns, raw_ns, zero_ns;
	uint32_t known; /* sensors that have been there */
};

struct track_dtrack_reports {
	uint64_t missed;    /* frames between the last one and this */
	unsigned bad_poses; /* matrices that turn nothing */
	unsigned count;
	struct track_report reports[TRACK_DTRACK_SENSORS];
};

/*
 * The reports of a frame that arrived at arrived_ns; a sensor that was there
 * and is in none of the lines that list it is lost. GR_OK, or
 * -TRACK_FAULT_ORDER for a duplicate or a straggler.
 */
int track_dtrack_take(struct track_dtrack_state *state, const struct track_dtrack_setup *setup,
		      const struct track_dtrack_frame *frame, int64_t arrived_ns,
		      struct track_dtrack_reports *out);

/* Borrowed while the device is made. */
struct track_dtrack_params {
	const char *address; /* of the controller, numeric IPv4; NULL: anyone may send */
	const char *group;   /* multicast group to join, or NULL */
	const char *interface_name; /* that hears the group; NULL: the system chooses */
	uint16_t port;
	bool knock; /* opens a firewall's way for the controller, see dtrack_device.c */
	int64_t silence_ns; /* without a frame it is absent; 0: TRACK_DTRACK_SILENCE_NS */
	struct track_dtrack_setup setup;
};
/* GR_OK, GR_ERR_NOMEM, GR_ERR_IO, GR_ERR_RANGE (an address that is none). */
int track_dtrack_create(struct track_device **out, const struct track_dtrack_params *params,
			const struct gr_clock *clock);

#endif
