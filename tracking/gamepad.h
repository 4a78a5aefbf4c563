/*
 * Any HID gamepad or joystick as a wand's buttons and axes, by its report
 * descriptor (tracking/hid_descriptor.h). Sensors "pad", and "pad2" to "pad4"
 * where several are behind one node. No pose.
 *
 * Pads of Microsoft's (Xbox 360, One) by USB are not HID, and not for this.
 * Nothing here was tried on a real device; the tests' descriptors are those
 * of devices.
 */
#ifndef GROTTO_TRACKING_GAMEPAD_H
#define GROTTO_TRACKING_GAMEPAD_H

#include "tracking/device.h"

extern const char *const track_gamepad_axes[TRACK_AXES + 1];

/* Borrowed while the device is made. */
struct track_gamepad_params {
	uint16_t vendor, product;  /* 0: any */
	const char *serial, *path; /* NULL: any; path: of the USB bus */
	int number;		   /* of several that fit */
	uint8_t triggers;	   /* bit: an axis that goes from 0 to 1; sliders do so anyway */
	float dead_zone;	   /* 0..0.9 */
};
/* GR_OK, GR_ERR_NOMEM, GR_ERR_IO, GR_ERR_RANGE (a text too long). */
int track_gamepad_create(struct track_device **out, const struct track_gamepad_params *params,
			 const struct gr_clock *clock);

#endif
