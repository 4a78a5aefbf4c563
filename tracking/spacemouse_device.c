/* The SpaceMouse's node: what the cap says moves a pose, also between reports. */
#include "tracking/hid.h"
#include "tracking/spacemouse.h"

#include "base/result.h"

#include <stdio.h>
#include <stdlib.h>

#define MOVING_NS (10 * GR_NS_PER_MS) /* between poses while the cap is off its middle */
#define RESTING_NS (40 * GR_NS_PER_MS)

/* By product: both vendors make plain mice and keyboards, too. */
static const struct {
	uint16_t vendor, product;
} products[] = {
	{ 0x046d, 0xc603 }, { 0x046d, 0xc605 }, { 0x046d, 0xc606 }, { 0x046d, 0xc621 },
	{ 0x046d, 0xc623 }, { 0x046d, 0xc625 }, { 0x046d, 0xc626 }, { 0x046d, 0xc627 },
	{ 0x046d, 0xc628 }, { 0x046d, 0xc629 }, { 0x046d, 0xc62b }, { 0x256f, 0xc62e },
	{ 0x256f, 0xc62f }, { 0x256f, 0xc631 }, { 0x256f, 0xc632 }, { 0x256f, 0xc633 },
	{ 0x256f, 0xc635 }, { 0x256f, 0xc636 }, { 0x256f, 0xc638 }, { 0x256f, 0xc63a },
};

struct spacemouse {
	struct track_device device;
	struct track_hid_choice choice;
	struct track_spacemouse_motion motion;
	struct track_spacemouse_state state;
	hid_device *hid;
	int64_t said_ns;
};

static bool is_one(const struct track_hid_node *node)
{
	/* Some have a keyboard beside it. */
	if (!track_hid_has_usage(node, TRACK_HID_MULTI_AXIS))
		return false;
	for (size_t i = 0; i < sizeof products / sizeof *products; i++)
		if (node->vendor == products[i].vendor && node->product == products[i].product)
			return true;
	return false;
}

static void close_spacemouse(struct track_device *device)
{
	struct spacemouse *s = (struct spacemouse *)device;

	hid_close(s->hid);
	s->hid = NULL;
}

static enum track_state open_spacemouse(struct track_device *device, char *why, size_t size)
{
	struct spacemouse *s = (struct spacemouse *)device;
	struct track_hid_node nodes[TRACK_HID_NODES];
	const struct track_hid_node *node;
	const int listed = track_hid_list(0, 0, nodes, TRACK_HID_NODES);
	enum track_state state;
	int count = 0;

	for (int i = 0; i < listed; i++)
		if (is_one(&nodes[i]))
			nodes[count++] = nodes[i];
	node = track_hid_choose(&s->choice, nodes, count, "SpaceMouse", why, size);
	if (!node)
		return TRACK_ABSENT;
	state = track_hid_open(node, &s->hid, why, size);
	if (state != TRACK_RUNNING)
		return state;
	/* Where it was when it was unplugged is where it goes on; its cap rests until it says else.
	 */
	memset(s->state.move, 0, sizeof s->state.move);
	memset(s->state.turn, 0, sizeof s->state.turn);
	s->state.buttons = 0;
	s->state.now_ns = 0;
	s->said_ns = 0;
	snprintf(why, size, "%s, %.60s (%04x:%04x) at %.40s", node->path, node->name, node->vendor,
		 node->product, track_hid_port(node));
	return TRACK_RUNNING;
}

static void publish(struct spacemouse *s, int64_t now_ns)
{
	struct track_report report;

	track_spacemouse_pose(&s->state, &report);
	(void)track_device_publish(&s->device, &report);
	s->said_ns = now_ns;
}

static void take(struct spacemouse *s, const uint8_t *bytes, size_t len, int64_t now_ns)
{
	struct track_spacemouse_report report;
	const int r = track_spacemouse_decode(bytes, len, &report);

	if (r < 0)
		track_device_fault(&s->device, (enum track_fault) - r);
	if (r != GR_OK)
		return;
	track_spacemouse_take(&s->state, &s->motion, &report, now_ns);
	publish(s, now_ns);
}

static int read_spacemouse(struct track_device *device, int timeout_ms, char *why, size_t size)
{
	struct spacemouse *s = (struct spacemouse *)device;
	const int64_t period_ns = track_spacemouse_moves(&s->state) ? MOVING_NS : RESTING_NS;
	const int wait_ms = (int)(period_ns / GR_NS_PER_MS);
	uint8_t bytes[64];
	const int n = track_hid_read(device, s->hid, bytes, sizeof bytes,
				     timeout_ms < wait_ms ? timeout_ms : wait_ms);
	const int64_t now_ns = track_device_now(device);

	if (n < 0) {
		snprintf(why, size, "unplugged");
		return GR_ERR_IO;
	}
	track_spacemouse_move(&s->state, &s->motion, now_ns);
	if (n > 0)
		take(s, bytes, (size_t)n, now_ns);
	else if (now_ns - s->said_ns >= period_ns)
		publish(s, now_ns);
	return n ? GR_OK : GR_NOTHING;
}

static void destroy_spacemouse(struct track_device *device)
{
	free(device);
}

static const char *const sensors[] = { "cap", NULL };
static const char *const axis_names[] = { "right", "up", "back", "pitch", "yaw", "roll", NULL };

static const struct track_device_ops spacemouse_ops = {
	.kind = "spacemouse",
	.subsystem = "hidraw",
	.sensors = sensors,
	.buttons = track_spacemouse_buttons,
	.axes = axis_names,
	.open = open_spacemouse,
	.read = read_spacemouse,
	.close = close_spacemouse,
	.destroy = destroy_spacemouse,
};

int track_spacemouse_create(struct track_device **out, const struct track_spacemouse_params *params,
			    const struct gr_clock *clock)
{
	struct track_hid_choice choice;
	struct spacemouse *s;
	int r;

	if (track_hid_choice_set(&choice, params->serial, params->path, params->number) < 0)
		return GR_ERR_RANGE;
	r = track_device_alloc(&s, sizeof *s, &spacemouse_ops, clock);
	if (r < 0)
		return r;
	s->choice = choice;
	s->motion = params->motion;
	*out = &s->device;
	return GR_OK;
}
