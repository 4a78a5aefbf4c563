/* The layout's keys about trackers. */
#include "config/layout_options.h"

static const char *const kind_choices[] = { "sim",     "replay", "window", "hydra", "viper", "liberty",
					    "patriot", "dtrack", "vrpn",  "gamepad",
					    "dualshock4", "dualsense", "spacemouse", NULL };
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

static const char *const filter_choices[] = { "auto", "none", "one-euro", "exponential", "kalman", NULL };

#define CONSTANT(key_, low, high, standard_, unit_, member, help_)                              \
	{ .key = key_, .type = OPTION_FLOAT, .min = low, .max = high, .standard = standard_, \
	  .unit = unit_, AT(layout_file_filter, filter.member), .help = help_ }
#define TURN(key_, high, standard_, unit_, member, help_)                                     \
	{ .key = key_, .type = OPTION_FLOAT, .min = 0, .max = high, .standard = standard_, \
	  .scale = LAYOUT_RAD_PER_DEG, .unit = unit_, AT(layout_file_filter, filter.member), .help = help_ }
#define SPAN(key_, low, high, standard_, member, help_)                                          \
	{ .key = key_, .type = OPTION_FLOAT, .min = low, .max = high, .standard = standard_,  \
	  .scale = 1e-3, .unit = "ms", AT(layout_file_filter, filter.member), .help = help_ }

static const struct option filter_options[] = {
	{ .key = "kind", .type = OPTION_CHOICE, .choices = filter_choices, .standard = "auto",
	  AT(layout_file_filter, filter.kind),
	  .help = "auto is kalman for a device, none without a gate for sim and replay; `grotto bench trackers` compares them" },
	CONSTANT("noise_position_m", 1e-6, 0.1, "0.0003", "m", noise_position_m,
		 "kalman: standard deviation of a sample's position"),
	{ .key = "noise_angle_deg", .type = OPTION_FLOAT, .min = 1e-4, .max = 10, .standard = "0.1",
	  .scale = LAYOUT_RAD_PER_DEG, .unit = "deg", AT(layout_file_filter, filter.noise_angle_rad),
	  .help = "kalman: of its orientation" },
	CONSTANT("move_position", 1e-3, 1e4, "5", "m^2/s^3", move_position,
		 "kalman: density of the acceleration of a body that moves; more follows quicker"),
	CONSTANT("move_angle", 1e-3, 1e6, "100", "rad^2/s^3", move_angle, "kalman: the same of its turns"),
	CONSTANT("cutoff_hz", 0.01, 1000, "1", "Hz", cutoff_hz, "one-euro: cut-off at rest; less is calmer"),
	CONSTANT("slope_hz", 0.01, 1000, "6", "Hz", slope_hz, "one-euro: cut-off of the speed"),
	CONSTANT("beta_position", 0, 1e4, "60", "1/m", beta_position,
		 "one-euro: by how much the cut-off rises with the speed; more lags less"),
	CONSTANT("beta_angle", 0, 1e4, "10", "1/rad", beta_angle, "one-euro: the same for turns"),
	SPAN("tau_ms", 0.1, 1000, "20", tau_s, "exponential: time constant"),
	{ .key = "gate", .type = OPTION_BOOL, .standard = "true", AT(layout_file_filter, filter.gate),
	  .help = "whether samples are refused that jump as no body does" },
	CONSTANT("gate_m", 0.001, 10, "0.05", "m", gate_m, "such a jump is further than this"),
	CONSTANT("gate_m_s", 0, 100, "10", "m/s", gate_m_s, "and this times the time since the last sample"),
	TURN("gate_deg", 180, "17", "deg", gate_rad, "or a turn of more than this"),
	TURN("gate_deg_s", 1e5, "1700", "deg/s", gate_rad_s, "and this times that time"),
	SPAN("gate_hold_ms", 0, 1000, "50", gate_hold_s, "when they go on to agree for so long, the body is there"),
	SPAN("ahead_ms", 0, 500, "60", ahead_s, "how far a body is moved on along its velocity"),
	SPAN("decay_ms", 1, 5000, "60", decay_s, "how soon it comes back to its last good pose after that"),
	SPAN("gap_ms", 1, 5000, "250", gap_s, "after so long without a sample the filter starts anew"),
	SPAN("blend_ms", 0, 5000, "200", blend_s, "how long it takes from the pose that was shown to the one seen again"),
	{ .key = NULL },
};

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
	  .help = "a simulated visitor, a log that is replayed, keyboard and mouse in the nodes' windows, or a device" },
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
	{ .key = "filter", .type = OPTION_GROUP, AT(layout_file_tracker, filter), .group = filter_options,
	  .help = "what is made of the samples of a body whose position it gives" },
	{ .key = "serial", .type = OPTION_STRING, AT(layout_file_tracker, tracker.serial),
	  .help = "for a device: its serial number, where there are several" },
	{ .key = "number", .type = OPTION_INT, .min = 0, .max = 15, .standard = "0",
	  AT(layout_file_tracker, tracker.number),
	  .help = "for a device without a serial number: which of several that are alike" },
	{ .key = "latency_ms", .type = OPTION_TIME, .min = 0, .max = 1000, .standard = "0",
	  .scale = LAYOUT_NS_PER_MS, .unit = "ms", AT(layout_file_tracker, tracker.latency_ns),
	  .help = "for a device: how old its quickest report is when it arrives" },
	{ .key = "dtrack", .type = OPTION_GROUP, AT(layout_file_tracker, dtrack),
	  .group = layout_dtrack_options, .help = "for dtrack: what the controller sends, and where to" },
	{ .key = "vrpn", .type = OPTION_GROUP, AT(layout_file_tracker, vrpn),
	  .group = layout_vrpn_options, .help = "for vrpn: the server, and which of its devices" },
	{ .key = "base", .type = OPTION_GROUP, AT(layout_file_tracker, base), .group = base_options,
	  .help = "for a device: where its frame is in the room" },
	{ .key = "polhemus", .type = OPTION_GROUP, AT(layout_file_tracker, polhemus),
	  .group = polhemus_options, .help = "for viper, liberty, patriot: how it measures" },
	{ .key = "pad", .type = OPTION_GROUP, AT(layout_file_tracker, pad), .group = layout_pad_options,
	  .help = "for gamepad, dualshock4, dualsense: which one, and its sticks" },
	{ .key = "spacemouse", .type = OPTION_GROUP, AT(layout_file_tracker, spacemouse),
	  .group = layout_spacemouse_options, .help = "for spacemouse: how fast and how far a body is moved" },
	{ .key = "bind", .type = OPTION_LIST, .count = LAYOUT_MAX_BINDINGS,
	  AT(layout_file_tracker, bindings), .size = sizeof(struct layout_file_binding),
	  .count_offset = offsetof(struct layout_file_tracker, binding_count),
	  .group = bind_options, .help = "for a device: which sensor gives what" },
	{ .key = NULL },
};
