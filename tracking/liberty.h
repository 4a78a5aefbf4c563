/*
 * The bytes of Polhemus LIBERTY, LIBERTY LATUS and PATRIOT in binary mode:
 * frames of one station each, an 8-byte head and a body, little endian; no
 * checksum. Commands are text.
 *
 * Head, body and output list: as read by ipab-slmc/polhemus_ros_driver
 * (liberty_protocol.h) and VRPN (vrpn_Tracker_Liberty.C, _LibertyHS.C), which
 * agree. Stylus button (item 10 of the list) and the meaning of the error
 * byte: from their comments alone; an error only takes a report's quality.
 * Nothing here was tried on a real device.
 */
#ifndef GROTTO_TRACKING_LIBERTY_H
#define GROTTO_TRACKING_LIBERTY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TRACK_LIBERTY_HEAD 8
#define TRACK_LIBERTY_STATIONS 16
#define TRACK_LIBERTY_BODY_MOST 512 /* who-am-I has some 300 */
#define TRACK_LIBERTY_POSE_MOST 128 /* all items that there are, once each */
#define TRACK_LIBERTY_MAP_COMMAND 21 /* Ctrl-U */

/* The output list that poses are asked for in, and without the button. */
#define TRACK_LIBERTY_LIST "O*,8,9,11,3,7,10\r"
#define TRACK_LIBERTY_LIST_PLAIN "O*,8,9,11,3,7\r"
#define TRACK_LIBERTY_BODY 44
#define TRACK_LIBERTY_BODY_PLAIN 40

struct track_liberty_head {
	uint8_t station; /* 1..16 for poses */
	uint8_t command; /* what it answers: 'C' continuous, 'P' once, 21 */
	uint8_t error;	 /* ' ' or 0: none */
	uint16_t size;	 /* of the body */
};

struct track_liberty_pose {
	unsigned station; /* 0..15 */
	uint8_t error;	  /* 0: none */
	uint32_t stamp_ms, frame;
	int32_t distortion;
	float place_cm[3]; /* X forward, Y right, Z down; centimetres after U1 */
	float turn[4];	   /* w x y z */
	bool has_button;
	bool button;
};

/* Whether at least 8 bytes begin as a frame does; *out is its head then. */
bool track_liberty_head(const uint8_t *bytes, struct track_liberty_head *out);
bool track_liberty_is_pose(const struct track_liberty_head *head);
/* Whole frames. GR_OK; -TRACK_FAULT_LENGTH, _FORMAT, _SENSOR. */
int track_liberty_pose(const uint8_t *frame, size_t len, struct track_liberty_pose *out);
/* The reply to Ctrl-U 0: stations, bit by station, that are plugged in and switched on. */
int track_liberty_map(const uint8_t *frame, size_t len, uint16_t *detected, uint16_t *active);

#endif
