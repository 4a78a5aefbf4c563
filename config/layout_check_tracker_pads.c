/* Trackers that are gamepads or SpaceMouse: keys that another kind's device has. */
#include "config/layout_check.h"

static void for_others(struct options_reader *reader, const struct layout_file_pad *pad,
		       const char *key, bool there, const char *of)
{
	if (there)
		options_fault(reader, GR_DIAG_WARNING, pad->at, key, "not used: only %s", of);
}

static void check_pad(struct options_reader *reader, const struct layout_file_tracker *entry)
{
	const struct layout_file_pad *file = &entry->pad;
	const bool gamepad = entry->tracker.kind == LAYOUT_TRACKER_GAMEPAD;

	if (file->pad.product && !file->pad.vendor)
		options_fault(reader, GR_DIAG_ERROR, file->at, "product",
			      "of which vendor is not said; give vendor, too");
	for_others(reader, file, "recentre", gamepad && file->pad.recentre[0],
		   "kind = \"dualshock4\" and \"dualsense\" know how they are turned");
	for_others(reader, file, "vendor", !gamepad && file->pad.vendor,
		   "kind = \"gamepad\" is chosen by vendor");
	for_others(reader, file, "product", !gamepad && file->pad.product,
		   "kind = \"gamepad\" is chosen by product");
	for_others(reader, file, "triggers", !gamepad && file->pad.triggers,
		   "of kind = \"gamepad\" it is not known which axes are triggers");
}

void layout_check_tracker_pads(struct options_reader *reader, const struct layout_file *file,
			       size_t i)
{
	const struct layout_file_tracker *entry = &file->trackers[i];
	const bool pad = layout_tracker_is_pad(&entry->tracker);

	if (pad)
		check_pad(reader, entry);
	else if (entry->pad.at)
		options_fault(reader, GR_DIAG_WARNING, entry->at, "pad",
			      "not used: only kind = \"gamepad\", \"dualshock4\" and \"dualsense\" "
			      "are pads");
	if (entry->tracker.kind != LAYOUT_TRACKER_SPACEMOUSE && entry->spacemouse.at)
		options_fault(reader, GR_DIAG_WARNING, entry->at, "spacemouse",
			      "not used: only kind = \"spacemouse\" is one");
}
