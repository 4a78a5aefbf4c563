/*
 * Polhemus' magnetic trackers on USB: VIPER, LIBERTY (and LATUS), PATRIOT.
 * Sensors "1" to "16", in the order of the sockets.
 *
 * What of this is known how: see tracking/viper.h, tracking/liberty.h (bytes)
 * and tracking/polhemus_reports.h (axes, time). Product numbers, endpoints'
 * kind, the order of commands at the start, and that a program before may have
 * left the device sending: ipab-slmc/polhemus_ros_driver,
 * armeenm/libpolhemus, VRPN. That a PATRIOT takes LIBERTY's commands: from the
 * same. The maker's rate command of LIBERTY is not known here: the rate is
 * left as it is and counted. Nothing here was tried on a real device.
 *
 * What is set: metres or centimetres, quaternions, no prediction of the
 * device's own (grotto predicts to the time of the light, and twice is too
 * far), no filter of its own unless wanted, the hemisphere. None of it is made
 * to last beyond the device's next power-up.
 */
#ifndef GROTTO_TRACKING_POLHEMUS_H
#define GROTTO_TRACKING_POLHEMUS_H

#include "tracking/device.h"

enum track_polhemus_model {
	TRACK_POLHEMUS_MODEL_VIPER,
	TRACK_POLHEMUS_MODEL_LIBERTY,
	TRACK_POLHEMUS_MODEL_PATRIOT,
	TRACK_POLHEMUS_MODELS,
};

/* Borrowed while the device is made. */
struct track_polhemus_params {
	enum track_polhemus_model model;
	const char *serial; /* of the USB device or as a VIPER says itself; NULL: any */
	const char *path;   /* bus and ports, "1-2.4"; NULL: any */
	int number;	    /* without either: which of several, by path */
	int rate_hz;	    /* VIPER: 30, 60, 120, 240, 480, 960 */
	vec3 hemisphere;    /* from the source, base's axes: half of space that the sensors begin
			       in. All 0: as the device has it */
	bool follow; /* VIPER: the hemisphere goes with the sensor from there on */
	bool filter; /* leaves the device's own filter as it is */
};

/* GR_OK, GR_ERR_NOMEM, GR_ERR_IO, GR_ERR_RANGE (a rate that there is not, texts too long). */
int track_polhemus_create(struct track_device **out, const struct track_polhemus_params *params,
			  const struct gr_clock *clock);

#endif
