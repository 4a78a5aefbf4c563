/*
 * Tells that something was plugged in, by udev: after its rules have run, so
 * that a node that is announced may be opened. Thread: one owns it.
 */
#ifndef GROTTO_TRACKING_HOTPLUG_H
#define GROTTO_TRACKING_HOTPLUG_H

#include <stdbool.h>

struct track_hotplug;

/* NULL where there is no udev: whoever waits has to look again by time. subsystem: "usb", "hidraw".
 */
struct track_hotplug *track_hotplug_create(const char *subsystem);
void track_hotplug_destroy(struct track_hotplug **hotplug);
/* Readable when there is something to read; -1 for NULL. */
int track_hotplug_fd(const struct track_hotplug *hotplug);
/* Reads all that is there; true when a device was added. Never blocks. */
bool track_hotplug_added(struct track_hotplug *hotplug);

#endif
