/*
 * What drivers of USB devices without a class share: finding a device, opening
 * it with a reason that a person can act on, and a pipe of bytes to and from
 * it. By libusb, asynchronous: TRACK_USB_TRANSFERS reads of one packet each
 * are with the kernel at any time, so that nothing waits in the device while
 * the thread does something else, and no packet has to wait for another to
 * fill a longer read.
 *
 * Every struct track_usb has a libusb context of its own: one that is begun
 * looks at what is plugged in now, and events are handled by its thread alone.
 * Thread: one per struct.
 */
#ifndef GROTTO_TRACKING_USB_H
#define GROTTO_TRACKING_USB_H

#include "tracking/device.h"

#include <libusb.h>
#include <poll.h>

#define TRACK_USB_NODES 16
#define TRACK_USB_TRANSFERS 16
#define TRACK_USB_PACKET_MOST 1024 /* of high speed bulk it is 512 */
#define TRACK_USB_POLLED 8

struct track_usb_node {
	uint16_t product;
	char path[40];	  /* bus and ports, "1-2.4", as in sysfs */
	char devnode[32]; /* "/dev/bus/usb/001/005" */
	char serial[64];  /* once opened: as far as it is printable; "" none */
	libusb_device *device;
};

/* Bytes that have arrived, in order; at most a packet. Called inside receive and send. */
typedef void track_usb_take(void *ctx, const uint8_t *bytes, size_t len);

struct track_usb_transfer {
	struct track_usb *usb;
	struct libusb_transfer *transfer; /* NULL: none */
	bool flying; /* with the kernel */
	uint8_t bytes[TRACK_USB_PACKET_MOST];
};

struct track_usb {
	libusb_context *context;
	struct track_usb_node nodes[TRACK_USB_NODES]; /* of the vendor, by path */
	int count;
	/* Open. */
	libusb_device_handle *handle;
	uint32_t claimed; /* interfaces */
	uint8_t in, out;  /* endpoint addresses; 0: none */
	bool in_interrupt, out_interrupt;
	uint16_t in_packet, out_packet; /* wMaxPacketSize */
	struct track_usb_transfer transfers[TRACK_USB_TRANSFERS];
	struct pollfd polled[TRACK_USB_POLLED + 1];
	int polled_count;
	track_usb_take *take;
	void *ctx;
	bool heard;	/* since receive was called */
	bool woken;	/* receive ended because wake_fd was readable */
	bool stalled;	/* the IN endpoint is halted */
	int stalls;	/* in a row */
	bool closing;
	int failed; /* enum libusb_error or 0 */
};

/* Looks at what is plugged in. GR_OK with nodes, or negative. End it in both cases. */
int track_usb_begin(struct track_usb *usb, uint16_t vendor);
/* Closes what is open and forgets the nodes. After a struct of zeroes, too. */
void track_usb_end(struct track_usb *usb);

/*
 * Opens a node: claims its interfaces, finds the first bulk or interrupt
 * endpoint of either direction and begins to read. TRACK_RUNNING, or why not,
 * with what a person can do in `why`; nothing is open then.
 */
enum track_state track_usb_open(struct track_usb *usb, struct track_usb_node *node,
				track_usb_take *take, void *ctx, char *why, size_t size);
void track_usb_close(struct track_usb *usb);

/*
 * Waits for bytes, at most timeout_ms or until wake_fd is readable, and hands
 * over all that have come. GR_OK; GR_NOTHING; with the reason GR_ERR_IO: it is
 * gone, GR_ERR_STATE: the connection broke.
 */
int track_usb_receive(struct track_usb *usb, int wake_fd, int timeout_ms, char *why, size_t size);
/*
 * Sends; a packet of no bytes follows where the last one is full, or the device
 * would wait for more. Takes at most half a second. GR_OK, or as receive.
 */
int track_usb_send(struct track_usb *usb, const uint8_t *bytes, size_t len, char *why, size_t size);

#endif
