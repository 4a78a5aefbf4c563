/* The Hydra's nodes: interface 0 reports, interface 1 switches the mode. */
#include "tracking/hid.h"
#include "tracking/hydra.h"

#include "base/result.h"

#include <stdio.h>
#include <stdlib.h>

#define VENDOR 0x1532
#define PRODUCT 0x0300
#define LISTEN_MS 250 /* for a device that is in motion mode already: 60 reports' time */
#define SWITCH_NS (5 * GR_NS_PER_S) /* that a mode switch may take */
#define SILENCE_NS GR_NS_PER_S /* in motion mode it never rests: somebody has switched it */
#define SERIAL_AT 216		    /* in a long feature report */
#define SERIAL_LEN 17

struct hydra {
	struct track_device device;
	char serial[64];
	int number;
	hid_device *reports, *control;
	bool was_gamepad; /* when it was opened: it is left so */
	bool heard;	  /* a motion report, since the mode was switched last */
	int64_t switched_ns, heard_ns;
	struct track_hydra_state state;
};

static void switch_mode(struct hydra *h, bool motion)
{
	uint8_t feature[TRACK_HYDRA_FEATURE_BYTES];

	track_hydra_mode(motion, feature);
	/* Whether it took it shows in what it sends; it is asked again until it does. */
	(void)hid_send_feature_report(h->control, feature, sizeof feature);
	memset(feature, 0, sizeof feature);
	(void)hid_get_feature_report(h->control, feature, sizeof feature);
	h->switched_ns = track_device_now(&h->device);
	h->heard = false;
}

/* The serial number that the device has in a feature report; "" when it has none. */
static void read_serial(struct hydra *h, char out[SERIAL_LEN + 1])
{
	uint8_t feature[256] = { 0 };
	const int n = hid_get_feature_report(h->control, feature, sizeof feature);

	memset(out, 0, SERIAL_LEN + 1);
	for (int i = 0; i < SERIAL_LEN && SERIAL_AT + i < n; i++) {
		const uint8_t c = feature[SERIAL_AT + i];

		if (c < 0x21 || c >= 0x7f)
			break;
		out[i] = (char)c;
	}
}

static void close_hydra(struct track_device *device)
{
	struct hydra *h = (struct hydra *)device;

	if (h->control && h->was_gamepad)
		switch_mode(h, false);
	if (h->reports)
		hid_close(h->reports);
	if (h->control)
		hid_close(h->control);
	h->reports = h->control = NULL;
}

/* The node of the other interface of the same device; NULL when it is not there. */
static const struct track_hid_node *sibling(const struct track_hid_node *nodes, int count,
					    const struct track_hid_node *of)
{
	for (int i = 0; i < count; i++)
		if (nodes[i].interface == 1 && !strcmp(nodes[i].device, of->device))
			return &nodes[i];
	return NULL;
}

static enum track_state open_pair(struct hydra *h, const struct track_hid_node *reports,
				  const struct track_hid_node *control, char *why, size_t size)
{
	enum track_state state = track_hid_open(reports, &h->reports, why, size);

	if (state == TRACK_RUNNING)
		state = track_hid_open(control, &h->control, why, size);
	if (state != TRACK_RUNNING)
		close_hydra(&h->device);
	return state;
}

/* Listens before it switches, or the mode that it was in would be forgotten. */
static void start(struct hydra *h)
{
	uint8_t bytes[64];
	int n;

	h->state = (struct track_hydra_state){ 0 };
	n = track_hid_read(&h->device, h->reports, bytes, sizeof bytes, LISTEN_MS);
	h->heard = n == TRACK_HYDRA_BYTES;
	h->heard_ns = track_device_now(&h->device);
	h->was_gamepad = !h->heard;
	if (!h->heard)
		switch_mode(h, true);
}

static enum track_state open_hydra(struct track_device *device, char *why, size_t size)
{
	struct hydra *h = (struct hydra *)device;
	struct track_hid_node nodes[TRACK_HID_NODES];
	const int count = track_hid_list(VENDOR, PRODUCT, nodes, TRACK_HID_NODES);
	enum track_state state = TRACK_ABSENT;
	char serial[SERIAL_LEN + 1];
	int found = 0;

	snprintf(why, size, "no Razer Hydra (1532:0300) is plugged in");
	for (int i = 0; i < count; i++) {
		const struct track_hid_node *control = sibling(nodes, count, &nodes[i]);

		if (nodes[i].interface != 0 || !control || (!h->serial[0] && found++ != h->number))
			continue;
		state = open_pair(h, &nodes[i], control, why, size);
		if (state != TRACK_RUNNING)
			return state;
		read_serial(h, serial);
		if (!h->serial[0] || !strcmp(h->serial, serial) ||
		    !strcmp(h->serial, nodes[i].serial)) {
			start(h);
			snprintf(why, size, "%s and %s, serial number %s", nodes[i].path,
				 control->path, serial[0] ? serial : "not said");
			return TRACK_RUNNING;
		}
		h->was_gamepad = false; /* not ours: as it was */
		close_hydra(device);
		snprintf(why, size, "no Razer Hydra with serial number %s is plugged in",
			 h->serial);
		state = TRACK_ABSENT;
	}
	if (count && state == TRACK_ABSENT && !h->serial[0])
		snprintf(why, size,
			 "Razer Hydra number %d is not plugged in, or not with both its interfaces",
			 h->number);
	return state;
}

static int take(struct hydra *h, const uint8_t *bytes, size_t len, char *why, size_t size)
{
	struct track_report reports[TRACK_HYDRA_WANDS];
	struct track_hydra_report raw;
	const int r = track_hydra_decode(bytes, len, &raw);

	if (r < 0) {
		track_device_fault(&h->device, (enum track_fault) - r);
		if (r != -TRACK_FAULT_LENGTH)
			return GR_OK;
		snprintf(why, size,
			 "sends %zu bytes, not %d: another program has switched its mode", len,
			 TRACK_HYDRA_BYTES);
		return GR_ERR_STATE;
	}
	h->heard = true;
	h->heard_ns = track_device_now(&h->device);
	track_device_missed(&h->device, track_hydra_reports(&h->state, &raw,
							    track_device_now(&h->device), reports));
	for (int i = 0; i < TRACK_HYDRA_WANDS; i++)
		(void)track_device_publish(&h->device, &reports[i]);
	return GR_OK;
}

static int read_hydra(struct track_device *device, int timeout_ms, char *why, size_t size)
{
	struct hydra *h = (struct hydra *)device;
	uint8_t bytes[64];
	const int wait_ms = timeout_ms < TRACK_HID_WAIT_MS ? timeout_ms : TRACK_HID_WAIT_MS;
	const int n = track_hid_read(device, h->reports, bytes, sizeof bytes, wait_ms);

	if (n > 0)
		return take(h, bytes, (size_t)n, why, size);
	if (n < 0) {
		snprintf(why, size, "unplugged");
		return GR_ERR_IO;
	}
	if (h->heard ? track_device_now(device) - h->heard_ns > SILENCE_NS
		     : track_device_now(device) - h->switched_ns > SWITCH_NS)
		switch_mode(h, true);
	return GR_NOTHING;
}

static void destroy_hydra(struct track_device *device)
{
	free(device);
}

static const char *const sensors[] = { "left", "right", NULL };
static const char *const button_names[] = { "bumper", "1", "2", "3", "4", "start", "stick", NULL };
static const char *const axis_names[] = { "stick_x", "stick_y", "trigger", NULL };

static const struct track_device_ops hydra_ops = {
	.kind = "hydra",
	.subsystem = "hidraw",
	.sensors = sensors,
	.buttons = button_names,
	.axes = axis_names,
	.open = open_hydra,
	.read = read_hydra,
	.close = close_hydra,
	.destroy = destroy_hydra,
};

int track_hydra_create(struct track_device **out, const struct track_hydra_params *params,
		       const struct gr_clock *clock)
{
	struct hydra *h;
	int r;

	if (params->serial && strlen(params->serial) >= sizeof h->serial)
		return GR_ERR_RANGE;
	r = track_device_alloc(&h, sizeof *h, &hydra_ops, clock);
	if (r < 0)
		return r;
	snprintf(h->serial, sizeof h->serial, "%s", params->serial ? params->serial : "");
	h->number = params->number;
	*out = &h->device;
	return GR_OK;
}
