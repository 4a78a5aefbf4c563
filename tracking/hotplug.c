#include "tracking/hotplug.h"

#include <libudev.h>
#include <stdlib.h>
#include <string.h>

struct track_hotplug {
	struct udev *udev;
	struct udev_monitor *monitor;
};

struct track_hotplug *track_hotplug_create(const char *subsystem)
{
	struct track_hotplug *h = calloc(1, sizeof *h);

	if (!h)
		return NULL;
	h->udev = udev_new();
	if (h->udev)
		h->monitor = udev_monitor_new_from_netlink(h->udev, "udev");
	if (!h->monitor ||
	    udev_monitor_filter_add_match_subsystem_devtype(h->monitor, subsystem, NULL) < 0 ||
	    udev_monitor_enable_receiving(h->monitor) < 0)
		track_hotplug_destroy(&h);
	return h;
}

void track_hotplug_destroy(struct track_hotplug **hotplug)
{
	struct track_hotplug *h = *hotplug;

	*hotplug = NULL;
	if (!h)
		return;
	if (h->monitor)
		udev_monitor_unref(h->monitor);
	if (h->udev)
		udev_unref(h->udev);
	free(h);
}

int track_hotplug_fd(const struct track_hotplug *h)
{
	return h ? udev_monitor_get_fd(h->monitor) : -1;
}

bool track_hotplug_added(struct track_hotplug *h)
{
	struct udev_device *device;
	bool added = false;

	while (h && (device = udev_monitor_receive_device(h->monitor)) != NULL) {
		const char *action = udev_device_get_action(device);

		added = added || (action && !strcmp(action, "add"));
		udev_device_unref(device);
	}
	return added;
}
