/* The layout's keys about trackers that come by the network. */
#include "config/layout_options.h"

static const char *const up_choices[] = { "y", "z", NULL };
static const char *const stick_x_choices[] = { "left", "right", NULL };
static const char *const stick_y_choices[] = { "up", "down", NULL };
static const char *const transport_choices[] = { "tcp", "udp", NULL };

#define AT(type, member) .offset = offsetof(struct type, member)

/* The first of each table is one that can be absent: the group is not written then. */
const struct option layout_dtrack_options[] = {
	{ .key = "up", .type = OPTION_CHOICE, .choices = up_choices, .standard = "y",
	  AT(layout_file_dtrack, dtrack.up),
	  .help = "the axis that points up as the room was calibrated; X points to the right in either case" },
	{ .key = "port", .type = OPTION_PORT, .min = 1024, .max = 65535, .standard = "5000",
	  AT(layout_file_dtrack, dtrack.port),
	  .help = "UDP port of this machine that the controller sends to" },
	{ .key = "address", .type = OPTION_STRING, AT(layout_file_dtrack, dtrack.address),
	  .help = "numeric IPv4 address of the controller; without it what anyone sends is taken" },
	{ .key = "group", .type = OPTION_STRING, AT(layout_file_dtrack, dtrack.group),
	  .help = "IPv4 multicast group that the controller sends to" },
	{ .key = "interface", .type = OPTION_STRING, AT(layout_file_dtrack, dtrack.interface),
	  .help = "network interface that hears the group; without it the system chooses" },
	{ .key = "knock", .type = OPTION_BOOL, .standard = "false",
	  AT(layout_file_dtrack, dtrack.knock),
	  .help = "send the controller a datagram first, so that a firewall lets its own in" },
	{ .key = "stick_x_plus", .type = OPTION_CHOICE, .choices = stick_x_choices,
	  .standard = "left", AT(layout_file_dtrack, dtrack.stick_x_plus),
	  .help = "where a Flystick's stick is when the controller says +1; A.R.T.'s manual says left" },
	{ .key = "stick_y_plus", .type = OPTION_CHOICE, .choices = stick_y_choices, .standard = "up",
	  AT(layout_file_dtrack, dtrack.stick_y_plus), .help = "likewise" },
	{ .key = NULL },
};

const struct option layout_vrpn_options[] = {
	{ .key = "device", .type = OPTION_STRING, .required = true,
	  AT(layout_file_vrpn, vrpn.device),
	  .help = "the server's name for the device: what stands before the @ in \"Tracker0@host\"" },
	{ .key = "address", .type = OPTION_STRING, .required = true,
	  AT(layout_file_vrpn, vrpn.address), .help = "the server's machine, as a numeric IPv4 address" },
	{ .key = "port", .type = OPTION_PORT, .min = 1, .max = 65535, .standard = "3883",
	  AT(layout_file_vrpn, vrpn.port), .help = "of the server" },
	{ .key = "transport", .type = OPTION_CHOICE, .choices = transport_choices,
	  .standard = "tcp", AT(layout_file_vrpn, vrpn.transport),
	  .help = "tcp: one connection to the server; udp: it connects back, and poses come as datagrams" },
	{ .key = NULL },
};
