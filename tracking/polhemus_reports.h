/*
 * What Polhemus' trackers have in common once their bytes are decoded: frame
 * numbers to times, axes, sensors that were pulled. Pure.
 *
 * Device's axes, of source and sensor alike: X forward, Y right, Z down
 * (VIPER 4 manual, page 72; the older ones from drivers that turn Z round).
 * Forward of the source is -Z of the base: (x, y, z) becomes (y, -z, -x), of
 * determinant +1. The same for the vector part of a quaternion.
 *
 * Time is the frame's number times the frame's period: the number counts the
 * moments of measurement, a time stamp of whole milliseconds would be up to
 * 1 mm of a hand's way off. The period is what the device was told to do; what
 * arrives is held against it.
 */
#ifndef GROTTO_TRACKING_POLHEMUS_REPORTS_H
#define GROTTO_TRACKING_POLHEMUS_REPORTS_H

#include "tracking/report.h"

#define TRACK_POLHEMUS_SENSORS 16

/* A sensor as decoded, in the device's axes. */
struct track_polhemus_sensor {
	unsigned sensor; /* 0..15 */
	vec3 place_m;
	float turn[4]; /* w x y z */
	uint32_t has; /* of TRACK_BUTTONS, TRACK_QUALITY */
	uint32_t buttons;
	float quality;
};

/* From one frame to the next. */
struct track_polhemus_state {
	bool started;
	uint64_t frame;	    /* the last one's number, unwrapped */
	int64_t arrived_ns; /* when its first report did */
	int64_t device_ns;
	int64_t period_ns;
	uint64_t first;	  /* frame of... */
	int64_t first_ns; /* ... this device time */
	/* How often frames come: since when and which it is counted, what the last count said. */
	uint64_t counted;
	int64_t counted_ns;
	int64_t counted_period_ns;
	/* Sensors. */
	uint32_t known, present; /* bit by sensor; present: in this frame so far */
	uint8_t absent[TRACK_POLHEMUS_SENSORS]; /* frames in a row */
};

/* Of a struct of zeroes, or again when the device was told to begin again: time goes on. */
void track_polhemus_begin(struct track_polhemus_state *state, double rate_hz);
/*
 * A report of the frame with this number (32 bits of it) has arrived; several
 * in a row may be of one frame. *missed: frames that nobody got before it.
 * Returns the sensors, bit by sensor, that have been missing from three whole
 * frames and are lost with this one: see track_polhemus_lost.
 *
 * A number that jumps is a device that began anew: its time goes on two
 * seconds later, which the clock takes for a step.
 */
uint32_t track_polhemus_frame(struct track_polhemus_state *state, uint32_t number,
			      int64_t arrived_ns, uint64_t *missed);
/* A sensor of the frame that was told last. */
void track_polhemus_report(struct track_polhemus_state *state,
			   const struct track_polhemus_sensor *sensor, struct track_report *out);
void track_polhemus_lost(const struct track_polhemus_state *state, unsigned sensor,
			 struct track_report *out);

/* Device's axes to the base's and back; in and out may be the same. */
void track_polhemus_to_base(const float device[3], float base[3]);
void track_polhemus_from_base(const float base[3], float device[3]);

#endif
