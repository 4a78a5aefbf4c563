#include "config/layout_options.h"

#define RAD_PER_DEG 0.017453292519943295
#define NS_PER_MS 1e6
#define NS_PER_US 1e3

static const char *const eyes_choices[] = { "mono", "quad-buffer", "side-by-side", "top-bottom",
					    "eye-per-node", NULL };
static const char *const node_eyes_choices[] = { "mono", "quad-buffer", "side-by-side",
						 "top-bottom", NULL };
static const char *const eye_choices[] = { "left", "right", NULL };
static const char *const target_choices[] = { "headless", "window", "fullscreen", NULL };
static const char *const cast_choices[] = { "unicast", "multicast", "broadcast", "auto", NULL };
static const char *const swap_choices[] = { "auto", "message", "scheduled", "hardware", NULL };
static const char *const orphan_choices[] = { "hold", "black", "test", NULL };
static const char *const tracker_choices[] = { "sim", "replay", NULL };

#define AT(type, member) .offset = offsetof(struct type, member)

static const struct option node_options[] = {
	{ .key = "name", .type = OPTION_NAME, AT(layout_file_node, node.name),
	  .help = "the node's name, as in grotto-node@NAME; without it the wall's name" },
	{ .key = "address", .type = OPTION_STRING, .required = true,
	  AT(layout_file_node, node.address),
	  .help = "the machine that draws, as a numeric IPv4 or IPv6 address" },
	{ .key = "port", .type = OPTION_PORT, .min = 1024, .max = 65535, .standard = "27110",
	  AT(layout_file_node, node.port),
	  .help = "UDP port of the node; nodes on one address need one each" },
	{ .key = "part", .type = OPTION_FLOAT, .count = 4, .min = 0, .max = 1,
	  .standard = "0 0 1 1", AT(layout_file_node, node.part),
	  .help = "the part of the wall that this node draws: x0, y0, x1, y1 from its lower left" },
	{ .key = "eye", .type = OPTION_CHOICE, .choices = eye_choices, AT(layout_file_node, eye),
	  .help = "the eye that this node draws, where the wall says eyes = \"eye-per-node\"" },
	{ .key = "eyes", .type = OPTION_CHOICE, .choices = node_eyes_choices,
	  AT(layout_file_node, eyes), .help = "how this node draws the eyes, where it differs from its wall" },
	{ .key = "target", .type = OPTION_CHOICE, .choices = target_choices,
	  .standard = "headless", AT(layout_file_node, node.target),
	  .help = "where the picture goes: no display at all, a window, or a whole monitor" },
	{ .key = "display", .type = OPTION_STRING, AT(layout_file_node, node.display),
	  .help = "X display of a window, such as \":0\"; without it the environment's" },
	{ .key = "monitor", .type = OPTION_INT, .min = 0, .max = 31, .standard = "0",
	  AT(layout_file_node, node.monitor), .help = "number of the monitor for fullscreen" },
	{ .key = "gpu", .type = OPTION_INT, .min = -1, .max = 63, .standard = "-1",
	  AT(layout_file_node, node.gpu),
	  .help = "EGL device to draw on; -1 takes the first that works" },
	{ .key = NULL },
};

static const struct option wall_options[] = {
	{ .key = "name", .type = OPTION_NAME, .required = true, AT(layout_file_wall, name),
	  .help = "the wall's name: letters, digits, '_', '-', '.'" },
	{ .key = "lower_left", .type = OPTION_FLOAT, .count = 3, .min = -1000, .max = 1000,
	  .unit = "m", AT(layout_file_wall, lower_left),
	  .help = "measured corner in the room, as the person inside sees the wall" },
	{ .key = "lower_right", .type = OPTION_FLOAT, .count = 3, .min = -1000, .max = 1000,
	  .unit = "m", AT(layout_file_wall, lower_right), .help = "measured corner, likewise" },
	{ .key = "upper_left", .type = OPTION_FLOAT, .count = 3, .min = -1000, .max = 1000,
	  .unit = "m", AT(layout_file_wall, upper_left), .help = "measured corner, likewise" },
	{ .key = "center", .type = OPTION_FLOAT, .count = 3, .min = -1000, .max = 1000,
	  .unit = "m", AT(layout_file_wall, center),
	  .help = "middle of the wall; with size, instead of the three corners" },
	{ .key = "size", .type = OPTION_FLOAT, .count = 2, .min = 0.01, .max = 100, .unit = "m",
	  AT(layout_file_wall, size), .help = "width and height of the wall; with center" },
	{ .key = "heading_deg", .type = OPTION_FLOAT, .min = -360, .max = 360, .unit = "deg",
	  .scale = RAD_PER_DEG, .standard = "0", AT(layout_file_wall, heading),
	  .help = "with center: where a person who faces the wall looks; 0 is the front (-Z), 90 the left (-X)" },
	{ .key = "pitch_deg", .type = OPTION_FLOAT, .min = -180, .max = 180, .unit = "deg",
	  .scale = RAD_PER_DEG, .standard = "0", AT(layout_file_wall, pitch),
	  .help = "with center: how far up that person looks; -90 is the floor" },
	{ .key = "roll_deg", .type = OPTION_FLOAT, .min = -180, .max = 180, .unit = "deg",
	  .scale = RAD_PER_DEG, .standard = "0", AT(layout_file_wall, roll),
	  .help = "with center: turn in the wall's plane, counter-clockwise as seen" },
	{ .key = "pixels", .type = OPTION_INT, .required = true, .count = 2, .min = 16,
	  .max = 65536, .unit = "pixels", AT(layout_file_wall, pixels),
	  .help = "width and height of the whole wall's picture for one eye" },
	{ .key = "eyes", .type = OPTION_CHOICE, .choices = eyes_choices, .standard = "mono",
	  AT(layout_file_wall, eyes),
	  .help = "one picture, left and right of one node, or nodes that draw one eye each" },
	{ .key = "nodes", .type = OPTION_LIST, .required = true, .count = LAYOUT_MAX_NODES,
	  AT(layout_file_wall, nodes), .size = sizeof(struct layout_file_node),
	  .count_offset = offsetof(struct layout_file_wall, node_count), .group = node_options,
	  .help = "the list of nodes that draw this wall" },
	{ .key = NULL },
};

static const struct option network_options[] = {
	{ .key = "cast", .type = OPTION_CHOICE, .choices = cast_choices, .standard = "unicast",
	  AT(layout_file_network, network.cast),
	  .help = "how one datagram reaches all nodes; auto is multicast while all nodes hear it, else unicast" },
	{ .key = "interface", .type = OPTION_STRING, AT(layout_file_network, network.interface),
	  .help = "network interface of the room's own net, such as \"eth1\"; without it the system chooses" },
	{ .key = "master_address", .type = OPTION_STRING, .standard = "127.0.0.1",
	  AT(layout_file_network, network.master_address),
	  .help = "numeric address of the machine that runs grotto-master" },
	{ .key = "master_port", .type = OPTION_PORT, .min = 1024, .max = 65535,
	  .standard = "27100", AT(layout_file_network, network.master_port),
	  .help = "UDP port of grotto-master" },
	{ .key = "group", .type = OPTION_STRING, AT(layout_file_network, network.group),
	  .help = "multicast group (for auto, too) or broadcast address; not for unicast" },
	{ .key = "group_port", .type = OPTION_PORT, .min = 1024, .max = 65535,
	  .standard = "27101", AT(layout_file_network, network.group_port),
	  .help = "UDP port of the group" },
	{ .key = "ttl", .type = OPTION_INT, .min = 0, .max = 255, .standard = "1",
	  .unit = "hops", AT(layout_file_network, network.ttl),
	  .help = "how many routers a multicast datagram may pass, plus one" },
	{ .key = "loop", .type = OPTION_BOOL, .standard = "true", AT(layout_file_network, network.loop),
	  .help = "whether multicast is heard on the sending machine too; nodes beside the master need it" },
	{ .key = "mtu", .type = OPTION_INT, .min = 576, .max = 9000, .standard = "1500",
	  .unit = "bytes", AT(layout_file_network, network.mtu),
	  .help = "largest IP packet that the room's net carries whole" },
	{ .key = "key_file", .type = OPTION_STRING, AT(layout_file_network, network.key_file),
	  .help = "file with the cluster's key; only a room on loopback may do without" },
	{ .key = NULL },
};

static const struct option rates_options[] = {
	{ .key = "frame_hz", .type = OPTION_FLOAT, .min = 1, .max = 1000, .standard = "60",
	  .unit = "Hz", AT(layout_file_rates, rates.frame_hz), .help = "frames a second at most" },
	{ .key = "barrier_deadline_ms", .type = OPTION_TIME, .min = 1, .max = 60000,
	  .standard = "50", .scale = NS_PER_MS, .unit = "ms",
	  AT(layout_file_rates, rates.barrier_deadline_ns),
	  .help = "how long after a frame began the others swap without a late node" },
	{ .key = "evict_frames", .type = OPTION_INT, .min = 1, .max = 1000, .standard = "3",
	  .unit = "frames", AT(layout_file_rates, rates.evict_frames),
	  .help = "frames that a node may miss in a row before it is left out" },
	{ .key = "display_latency_ms", .type = OPTION_TIME, .min = 0, .max = 1000,
	  .standard = "16.7", .scale = NS_PER_MS, .unit = "ms",
	  AT(layout_file_rates, rates.display_latency_ns),
	  .help = "from the swap to light on the wall; heads are predicted to that time" },
	{ .key = NULL },
};

static const struct option swap_options[] = {
	{ .key = "mode", .type = OPTION_CHOICE, .choices = swap_choices, .standard = "auto",
	  AT(layout_file_swap, swap.mode),
	  .help = "when a node shows what all have drawn: when told, at a time that the master gives, or by the driver's swap barrier" },
	{ .key = "lead_most", .type = OPTION_FLOAT, .min = 0.01, .max = 0.5, .standard = "0.25",
	  .unit = "frames", AT(layout_file_swap, swap.lead_most),
	  .help = "how far ahead of its word the master may set a swap; it takes what the ways need" },
	{ .key = "busy_poll_us", .type = OPTION_TIME, .min = 0, .max = 10000, .standard = "200",
	  .scale = NS_PER_US, .unit = "us", AT(layout_file_swap, swap.busy_poll_ns),
	  .help = "before a swap's time in which a node does not sleep but looks at the clock" },
	{ .key = "without_master", .type = OPTION_CHOICE, .choices = orphan_choices,
	  .standard = "hold", AT(layout_file_swap, swap.orphan),
	  .help = "what a wall shows when its node has lost the master or was left out: the last picture, black, or a test pattern" },
	{ .key = NULL },
};

static const struct option test_options[] = {
	{ .key = "faults", .type = OPTION_BOOL, .standard = "false", AT(layout_file_test, test.faults),
	  .help = "whether grotto faults may disturb the room; each daemon then has a control socket" },
	{ .key = "off_loopback", .type = OPTION_BOOL, .standard = "false",
	  AT(layout_file_test, test.off_loopback),
	  .help = "whether it may although machines of the room are not on loopback" },
	{ .key = NULL },
};

#define START(key_, unit_, limit, standard_, scale_, member, help_)                         \
	{ .key = key_, .type = OPTION_FLOAT, .min = -(limit), .max = limit, .unit = unit_,  \
	  .standard = standard_, .scale = scale_, AT(layout_file_start, member), .help = help_ }

static const struct option start_options[] = {
	{ .key = "head", .type = OPTION_FLOAT, .count = 3, .min = -100, .max = 100, .unit = "m",
	  .standard = "0 1.7 0", AT(layout_file_start, head),
	  .help = "midpoint between the eyes before a tracker speaks" },
	START("head_heading_deg", "deg", 360, "0", RAD_PER_DEG, head_angles[0],
	      "where the head looks; 0 is the front (-Z), 90 the left"),
	START("head_pitch_deg", "deg", 90, "0", RAD_PER_DEG, head_angles[1],
	      "how far up the head looks"),
	START("head_roll_deg", "deg", 180, "0", RAD_PER_DEG, head_angles[2],
	      "how far the head leans to its left"),
	{ .key = "wand", .type = OPTION_FLOAT, .count = 3, .min = -100, .max = 100, .unit = "m",
	  .standard = "0.25 1.2 -0.35", AT(layout_file_start, wand),
	  .help = "tip of the wand before a tracker speaks" },
	START("wand_heading_deg", "deg", 360, "0", RAD_PER_DEG, wand_angles[0],
	      "where the wand points, likewise"),
	START("wand_pitch_deg", "deg", 90, "0", RAD_PER_DEG, wand_angles[1], "likewise"),
	START("wand_roll_deg", "deg", 180, "0", RAD_PER_DEG, wand_angles[2], "likewise"),
	{ .key = NULL },
};

static const struct option room_options[] = {
	{ .key = "min", .type = OPTION_FLOAT, .count = 3, .min = -1000, .max = 1000, .unit = "m",
	  .required = true, AT(layout_file_room, min),
	  .help = "the corner of the room with the smallest x, y and z" },
	{ .key = "max", .type = OPTION_FLOAT, .count = 3, .min = -1000, .max = 1000, .unit = "m",
	  .required = true, AT(layout_file_room, max), .help = "the corner opposite to min" },
	{ .key = NULL },
};

static const struct option sim_options[] = {
	{ .key = "rate_hz", .type = OPTION_FLOAT, .min = 1, .max = 1000, .standard = "120",
	  .unit = "Hz", AT(layout_file_sim, sim.rate_hz), .help = "samples a second and body" },
	{ .key = "noise_position_m", .type = OPTION_FLOAT, .min = 0, .max = 0.1, .standard = "0",
	  .unit = "m", AT(layout_file_sim, sim.noise_position_m),
	  .help = "standard deviation of the position" },
	{ .key = "noise_angle_deg", .type = OPTION_FLOAT, .min = 0, .max = 10, .standard = "0",
	  .scale = RAD_PER_DEG, .unit = "deg", AT(layout_file_sim, sim.noise_angle_rad),
	  .help = "standard deviation of the orientation" },
	{ .key = "latency_ms", .type = OPTION_TIME, .min = 0, .max = 1000, .standard = "0",
	  .scale = NS_PER_MS, .unit = "ms", AT(layout_file_sim, sim.latency_ns),
	  .help = "age of a sample when it arrives" },
	{ .key = "dropout_per_s", .type = OPTION_FLOAT, .min = 0, .max = 100, .standard = "0",
	  .unit = "1/s", AT(layout_file_sim, sim.dropout_per_s),
	  .help = "mean number of drop-outs a second" },
	{ .key = "dropout_ms", .type = OPTION_TIME, .min = 0, .max = 60000, .standard = "100",
	  .scale = NS_PER_MS, .unit = "ms", AT(layout_file_sim, sim.dropout_ns),
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

static const struct option tracker_options[] = {
	{ .key = "name", .type = OPTION_NAME, .required = true,
	  AT(layout_file_tracker, tracker.name), .help = "the tracker's name in logs and status" },
	{ .key = "kind", .type = OPTION_CHOICE, .required = true, .choices = tracker_choices,
	  AT(layout_file_tracker, tracker.kind),
	  .help = "the kind of device: a simulated visitor, or a log that is replayed" },
	{ .key = "head", .type = OPTION_BOOL, .standard = "true",
	  AT(layout_file_tracker, tracker.head), .help = "whether it tracks the head" },
	{ .key = "wand", .type = OPTION_BOOL, .standard = "true",
	  AT(layout_file_tracker, tracker.wand), .help = "whether it tracks the wand" },
	{ .key = "file", .type = OPTION_STRING, AT(layout_file_tracker, tracker.file),
	  .help = "for replay: the log, absolute or beside the layout file" },
	{ .key = "loop", .type = OPTION_BOOL, .standard = "true",
	  AT(layout_file_tracker, tracker.loop), .help = "for replay: begin again at the end" },
	{ .key = "sim", .type = OPTION_GROUP, AT(layout_file_tracker, sim), .group = sim_options,
	  .help = "for sim: what the simulated visitor does" },
	{ .key = NULL },
};

const struct option layout_options[] = {
	{ .key = "name", .type = OPTION_NAME, .standard = "cave", AT(layout_file, name),
	  .help = "the room's name in logs and status" },
	{ .key = "eye_separation_m", .type = OPTION_FLOAT, .min = 0, .max = 0.2,
	  .standard = "0.063", .unit = "m", AT(layout_file, eye_separation_m),
	  .help = "distance between the pupils" },
	{ .key = "control_socket", .type = OPTION_STRING, .standard = "/run/grotto/control",
	  AT(layout_file, control_socket),
	  .help = "absolute path of the socket where grotto-master answers grotto status" },
	{ .key = "walls", .type = OPTION_LIST, .required = true, .count = LAYOUT_MAX_NODES,
	  AT(layout_file, walls), .size = sizeof(struct layout_file_wall),
	  .count_offset = offsetof(struct layout_file, wall_count), .group = wall_options,
	  .help = "the list of walls ( { ... }, { ... } )" },
	{ .key = "network", .type = OPTION_GROUP, AT(layout_file, network),
	  .group = network_options, .help = "how the machines talk" },
	{ .key = "rates", .type = OPTION_GROUP, AT(layout_file, rates), .group = rates_options,
	  .help = "frame rate, barrier, latency" },
	{ .key = "swap", .type = OPTION_GROUP, AT(layout_file, swap), .group = swap_options,
	  .help = "when the walls change their picture" },
	{ .key = "test", .type = OPTION_GROUP, AT(layout_file, test), .group = test_options,
	  .help = "what only a room that is being tested has" },
	{ .key = "start", .type = OPTION_GROUP, AT(layout_file, start), .group = start_options,
	  .help = "where head and wand are before a tracker speaks" },
	{ .key = "room", .type = OPTION_GROUP, AT(layout_file, room), .group = room_options,
	  .help = "where eyes may be; without it the box around the walls" },
	{ .key = "trackers", .type = OPTION_LIST, .count = LAYOUT_MAX_TRACKERS,
	  AT(layout_file, trackers), .size = sizeof(struct layout_file_tracker),
	  .count_offset = offsetof(struct layout_file, tracker_count), .group = tracker_options,
	  .help = "the list of trackers; without one the head stays at its start" },
	{ .key = NULL },
};
