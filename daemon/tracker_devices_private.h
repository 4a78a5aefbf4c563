/* What tracker_devices.c and tracker_pads.c share. */
#ifndef GROTTO_DAEMON_TRACKER_DEVICES_PRIVATE_H
#define GROTTO_DAEMON_TRACKER_DEVICES_PRIVATE_H

#include "daemon/tracker_devices.h"

/* Makes the device of a tracker; GR_ERR_CONFIG with a line in diag, any other error without. */
typedef int tracker_create(struct track_device **out, const struct layout *layout,
			   const struct layout_tracker *tracker, struct gr_diag *diag);
tracker_create tracker_create_gamepad, tracker_create_sony, tracker_create_spacemouse;

/* "a, b, c": as many names as there is room for. */
void tracker_list_names(char *text, size_t size, const char *const *names);

#endif
