/* A gamepad's node: found by its descriptor, read as that says. */
#include "tracking/gamepad.h"
#include "tracking/hid.h"
#include "tracking/hid_descriptor.h"

#include "base/result.h"

#include <stdio.h>
#include <stdlib.h>

#define AGAIN_NS                                                                                   \
	(40 * GR_NS_PER_MS) /* a pad that is held still says nothing: its state is told again */
#define AGAIN_MS 20

struct gamepad {
	struct track_device device;
	struct track_hid_choice choice;
	uint16_t vendor, product;
	uint8_t triggers;
	float dead_zone;
	hid_device *hid;
	struct track_hid_pads pads;
	struct track_hid_values values;
	unsigned heard; /* pads that have said something, bits */
	int64_t said_ns[TRACK_HID_PADS];
};

static void close_gamepad(struct track_device *device)
{
	struct gamepad *g = (struct gamepad *)device;

	hid_close(g->hid);
	g->hid = NULL;
}

/* GR_OK with g->pads; else why the node is no gamepad. */
static int describe(struct gamepad *g, const struct track_hid_node *node, char *why, size_t size)
{
	uint8_t bytes[TRACK_HID_DESCRIPTOR_MOST];
	const size_t len = track_hid_descriptor(node, bytes, sizeof bytes);
	int r;

	if (!len) {
		snprintf(why, size, "its report descriptor cannot be read");
		return GR_ERR_IO;
	}
	r = track_hid_parse(bytes, len, false, &g->pads, why, size);
	/* One that somebody named may call itself something else, and all that it has counts. */
	if (r < 0 && g->vendor && g->product)
		r = track_hid_parse(bytes, len, true, &g->pads, why, size);
	return r;
}

/* Moves those that are gamepads to the front. What one that should be is not, goes to `wrong`. */
static int keep_pads(struct gamepad *g, struct track_hid_node *nodes, int count, char *wrong,
		     size_t size)
{
	int kept = 0;

	for (int i = 0; i < count; i++) {
		const bool named = g->vendor && g->product;
		char why[TRACK_WHY];

		if (!named && !track_hid_has_usage(&nodes[i], TRACK_HID_GAMEPAD) &&
		    !track_hid_has_usage(&nodes[i], TRACK_HID_JOYSTICK))
			continue;
		if (describe(g, &nodes[i], why, sizeof why) == GR_OK)
			nodes[kept++] = nodes[i];
		else
			snprintf(wrong, size, "%s: %.180s", nodes[i].path, why);
	}
	return kept;
}

static unsigned count_bits(uint32_t bits)
{
	unsigned n = 0;

	for (; bits; bits &= bits - 1)
		n++;
	return n;
}

static enum track_state open_gamepad(struct track_device *device, char *why, size_t size)
{
	struct gamepad *g = (struct gamepad *)device;
	struct track_hid_node nodes[TRACK_HID_NODES];
	const struct track_hid_node *node;
	char wrong[TRACK_WHY] = "", what[32] = "gamepad";
	enum track_state state;
	int count = track_hid_list(g->vendor, g->product, nodes, TRACK_HID_NODES);

	count = keep_pads(g, nodes, count, wrong, sizeof wrong);
	if (g->vendor)
		snprintf(what, sizeof what, "gamepad %04x:%04x", g->vendor, g->product);
	node = track_hid_choose(&g->choice, nodes, count, what, why, size);
	if (!node) {
		if (!wrong[0])
			return TRACK_ABSENT;
		snprintf(why, size, "%s", wrong);
		return TRACK_FAILED;
	}
	/* Those after it have been looked at, too. */
	if (describe(g, node, wrong, sizeof wrong) != GR_OK) {
		snprintf(why, size, "%s: gone while it was being opened", node->path);
		return TRACK_ABSENT;
	}
	state = track_hid_open(node, &g->hid, why, size);
	if (state != TRACK_RUNNING)
		return state;
	g->heard = 0;
	track_hid_rest(&g->values);
	snprintf(why, size, "%s, %.60s (%04x:%04x) at %.40s, %u buttons, %u axes", node->path,
		 node->name, node->vendor, node->product, track_hid_port(node),
		 count_bits(g->pads.has_buttons[0]), count_bits(g->pads.has_axes[0]));
	return TRACK_RUNNING;
}

static void publish(struct gamepad *g, unsigned pad, int64_t now_ns)
{
	struct track_report report;

	track_hid_report(&g->values, pad, &report);
	for (unsigned i = 0; i < TRACK_HID_SLIDER; i++)
		if (!(g->triggers >> i & 1))
			report.axes[i] = track_dead_zone(report.axes[i], g->dead_zone);
	(void)track_device_publish(&g->device, &report);
	g->said_ns[pad] = now_ns;
}

static int read_gamepad(struct track_device *device, int timeout_ms, char *why, size_t size)
{
	struct gamepad *g = (struct gamepad *)device;
	uint8_t bytes[TRACK_HID_REPORT_MOST];
	const int n = track_hid_read(device, g->hid, bytes, sizeof bytes,
				     timeout_ms < AGAIN_MS ? timeout_ms : AGAIN_MS);
	const int64_t now_ns = track_device_now(device);
	int which = 0;

	if (n < 0) {
		snprintf(why, size, "unplugged");
		return GR_ERR_IO;
	}
	if (n > 0)
		which = track_hid_take(&g->pads, bytes, (size_t)n, g->triggers, &g->values);
	if (which < 0) {
		track_device_fault(device, (enum track_fault) - which);
		return GR_OK;
	}
	g->heard |= (unsigned)which;
	for (unsigned i = 0; i < g->pads.pad_count; i++)
		if ((unsigned)which >> i & 1 ||
		    (g->heard >> i & 1 && now_ns - g->said_ns[i] >= AGAIN_NS))
			publish(g, i, now_ns);
	return n ? GR_OK : GR_NOTHING;
}

static void destroy_gamepad(struct track_device *device)
{
	free(device);
}

static const char *const sensors[] = { "pad", "pad2", "pad3", "pad4", NULL };
static const char *const button_names[] = {
	"1",  "2",  "3",  "4",	"5",  "6",  "7",  "8",	   "9",	   "10",   "11",
	"12", "13", "14", "15", "16", "17", "18", "19",	   "20",   "21",   "22",
	"23", "24", "25", "26", "27", "28", "up", "right", "down", "left", NULL,
};
const char *const track_gamepad_axes[] = {
	"x", "y", "z", "rx", "ry", "rz", "slider", "slider2", NULL,
};
_Static_assert(sizeof sensors / sizeof *sensors == TRACK_HID_PADS + 1, "a name each");
_Static_assert(sizeof button_names / sizeof *button_names == TRACK_HID_BUTTONS + 5, "a name each");

static const struct track_device_ops gamepad_ops = {
	.kind = "gamepad",
	.subsystem = "hidraw",
	.sensors = sensors,
	.buttons = button_names,
	.axes = track_gamepad_axes,
	.open = open_gamepad,
	.read = read_gamepad,
	.close = close_gamepad,
	.destroy = destroy_gamepad,
};

int track_gamepad_create(struct track_device **out, const struct track_gamepad_params *params,
			 const struct gr_clock *clock)
{
	struct track_hid_choice choice;
	struct gamepad *g;
	int r;

	if (track_hid_choice_set(&choice, params->serial, params->path, params->number) < 0)
		return GR_ERR_RANGE;
	r = track_device_alloc(&g, sizeof *g, &gamepad_ops, clock);
	if (r < 0)
		return r;
	g->choice = choice;
	g->vendor = params->vendor;
	g->product = params->product;
	g->triggers = params->triggers;
	g->dead_zone = params->dead_zone;
	*out = &g->device;
	return GR_OK;
}
