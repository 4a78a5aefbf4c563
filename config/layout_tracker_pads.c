/* The layout's keys about gamepads and SpaceMouse. */
#include "config/layout_options.h"

#define AT(type, member) .offset = offsetof(struct type, member)

/* The first of each table is one that can be absent: the group is not written then. */
const struct option layout_pad_options[] = {
	{ .key = "dead_zone", .type = OPTION_FLOAT, .min = 0, .max = 0.9, .standard = "0.08",
	  AT(layout_file_pad, pad.dead_zone),
	  .help = "part of a stick's way around its middle that counts as its middle" },
	{ .key = "vendor", .type = OPTION_INT, .min = 0, .max = 65535, .standard = "0",
	  AT(layout_file_pad, pad.vendor),
	  .help = "for gamepad: USB or Bluetooth vendor number, such as 0x046d; 0 for any" },
	{ .key = "product", .type = OPTION_INT, .min = 0, .max = 65535, .standard = "0",
	  AT(layout_file_pad, pad.product),
	  .help = "for gamepad: its product number; with it the device need not call itself a gamepad" },
	{ .key = "path", .type = OPTION_STRING, AT(layout_file_pad, pad.path),
	  .help = "where it is plugged in, bus and ports as in /sys/bus/usb/devices, such as \"1-2.4\"; without it anywhere" },
	{ .key = "triggers", .type = OPTION_STRING, AT(layout_file_pad, pad.triggers),
	  .help = "for gamepad: axes that rest at one end and go from 0 to 1, names apart by blanks; sliders and pedals do so anyway" },
	{ .key = "recentre", .type = OPTION_NAME, AT(layout_file_pad, pad.recentre),
	  .help = "for dualshock4 and dualsense: button that turns the wand's heading to the base's -Z; without it none" },
	{ .key = NULL },
};

const struct option layout_spacemouse_options[] = {
	{ .key = "speed_m_s", .type = OPTION_FLOAT, .min = 0, .max = 20, .standard = "0.5",
	  .unit = "m/s", AT(layout_file_spacemouse, spacemouse.speed_m_s),
	  .help = "how fast the body goes when the cap is pushed all the way" },
	{ .key = "turn_deg_s", .type = OPTION_FLOAT, .min = 0, .max = 720, .standard = "60",
	  .scale = LAYOUT_RAD_PER_DEG, .unit = "deg/s",
	  AT(layout_file_spacemouse, spacemouse.turn_rad_s), .help = "likewise, turned all the way" },
	{ .key = "reach_m", .type = OPTION_FLOAT, .min = 0, .max = 500, .standard = "2", .unit = "m",
	  AT(layout_file_spacemouse, spacemouse.reach_m),
	  .help = "how far it goes from the base's origin, along each axis" },
	{ .key = "home", .type = OPTION_NAME, AT(layout_file_spacemouse, spacemouse.home),
	  .help = "button that takes it back to the base's origin; without it none" },
	{ .key = "path", .type = OPTION_STRING, AT(layout_file_spacemouse, spacemouse.path),
	  .help = "where it is plugged in, as in /sys/bus/usb/devices; without it anywhere" },
	{ .key = NULL },
};
