/* A tracker of the file's form as one of the layout, and back. */
#include "config/layout_options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool layout_tracker_is_polhemus(const struct layout_tracker *tracker)
{
	return tracker->kind >= LAYOUT_TRACKER_VIPER && tracker->kind <= LAYOUT_TRACKER_PATRIOT;
}

bool layout_tracker_is_pad(const struct layout_tracker *tracker)
{
	return tracker->kind >= LAYOUT_TRACKER_GAMEPAD && tracker->kind <= LAYOUT_TRACKER_DUALSENSE;
}

bool layout_tracker_is_device(const struct layout_tracker *tracker)
{
	return tracker->kind > LAYOUT_TRACKER_WINDOW;
}

void layout_pose_from_angles(const vec3 position, const vec3 angles, struct gr_pose *out)
{
	struct gr_pose pitch = GR_POSE_IDENTITY, roll = GR_POSE_IDENTITY;

	gr_pose_heading(position, angles[0], out);
	pitch.q[0] = sinf(angles[1] * 0.5f);
	pitch.q[3] = cosf(angles[1] * 0.5f);
	roll.q[2] = sinf(angles[2] * 0.5f);
	roll.q[3] = cosf(angles[2] * 0.5f);
	gr_pose_mul(out, &pitch, out);
	gr_pose_mul(out, &roll, out);
}

/* Moves an owned string out of the file's form. */
static char *take(char **from)
{
	char *text = *from;

	*from = NULL;
	return text;
}

static void make_pose(struct layout_frame *frame)
{
	layout_pose_from_angles(frame->position, frame->angles, &frame->pose);
}

static void build_binding(struct layout_binding *to, struct layout_file_binding *from)
{
	*to = from->binding;
	to->buttons = take(&from->binding.buttons);
	to->axes = take(&from->binding.axes);
	to->line = (int)config_setting_source_line(from->at);
	make_pose(&to->sensor_body);
}

static void build_network(struct layout_tracker *out, struct layout_file_tracker *from)
{
	out->dtrack = from->dtrack.dtrack;
	out->dtrack.address = take(&from->dtrack.dtrack.address);
	out->dtrack.group = take(&from->dtrack.dtrack.group);
	out->dtrack.interface = take(&from->dtrack.dtrack.interface);
	out->vrpn = from->vrpn.vrpn;
	out->vrpn.device = take(&from->vrpn.vrpn.device);
	out->vrpn.address = take(&from->vrpn.vrpn.address);
}

static void build_pads(struct layout_tracker *out, struct layout_file_tracker *from)
{
	out->pad = from->pad.pad;
	out->pad.path = take(&from->pad.pad.path);
	out->pad.triggers = take(&from->pad.pad.triggers);
	out->spacemouse = from->spacemouse.spacemouse;
	out->spacemouse.path = take(&from->spacemouse.spacemouse.path);
}

void layout_tracker_build(struct layout_tracker *out, struct layout_file_tracker *from)
{
	*out = from->tracker;
	out->file = take(&from->tracker.file);
	out->serial = take(&from->tracker.serial);
	out->sim = from->sim.sim;
	build_network(out, from);
	build_pads(out, from);
	out->filter = from->filter.filter;
	out->room_base = from->base.room_base;
	out->scale = from->base.scale;
	out->polhemus = from->polhemus.polhemus;
	out->polhemus.path = take(&from->polhemus.polhemus.path);
	make_pose(&out->room_base);
	out->line = (int)config_setting_source_line(from->at);
	out->binding_count = from->binding_count;
	for (size_t i = 0; i < from->binding_count; i++)
		build_binding(&out->bindings[i], &from->bindings[i]);
	if (out->kind == LAYOUT_TRACKER_WINDOW)
		out->head = false;
	if (!layout_tracker_is_device(out))
		return;
	out->head = out->wand = false;
	for (size_t i = 0; i < out->binding_count; i++)
		*(out->bindings[i].body == LAYOUT_HEAD ? &out->head : &out->wand) = true;
}

void layout_tracker_free(struct layout_tracker *tracker)
{
	free(tracker->file);
	free(tracker->serial);
	free(tracker->polhemus.path);
	free(tracker->dtrack.address);
	free(tracker->dtrack.group);
	free(tracker->dtrack.interface);
	free(tracker->vrpn.device);
	free(tracker->vrpn.address);
	free(tracker->pad.path);
	free(tracker->pad.triggers);
	free(tracker->spacemouse.path);
	for (size_t i = 0; i < tracker->binding_count; i++) {
		free(tracker->bindings[i].buttons);
		free(tracker->bindings[i].axes);
	}
}

void layout_tracker_fill(struct layout_file_tracker *out, const struct layout_tracker *from,
			 struct layout_file_binding bindings[LAYOUT_MAX_BINDINGS])
{
	out->tracker = *from;
	out->sim.sim = from->sim;
	out->filter.filter = from->filter;
	/* A group whose first value is absent is not written. */
	if (from->kind != LAYOUT_TRACKER_SIM)
		out->sim.sim.rate_hz = NAN;
	out->dtrack.dtrack = from->dtrack;
	if (from->kind != LAYOUT_TRACKER_DTRACK)
		out->dtrack.dtrack.up = (enum layout_up)OPTION_ABSENT;
	out->vrpn.vrpn = from->vrpn;
	if (from->kind != LAYOUT_TRACKER_VRPN)
		out->vrpn.vrpn.device = NULL;
	out->base.room_base = from->room_base;
	out->base.scale = from->scale;
	if (!layout_tracker_is_device(from))
		out->base.room_base.position[0] = NAN;
	else /* what `bind` says; the keys are not a device's */
		out->tracker.head = out->tracker.wand = true;
	out->polhemus.polhemus = from->polhemus;
	if (!layout_tracker_is_polhemus(from))
		out->polhemus.polhemus.hemisphere[0] = NAN;
	out->pad.pad = from->pad;
	if (!layout_tracker_is_pad(from))
		out->pad.pad.dead_zone = NAN;
	out->spacemouse.spacemouse = from->spacemouse;
	if (from->kind != LAYOUT_TRACKER_SPACEMOUSE)
		out->spacemouse.spacemouse.speed_m_s = NAN;
	out->bindings = bindings;
	out->binding_count = from->binding_count;
	for (size_t i = 0; i < from->binding_count; i++)
		bindings[i].binding = from->bindings[i];
}
