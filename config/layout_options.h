/*
 * A layout as its file says it, before it is checked and turned into struct
 * layout: corners or centre and size, eyes of the wall or of the node.
 *
 * Private to config/.
 */
#ifndef GROTTO_CONFIG_LAYOUT_OPTIONS_H
#define GROTTO_CONFIG_LAYOUT_OPTIONS_H

#include "config/layout.h"
#include "config/options.h"

#define LAYOUT_MAX_TRACKERS 8

/* Values of `eyes` of a wall or node: enum layout_eyes up to this one. */
#define LAYOUT_FILE_EYE_PER_NODE LAYOUT_EYES_LEFT

struct layout_file_projector {
	const config_setting_t *at;
	struct layout_projector projector;
};

struct layout_file_node {
	const config_setting_t *at;
	struct layout_node node; /* but for its projector */
	struct layout_file_projector projector;
	int eyes, eye; /* as given, OPTION_ABSENT when not */
};

struct layout_file_wall {
	const config_setting_t *at;
	char name[LAYOUT_NAME_MAX];
	vec3 lower_left, lower_right, upper_left; /* NaN when not given */
	vec3 center;
	float size[2];
	float heading, pitch, roll; /* radians */
	int pixels[2];
	int eyes;
	struct layout_file_node *nodes;
	size_t node_count;
};

struct layout_file_network {
	const config_setting_t *at;
	struct layout_network network;
};

struct layout_file_standby {
	const config_setting_t *at;
	struct layout_standby standby;
};

struct layout_file_rates {
	const config_setting_t *at;
	struct layout_rates rates;
};

struct layout_file_swap {
	const config_setting_t *at;
	struct layout_swap swap;
};

struct layout_file_slow {
	const config_setting_t *at;
	struct layout_slow slow;
};

struct layout_file_test {
	const config_setting_t *at;
	struct layout_test test;
};

struct layout_file_hand {
	const config_setting_t *at;
	struct layout_hand hand;
};

struct layout_file_start {
	const config_setting_t *at;
	vec3 head, wand;
	vec3 head_angles, wand_angles; /* heading, pitch, roll; radians */
};

struct layout_file_room {
	const config_setting_t *at;
	vec3 min, max;
};

struct layout_file_sim {
	const config_setting_t *at;
	struct layout_sim sim;
};

struct layout_file_dtrack {
	const config_setting_t *at;
	struct layout_dtrack dtrack;
};

struct layout_file_vrpn {
	const config_setting_t *at;
	struct layout_vrpn vrpn;
};

struct layout_file_filter {
	const config_setting_t *at;
	struct layout_filter filter;
};

struct layout_file_base {
	const config_setting_t *at;
	struct layout_frame room_base;
	float scale;
};

struct layout_file_polhemus {
	const config_setting_t *at;
	struct layout_polhemus polhemus;
};

struct layout_file_pad {
	const config_setting_t *at;
	struct layout_pad pad;
};

struct layout_file_spacemouse {
	const config_setting_t *at;
	struct layout_spacemouse spacemouse;
};

struct layout_file_binding {
	const config_setting_t *at;
	struct layout_binding binding;
};

struct layout_file_tracker {
	const config_setting_t *at;
	struct layout_tracker tracker;
	struct layout_file_sim sim;
	struct layout_file_dtrack dtrack;
	struct layout_file_vrpn vrpn;
	struct layout_file_filter filter;
	struct layout_file_base base;
	struct layout_file_polhemus polhemus;
	struct layout_file_pad pad;
	struct layout_file_spacemouse spacemouse;
	struct layout_file_binding *bindings;
	size_t binding_count;
};

struct layout_file {
	const config_setting_t *at;
	char name[LAYOUT_NAME_MAX];
	float eye_separation_m;
	char *control_socket;
	struct layout_file_wall *walls;
	size_t wall_count;
	struct layout_file_network network;
	struct layout_file_rates rates;
	struct layout_file_swap swap;
	struct layout_file_slow slow;
	struct layout_file_test test;
	struct layout_file_hand hand;
	struct layout_file_start start;
	struct layout_file_room room;
	struct layout_file_standby *standby;
	size_t standby_count;
	struct layout_file_tracker *trackers;
	size_t tracker_count;
};

extern const struct option layout_options[];
extern const struct option layout_tracker_options[];
extern const struct option layout_hand_options[];
extern const struct option layout_dtrack_options[], layout_vrpn_options[];
extern const struct option layout_pad_options[], layout_spacemouse_options[];

/* Factors from the files' units to ours. */
#define LAYOUT_RAD_PER_DEG 0.017453292519943295
#define LAYOUT_NS_PER_S 1e9
#define LAYOUT_NS_PER_MS 1e6
#define LAYOUT_NS_PER_US 1e3

/* One group of `trackers` as a tracker; strings move over. */
void layout_tracker_build(struct layout_tracker *out, struct layout_file_tracker *from);
void layout_tracker_free(struct layout_tracker *tracker);
/* The other way, for writing; strings are borrowed. bindings: room for the tracker's. */
void layout_tracker_fill(struct layout_file_tracker *out, const struct layout_tracker *from,
			 struct layout_file_binding bindings[LAYOUT_MAX_BINDINGS]);
/* heading about +Y, then pitch about the turned X, then roll about the line of sight. */
void layout_pose_from_angles(const vec3 position, const vec3 angles, struct gr_pose *out);

#endif
