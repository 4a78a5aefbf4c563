/*
 * What the option table cannot check: keys against each other. Private to
 * config/.
 */
#ifndef GROTTO_CONFIG_LAYOUT_CHECK_H
#define GROTTO_CONFIG_LAYOUT_CHECK_H

#include "config/layout_options.h"

/* Largest departure of a wall's corner from 90 degrees. */
#define LAYOUT_RIGHT_ANGLE_DEG 0.1
/* Shortest side of a wall, metres. */
#define LAYOUT_SIDE_MIN 0.01

/*
 * Completes the file's form (corners from centre and size, node names, eyes,
 * the room's box) and reports every fault. After it, and with no fault in the
 * reader, the form can be built.
 */
void layout_check(struct options_reader *reader, struct layout_file *file);

/* Parts of it: corners of every wall; who draws what; start pose and room; addresses; trackers. */
void layout_check_walls(struct options_reader *reader, struct layout_file *file);
void layout_check_nodes(struct options_reader *reader, struct layout_file *file);
void layout_check_room(struct options_reader *reader, struct layout_file *file);
void layout_check_network(struct options_reader *reader, struct layout_file *file);
void layout_check_trackers(struct options_reader *reader, const struct layout_file *file);
void layout_check_hand(struct options_reader *reader, const struct layout_file *file);
/* Of trackers: the addresses and ports of tracker i, a device. */
void layout_check_tracker_network(struct options_reader *reader, const struct layout_file *file,
				  size_t i);
/* The groups of gamepads and of SpaceMouse, given to tracker i. */
void layout_check_tracker_pads(struct options_reader *reader, const struct layout_file *file,
			       size_t i);

#endif
