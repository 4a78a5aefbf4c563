/* Finding and opening. What flows then is in usb_pipe.c. */
#include "tracking/usb_private.h"

#include "base/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is plugged in ---- */

static int by_path(const void *a, const void *b)
{
	const struct track_usb_node *left = a, *right = b;
	const size_t l = strlen(left->path), r = strlen(right->path);

	return l != r ? (l > r) - (l < r) : strcmp(left->path, right->path);
}

static void describe(struct track_usb_node *node, libusb_device *device, uint16_t product)
{
	uint8_t ports[8];
	const int n = libusb_get_port_numbers(device, ports, sizeof ports);
	const unsigned bus = libusb_get_bus_number(device);
	size_t len;

	*node = (struct track_usb_node){ .product = product };
	len = (size_t)snprintf(node->path, sizeof node->path, "%u", bus);
	for (int i = 0; i < n && len < sizeof node->path; i++)
		len += (size_t)snprintf(node->path + len, sizeof node->path - len, "%c%u",
					i ? '.' : '-', ports[i]);
	snprintf(node->devnode, sizeof node->devnode, "/dev/bus/usb/%03u/%03u", bus,
		 libusb_get_device_address(device));
	node->device = libusb_ref_device(device);
}

int track_usb_begin(struct track_usb *usb, uint16_t vendor)
{
	libusb_device **all = NULL;
	ssize_t n;

	memset(usb, 0, sizeof *usb);
	if (libusb_init(&usb->context) != 0) {
		usb->context = NULL;
		return GR_ERR_IO;
	}
	n = libusb_get_device_list(usb->context, &all);
	for (ssize_t i = 0; i < n && usb->count < TRACK_USB_NODES; i++) {
		struct libusb_device_descriptor d;

		if (libusb_get_device_descriptor(all[i], &d) == 0 && d.idVendor == vendor)
			describe(&usb->nodes[usb->count++], all[i], d.idProduct);
	}
	if (n >= 0)
		libusb_free_device_list(all, 1);
	qsort(usb->nodes, (size_t)usb->count, sizeof *usb->nodes, by_path);
	return n < 0 ? GR_ERR_IO : GR_OK;
}

void track_usb_end(struct track_usb *usb)
{
	track_usb_close(usb);
	for (int i = 0; i < usb->count; i++)
		libusb_unref_device(usb->nodes[i].device);
	usb->count = 0;
	if (usb->context)
		libusb_exit(usb->context);
	usb->context = NULL;
}

/* ---- opening ---- */

static enum track_state why_not(const struct track_usb_node *node, int error, char *why,
				size_t size)
{
	switch (error) {
	case LIBUSB_ERROR_ACCESS:
		snprintf(why, size,
			 "%s: no permission; install the udev rule 70-grotto.rules, plug the "
			 "device in again, and be in group grotto",
			 node->devnode);
		return TRACK_DENIED;
	case LIBUSB_ERROR_BUSY:
		snprintf(why, size, "%s: another program has it; end that one", node->devnode);
		return TRACK_BUSY;
	case LIBUSB_ERROR_NO_DEVICE:
		snprintf(why, size, "%s: gone while it was being opened", node->devnode);
		return TRACK_ABSENT;
	default:
		snprintf(why, size, "%s: cannot be opened: %s", node->devnode,
			 libusb_strerror(error));
		return TRACK_FAILED;
	}
}

static void take_endpoint(struct track_usb *usb, const struct libusb_endpoint_descriptor *e)
{
	const unsigned type = e->bmAttributes & LIBUSB_TRANSFER_TYPE_MASK;
	const bool in = e->bEndpointAddress & LIBUSB_ENDPOINT_IN;
	uint8_t *which = in ? &usb->in : &usb->out;
	const uint16_t packet = e->wMaxPacketSize & 0x7ff;

	if (*which || !packet || packet > TRACK_USB_PACKET_MOST ||
	    (type != LIBUSB_TRANSFER_TYPE_BULK && type != LIBUSB_TRANSFER_TYPE_INTERRUPT))
		return;
	*which = e->bEndpointAddress;
	*(in ? &usb->in_packet : &usb->out_packet) = packet;
	*(in ? &usb->in_interrupt : &usb->out_interrupt) = type == LIBUSB_TRANSFER_TYPE_INTERRUPT;
}

/* Claims all interfaces: the endpoints may be of two. */
static int claim(struct track_usb *usb, const struct libusb_config_descriptor *config)
{
	for (unsigned i = 0; i < config->bNumInterfaces && i < 32; i++) {
		const struct libusb_interface *interface = &config->interface[i];
		const struct libusb_interface_descriptor *d = interface->altsetting;
		int r;

		if (interface->num_altsetting < 1 || d->bInterfaceNumber >= 32)
			continue;
		r = libusb_claim_interface(usb->handle, d->bInterfaceNumber);
		if (r != 0)
			return r;
		usb->claimed |= UINT32_C(1) << d->bInterfaceNumber;
		for (unsigned e = 0; e < d->bNumEndpoints; e++)
			take_endpoint(usb, &d->endpoint[e]);
	}
	return 0;
}

static int configure(struct track_usb *usb, libusb_device *device)
{
	struct libusb_config_descriptor *config;
	int current = 0, r = libusb_get_configuration(usb->handle, &current);

	/* Not twice: some devices begin anew when they are told what they are already. */
	if (r == 0 && current == 0)
		r = libusb_set_configuration(usb->handle, 1);
	if (r == 0)
		r = libusb_get_active_config_descriptor(device, &config);
	if (r != 0)
		return r;
	/* "Not supported" where the system has no drivers to detach. */
	(void)libusb_set_auto_detach_kernel_driver(usb->handle, 1);
	r = claim(usb, config);
	libusb_free_config_descriptor(config);
	return r;
}

static void read_serial(struct track_usb *usb, struct track_usb_node *node)
{
	struct libusb_device_descriptor d;
	uint8_t text[sizeof node->serial];
	size_t len = 0;
	int n = 0;

	if (libusb_get_device_descriptor(node->device, &d) == 0 && d.iSerialNumber)
		n = libusb_get_string_descriptor_ascii(usb->handle, d.iSerialNumber, text,
						       (int)sizeof text - 1);
	for (int i = 0; i < n; i++)
		if (text[i] > 0x20 && text[i] < 0x7f)
			node->serial[len++] = (char)text[i];
	node->serial[len] = '\0';
}

enum track_state track_usb_open(struct track_usb *usb, struct track_usb_node *node,
				track_usb_take *take, void *ctx, char *why, size_t size)
{
	enum track_state state = TRACK_RUNNING;
	int r = libusb_open(node->device, &usb->handle);

	if (r != 0) {
		usb->handle = NULL;
		return why_not(node, r, why, size);
	}
	usb->take = take;
	usb->ctx = ctx;
	r = configure(usb, node->device);
	if (r == 0 && (!usb->in || !usb->out)) {
		snprintf(why, size, "%s: has no pair of bulk endpoints; it is not what its "
			 "product number says", node->devnode);
		state = TRACK_FAILED;
	} else if (r == 0) {
		read_serial(usb, node);
		r = track_usb_start_reading(usb);
	}
	if (r != 0)
		state = why_not(node, r, why, size);
	if (state != TRACK_RUNNING)
		track_usb_close(usb);
	return state;
}

void track_usb_close(struct track_usb *usb)
{
	if (!usb->handle)
		return;
	track_usb_stop_reading(usb);
	for (int i = 0; i < 32; i++)
		if (usb->claimed >> i & 1)
			(void)libusb_release_interface(usb->handle, i);
	libusb_close(usb->handle);
	usb->handle = NULL;
	usb->claimed = 0;
	usb->in = usb->out = 0;
}
