/* What is plugged in, and how it is opened. Which one is meant is in hid_choose.c. */
#include "tracking/hid.h"

#include <errno.h>
#include <fcntl.h>
#include <libudev.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define SLICE_MS 20

/*
 * hidapi's hid_enumerate and hid_open_path free and set the text of its last
 * error, which all threads share: one at a time. Once a device is open it has
 * a text of its own.
 */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

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

static void add_usage(struct track_hid_node *node, const struct hid_device_info *info)
{
	const uint32_t usage = TRACK_HID_USAGE(info->usage_page, info->usage);

	for (int i = 0; i < TRACK_HID_USAGES; i++)
		if (!node->usages[i] || node->usages[i] == usage) {
			node->usages[i] = usage;
			return;
		}
}

static struct track_hid_node *known(struct track_hid_node *nodes, int count, const char *path)
{
	for (int i = 0; i < count; i++)
		if (!strcmp(nodes[i].path, path))
			return &nodes[i];
	return NULL;
}

int track_hid_list(uint16_t vendor, uint16_t product, struct track_hid_node *out, int room)
{
	struct hid_device_info *all;
	int count = 0;

	pthread_mutex_lock(&lock);
	all = hid_enumerate(vendor, product);
	pthread_mutex_unlock(&lock);
	for (const struct hid_device_info *i = all; i; i = i->next) {
		/* hidapi lists a node once for each of its usages. */
		struct track_hid_node *node = i->path ? known(out, count, i->path) : NULL;

		if (!i->path || strlen(i->path) >= sizeof node->path || (!node && count == room))
			continue;
		if (node) {
			add_usage(node, i);
			continue;
		}
		node = &out[count++];
		*node = (struct track_hid_node){
			.vendor = i->vendor_id,
			.product = i->product_id,
			.interface = i->interface_number,
			.bluetooth = i->bus_type == HID_API_BUS_BLUETOOTH,
		};
		add_usage(node, i);
		strcpy(node->path, i->path);
		narrow(node->serial, sizeof node->serial, i->serial_number);
		narrow(node->name, sizeof node->name, i->product_string);
		device_of(node->device, sizeof node->device, i->path);
	}
	hid_free_enumeration(all);
	qsort(out, (size_t)count, sizeof *out, by_path);
	return count;
}

/* ---- opening and reading ---- */

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
	pthread_mutex_lock(&lock);
	*out = hid_open_path(node->path);
	pthread_mutex_unlock(&lock);
	return *out ? TRACK_RUNNING : why_not(node, why, size);
}

static bool is_to_end(const struct track_device *device)
{
	struct pollfd wake = { .fd = track_device_wake_fd(device), .events = POLLIN };

	return poll(&wake, 1, 0) > 0;
}

int track_hid_read(const struct track_device *device, hid_device *hid, uint8_t *bytes, size_t size,
		   int timeout_ms)
{
	int n = 0;

	do {
		const int slice_ms = timeout_ms < SLICE_MS ? timeout_ms : SLICE_MS;

		n = hid_read_timeout(hid, bytes, size, slice_ms);
		timeout_ms -= slice_ms;
	} while (n == 0 && timeout_ms > 0 && !is_to_end(device));
	return n;
}
