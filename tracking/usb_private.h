/* What usb.c and usb_pipe.c share. */
#ifndef GROTTO_TRACKING_USB_PRIVATE_H
#define GROTTO_TRACKING_USB_PRIVATE_H

#include "tracking/usb.h"

/* 0, or an enum libusb_error; stop reading in both cases. */
int track_usb_start_reading(struct track_usb *usb);
/* Waits until the kernel has given everything back. */
void track_usb_stop_reading(struct track_usb *usb);

#endif
