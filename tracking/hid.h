/*
 * What drivers of HID devices share: finding a device's nodes, opening them
 * with a reason a person can act on. By hidapi's hidraw backend.
 *
 * hidapi has no descriptor to wait on beside others: track_hid_read looks
 * between short waits whether the thread is to end. What a driver waits for in
 * one go is at most TRACK_HID_WAIT_MS all the same.
 *
 * Thread: hidapi's functions about one device, one thread. track_hid_list and
 * track_hid_open may be called from several threads.
 */
#ifndef GROTTO_TRACKING_HID_H
#define GROTTO_TRACKING_HID_H

#include "tracking/device.h"

#include <hidapi.h>

#define TRACK_HID_WAIT_MS 100
#define TRACK_HID_NODES 32
#define TRACK_HID_USAGES 4 /* of a node's application collections; more are left out */
/* A usage with its page, as HID writes it into four bytes. */
#define TRACK_HID_USAGE(page, id) ((uint32_t)(page) << 16 | (uint32_t)(id))
#define TRACK_HID_JOYSTICK TRACK_HID_USAGE(1, 4)
#define TRACK_HID_GAMEPAD TRACK_HID_USAGE(1, 5)
#define TRACK_HID_MULTI_AXIS TRACK_HID_USAGE(1, 8)

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
	uint32_t usages[TRACK_HID_USAGES]; /* of its application collections; 0: none */
};

/* Which of several is meant. */
struct track_hid_choice {
	char serial[64]; /* "": any; a Bluetooth device's is its address */
	char path[64]; /* where on the USB bus: "1-2.4", as in /sys/bus/usb/devices; "": anywhere */
	int number;    /* of those that fit, by node */
};

/* The nodes of this vendor (and product; 0: any), by path; returns how many, at most `room`. */
int track_hid_list(uint16_t vendor, uint16_t product, struct track_hid_node *out, int room);
/* Has an application collection of this usage. */
bool track_hid_has_usage(const struct track_hid_node *node, uint32_t usage);
/* Where the node's device is plugged in: the last part of node->device. */
const char *track_hid_port(const struct track_hid_node *node);
/* GR_OK, GR_ERR_RANGE: serial or path (NULL: any) too long. */
int track_hid_choice_set(struct track_hid_choice *choice, const char *serial, const char *path,
			 int number);
/* The node that is meant, or NULL with what is missing in `why`; `what` is its kind: "DualSense".
 */
const struct track_hid_node *track_hid_choose(const struct track_hid_choice *choice,
					      const struct track_hid_node *nodes, int count,
					      const char *what, char *why, size_t size);
/*
 * The node's report descriptor as the kernel has it, from sysfs (hidapi 0.13
 * has no call for it). Its length, or 0 when it cannot be read or does not fit.
 */
size_t track_hid_descriptor(const struct track_hid_node *node, uint8_t *out, size_t room);
/*
 * hid_read_timeout for a device's thread: 0 early, within 20 ms, when the
 * thread is to end.
 */
int track_hid_read(const struct track_device *device, hid_device *hid, uint8_t *bytes, size_t size,
		   int timeout_ms);
/*
 * Opens a node. TRACK_RUNNING; TRACK_DENIED, TRACK_BUSY, TRACK_ABSENT (gone
 * meanwhile) or TRACK_FAILED with what a person can do in `why`.
 */
enum track_state track_hid_open(const struct track_hid_node *node, hid_device **out, char *why,
				size_t size);

#endif
