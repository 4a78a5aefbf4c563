/* Bytes to and from an open device. */
#include "tracking/usb_private.h"

#include "base/result.h"

#include <stdio.h>
#include <string.h>

#define SEND_MS 200
#define STALLS_MOST 8 /* in a row, with nothing between */

static int submit(struct track_usb_transfer *t)
{
	const int r = libusb_submit_transfer(t->transfer);

	t->flying = r == 0;
	return r;
}

static void arrived(struct libusb_transfer *transfer)
{
	struct track_usb_transfer *t = transfer->user_data;
	struct track_usb *usb = t->usb;
	int r = 0;

	t->flying = false;
	switch (transfer->status) {
	case LIBUSB_TRANSFER_COMPLETED:
		usb->stalls = 0;
		if (transfer->actual_length > 0 && !usb->closing) {
			usb->heard = true;
			usb->take(usb->ctx, t->bytes, (size_t)transfer->actual_length);
		}
		break;
	case LIBUSB_TRANSFER_STALL: usb->stalled = true; break;
	case LIBUSB_TRANSFER_CANCELLED: break; /* by close, or to clear a halt */
	case LIBUSB_TRANSFER_NO_DEVICE: r = LIBUSB_ERROR_NO_DEVICE; break;
	case LIBUSB_TRANSFER_OVERFLOW: r = LIBUSB_ERROR_OVERFLOW; break;
	default: r = LIBUSB_ERROR_IO; break;
	}
	if (r == 0 && transfer->status == LIBUSB_TRANSFER_COMPLETED && !usb->stalled &&
	    !usb->closing)
		r = submit(t);
	if (r != 0 && !usb->failed)
		usb->failed = r;
}

static bool any_flying(const struct track_usb *usb)
{
	for (int i = 0; i < TRACK_USB_TRANSFERS; i++)
		if (usb->transfers[i].flying)
			return true;
	return false;
}

static void handle_events(struct track_usb *usb, int timeout_ms)
{
	struct timeval limit = { timeout_ms / 1000, timeout_ms % 1000 * 1000L };

	(void)libusb_handle_events_timeout_completed(usb->context, &limit, NULL);
}

/* What is cancelled comes back, from a device that is gone, too: libusb sees to it. */
static void call_back_all(struct track_usb *usb)
{
	for (int i = 0; i < TRACK_USB_TRANSFERS; i++)
		if (usb->transfers[i].flying)
			(void)libusb_cancel_transfer(usb->transfers[i].transfer);
	while (any_flying(usb))
		handle_events(usb, 100);
}

static int submit_all(struct track_usb *usb)
{
	int r = 0;

	for (int i = 0; i < TRACK_USB_TRANSFERS && r == 0; i++)
		r = submit(&usb->transfers[i]);
	return r;
}

/* Only while it is open does libusb have all the descriptors that it will have. */
static void list_polled(struct track_usb *usb)
{
	const struct libusb_pollfd **fds = libusb_get_pollfds(usb->context);

	usb->polled_count = 0;
	for (int i = 0; fds && fds[i] && usb->polled_count < TRACK_USB_POLLED; i++)
		usb->polled[usb->polled_count++] =
			(struct pollfd){ .fd = fds[i]->fd, .events = fds[i]->events };
	libusb_free_pollfds(fds);
}

int track_usb_start_reading(struct track_usb *usb)
{
	usb->closing = usb->stalled = false;
	usb->failed = usb->stalls = 0;
	for (int i = 0; i < TRACK_USB_TRANSFERS; i++) {
		struct track_usb_transfer *t = &usb->transfers[i];

		t->usb = usb;
		t->flying = false;
		t->transfer = libusb_alloc_transfer(0);
		if (!t->transfer)
			return LIBUSB_ERROR_NO_MEM;
		if (usb->in_interrupt)
			libusb_fill_interrupt_transfer(t->transfer, usb->handle, usb->in, t->bytes,
						       usb->in_packet, arrived, t, 0);
		else
			libusb_fill_bulk_transfer(t->transfer, usb->handle, usb->in, t->bytes,
						  usb->in_packet, arrived, t, 0);
	}
	list_polled(usb);
	return submit_all(usb);
}

void track_usb_stop_reading(struct track_usb *usb)
{
	usb->closing = true;
	call_back_all(usb);
	for (int i = 0; i < TRACK_USB_TRANSFERS; i++) {
		libusb_free_transfer(usb->transfers[i].transfer);
		usb->transfers[i].transfer = NULL;
	}
}

/* A halted endpoint gives nothing until it is told to go on, and nothing may be queued then. */
static void clear_halt(struct track_usb *usb)
{
	int r;

	call_back_all(usb);
	r = libusb_clear_halt(usb->handle, usb->in);
	usb->stalled = false;
	if (r == 0 && ++usb->stalls > STALLS_MOST)
		r = LIBUSB_ERROR_PIPE;
	if (r == 0)
		r = submit_all(usb);
	if (r != 0 && !usb->failed)
		usb->failed = r;
}

static int broken(int error, char *why, size_t size)
{
	if (error == LIBUSB_ERROR_NO_DEVICE) {
		snprintf(why, size, "unplugged");
		return GR_ERR_IO;
	}
	snprintf(why, size, "the USB connection broke: %s", libusb_strerror(error));
	return GR_ERR_STATE;
}

int track_usb_receive(struct track_usb *usb, int wake_fd, int timeout_ms, char *why, size_t size)
{
	const int n = usb->polled_count;

	usb->heard = usb->woken = false;
	usb->polled[n] = (struct pollfd){ .fd = wake_fd, .events = POLLIN };
	if (!usb->failed && poll(usb->polled, (nfds_t)n + 1, timeout_ms) > 0) {
		usb->woken = usb->polled[n].revents != 0;
		handle_events(usb, 0);
	}
	if (usb->stalled && !usb->failed)
		clear_halt(usb);
	if (usb->failed)
		return broken(usb->failed, why, size);
	return usb->heard ? GR_OK : GR_NOTHING;
}

/* By libusb_bulk_transfer, which handles events meanwhile: bytes may arrive in it. */
static int send_packets(struct track_usb *usb, const uint8_t *bytes, size_t len)
{
	uint8_t *data = (uint8_t *)(uintptr_t)bytes; /* it only reads them */
	int done = 0, r;

	r = usb->out_interrupt ? libusb_interrupt_transfer(usb->handle, usb->out, data, (int)len,
							   &done, SEND_MS)
			       : libusb_bulk_transfer(usb->handle, usb->out, data, (int)len, &done,
						      SEND_MS);
	if (r == LIBUSB_ERROR_PIPE)
		(void)libusb_clear_halt(usb->handle, usb->out);
	return r == 0 && done != (int)len ? LIBUSB_ERROR_IO : r;
}

int track_usb_send(struct track_usb *usb, const uint8_t *bytes, size_t len, char *why, size_t size)
{
	int r = usb->failed;

	if (r == 0)
		r = send_packets(usb, bytes, len);
	if (r == 0 && len % usb->out_packet == 0)
		r = send_packets(usb, bytes, 0);
	return r == 0 ? GR_OK : broken(r, why, size);
}
