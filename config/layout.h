/*
 * A cave layout: the walls, who draws them, how the machines talk, who is
 * tracked. Read from a libconfig file; every key is in the option table
 * (config/options.h), and docs/layout.md is made from that table.
 *
 * Frame: room (base/pose.h). Lengths are metres, angles radians, times
 * nanoseconds here; files say degrees and milliseconds in the key's name.
 *
 * Ownership: strings and arrays belong to the layout. Not thread safe while
 * being loaded, read-only after.
 */
#ifndef GROTTO_CONFIG_LAYOUT_H
#define GROTTO_CONFIG_LAYOUT_H

#include "base/diag.h"
#include "base/item.h"
#include "base/pose.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define LAYOUT_NAME_MAX 32 /* with the final NUL */
#define LAYOUT_MAX_NODES 64
#define LAYOUT_MAX_STANDBY 7 /* nodes and masters are at most LAYOUT_MAX_NODES together */

enum layout_eyes {
	LAYOUT_EYES_MONO,         /* one picture from between the eyes */
	LAYOUT_EYES_QUAD_BUFFER,  /* left and right back buffer of one context */
	LAYOUT_EYES_SIDE_BY_SIDE, /* left half and right half of the picture */
	LAYOUT_EYES_TOP_BOTTOM,   /* left eye on top */
	LAYOUT_EYES_LEFT,         /* this node draws the left eye alone */
	LAYOUT_EYES_RIGHT,
};

enum layout_target {
	LAYOUT_TARGET_HEADLESS, /* EGL without a display: device platform, then surfaceless */
	LAYOUT_TARGET_WINDOW,   /* a GLFW window */
	LAYOUT_TARGET_FULLSCREEN,
};

enum layout_cast {
	LAYOUT_UNICAST,
	LAYOUT_MULTICAST,
	LAYOUT_BROADCAST,
	LAYOUT_AUTO, /* multicast while every node hears it, else unicast */
};

/* Whether what is sent to all is sent with parity, so that losses need no repair. */
enum layout_parity {
	LAYOUT_PARITY_AUTO, /* while datagrams get lost */
	LAYOUT_PARITY_OFF,
	LAYOUT_PARITY_ON,
};

/* One projected wall. Corners as the person inside sees them. */
struct layout_wall {
	char name[LAYOUT_NAME_MAX];
	vec3 lower_left, lower_right, upper_left; /* room, metres */
	int pixels[2];                            /* of the whole wall and one eye */
	int line;                                 /* in the file */
};

/* Of a picture's values on their way to the display. */
enum layout_depth { LAYOUT_DEPTH_8, LAYOUT_DEPTH_10, LAYOUT_DEPTH_FLOAT };

/* What a node's projector makes of them, measured; renderer/tone/projector.h says how. */
struct layout_projector {
	vec3 black, gain; /* light of code 0 and of code 1; 1 is the room's white */
	vec3 gamma;       /* NaN: the scene's */
	char *table;      /* instead of the three; NULL, absolute, or beside the layout file */
	enum layout_depth depth;
	bool dither;
};

/* One render node: draws `part` of one wall. */
struct layout_node {
	char name[LAYOUT_NAME_MAX]; /* unique; the instance of grotto-node@NAME */
	size_t wall;                /* index into walls */
	float part[4];              /* x0 y0 x1 y1 of the wall, 0..1 from its lower left */
	char *address;              /* numeric IPv4 or IPv6 */
	uint16_t port;
	enum layout_eyes eyes;
	enum layout_target target;
	char *display; /* X display for a window, NULL for the environment's */
	int monitor;   /* for fullscreen */
	int gpu;       /* EGL device index, -1 for the first that works */
	struct layout_projector projector;
	int line;
};

struct layout_network {
	enum layout_cast cast;
	char *interface;      /* name, NULL: the system chooses */
	char *master_address; /* numeric */
	uint16_t master_port;
	char *group; /* multicast group or broadcast address, NULL for unicast */
	uint16_t group_port;
	int ttl;
	bool loop;      /* the group is heard on the sending machine, too */
	int mtu;        /* bytes of an IP packet */
	enum layout_parity parity; /* the master's to decide: nodes need not have it alike */
	char *key_file; /* absolute, or relative to the layout file; NULL: unkeyed, loopback only */
	int key_file_line; /* in the file, 0 without one */
};

/* Another machine with a master, that takes over when the one before it is silent. */
struct layout_standby {
	char *address; /* numeric */
	uint16_t port;
	int line;
};

struct layout_rates {
	float frame_hz;
	int64_t barrier_deadline_ns; /* after which SWAP goes out without the late */
	int evict_frames;            /* missed in a row before a node is left out */
	int takeover_frames;         /* within which a standby has taken over, where there is one */
	int64_t display_latency_ns;  /* from SWAP to light on the wall, for the photon time */
};

/* When a node shows a frame that all have drawn. */
enum layout_swap_mode {
	LAYOUT_SWAP_AUTO,      /* by the driver's barrier where all is there for it, else at a time, else when told */
	LAYOUT_SWAP_MESSAGE,   /* when the master's word arrives */
	LAYOUT_SWAP_SCHEDULED, /* at a time that the master gives */
	LAYOUT_SWAP_HARDWARE,  /* by NV_swap_group and its barrier; refused where there is none */
};

/* What a wall shows whose node has lost its master, or was left out. */
enum layout_orphan { LAYOUT_ORPHAN_HOLD, LAYOUT_ORPHAN_BLACK, LAYOUT_ORPHAN_TEST };

struct layout_swap {
	enum layout_swap_mode mode;
	float lead_most;      /* of a frame's time: how far ahead the master may set a swap */
	int64_t busy_poll_ns; /* before a swap's time in which a node looks at the clock and sleeps no more */
	enum layout_orphan orphan;
};

/* What becomes of a node that lives and does not keep up; protocol/pace.h has the rule. */
enum layout_slow_policy {
	LAYOUT_SLOW_EVICT, /* it is left out, and may not come back at once */
	LAYOUT_SLOW_WAIT,  /* all wait for it, past the deadline */
	LAYOUT_SLOW_HALF,  /* it shows every second frame, the others all */
};

struct layout_slow {
	enum layout_slow_policy policy;
	int64_t limit_ns;       /* ready later than this is slow; 0: the deadline, for half 1.5 frames */
	int frames;             /* so many more slow frames than others, and the policy is followed */
	int64_t wait_most_ns;   /* all wait for it no longer than this after a frame began */
	int64_t rejoin_most_ns; /* the longest that an evicted one is kept out */
};

/* What only a room that is being tested has. */
struct layout_test {
	bool faults;       /* grotto faults may disturb it */
	bool off_loopback; /* and that beyond this machine */
};

/* What the buttons and axes of the wand do, by their number from 0, -1: none; see daemon/hand.h. */
enum layout_turn { LAYOUT_TURN_LEVEL, LAYOUT_TURN_FREE };
struct layout_hand {
	int next;                    /* buttons: in every input layout */
	int fly, drag, reset, lamps; /* navigation */
	int torch, dimmer, brighter; /* lighting */
	int quality, fewer, more;    /* settings */
	int saturation, hue;         /* axes: lighting */
	int absorption, scattering;  /* settings */
	enum layout_turn turn;
	bool hud;
	float hud_scale;
};

/* All after LAYOUT_TRACKER_WINDOW are devices, see docs/trackers.md. */
enum layout_tracker_kind {
	LAYOUT_TRACKER_SIM,
	LAYOUT_TRACKER_REPLAY,
	LAYOUT_TRACKER_WINDOW, /* a wand of keyboard and mouse in the nodes' windows */
	LAYOUT_TRACKER_HYDRA,
	LAYOUT_TRACKER_VIPER,
	LAYOUT_TRACKER_LIBERTY,
	LAYOUT_TRACKER_PATRIOT,
	LAYOUT_TRACKER_DTRACK,
	LAYOUT_TRACKER_VRPN,
	LAYOUT_TRACKER_GAMEPAD,
	LAYOUT_TRACKER_DUALSHOCK4,
	LAYOUT_TRACKER_DUALSENSE,
	LAYOUT_TRACKER_SPACEMOUSE,
};

/* The simulated visitor, see tracking/sim.h for what each does. */
struct layout_sim {
	float rate_hz;
	float noise_position_m; /* standard deviation */
	float noise_angle_rad;
	int64_t latency_ns;
	float dropout_per_s; /* mean number of drop-outs a second */
	int64_t dropout_ns;  /* length of one */
	uint32_t seed;
	float walk_radius_m; /* how far from the start pose the visitor walks */
	float walk_speed_m_s;
};

/* Polhemus' trackers, see tracking/polhemus.h. */
struct layout_polhemus {
	char *path; /* of the USB bus; NULL: any */
	int rate_hz;
	vec3 hemisphere; /* base's axes; all 0: the device's own */
	bool follow;
	bool filter;
};

/* A.R.T. DTrack, see tracking/dtrack.h. */
enum layout_up { LAYOUT_UP_Y, LAYOUT_UP_Z };
enum layout_stick_x { LAYOUT_STICK_LEFT, LAYOUT_STICK_RIGHT };
enum layout_stick_y { LAYOUT_STICK_UP, LAYOUT_STICK_DOWN };
struct layout_dtrack {
	enum layout_up up; /* of the room as it was calibrated */
	uint16_t port;     /* that the controller sends to */
	char *address;     /* of the controller, numeric IPv4; NULL: anyone may send */
	char *group;       /* multicast group to join, or NULL */
	char *interface;   /* that hears the group; NULL: the system chooses */
	bool knock;        /* a datagram goes out to the controller first, for a firewall */
	enum layout_stick_x stick_x_plus; /* where a Flystick's stick is when it says +1 */
	enum layout_stick_y stick_y_plus;
};

/* A VRPN server's device, see tracking/vrpn.h. */
enum layout_transport { LAYOUT_TCP, LAYOUT_UDP };
struct layout_vrpn {
	char *device;  /* the server's name for it */
	char *address; /* of the server, numeric IPv4 */
	uint16_t port;
	enum layout_transport transport;
};

/* A gamepad, see tracking/gamepad.h and sony.h. */
struct layout_pad {
	float dead_zone;
	int vendor, product; /* 0: any */
	char *path;	     /* of the USB bus; NULL: any */
	char *triggers;	     /* axes by name; NULL: none */
	char recentre[LAYOUT_NAME_MAX]; /* button; "": none */
};

/* A SpaceMouse, see tracking/spacemouse.h. */
struct layout_spacemouse {
	float speed_m_s, turn_rad_s, reach_m;
	char home[LAYOUT_NAME_MAX]; /* button; "": none */
	char *path;		    /* of the USB bus; NULL: any */
};

enum layout_body { LAYOUT_HEAD, LAYOUT_WAND };

/* Position and angles (heading, pitch, roll; radians) as the file gives them, and the pose they make. */
struct layout_frame {
	vec3 position, angles;
	struct gr_pose pose;
};

/* What a device's sensor gives of a body. */
struct layout_binding {
	enum layout_body body;
	char sensor[LAYOUT_NAME_MAX]; /* the device's name for it; "": its first */
	bool position, orientation, input; /* input: buttons and axes */
	struct layout_frame sensor_body;   /* T_sensor_body: the eyes' middle or the wand's tip */
	char *buttons, *axes; /* names of the device, see tracking/bind.h; NULL: its own order */
	int line;
};
#define LAYOUT_MAX_BINDINGS 8

/* What is made of samples; see tracking/filter.h for what each does. */
enum layout_filter_kind {
	LAYOUT_FILTER_AUTO, /* a device: kalman; sim and replay: none, and no gate */
	LAYOUT_FILTER_NONE,
	LAYOUT_FILTER_ONE_EURO,
	LAYOUT_FILTER_EXPONENTIAL,
	LAYOUT_FILTER_KALMAN,
};
struct layout_filter {
	enum layout_filter_kind kind;
	float noise_position_m, noise_angle_rad; /* kalman */
	float move_position, move_angle;         /* kalman: m^2/s^3, rad^2/s^3 */
	float cutoff_hz, slope_hz;               /* one-euro */
	float beta_position, beta_angle;         /* Hz s/m, Hz s/rad */
	float tau_s;                             /* exponential */
	bool gate;
	float gate_m, gate_m_s, gate_rad, gate_rad_s;
	float gate_hold_s, ahead_s, decay_s, gap_s, blend_s;
};

struct layout_tracker {
	char name[LAYOUT_NAME_MAX];
	enum layout_tracker_kind kind;
	bool head, wand; /* what it tracks; of a device: what is bound */
	char *file;      /* replay: the log, absolute or relative to the layout file */
	bool loop;
	struct layout_sim sim;
	struct layout_filter filter; /* of the bodies whose position it gives */
	/* Devices. */
	char *serial; /* NULL: any */
	int number;   /* of those that fit, from 0 */
	int64_t latency_ns; /* of the device's quickest report */
	struct layout_dtrack dtrack; /* of that kind alone, */
	struct layout_vrpn vrpn;     /* and of that */
	struct layout_frame room_base; /* T_room_base: where the device's frame is */
	float scale; /* room metres per metre that the device says */
	struct layout_polhemus polhemus;
	struct layout_pad pad;
	struct layout_spacemouse spacemouse;
	struct layout_binding bindings[LAYOUT_MAX_BINDINGS];
	size_t binding_count;
	int line;
};
/* Whether it is a device, with bindings. */
bool layout_tracker_is_device(const struct layout_tracker *tracker);
/* Whether it is one of Polhemus', which the group of that name is for. */
bool layout_tracker_is_polhemus(const struct layout_tracker *tracker);
/* Whether the group "pad" is for it. */
bool layout_tracker_is_pad(const struct layout_tracker *tracker);

struct layout {
	char *path; /* as given to layout_load */
	char name[LAYOUT_NAME_MAX];
	struct layout_wall *walls;
	size_t wall_count;
	struct layout_node *nodes;
	size_t node_count;
	struct layout_network network;
	struct layout_standby *standby; /* in the order in which they take over */
	size_t standby_count;
	struct layout_rates rates;
	struct layout_swap swap;
	struct layout_slow slow;
	struct layout_test test;
	struct layout_hand hand;
	struct layout_tracker *trackers;
	size_t tracker_count;
	struct gr_pose start_head; /* T_room_head before a tracker speaks */
	struct gr_pose start_wand;
	float eye_separation_m;
	vec3 room_min, room_max; /* where eyes may be; from the walls unless given */
	char *control_socket;    /* path of the master's control socket */
	uint8_t hash[32];        /* see layout_items; nodes compare it at join */
	vec3 start_head_angles;  /* as the file gives them: heading, pitch, roll; radians */
	vec3 start_wand_angles;
	bool room_given;         /* room_min and room_max are the file's own */
};

/*
 * Reads and checks a layout. Faults go to diag, each with file and line.
 * GR_OK with *out set; GR_ERR_CONFIG when diag has an error, GR_ERR_IO,
 * GR_ERR_NOMEM: *out is NULL then.
 */
int layout_load(const char *path, struct layout **out, struct gr_diag *diag);
/* The same from memory; path stands in messages and for what is relative to it. */
int layout_parse(const char *text, size_t len, const char *path, struct layout **out,
		 struct gr_diag *diag);
void layout_destroy(struct layout **layout);

/*
 * Writes a layout as a file that loads to the same values (walls by their
 * corners, comments lost). GR_OK, GR_ERR_IO, GR_ERR_NOMEM.
 */
int layout_write(FILE *file, const struct layout *layout);
/*
 * What all machines of a room must agree on, part by part in the order of the
 * file, up to `room` of them (items may be NULL), and the BLAKE2b-256 of the
 * canonical form of all: walls, nodes (name, wall, part, address, port, eyes), network, standbys, rates,
 * start, room, eye separation. Not of paths, comments, the key file, the
 * trackers, the hand, the control socket, tests, slow and how far ahead a swap is set (the master's own), nor of target, display,
 * monitor and gpu (one node's own). layout_load has stored it in hash. Returns the
 * number of parts, at most LAYOUT_ITEMS_MAX.
 */
#define LAYOUT_ITEMS_MAX (2 * LAYOUT_MAX_NODES + 19)
size_t layout_items(const struct layout *layout, struct gr_item *items, size_t room,
		    uint8_t hash[32]);

/* Index of the node of that name, or -1. */
int layout_find_node(const struct layout *layout, const char *name);
/* The corners of the part of a wall that a node draws, and its pixels (one eye). */
void layout_node_corners(const struct layout *layout, size_t node, vec3 lower_left,
			 vec3 lower_right, vec3 upper_left);
void layout_node_pixels(const struct layout *layout, size_t node, int pixels[2]);
/* A file that the layout names as a path that can be opened. Caller frees. */
char *layout_beside(const struct layout *layout, const char *name);
/* The same of key_file; NULL when there is none. */
char *layout_key_path(const struct layout *layout);

/*
 * What `grotto check` says about the room: size of each wall, and for each two
 * walls that share an edge the gap or overlap in millimetres at both ends.
 * Adds GR_DIAG_NOTE lines, and a warning from 5 mm on.
 */
void layout_report_geometry(const struct layout *layout, struct gr_diag *diag);

#endif
