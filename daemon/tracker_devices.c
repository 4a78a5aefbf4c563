#include "daemon/tracker_devices_private.h"

#include "base/clock.h"
#include "base/result.h"
#include "tracking/dtrack.h"
#include "tracking/hydra.h"
#include "tracking/polhemus.h"
#include "tracking/vrpn.h"

#include <stdio.h>
#include <string.h>

static int create_hydra(struct track_device **out, const struct layout *layout,
			const struct layout_tracker *tracker, struct gr_diag *diag)
{
	const struct track_hydra_params params = {
		.serial = tracker->serial,
		.number = tracker->number,
	};

	(void)layout;
	(void)diag;
	return track_hydra_create(out, &params, &gr_clock_monotonic);
}

static int create_polhemus(struct track_device **out, const struct layout *layout,
			   const struct layout_tracker *tracker, struct gr_diag *diag)
{
	const struct layout_polhemus *from = &tracker->polhemus;
	const struct track_polhemus_params params = {
		.model = tracker->kind == LAYOUT_TRACKER_VIPER	 ? TRACK_POLHEMUS_MODEL_VIPER :
			 tracker->kind == LAYOUT_TRACKER_LIBERTY ? TRACK_POLHEMUS_MODEL_LIBERTY :
								   TRACK_POLHEMUS_MODEL_PATRIOT,
		.serial = tracker->serial,
		.path = from->path,
		.number = tracker->number,
		.rate_hz = from->rate_hz,
		.hemisphere = { from->hemisphere[0], from->hemisphere[1], from->hemisphere[2] },
		.follow = from->follow,
		.filter = from->filter,
	};

	(void)layout;
	(void)diag;
	return track_polhemus_create(out, &params, &gr_clock_monotonic);
}

static int create_dtrack(struct track_device **out, const struct layout *layout,
			 const struct layout_tracker *tracker, struct gr_diag *diag)
{
	const struct layout_dtrack *from = &tracker->dtrack;
	const struct track_dtrack_params params = {
		.address = from->address,
		.group = from->group,
		.interface_name = from->interface,
		.port = from->port,
		.knock = from->knock,
		.setup = { .z_up = from->up == LAYOUT_UP_Z,
			   .stick_x_left = from->stick_x_plus == LAYOUT_STICK_LEFT,
			   .stick_y_down = from->stick_y_plus == LAYOUT_STICK_DOWN },
	};

	(void)layout;
	(void)diag;
	return track_dtrack_create(out, &params, &gr_clock_monotonic);
}

static int create_vrpn(struct track_device **out, const struct layout *layout,
		       const struct layout_tracker *tracker, struct gr_diag *diag)
{
	const struct track_vrpn_params params = {
		.device = tracker->vrpn.device,
		.address = tracker->vrpn.address,
		.port = tracker->vrpn.port,
		.udp = tracker->vrpn.transport == LAYOUT_UDP,
	};

	(void)layout;
	(void)diag;
	return track_vrpn_create(out, &params, &gr_clock_monotonic);
}

/* Indexed by kind. */
static tracker_create *const create[] = {
	[LAYOUT_TRACKER_HYDRA] = create_hydra,
	[LAYOUT_TRACKER_VIPER] = create_polhemus,
	[LAYOUT_TRACKER_LIBERTY] = create_polhemus,
	[LAYOUT_TRACKER_PATRIOT] = create_polhemus,
	[LAYOUT_TRACKER_DTRACK] = create_dtrack,
	[LAYOUT_TRACKER_VRPN] = create_vrpn,
	[LAYOUT_TRACKER_GAMEPAD] = tracker_create_gamepad,
	[LAYOUT_TRACKER_DUALSHOCK4] = tracker_create_sony,
	[LAYOUT_TRACKER_DUALSENSE] = tracker_create_sony,
	[LAYOUT_TRACKER_SPACEMOUSE] = tracker_create_spacemouse,
};

int tracker_device_create(struct track_device **out, const struct layout *layout,
			  const struct layout_tracker *tracker, struct gr_diag *diag)
{
	int r = create[tracker->kind](out, layout, tracker, diag);

	if (r < 0 && r != GR_ERR_CONFIG) /* which is said already */
		gr_diag_add(diag, GR_DIAG_ERROR, layout->path, tracker->line, tracker->name,
			    "cannot be made ready: %s", gr_result_name(r));
	return r;
}

void tracker_list_names(char *text, size_t size, const char *const *names)
{
	size_t len = 0;

	for (int i = 0; names[i] && len < size; i++)
		len += (size_t)snprintf(text + len, size - len, "%s%s", i ? ", " : "", names[i]);
}

static int bind_one(struct track_binding *out, const struct layout *layout,
		    const struct layout_tracker *tracker, const struct layout_binding *from,
		    const struct track_device_ops *ops, struct gr_diag *diag)
{
	const struct track_names names = { ops->buttons, ops->axes };
	const struct track_place buttons = { layout->path, "buttons", from->line };
	const struct track_place axes = { layout->path, "axes", from->line };
	const int sensor =
		from->sensor[0] ? track_name_index(ops->sensors, from->sensor, strlen(from->sensor))
				: 0;
	char known[400] = "";
	int r;

	*out = (struct track_binding){
		.body = from->body == LAYOUT_HEAD ? TRACK_HEAD : TRACK_WAND,
		.sensor = (unsigned)sensor,
		.parts = (from->position ? TRACK_PART_POSITION : 0u) |
			 (from->orientation ? TRACK_PART_ORIENTATION : 0u) |
			 (from->input && from->body == LAYOUT_WAND ? TRACK_PART_INPUT : 0u),
		.T_room_base = tracker->room_base.pose,
		.scale = tracker->scale,
		.T_sensor_body = from->sensor_body.pose,
		.latency_ns = tracker->latency_ns,
	};
	if (sensor < 0) {
		tracker_list_names(known, sizeof known, ops->sensors);
		gr_diag_add(diag, GR_DIAG_ERROR, layout->path, from->line, "sensor",
			    "\"%s\" is no sensor of a %s; it has %s", from->sensor, ops->kind,
			    known);
		return GR_ERR_CONFIG;
	}
	r = track_bind_buttons(out, &names, from->buttons, &buttons, diag);
	if (track_bind_axes(out, &names, from->axes, &axes, diag) < 0)
		r = GR_ERR_CONFIG;
	return r;
}

int tracker_bindings(struct track_binding *out, const struct layout *layout,
		     const struct layout_tracker *tracker, const struct track_device_ops *ops,
		     struct gr_diag *diag)
{
	int result = GR_OK;

	for (size_t i = 0; i < tracker->binding_count; i++)
		if (bind_one(&out[i], layout, tracker, &tracker->bindings[i], ops, diag) < 0)
			result = GR_ERR_CONFIG;
	return result;
}

void tracker_devices_check(const struct layout *layout, struct gr_diag *diag)
{
	for (size_t i = 0; i < layout->tracker_count; i++) {
		const struct layout_tracker *tracker = &layout->trackers[i];
		struct track_binding bindings[LAYOUT_MAX_BINDINGS];
		struct track_device *device = NULL;

		if (layout_tracker_is_device(tracker) &&
		    tracker_device_create(&device, layout, tracker, diag) >= 0)
			(void)tracker_bindings(bindings, layout, tracker, device->ops, diag);
		track_device_destroy(&device);
	}
}
