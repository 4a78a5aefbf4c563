/*
 * A HID device's hidraw node under the real hidapi: reports with their
 * boundaries, feature and output reports, unplugging.
 *
 * Thread: any; the callbacks run in the test bed's own.
 */
#ifndef GROTTO_TESTS_UNIT_MOCK_HID_H
#define GROTTO_TESTS_UNIT_MOCK_HID_H

#include "tests/unit/mock_node.h"

#include <stddef.h>

/* NULL: the device stalls such a request. */
struct mock_hid_ops {
	/* bytes[0] is the report's number; fills up to `room`, returns the length or -errno. */
	int (*get_feature)(void *ctx, uint8_t *bytes, int room);
	/* Returns len or -errno. */
	int (*set_feature)(void *ctx, const uint8_t *bytes, int len);
	void (*output)(void *ctx, const uint8_t *bytes, int len);
	void *ctx;
};

struct mock_hid_params {
	int number; /* of the node: /dev/hidraw<number> */
	int port;   /* of the USB bus: nodes of one device share it */
	int interface;
	unsigned vendor, product;
	bool bluetooth; /* no USB device: port and interface are not used */
	const char *name, *serial;
	const uint8_t *descriptor;
	size_t descriptor_len;
	struct mock_hid_ops ops;
};

struct mock_hid;
/*
 * Plugged in at once. Of a device with several nodes the USB device must come
 * with the first and go with the last: see `last` of mock_hid_unplug.
 */
struct mock_hid *mock_hid_plug(UMockdevTestbed *bed, const struct mock_hid_params *params);
/* An input report arrives; as with the kernel, at most 64 wait, and the oldest gives way. */
void mock_hid_push(struct mock_hid *hid, const uint8_t *report, size_t len);
/* Reports that nobody has read yet. */
size_t mock_hid_waiting(struct mock_hid *hid);
/* last: the USB device goes, too. What is pushed after goes nowhere. */
void mock_hid_unplug(struct mock_hid *hid, bool last);
/* After it was unplugged and every client has closed it. *hid may be NULL; it is after. */
void mock_hid_free(struct mock_hid **hid);

#endif
