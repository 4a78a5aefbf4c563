#include "tests/unit/mock_usb.h"

#include <errno.h>
#include <linux/usbdevice_fs.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

/* A file that nobody may open for writing, root included: the kernel's name is fixed. */
#define NOBODYS "/proc/sys/kernel/ostype"
#define DESCRIPTORS (18 + 9 + 9 + 2 * 7)

struct packet {
	struct packet *next;
	int error;
	size_t len;
	uint8_t bytes[];
};

struct urb {
	struct urb *next;
	UMockdevIoctlData *data, *buffer; /* the client's struct usbdevfs_urb and its bytes */
	uint8_t endpoint, type;
};

struct mock_usb {
	UMockdevTestbed *bed;
	struct mock_node node;
	UMockdevIoctlBase *base;
	pthread_mutex_t lock; /* recursive */
	struct mock_usb_params params;
	char devnode[64], path[64];
	uint8_t descriptors[DESCRIPTORS];
	size_t descriptors_len;
	int configuration;
	struct urb *flying, *done;
	struct packet *packets;
	bool ready, gone, claimed, halted;
};

/* usbfs says POLLOUT exactly while something can be reaped: a stopped terminal takes no output. */
static void set_ready(struct mock_usb *m)
{
	const bool ready = m->done != NULL;

	if (ready != m->ready && m->node.slave >= 0)
		tcflow(m->node.slave, ready ? TCOON : TCOOFF);
	m->ready = ready;
}

static void finish(struct mock_usb *m, struct urb **at, int error, const uint8_t *bytes, size_t len)
{
	struct urb *u = *at, **end = &m->done;
	struct usbdevfs_urb *raw = (void *)u->data->data;
	const size_t skip = u->type == USBDEVFS_URB_TYPE_CONTROL ? 8 : 0;
	const size_t room = (size_t)raw->buffer_length - skip;

	*at = u->next;
	if (len > room) {
		len = room;
		error = error ? error : -EOVERFLOW;
	}
	if (bytes && len)
		memcpy(u->buffer->data + skip, bytes, len);
	raw->status = error;
	raw->actual_length = (int)len;
	while (*end)
		end = &(*end)->next;
	u->next = NULL;
	*end = u;
}

static struct urb **first_read(struct mock_usb *m)
{
	struct urb **read = &m->flying;

	while (*read && (*read)->endpoint != m->params.in)
		read = &(*read)->next;
	return *read ? read : NULL;
}

/* Packets that wait to reads that wait. */
static void pump(struct mock_usb *m)
{
	uint8_t bytes[1024];
	struct urb **read;
	size_t len;

	while (!m->halted && (read = first_read(m)) != NULL) {
		struct packet *packet = m->packets;

		if (packet) {
			m->halted = packet->error == -EPIPE;
			finish(m, read, packet->error, packet->bytes, packet->len);
			m->packets = packet->next;
			free(packet);
			continue;
		}
		len = m->params.idle ? m->params.idle(m->params.ctx, bytes, m->params.packet) : 0;
		if (!len)
			break;
		finish(m, read, 0, bytes, len);
	}
	set_ready(m);
}

/* Negative: the device stalls the request. */
static int answer_control(const struct mock_usb *m, const uint8_t setup[8], uint8_t out[256])
{
	const char *text = m->params.serial;
	size_t len = 4;

	if (setup[0] != 0x80 || setup[1] != 6 || setup[3] != 3) /* GET_DESCRIPTOR, string */
		return -EPIPE;
	memcpy(out, (const uint8_t[]){ 4, 3, 9, 4 }, 4); /* languages: English */
	if (setup[2] == 0)
		return 4;
	if (setup[2] != 3 || !text)
		return -EPIPE;
	for (len = 2; *text && len < 254; len += 2) {
		out[len] = (uint8_t)*text++;
		out[len + 1] = 0;
	}
	out[0] = (uint8_t)len;
	return (int)len;
}

static void submit(struct mock_usb *m, UMockdevIoctlData *arg)
{
	UMockdevIoctlData *data = umockdev_ioctl_data_resolve(arg, 0, sizeof(struct usbdevfs_urb), NULL);
	const struct usbdevfs_urb *raw = (void *)data->data;
	struct urb *u = calloc(1, sizeof *u), **at = &m->flying;
	const size_t len = (size_t)raw->buffer_length;

	u->data = data;
	u->endpoint = raw->endpoint;
	u->type = raw->type;
	if (len)
		u->buffer = umockdev_ioctl_data_resolve(data, offsetof(struct usbdevfs_urb, buffer), len,
							NULL);
	while (*at)
		at = &(*at)->next;
	*at = u;
	if (u->type == USBDEVFS_URB_TYPE_CONTROL) {
		const uint8_t *setup = u->buffer->data;
		const size_t room = (size_t)(setup[6] | setup[7] << 8);
		uint8_t answer[256];
		const int n = answer_control(m, setup, answer);

		finish(m, at, n < 0 ? n : 0, answer, n < 0 ? 0 : (size_t)n < room ? (size_t)n : room);
	} else if (!(u->endpoint & 0x80)) {
		const int r = m->params.sent ? m->params.sent(m->params.ctx,
							      u->buffer ? u->buffer->data : NULL, len) :
					       0;

		/* What it said to that may have moved this one in the list, but not past others. */
		for (at = &m->flying; *at != u; at = &(*at)->next)
			;
		finish(m, at, r, NULL, r ? 0 : len);
	}
	pump(m);
}

static int discard(struct mock_usb *m, UMockdevIoctlData *arg)
{
	struct urb **at = &m->flying;

	while (*at && (*at)->data->client_addr != *(gulong *)arg->data)
		at = &(*at)->next;
	if (!*at)
		return -EINVAL;
	finish(m, at, -ENOENT, NULL, 0);
	set_ready(m);
	return 0;
}

static void free_urb(struct urb *u)
{
	g_object_unref(u->data);
	if (u->buffer)
		g_object_unref(u->buffer);
	free(u);
}

static void set_configuration(struct mock_usb *m)
{
	g_autofree char *path = g_strconcat("/sys", m->path, NULL);

	m->configuration = 1;
	umockdev_testbed_set_attribute(m->bed, path, "bConfigurationValue", "1\n");
}

static int simple(struct mock_usb *m, unsigned long request, UMockdevIoctlData *arg)
{
	if (request == USBDEVFS_GETDRIVER || request == USBDEVFS_IOCTL)
		return -ENODATA; /* no driver of the kernel's is bound */
	if (request == USBDEVFS_RELEASEINTERFACE)
		m->claimed = false;
	if (m->gone)
		return -ENODEV;
	switch (request) {
	case USBDEVFS_GET_CAPABILITIES: {
		g_autoptr(UMockdevIoctlData) d = umockdev_ioctl_data_resolve(arg, 0, 4, NULL);

		*(uint32_t *)d->data = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION |
				       USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
				       USBDEVFS_CAP_BULK_SCATTER_GATHER |
				       USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
		return 0;
	}
	case USBDEVFS_DISCONNECT_CLAIM:
	case USBDEVFS_CLAIMINTERFACE:
		m->claimed = !m->params.busy;
		return m->params.busy ? -EBUSY : 0;
	case USBDEVFS_SETCONFIGURATION: set_configuration(m); return 0;
	case USBDEVFS_CLEAR_HALT:
		m->halted = false;
		pump(m);
		return 0;
	case USBDEVFS_RELEASEINTERFACE:
	case USBDEVFS_SETINTERFACE:
	case USBDEVFS_RESET: return 0;
	case USBDEVFS_SUBMITURB: submit(m, arg); return 0;
	case USBDEVFS_DISCARDURB: return discard(m, arg);
	default: return -ENOTTY;
	}
}

static gboolean on_ioctl(UMockdevIoctlBase *base, UMockdevIoctlClient *client, struct mock_usb *m)
{
	const unsigned long request = umockdev_ioctl_client_get_request(client);
	UMockdevIoctlData *arg = umockdev_ioctl_client_get_arg(client);
	struct urb *reaped = NULL;
	int r = 0;

	(void)base;
	pthread_mutex_lock(&m->lock);
	if (request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY) {
		reaped = m->done;
		if (reaped)
			m->done = reaped->next;
		else
			r = m->gone ? -ENODEV : -EAGAIN;
		set_ready(m);
	} else {
		r = simple(m, request, arg);
	}
	pthread_mutex_unlock(&m->lock);
	if (!reaped) {
		umockdev_ioctl_client_complete(client, r < 0 ? -1 : r, r < 0 ? -r : 0);
		return TRUE;
	}
	/* Hands the client its own urb's address, and what was written into it and its bytes. */
	g_autoptr(UMockdevIoctlData) pointer = umockdev_ioctl_data_resolve(arg, 0, sizeof(void *), NULL);
	umockdev_ioctl_data_set_ptr(pointer, 0, reaped->data);
	umockdev_ioctl_client_complete(client, 0, 0);
	free_urb(reaped);
	return TRUE;
}

static void push(struct mock_usb *m, int error, const uint8_t *bytes, size_t len)
{
	struct packet *packet = malloc(sizeof *packet + len), **end = &m->packets;

	packet->next = NULL;
	packet->error = error;
	packet->len = len;
	if (len)
		memcpy(packet->bytes, bytes, len);
	while (*end)
		end = &(*end)->next;
	*end = packet;
}

void mock_usb_push(struct mock_usb *m, const uint8_t *bytes, size_t len)
{
	pthread_mutex_lock(&m->lock);
	for (size_t at = 0; at < len; at += m->params.packet)
		push(m, 0, bytes + at, len - at < m->params.packet ? len - at : m->params.packet);
	pump(m);
	pthread_mutex_unlock(&m->lock);
}

void mock_usb_push_error(struct mock_usb *m, int error)
{
	pthread_mutex_lock(&m->lock);
	push(m, error, NULL, 0);
	pump(m);
	pthread_mutex_unlock(&m->lock);
}

size_t mock_usb_waiting(struct mock_usb *m)
{
	size_t len = 0;

	pthread_mutex_lock(&m->lock);
	for (const struct packet *p = m->packets; p; p = p->next)
		len += p->len;
	pthread_mutex_unlock(&m->lock);
	return len;
}

bool mock_usb_claimed(struct mock_usb *m)
{
	pthread_mutex_lock(&m->lock);
	const bool claimed = m->claimed;
	pthread_mutex_unlock(&m->lock);
	return claimed;
}

void mock_usb_let_go(struct mock_usb *m)
{
	pthread_mutex_lock(&m->lock);
	m->params.busy = false;
	pthread_mutex_unlock(&m->lock);
}

unsigned mock_usb_reads(struct mock_usb *m)
{
	unsigned count = 0;

	pthread_mutex_lock(&m->lock);
	for (const struct urb *u = m->flying; u; u = u->next)
		count += u->endpoint == m->params.in;
	pthread_mutex_unlock(&m->lock);
	return count;
}

int mock_usb_configuration(struct mock_usb *m)
{
	pthread_mutex_lock(&m->lock);
	const int configuration = m->configuration;
	pthread_mutex_unlock(&m->lock);
	return configuration;
}

/* ---- plugging ---- */

static void describe(struct mock_usb *m)
{
	const struct mock_usb_params *p = &m->params;
	const uint8_t endpoints = (uint8_t)((p->in != 0) + (p->out != 0));
	const uint8_t total = (uint8_t)(9 + 9 + 7 * endpoints);
	const uint8_t device[18] = { 18,
				     1,
				     0,
				     2,
				     0,
				     0,
				     0,
				     64,
				     (uint8_t)p->vendor,
				     (uint8_t)(p->vendor >> 8),
				     (uint8_t)p->product,
				     (uint8_t)(p->product >> 8),
				     0,
				     1,
				     0,
				     0,
				     p->serial ? 3 : 0,
				     1 };
	const uint8_t configuration[9] = { 9, 2, total, 0, 1, 1, 0, 0x80, 50 };
	const uint8_t interface[9] = { 9, 4, 0, 0, endpoints, 255, 0, 0, 0 };
	const uint8_t size[2] = { (uint8_t)p->packet, (uint8_t)(p->packet >> 8) };
	uint8_t *to = m->descriptors;

	memcpy(to, device, 18);
	memcpy(to + 18, configuration, 9);
	memcpy(to + 27, interface, 9);
	to += 36;
	for (int i = 0; i < 2; i++) {
		const uint8_t address = i ? p->out : p->in;

		if (!address)
			continue;
		memcpy(to, (const uint8_t[]){ 7, 5, address, 2, size[0], size[1], 0 }, 7);
		to += 7;
	}
	m->descriptors_len = (size_t)(to - m->descriptors);
}

static void add_to_sysfs(struct mock_usb *m)
{
	const struct mock_usb_params *p = &m->params;
	g_autofree char *descriptors = mock_hex(m->descriptors, m->descriptors_len);
	g_autofree char *root = umockdev_testbed_get_root_dir(m->bed);
	g_autofree char *node = g_strconcat(root, m->devnode, NULL);
	g_autofree char *text = g_strdup_printf(
		"P: %s\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DRIVER=usb\nE: DEVNAME=%s\n"
		"E: BUSNUM=%03d\nE: DEVNUM=%03d\nE: MAJOR=189\nE: MINOR=%d\nA: dev=189:%d\\n\n"
		"A: busnum=%d\\n\nA: devnum=%d\\n\nA: bConfigurationValue=%d\\n\nA: speed=480\\n\n"
		"A: idVendor=%04x\\n\nA: idProduct=%04x\\n\nH: descriptors=%s\n\n",
		m->path, m->devnode, p->bus, p->number, p->number - 1, p->number - 1, p->bus, p->number,
		m->configuration, p->vendor, p->product, descriptors);

	mock_forget_number(m->bed, 189, (unsigned)p->number - 1);
	if (p->denied) {
		unlink(node);
		if (symlink(NOBODYS, node) != 0)
			abort();
	}
	mock_add(m->bed, text);
}

struct mock_usb *mock_usb_create(UMockdevTestbed *bed, const struct mock_usb_params *params)
{
	struct mock_usb *m = calloc(1, sizeof *m);
	pthread_mutexattr_t recursive;

	if (!m)
		abort();
	m->bed = bed;
	m->params = *params;
	m->ready = true;
	m->configuration = params->unconfigured ? 0 : 1;
	pthread_mutexattr_init(&recursive);
	pthread_mutexattr_settype(&recursive, PTHREAD_MUTEX_RECURSIVE);
	pthread_mutex_init(&m->lock, &recursive);
	pthread_mutexattr_destroy(&recursive);
	snprintf(m->devnode, sizeof m->devnode, "/dev/bus/usb/%03d/%03d", params->bus, params->number);
	snprintf(m->path, sizeof m->path, "/devices/mockusb/%d-%d", params->bus, params->number);
	m->base = umockdev_ioctl_base_new();
	g_signal_connect(m->base, "handle-ioctl", G_CALLBACK(on_ioctl), m);
	describe(m);
	return m;
}

void mock_usb_plug(struct mock_usb *m)
{
	/* Node, handlers, sysfs: in this order. */
	if (!mock_node_open(&m->node, m->bed, m->devnode) ||
	    !umockdev_testbed_attach_ioctl(m->bed, m->devnode, m->base, NULL))
		abort();
	set_ready(m);
	add_to_sysfs(m);
}

void mock_usb_hang_up(struct mock_usb *m)
{
	pthread_mutex_lock(&m->lock);
	if (!m->gone) {
		m->gone = true;
		while (m->flying)
			finish(m, &m->flying, -ENODEV, NULL, 0);
		set_ready(m);
		mock_node_hang_up(&m->node);
	}
	pthread_mutex_unlock(&m->lock);
}

void mock_usb_unplug(struct mock_usb *m)
{
	mock_usb_hang_up(m);
	mock_remove(m->bed, m->path);
	umockdev_testbed_detach_ioctl(m->bed, m->devnode, NULL);
}

void mock_usb_free(struct mock_usb **usb)
{
	struct mock_usb *m = *usb;

	*usb = NULL;
	if (!m)
		return;
	for (struct packet *p = m->packets, *next; p; p = next) {
		next = p->next;
		free(p);
	}
	for (struct urb *u = m->done, *next; u; u = next) {
		next = u->next;
		free_urb(u);
	}
	g_object_unref(m->base);
	pthread_mutex_destroy(&m->lock);
	free(m);
}
