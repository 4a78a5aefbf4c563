/*
 * What drivers of HID devices share: finding a device's nodes, opening them
 * with a reason a person can act on. By hidapi's hidraw backend.
 *
 * hidapi has no descriptor to wait on: hid_read_timeout with at most
 * TRACK_HID_WAIT_MS is how a driver blocks, and how soon it ends.
 *
 * Thread: hidapi's functions about one device, one thread. track_hid_list may
 * be called from several threads.
 */
#ifndef GROTTO_TRACKING_HID_H
#define GROTTO_TRACKING_HID_H

#include "tracking/device.h"

#include <hidapi.h>

#define TRACK_HID_WAIT_MS 100
#define TRACK_HID_NODES 32

/* One hidraw node. */
struct track_hid_node {
	uint16_t vendor, product;
	int interface; /* of the USB device; -1: not USB */
	bool bluetooth;
	char path[64];	  /* "/dev/hidraw3" */
	char serial[64];  /* as far as it is ASCII; "" none */
	char name[64];	  /* the product's, likewise */
	char device[256]; /* sysfs path of the USB device, or of the HID device without one: nodes
			     of one device share it */
};

/* The nodes of this vendor (and product; 0: any), by path; returns how many, at most `room`. */
int track_hid_list(uint16_t vendor, uint16_t product, struct track_hid_node *out, int room);
/*
 * Opens a node. TRACK_RUNNING; TRACK_DENIED, TRACK_BUSY, TRACK_ABSENT (gone
 * meanwhile) or TRACK_FAILED with what a person can do in `why`.
 */
enum track_state track_hid_open(const struct track_hid_node *node, hid_device **out, char *why,
				size_t size);

#endif
