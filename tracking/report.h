/*
 * What a device says of one of its sensors, after decoding: the common form
 * of all drivers. Pure data.
 *
 * Frame of a device ("base"), whatever the device calls its axes: right
 * handed, +X right, +Y up, +Z towards the one who stands before it; metres.
 * T_base_sensor takes coordinates of the sensor there. Conversion into this
 * frame is the decoder's; where the base stands in the room is the layout's
 * (tracking/bind.h).
 *
 * Convention of decoders: a pure function that looks at the length first,
 *
 *     int hydra_decode(const uint8_t *bytes, size_t len, struct hydra_report *out);
 *
 * GR_OK, or the fault negated (-TRACK_FAULT_LENGTH ...), *out untouched then.
 * No I/O, no state; what has to be remembered from one report to the next
 * (hemispheres, wrapped counters) is a struct that is handed in to a second
 * pure function.
 */
#ifndef GROTTO_TRACKING_REPORT_H
#define GROTTO_TRACKING_REPORT_H

#include "base/pose.h"

#include <stdbool.h>
#include <stdint.h>

#define TRACK_SENSORS 32 /* of one device */
#define TRACK_AXES 8
#define TRACK_PLACE_MAX_M                                                                          \
	1000.0f /* from the base's or room's origin, as far as the protocol carries a pose */

/* What a report holds. A field whose bit is not set means nothing. */
enum track_has {
	TRACK_POSITION = 1 << 0,
	TRACK_ORIENTATION = 1 << 1,
	TRACK_BUTTONS = 1 << 2,
	TRACK_AXIS_VALUES = 1 << 3,
	TRACK_DEVICE_TIME = 1 << 4,
	TRACK_BATTERY = 1 << 5,
	TRACK_QUALITY = 1 << 6,
	TRACK_LOST = 1 << 7, /* the device says that it has lost the sensor: no pose */
};

struct track_report {
	int64_t device_ns;  /* the device's own clock, unwrapped, any zero */
	int64_t arrived_ns; /* CLOCK_MONOTONIC when it was read. track_device_publish sets it */
	int64_t time_ns;    /* device_ns by the master's CLOCK_MONOTONIC; arrived_ns without one.
			       Likewise */
	struct gr_pose T_base_sensor;
	uint32_t has;	  /* enum track_has */
	uint32_t sensor;  /* 0..TRACK_SENSORS-1 */
	uint32_t buttons; /* bit i: the i-th of the driver's names */
	uint32_t axis_count;
	float axes[TRACK_AXES]; /* -1..1, right and up +; triggers 0..1 */
	float battery;		/* 0 empty .. 1 full */
	float quality;		/* 0 bad .. 1 good, as the device judges */
};

/* Why something that arrived was not used. */
enum track_fault {
	TRACK_FAULT_NONE,
	TRACK_FAULT_LENGTH, /* fewer or more bytes than such a report has */
	TRACK_FAULT_CHECKSUM,
	TRACK_FAULT_FORMAT, /* constant fields, counts, numbers that cannot be */
	TRACK_FAULT_POSE,   /* not finite, no unit quaternion, out of this world */
	TRACK_FAULT_ORDER,  /* a duplicate, or older than one that was there already */
	TRACK_FAULT_SENSOR, /* a sensor that the driver does not have */
	TRACK_FAULTS,
};
/* "length", "checksum", ... Never NULL. */
const char *track_fault_name(enum track_fault fault);

/*
 * A device's counter of `bits` bits as 64 ones: the value congruent to `raw`
 * that is nearest to `expected`, which is the last one plus what should have
 * been counted since (by the time of arrival). Never negative.
 */
uint64_t track_unwrap(uint64_t raw, unsigned bits, uint64_t expected);

/*
 * A stick that rests a little beside its middle: 0 within `zone` (0..0.9) of
 * it, from there on evenly to -1 and 1. value: -1..1.
 */
float track_dead_zone(float value, float zone);

#endif
