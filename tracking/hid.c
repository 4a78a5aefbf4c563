#include "tracking/hid.h"

#include <errno.h>
#include <fcntl.h>
#include <libudev.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* hid_init is not thread safe; after it hid_enumerate and hid_open_path are. */
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void init(void)
{
	(void)hid_init();
}

/* Printable ASCII of a wide string: a device may say anything. */
static void narrow(char *to, size_t size, const wchar_t *from)
{
	size_t len = 0;

	for (; from && *from && len + 1 < size; from++)
		if (*from >= 0x20 && *from < 0x7f)
			to[len++] = (char)*from;
	to[len] = '\0';
}

static void device_of(char *to, size_t size, const char *path)
{
	const char *name = strrchr(path, '/');
	struct udev *udev = udev_new();
	struct udev_device *node =
		udev && name ? udev_device_new_from_subsystem_sysname(udev, "hidraw", name + 1)
			     : NULL;
	struct udev_device *device = NULL; /* a parent is not referenced: it goes with its child */

	if (node)
		device = udev_device_get_parent_with_subsystem_devtype(node, "usb", "usb_device");
	if (node && !device)
		device = udev_device_get_parent(node);
	snprintf(to, size, "%s", device ? udev_device_get_syspath(device) : path);
	if (node)
		udev_device_unref(node);
	if (udev)
		udev_unref(udev);
}

static int by_path(const void *a, const void *b)
{
	const struct track_hid_node *left = a, *right = b;
	const size_t l = strlen(left->path), r = strlen(right->path);

	return l != r ? (l > r) - (l < r) : strcmp(left->path, right->path);
}

int track_hid_list(uint16_t vendor, uint16_t product, struct track_hid_node *out, int room)
{
	struct hid_device_info *all;
	int count = 0;

	pthread_once(&once, init);
	all = hid_enumerate(vendor, product);
	for (const struct hid_device_info *i = all; i && count < room; i = i->next) {
		struct track_hid_node *node = &out[count];
		bool known = false;

		if (!i->path || strlen(i->path) >= sizeof node->path)
			continue;
		/* hidapi lists a node once for each of its usages. */
		for (int k = 0; k < count; k++)
			known = known || !strcmp(out[k].path, i->path);
		if (known)
			continue;
		*node = (struct track_hid_node){
			.vendor = i->vendor_id,
			.product = i->product_id,
			.interface = i->interface_number,
			.bluetooth = i->bus_type == HID_API_BUS_BLUETOOTH,
		};
		strcpy(node->path, i->path);
		narrow(node->serial, sizeof node->serial, i->serial_number);
		narrow(node->name, sizeof node->name, i->product_string);
		device_of(node->device, sizeof node->device, i->path);
		count++;
	}
	hid_free_enumeration(all);
	qsort(out, (size_t)count, sizeof *out, by_path);
	return count;
}

/* hidapi does not say why: the system does, asked once more. */
static enum track_state why_not(const struct track_hid_node *node, char *why, size_t size)
{
	const int fd = open(node->path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
	const int error = fd < 0 ? errno : 0;

	if (fd >= 0)
		close(fd);
	switch (error) {
	case EACCES:
	case EPERM:
		snprintf(why, size,
			 "%s: no permission; install the udev rule 70-grotto.rules, plug the "
			 "device in again, and be in group grotto",
			 node->path);
		return TRACK_DENIED;
	case EBUSY:
		snprintf(why, size, "%s: another program has it; end that one", node->path);
		return TRACK_BUSY;
	case ENOENT:
	case ENODEV:
	case ENXIO:
		snprintf(why, size, "%s: gone while it was being opened", node->path);
		return TRACK_ABSENT;
	default:
		snprintf(why, size, "%s: cannot be opened: %s", node->path,
			 error ? strerror(error) : "hidapi refuses it");
		return TRACK_FAILED;
	}
}

enum track_state track_hid_open(const struct track_hid_node *node, hid_device **out, char *why,
				size_t size)
{
	pthread_once(&once, init);
	*out = hid_open_path(node->path);
	return *out ? TRACK_RUNNING : why_not(node, why, size);
}
