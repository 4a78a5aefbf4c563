/* The layout's keys about trackers. */
#include "config/layout_options.h"

static const char *const kind_choices[] = { "sim", "replay", "hydra", "viper", "liberty", "patriot", NULL };
static const char *const body_choices[] = { "head", "wand", NULL };

#define AT(type, member) .offset = offsetof(struct type, member)

static const struct option sim_options[] = {
	{ .key = "rate_hz", .type = OPTION_FLOAT, .min = 1, .max = 1000, .standard = "120",
	  .unit = "Hz", AT(layout_file_sim, sim.rate_hz), .help = "samples a second and body" },
	{ .key = "noise_position_m", .type = OPTION_FLOAT, .min = 0, .max = 0.1, .standard = "0",
	  .unit = "m", AT(layout_file_sim, sim.noise_position_m),
	  .help = "standard deviation of the position" },
	{ .key = "noise_angle_deg", .type = OPTION_FLOAT, .min = 0, .max = 10, .standard = "0",
	  .scale = LAYOUT_RAD_PER_DEG, .unit = "deg", AT(layout_file_sim, sim.noise_angle_rad),
	  .help = "standard deviation of the orientation" },
	{ .key = "latency_ms", .type = OPTION_TIME, .min = 0, .max = 1000, .standard = "0",
	  .scale = LAYOUT_NS_PER_MS, .unit = "ms", AT(layout_file_sim, sim.latency_ns),
	  .help = "age of a sample when it arrives" },
	{ .key = "dropout_per_s", .type = OPTION_FLOAT, .min = 0, .max = 100, .standard = "0",
	  .unit = "1/s", AT(layout_file_sim, sim.dropout_per_s),
	  .help = "mean number of drop-outs a second" },
	{ .key = "dropout_ms", .type = OPTION_TIME, .min = 0, .max = 60000, .standard = "100",
	  .scale = LAYOUT_NS_PER_MS, .unit = "ms", AT(layout_file_sim, sim.dropout_ns),
	  .help = "length of a drop-out" },
	{ .key = "seed", .type = OPTION_U32, .min = 0, .max = 4294967295.0, .standard = "1",
	  AT(layout_file_sim, sim.seed), .help = "the same seed gives the same visitor" },
	{ .key = "walk_radius_m", .type = OPTION_FLOAT, .min = 0, .max = 10, .standard = "0.5",
	  .unit = "m", AT(layout_file_sim, sim.walk_radius_m),
	  .help = "how far from the start pose the visitor walks" },
	{ .key = "walk_speed_m_s", .type = OPTION_FLOAT, .min = 0, .max = 3, .standard = "0.5",
	  .unit = "m/s", AT(layout_file_sim, sim.walk_speed_m_s), .help = "how fast the visitor walks" },
	{ .key = NULL },
};

#define ANGLE(key_, limit, form, member, help_)                                            \
	{ .key = key_, .type = OPTION_FLOAT, .min = -(limit), .max = limit, .unit = "deg", \
	  .scale = LAYOUT_RAD_PER_DEG, .standard = "0", AT(form, member), .help = help_ }

static const struct option base_options[] = {
	{ .key = "position", .type = OPTION_FLOAT, .count = 3, .min = -1000, .max = 1000,
	  .unit = "m", .standard = "0 0 0", AT(layout_file_base, room_base.position),
	  .help = "where the origin of the device's frame is in the room" },
	ANGLE("heading_deg", 360, layout_file_base, room_base.angles[0],
	      "how that frame is turned: 0 as the room, 90 to the left"),
	ANGLE("pitch_deg", 180, layout_file_base, room_base.angles[1], "then how far it is tilted up"),
	ANGLE("roll_deg", 180, layout_file_base, room_base.angles[2], "then how far it leans to its left"),
	{ .key = "scale", .type = OPTION_FLOAT, .min = 0.001, .max = 1000, .standard = "1",
	  AT(layout_file_base, scale), .help = "true length of what the device calls a metre" },
	{ .key = NULL },
};

static const struct option polhemus_options[] = {
	{ .key = "hemisphere", .type = OPTION_FLOAT, .count = 3, .min = -1, .max = 1,
	  .standard = "0 0 0", AT(layout_file_polhemus, polhemus.hemisphere),
	  .help = "direction from the source, in the axes of its base, to the half of space that the sensors are in; 0 0 0 as the device has it" },
	{ .key = "rate_hz", .type = OPTION_INT, .min = 30, .max = 960, .standard = "240",
	  .unit = "Hz", AT(layout_file_polhemus, polhemus.rate_hz),
	  .help = "for viper: frames a second, 30, 60, 120, 240, 480 or 960; the others keep theirs" },
	{ .key = "path", .type = OPTION_STRING, AT(layout_file_polhemus, polhemus.path),
	  .help = "where it is plugged in, bus and ports as in /sys/bus/usb/devices, such as \"1-2.4\"; without it anywhere" },
	{ .key = "follow", .type = OPTION_BOOL, .standard = "false",
	  AT(layout_file_polhemus, polhemus.follow),
	  .help = "for viper, with hemisphere: sensors begin in it and may go around the source then" },
	{ .key = "filter", .type = OPTION_BOOL, .standard = "false",
	  AT(layout_file_polhemus, polhemus.filter),
	  .help = "whether the device's own filter stays as it is; else it is switched off" },
	{ .key = NULL },
};

static const struct option bind_options[] = {
	{ .key = "body", .type = OPTION_CHOICE, .required = true, .choices = body_choices,
	  AT(layout_file_binding, binding.body), .help = "what the sensor is on" },
	{ .key = "sensor", .type = OPTION_NAME, AT(layout_file_binding, binding.sensor),
	  .help = "the sensor as the device names it, see docs/trackers.md; without it the first" },
	{ .key = "position", .type = OPTION_BOOL, .standard = "true",
	  AT(layout_file_binding, binding.position), .help = "whether the position comes from it" },
	{ .key = "orientation", .type = OPTION_BOOL, .standard = "true",
	  AT(layout_file_binding, binding.orientation),
	  .help = "whether the orientation comes from it" },
	{ .key = "input", .type = OPTION_BOOL, .standard = "true",
	  AT(layout_file_binding, binding.input),
	  .help = "whether the wand's buttons and axes come from it" },
	{ .key = "offset", .type = OPTION_FLOAT, .count = 3, .min = -10, .max = 10, .unit = "m",
	  .standard = "0 0 0", AT(layout_file_binding, binding.sensor_body.position),
	  .help = "lever arm: the midpoint between the eyes, or the wand's tip, in the sensor's frame" },
	ANGLE("heading_deg", 360, layout_file_binding, binding.sensor_body.angles[0],
	      "how head or wand are turned in the sensor's frame: 0 as the sensor, 90 to its left"),
	ANGLE("pitch_deg", 180, layout_file_binding, binding.sensor_body.angles[1], "then how far it is tilted up"),
	ANGLE("roll_deg", 180, layout_file_binding, binding.sensor_body.angles[2], "then how far it leans to its left"),
	{ .key = "buttons", .type = OPTION_STRING, AT(layout_file_binding, binding.buttons),
	  .help = "the device's buttons that are the wand's first, second, ...: names apart by blanks, - for none; without it the device's order" },
	{ .key = "axes", .type = OPTION_STRING, AT(layout_file_binding, binding.axes),
	  .help = "the device's axes that are the wand's first, second, ..., likewise; a - before a name turns it round" },
	{ .key = NULL },
};

const struct option layout_tracker_options[] = {
	{ .key = "name", .type = OPTION_NAME, .required = true,
	  AT(layout_file_tracker, tracker.name), .help = "the tracker's name in logs and status" },
	{ .key = "kind", .type = OPTION_CHOICE, .required = true, .choices = kind_choices,
	  AT(layout_file_tracker, tracker.kind),
	  .help = "a simulated visitor, a log that is replayed, or a device" },
	{ .key = "head", .type = OPTION_BOOL, .standard = "true",
	  AT(layout_file_tracker, tracker.head), .help = "for sim and replay: whether it tracks the head" },
	{ .key = "wand", .type = OPTION_BOOL, .standard = "true",
	  AT(layout_file_tracker, tracker.wand), .help = "for sim and replay: whether it tracks the wand" },
	{ .key = "file", .type = OPTION_STRING, AT(layout_file_tracker, tracker.file),
	  .help = "for replay: the log, absolute or beside the layout file" },
	{ .key = "loop", .type = OPTION_BOOL, .standard = "true",
	  AT(layout_file_tracker, tracker.loop), .help = "for replay: begin again at the end" },
	{ .key = "sim", .type = OPTION_GROUP, AT(layout_file_tracker, sim), .group = sim_options,
	  .help = "for sim: what the simulated visitor does" },
	{ .key = "serial", .type = OPTION_STRING, AT(layout_file_tracker, tracker.serial),
	  .help = "for a device: its serial number, where there are several" },
	{ .key = "number", .type = OPTION_INT, .min = 0, .max = 15, .standard = "0",
	  AT(layout_file_tracker, tracker.number),
	  .help = "for a device without a serial number: which of several that are alike" },
	{ .key = "latency_ms", .type = OPTION_TIME, .min = 0, .max = 1000, .standard = "0",
	  .scale = LAYOUT_NS_PER_MS, .unit = "ms", AT(layout_file_tracker, tracker.latency_ns),
	  .help = "for a device: how old its quickest report is when it arrives" },
	{ .key = "base", .type = OPTION_GROUP, AT(layout_file_tracker, base), .group = base_options,
	  .help = "for a device: where its frame is in the room" },
	{ .key = "polhemus", .type = OPTION_GROUP, AT(layout_file_tracker, polhemus),
	  .group = polhemus_options, .help = "for viper, liberty, patriot: how it measures" },
	{ .key = "bind", .type = OPTION_LIST, .count = LAYOUT_MAX_BINDINGS,
	  AT(layout_file_tracker, bindings), .size = sizeof(struct layout_file_binding),
	  .count_offset = offsetof(struct layout_file_tracker, binding_count),
	  .group = bind_options, .help = "for a device: which sensor gives what" },
	{ .key = NULL },
};
