/* A DualShock's or DualSense's node: the switch of mode, calibration, reports. */
#include "tracking/hid.h"
#include "tracking/sony.h"

#include "base/result.h"

#include <stdio.h>
#include <stdlib.h>

#define VENDOR 0x054c
#define DONGLE 0x0ba0
#define TRIES 3 /* at the calibration: right after it is plugged in it may be zeroes */
#define ASK_NS (2 * GR_NS_PER_S) /* between switches of mode, as long as it does not listen */

static const struct {
	const char *name;
	uint16_t products[3];
} models[] = {
	[TRACK_SONY_DUALSHOCK4] = { "DualShock 4", { 0x05c4, 0x09cc, DONGLE } },
	[TRACK_SONY_DUALSENSE] = { "DualSense", { 0x0ce6, 0x0df2, 0 } },
};

struct sony {
	struct track_device device;
	enum track_sony_model model;
	struct track_hid_choice choice;
	uint32_t recentre;
	float dead_zone;
	hid_device *hid;
	bool bluetooth, dongle;
	bool calibrated; /* by what it says itself */
	int64_t asked_ns;
	struct track_sony_state state;
};

static bool is_one(const struct sony *s, const struct track_hid_node *node)
{
	for (int i = 0; i < 3; i++)
		if (node->product == models[s->model].products[i])
			return node->product != 0;
	return false;
}

static void close_sony(struct track_device *device)
{
	struct sony *s = (struct sony *)device;

	hid_close(s->hid);
	s->hid = NULL;
}

/* By Bluetooth this is the switch of mode, too. */
static void ask_calibration(struct sony *s)
{
	const bool paired = s->model == TRACK_SONY_DUALSENSE || !(s->bluetooth || s->dongle);

	track_sony_nominal(&s->state.calibration);
	s->calibrated = false;
	for (int i = 0; i < TRIES && !s->calibrated; i++) {
		uint8_t feature[64] = { track_sony_calibration_number(s->model, s->bluetooth) };
		const int n = hid_get_feature_report(s->hid, feature,
						     track_sony_calibration_bytes(s->model,
										  s->bluetooth));

		s->calibrated =
			n > 0 && track_sony_calibrate(s->model, s->bluetooth, paired, feature,
						      (size_t)n, &s->state.calibration) == GR_OK;
	}
	s->asked_ns = track_device_now(&s->device);
}

static enum track_state open_sony(struct track_device *device, char *why, size_t size)
{
	struct sony *s = (struct sony *)device;
	struct track_hid_node nodes[TRACK_HID_NODES];
	const struct track_hid_node *node;
	const int listed = track_hid_list(VENDOR, 0, nodes, TRACK_HID_NODES);
	enum track_state state;
	int count = 0;

	for (int i = 0; i < listed; i++)
		if (is_one(s, &nodes[i]))
			nodes[count++] = nodes[i];
	node = track_hid_choose(&s->choice, nodes, count, models[s->model].name, why, size);
	if (!node)
		return TRACK_ABSENT;
	state = track_hid_open(node, &s->hid, why, size);
	if (state != TRACK_RUNNING)
		return state;
	s->bluetooth = node->bluetooth;
	s->dongle = node->product == DONGLE;
	s->state = (struct track_sony_state){ .imu.params = TRACK_IMU_STANDARD,
					      .recentre = s->recentre };
	ask_calibration(s);
	snprintf(why, size, "%s, %s by %s%s, serial number %s%s", node->path, models[s->model].name,
		 s->bluetooth ? "Bluetooth"
		 : s->dongle  ? "its dongle at USB "
			      : "USB ",
		 s->bluetooth ? "" : track_hid_port(node),
		 node->serial[0] ? node->serial : "not said",
		 s->calibrated
			 ? ""
			 : "; it says no calibration that can be used, so nominal values are");
	return TRACK_RUNNING;
}

static int take(struct sony *s, const uint8_t *bytes, size_t len)
{
	const int64_t now_ns = track_device_now(&s->device);
	struct track_report report = { .has = TRACK_LOST };
	struct track_sony_report raw;
	const int r = track_sony_decode(s->model, bytes, len, &raw);

	if (r < 0) {
		track_device_fault(&s->device, (enum track_fault) - r);
		return GR_OK;
	}
	if (r == GR_OK) {
		track_device_missed(&s->device,
				    track_sony_take(s->model, &s->state, &raw, now_ns, &report));
		for (int i = 0; i < 4; i++)
			report.axes[i] = track_dead_zone(report.axes[i], s->dead_zone);
		if (!raw.motion && s->bluetooth && now_ns - s->asked_ns > ASK_NS)
			ask_calibration(s);
	}
	(void)track_device_publish(&s->device, &report);
	return GR_OK;
}

static int read_sony(struct track_device *device, int timeout_ms, char *why, size_t size)
{
	struct sony *s = (struct sony *)device;
	uint8_t bytes[128];
	const int n =
		track_hid_read(device, s->hid, bytes, sizeof bytes,
			       timeout_ms < TRACK_HID_WAIT_MS ? timeout_ms : TRACK_HID_WAIT_MS);

	if (n > 0)
		return take(s, bytes, (size_t)n);
	if (n == 0)
		return GR_NOTHING;
	snprintf(why, size, s->bluetooth ? "switched off, or out of reach" : "unplugged");
	return GR_ERR_IO;
}

static void destroy_sony(struct track_device *device)
{
	free(device);
}

static const char *const sensors[] = { "pad", NULL };
static const char *const axis_names[] = { "stick_x", "stick_y", "right_x", "right_y",
					  "l2",	     "r2",	NULL };

#define OPS(kind_)                                                                                 \
	{                                                                                          \
		.kind = kind_, .subsystem = "hidraw", .sensors = sensors,                          \
		.buttons = track_sony_buttons, .axes = axis_names, .open = open_sony,              \
		.read = read_sony, .close = close_sony, .destroy = destroy_sony,                   \
	}
static const struct track_device_ops sony_ops[] = {
	[TRACK_SONY_DUALSHOCK4] = OPS("dualshock4"),
	[TRACK_SONY_DUALSENSE] = OPS("dualsense"),
};

int track_sony_create(struct track_device **out, const struct track_sony_params *params,
		      const struct gr_clock *clock)
{
	struct track_hid_choice choice;
	struct sony *s;
	int r;

	if (track_hid_choice_set(&choice, params->serial, params->path, params->number) < 0)
		return GR_ERR_RANGE;
	r = track_device_alloc(&s, sizeof *s, &sony_ops[params->model], clock);
	if (r < 0)
		return r;
	s->model = params->model;
	s->choice = choice;
	s->recentre = params->recentre;
	s->dead_zone = params->dead_zone;
	*out = &s->device;
	return GR_OK;
}
