/*
 * From a layout's tracker to a driver and its bindings. The one place where a
 * new driver is named: a line in the table of tracker_devices.c.
 */
#ifndef GROTTO_DAEMON_TRACKER_DEVICES_H
#define GROTTO_DAEMON_TRACKER_DEVICES_H

#include "config/layout.h"
#include "tracking/bind.h"
#include "tracking/device.h"

/*
 * Makes the device (opens nothing yet). GR_OK; an error, with lines in diag
 * where the layout asks for what the driver does not have.
 */
int tracker_device_create(struct track_device **out, const struct layout *layout,
			  const struct layout_tracker *tracker, struct gr_diag *diag);
/* The layout's bindings of that device, in its order. GR_OK, GR_ERR_CONFIG with lines in diag. */
int tracker_bindings(struct track_binding *out, const struct layout *layout,
		     const struct layout_tracker *tracker, const struct track_device_ops *ops,
		     struct gr_diag *diag);
/* Whether the devices have what the layout asks of them by name; opens none. Faults go to diag. */
void tracker_devices_check(const struct layout *layout, struct gr_diag *diag);

#endif
