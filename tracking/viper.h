/*
 * Polhemus VIPER's bytes (USB 0f44:bf01). Little endian throughout; a frame is
 * an 8-byte head ("VPRP" a pose, "VPRC" a command or its reply; how many bytes
 * follow), a body and a checksum: CRC-16/ARC of all before it, as 32 bits.
 *
 * From the maker's own header file, public in
 * GabrielGosden/Polhemus_Viper_ROS_driver (src/ViperInterface.h); the two
 * commands that tests compare byte by byte were computed from it. What rates,
 * hemispheres and filters do: VIPER 4 manual. Nothing here was tried on a real
 * device. The other pose mode (16-bit orientation, acceleration) is not asked
 * for and refused.
 */
#ifndef GROTTO_TRACKING_VIPER_H
#define GROTTO_TRACKING_VIPER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TRACK_VIPER_HEAD 8
#define TRACK_VIPER_SENSORS 16
#define TRACK_VIPER_PAYLOAD 256 /* the longest that is read: a refusal has 180 */
/* The longest frame that is waited for: 16 sensors and a source map's reply are shorter. */
#define TRACK_VIPER_FRAME_MOST 1024

enum track_viper_command {
	TRACK_VIPER_HEMISPHERE = 0,
	TRACK_VIPER_FILTER = 1,
	TRACK_VIPER_RATE = 6,
	TRACK_VIPER_UNITS = 7,
	TRACK_VIPER_STATION_MAP = 10,
	TRACK_VIPER_CONTINUOUS = 19,
	TRACK_VIPER_WHO_AM_I = 20,
	TRACK_VIPER_PREDICTION = 28,
};
enum track_viper_action {
	TRACK_VIPER_SET,
	TRACK_VIPER_GET,
	TRACK_VIPER_RESET,
	TRACK_VIPER_ACK,
	TRACK_VIPER_NAK,
	TRACK_VIPER_NAK_WARNING, /* done, with a warning */
};
#define TRACK_VIPER_ALL UINT32_MAX   /* arg1: all sensors */
#define TRACK_VIPER_NOT_READY 1	     /* code of a NAK while the device starts */
#define TRACK_VIPER_METRES 3	     /* of TRACK_VIPER_UNITS */
#define TRACK_VIPER_QUATERNION 2

struct track_viper_sensor {
	uint8_t sensor; /* 0..127 */
	bool copy;	/* a "virtual" one that repeats another */
	uint8_t position_unit; /* 0 inch, 1 foot, 2 cm, 3 m */
	uint8_t orientation_unit; /* 2: quaternion */
	uint8_t buttons; /* bits 0 and 1 */
	uint8_t distortion; /* 0 none .. 255 */
	float place[3]; /* in position_unit; X forward, Y right, Z down */
	float turn[4]; /* w x y z */
};

struct track_viper_pose {
	uint32_t unit, frame;
	uint8_t self_test; /* 0: no error */
	unsigned count;
	struct track_viper_sensor sensors[TRACK_VIPER_SENSORS];
};

struct track_viper_reply {
	uint32_t unit, command, action, arg1, arg2;
	size_t len; /* of the payload, as far as it is kept */
	uint8_t payload[TRACK_VIPER_PAYLOAD];
};

uint16_t track_viper_checksum(const uint8_t *bytes, size_t len);
/* Whether the last four bytes are the checksum of all before; len at least 4. */
bool track_viper_intact(const uint8_t *frame, size_t len);
/* Whole frames. GR_OK; -TRACK_FAULT_LENGTH, _CHECKSUM, _FORMAT. */
int track_viper_pose(const uint8_t *frame, size_t len, struct track_viper_pose *out);
int track_viper_reply(const uint8_t *frame, size_t len, struct track_viper_reply *out);

#define TRACK_VIPER_COMMAND_MOST 64
/*
 * A command to any unit. Returns its length, at most TRACK_VIPER_COMMAND_MOST;
 * 0 when the payload is too long for it. Payload: little endian already.
 */
size_t track_viper_command(uint8_t out[TRACK_VIPER_COMMAND_MOST], enum track_viper_command command,
			   enum track_viper_action action, uint32_t arg1, uint32_t arg2,
			   const uint8_t *payload, size_t len);
/* Metres of a unit; 0 for one that there is not. */
float track_viper_metres(uint8_t position_unit);

#endif
