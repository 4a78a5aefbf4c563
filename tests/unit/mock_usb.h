/*
 * A USB device's usbfs node under the real libusb: descriptors, control and
 * bulk transfers, endpoints that halt, unplugging, and being refused.
 *
 * Thread: any; the callbacks run in the test bed's own or in that of
 * mock_usb_push, and may push.
 */
#ifndef GROTTO_TESTS_UNIT_MOCK_USB_H
#define GROTTO_TESTS_UNIT_MOCK_USB_H

#include "tests/unit/mock_node.h"

#include <stddef.h>

struct mock_usb_params {
	int bus, number; /* /dev/bus/usb/001/002; the port is the number: path "1-2" */
	uint16_t vendor, product;
	uint8_t in, out; /* bulk endpoint addresses; 0: it has none */
	uint16_t packet; /* wMaxPacketSize of both */
	const char *serial; /* NULL: it has no such string */
	bool unconfigured; /* until it is told */
	bool denied; /* this user may not open it; root may not either */
	bool busy;   /* another program has claimed it */
	/* Bytes of one transfer, which may be none; 0 or -errno (-EPIPE: halts). */
	int (*sent)(void *ctx, const uint8_t *bytes, size_t len);
	/* Asked for a packet when a read waits and nothing was pushed. 0: none. May be NULL. */
	size_t (*idle)(void *ctx, uint8_t *bytes, size_t room);
	void *ctx;
};

struct mock_usb;
struct mock_usb *mock_usb_create(UMockdevTestbed *bed, const struct mock_usb_params *params);
/* Once. A client may have opened it before this returns. */
void mock_usb_plug(struct mock_usb *usb);
/* Bytes arrive from the device, in as many packets as they need. */
void mock_usb_push(struct mock_usb *usb, const uint8_t *bytes, size_t len);
/* The next read ends so: -EPIPE halts the endpoint until the client clears that. */
void mock_usb_push_error(struct mock_usb *usb, int error);
/* Bytes that no read has taken yet. */
size_t mock_usb_waiting(struct mock_usb *usb);
bool mock_usb_claimed(struct mock_usb *usb);
/* The other program that had it has ended. */
void mock_usb_let_go(struct mock_usb *usb);
/* Reads that are with the kernel. */
unsigned mock_usb_reads(struct mock_usb *usb);
int mock_usb_configuration(struct mock_usb *usb);
/*
 * Unplugs it: what a client has open ends with ENODEV, what it has submitted
 * likewise, and udev tells of it.
 *
 * umockdev aborts when a listener of udev's closes its socket just as it is
 * told. Where another thread may do that, hang up first, wait until the device
 * is claimed no more, and keep a libusb context, whose listener all share.
 */
void mock_usb_unplug(struct mock_usb *usb);
void mock_usb_hang_up(struct mock_usb *usb);
/* Of one that is unplugged and that no client has open any more. NULL: nothing. */
void mock_usb_free(struct mock_usb **usb);

#endif
