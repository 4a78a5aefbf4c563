#include "tests/unit/mock_hid.h"

#include <errno.h>
#include <linux/hidraw.h>
#include <linux/ioctl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define QUEUE 64
#define REPORT 256

struct report {
	size_t len;
	uint8_t bytes[REPORT];
};

struct mock_hid {
	UMockdevTestbed *bed;
	struct mock_node node;
	UMockdevIoctlBase *base;
	pthread_mutex_t lock;
	struct mock_hid_params params;
	char devnode[64], usb[128], interface[160], hid[224], raw[320]; /* without /sys */
	struct report queue[QUEUE];
	size_t first, count;
	bool bell; /* a byte is in the pty: poll says that there is something */
	_Atomic bool gone;
	UMockdevIoctlClient *pending; /* a read that waits */
};

static void ring(struct mock_hid *h, bool on)
{
	char c = 0;

	if (on && !h->bell && write(h->node.master, &c, 1) == 1)
		h->bell = true;
	if (on || !h->bell)
		return;
	while (read(h->node.slave, &c, 1) == 1)
		;
	h->bell = false;
}

static int feature(struct mock_hid *h, bool get, uint8_t *bytes, int len)
{
	const struct mock_hid_ops *ops = &h->params.ops;

	if (get)
		return ops->get_feature ? ops->get_feature(ops->ctx, bytes, len) : -EPIPE;
	return ops->set_feature ? ops->set_feature(ops->ctx, bytes, len) : -EPIPE;
}

static int answer(struct mock_hid *h, int number, uint8_t *bytes, int len)
{
	const struct mock_hid_params *p = &h->params;
	const int descriptor_len = (int)p->descriptor_len;
	struct hidraw_report_descriptor descriptor;
	const struct hidraw_devinfo info = { p->bluetooth ? 5 : 3, (short)p->vendor,
					     (short)p->product };

	switch (number) {
	case 1: /* HIDIOCGRDESCSIZE */
		memcpy(bytes, &descriptor_len, sizeof descriptor_len);
		return 0;
	case 2: /* HIDIOCGRDESC */
		memcpy(&descriptor, bytes, sizeof descriptor.size);
		if (descriptor.size > p->descriptor_len)
			descriptor.size = (unsigned)p->descriptor_len;
		memcpy(bytes + sizeof descriptor.size, p->descriptor, descriptor.size);
		return 0;
	case 3: /* HIDIOCGRAWINFO */ memcpy(bytes, &info, sizeof info); return 0;
	case 4: /* HIDIOCGRAWNAME */ return snprintf((char *)bytes, (size_t)len, "%s", p->name) + 1;
	case 6: /* HIDIOCSFEATURE */
	case 7: /* HIDIOCGFEATURE */ return feature(h, number == 7, bytes, len);
	default: return -ENOTTY;
	}
}

static gboolean on_ioctl(UMockdevIoctlBase *base, UMockdevIoctlClient *client, struct mock_hid *h)
{
	const unsigned long request = umockdev_ioctl_client_get_request(client);
	const int number = _IOC_NR(request);
	const gsize len =
		number == 2 ? sizeof(struct hidraw_report_descriptor) : _IOC_SIZE(request);
	int r;

	(void)base;
	if (h->gone || _IOC_TYPE(request) != 'H') {
		umockdev_ioctl_client_complete(client, -1, h->gone ? ENODEV : ENOTTY);
		return TRUE;
	}
	g_autoptr(UMockdevIoctlData) data =
		umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, len, NULL);
	r = answer(h, number, data->data, (int)len);
	umockdev_ioctl_client_complete(client, r < 0 ? -1 : r, r < 0 ? -r : 0);
	return TRUE;
}

static void give(UMockdevIoctlClient *client, const struct report *report)
{
	UMockdevIoctlData *data = umockdev_ioctl_client_get_arg(client);
	/* The kernel cuts, too. */
	const size_t room = (size_t)data->data_len, n = report->len < room ? report->len : room;

	memcpy(data->data, report->bytes, n);
	umockdev_ioctl_client_complete(client, (glong)n, 0);
}

static gboolean on_read(UMockdevIoctlBase *base, UMockdevIoctlClient *client, struct mock_hid *h)
{
	(void)base;
	pthread_mutex_lock(&h->lock);
	if (h->gone) {
		umockdev_ioctl_client_complete(client, -1, EIO);
	} else if (!h->count) {
		h->pending = g_object_ref(client);
	} else {
		struct report *report = &h->queue[h->first];

		h->first = (h->first + 1) % QUEUE;
		if (--h->count == 0)
			ring(h, false);
		give(client, report);
	}
	pthread_mutex_unlock(&h->lock);
	return TRUE;
}

static gboolean on_write(UMockdevIoctlBase *base, UMockdevIoctlClient *client, struct mock_hid *h)
{
	UMockdevIoctlData *data = umockdev_ioctl_client_get_arg(client);

	(void)base;
	if (h->gone) {
		umockdev_ioctl_client_complete(client, -1, ENODEV);
		return TRUE;
	}
	if (h->params.ops.output)
		h->params.ops.output(h->params.ops.ctx, data->data, (int)data->data_len);
	umockdev_ioctl_client_complete(client, (glong)data->data_len, 0);
	return TRUE;
}

void mock_hid_push(struct mock_hid *h, const uint8_t *bytes, size_t len)
{
	struct report report = { .len = len < REPORT ? len : REPORT };

	memcpy(report.bytes, bytes, report.len);
	pthread_mutex_lock(&h->lock);
	if (h->gone) {
		; /* nobody hears it */
	} else if (h->pending) {
		give(h->pending, &report);
		g_clear_object(&h->pending);
	} else {
		if (h->count == QUEUE) {
			h->first = (h->first + 1) % QUEUE;
			h->count--;
		}
		h->queue[(h->first + h->count++) % QUEUE] = report;
		ring(h, true);
	}
	pthread_mutex_unlock(&h->lock);
}

size_t mock_hid_waiting(struct mock_hid *h)
{
	size_t count;

	pthread_mutex_lock(&h->lock);
	count = h->count;
	pthread_mutex_unlock(&h->lock);
	return count;
}

static void name_paths(struct mock_hid *h)
{
	const struct mock_hid_params *p = &h->params;

	snprintf(h->devnode, sizeof h->devnode, "/dev/hidraw%d", p->number);
	snprintf(h->usb, sizeof h->usb, "/devices/mockusb/1-%d", p->port);
	if (p->bluetooth)
		snprintf(h->interface, sizeof h->interface, "/devices/mockbt");
	else
		snprintf(h->interface, sizeof h->interface, "%s/1-%d:1.%d", h->usb, p->port,
			 p->interface);
	snprintf(h->hid, sizeof h->hid, "%s/%04X:%04X:%04X.%04X", h->interface,
		 p->bluetooth ? 5u : 3u, p->vendor, p->product, p->number + 1);
	snprintf(h->raw, sizeof h->raw, "%s/hidraw/hidraw%d", h->hid, p->number);
}

static void describe_usb(struct mock_hid *h)
{
	const struct mock_hid_params *p = &h->params;
	g_autofree char *root = umockdev_testbed_get_root_dir(h->bed);
	g_autofree char *there = g_strconcat(root, "/sys", h->usb, NULL);
	g_autofree char *device = g_strdup_printf(
		"P: %s\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nA: busnum=1\\n\nA: devnum=%d\\n\n"
		"A: idVendor=%04x\\n\nA: idProduct=%04x\\n\nA: bcdDevice=0100\\n\n"
		"A: manufacturer=Mock\\n\nA: product=%s\\n\nA: serial=%s\\n\n\n",
		h->usb, p->port + 1, p->vendor, p->product, p->name, p->serial);
	g_autofree char *interface =
		g_strdup_printf("P: %s\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nA: "
				"bInterfaceNumber=%02x\\n\n\n",
				h->interface, p->interface);

	if (access(there, F_OK) != 0)
		mock_add(h->bed, device);
	mock_add(h->bed, interface);
}

/* All that hidapi looks for in sysfs; what it misses it passes over without a word. */
static void describe_hid(struct mock_hid *h)
{
	const struct mock_hid_params *p = &h->params;
	g_autofree char *descriptor = mock_hex(p->descriptor, p->descriptor_len);
	/* In one go, the event last: whoever hears it opens the device at once. */
	g_autofree char *text = g_strdup_printf(
		"P: %s\nE: SUBSYSTEM=hid\nE: HID_ID=%04X:%08X:%08X\nE: HID_NAME=%s\n"
		"E: HID_UNIQ=%s\nH: report_descriptor=%s\n\n"
		"P: %s\nE: SUBSYSTEM=hidraw\nE: DEVNAME=%s\nE: MAJOR=%u\n"
		"E: MINOR=%u\nA: dev=%u:%u\\n\nL: device=../../../%s\n\n",
		h->hid, p->bluetooth ? 5u : 3u, p->vendor, p->product, p->name, p->serial,
		descriptor, h->raw, h->devnode, h->node.major, h->node.minor, h->node.major,
		h->node.minor, strrchr(h->hid, '/') + 1);

	mock_add(h->bed, text);
}

struct mock_hid *mock_hid_plug(UMockdevTestbed *bed, const struct mock_hid_params *params)
{
	struct mock_hid *h = calloc(1, sizeof *h);

	if (!h)
		abort();
	h->bed = bed;
	h->params = *params;
	pthread_mutex_init(&h->lock, NULL);
	name_paths(h);
	h->base = umockdev_ioctl_base_new();
	g_signal_connect(h->base, "handle-ioctl", G_CALLBACK(on_ioctl), h);
	g_signal_connect(h->base, "handle-read", G_CALLBACK(on_read), h);
	g_signal_connect(h->base, "handle-write", G_CALLBACK(on_write), h);
	/* Node, handlers, sysfs: in this order. */
	if (!mock_node_open(&h->node, bed, h->devnode) ||
	    !umockdev_testbed_attach_ioctl(bed, h->devnode, h->base, NULL))
		abort();
	mock_forget_number(bed, h->node.major, h->node.minor);
	if (!params->bluetooth)
		describe_usb(h);
	describe_hid(h);
	return h;
}

void mock_hid_unplug(struct mock_hid *h, bool last)
{
	pthread_mutex_lock(&h->lock);
	h->gone = true;
	if (h->pending)
		umockdev_ioctl_client_complete(h->pending, -1, EIO);
	g_clear_object(&h->pending);
	mock_node_hang_up(&h->node);
	pthread_mutex_unlock(&h->lock);
	mock_remove(h->bed, h->raw);
	mock_remove(h->bed, h->hid);
	if (!h->params.bluetooth)
		mock_remove(h->bed, h->interface);
	if (last && !h->params.bluetooth)
		mock_remove(h->bed, h->usb);
	umockdev_testbed_detach_ioctl(h->bed, h->devnode, NULL);
}

void mock_hid_free(struct mock_hid **hid)
{
	struct mock_hid *h = *hid;

	*hid = NULL;
	if (!h)
		return;
	g_object_unref(h->base);
	pthread_mutex_destroy(&h->lock);
	free(h);
}
