/* A layout's gamepads and SpaceMouse as drivers: buttons and axes that it names are looked up. */
#include "daemon/tracker_devices_private.h"

#include "base/clock.h"
#include "base/result.h"
#include "tracking/gamepad.h"
#include "tracking/sony.h"
#include "tracking/spacemouse.h"

#include <string.h>

struct names {
	const struct layout *layout;
	const struct layout_tracker *tracker;
	const char *key, *what; /* "pad.triggers", "axis" */
	const char *const *known;
	struct gr_diag *diag;
};

/* The names of a text, apart by blanks, as bits. text may be NULL. */
static int name_bits(const struct names *n, const char *text, uint32_t *out)
{
	char known[300] = "";

	*out = 0;
	for (size_t len = 0; text && *text; text += len) {
		int index;

		text += strspn(text, " \t");
		len = strcspn(text, " \t");
		if (!len)
			break;
		index = track_name_index(n->known, text, len);
		if (index < 0) {
			tracker_list_names(known, sizeof known, n->known);
			gr_diag_add(n->diag, GR_DIAG_ERROR, n->layout->path, n->tracker->line,
				    n->key, "\"%.*s\" is no %s of it; it has %s",
				    len < 40 ? (int)len : 40, text, n->what, known);
			return GR_ERR_CONFIG;
		}
		*out |= UINT32_C(1) << index;
	}
	return GR_OK;
}

int tracker_create_gamepad(struct track_device **out, const struct layout *layout,
			   const struct layout_tracker *tracker, struct gr_diag *diag)
{
	const struct names axes = { layout, tracker, "pad.triggers", "axis", track_gamepad_axes,
				    diag };
	uint32_t triggers;
	const int r = name_bits(&axes, tracker->pad.triggers, &triggers);
	const struct track_gamepad_params params = {
		.vendor = (uint16_t)tracker->pad.vendor,
		.product = (uint16_t)tracker->pad.product,
		.serial = tracker->serial,
		.path = tracker->pad.path,
		.number = tracker->number,
		.triggers = (uint8_t)triggers,
		.dead_zone = tracker->pad.dead_zone,
	};

	return r < 0 ? r : track_gamepad_create(out, &params, &gr_clock_monotonic);
}

int tracker_create_sony(struct track_device **out, const struct layout *layout,
			const struct layout_tracker *tracker, struct gr_diag *diag)
{
	const struct names buttons = {
		layout, tracker, "pad.recentre", "button", track_sony_buttons, diag
	};
	uint32_t recentre;
	const int r = name_bits(&buttons, tracker->pad.recentre, &recentre);
	const struct track_sony_params params = {
		.model = tracker->kind == LAYOUT_TRACKER_DUALSENSE ? TRACK_SONY_DUALSENSE
								   : TRACK_SONY_DUALSHOCK4,
		.serial = tracker->serial,
		.path = tracker->pad.path,
		.number = tracker->number,
		.recentre = recentre,
		.dead_zone = tracker->pad.dead_zone,
	};

	return r < 0 ? r : track_sony_create(out, &params, &gr_clock_monotonic);
}

int tracker_create_spacemouse(struct track_device **out, const struct layout *layout,
			      const struct layout_tracker *tracker, struct gr_diag *diag)
{
	const struct names buttons = {
		layout, tracker, "spacemouse.home", "button", track_spacemouse_buttons, diag
	};
	uint32_t home;
	const int r = name_bits(&buttons, tracker->spacemouse.home, &home);
	const struct track_spacemouse_params params = {
		.serial = tracker->serial,
		.path = tracker->spacemouse.path,
		.number = tracker->number,
		.motion = { .speed_m_s = tracker->spacemouse.speed_m_s,
			    .turn_rad_s = tracker->spacemouse.turn_rad_s,
			    .reach_m = tracker->spacemouse.reach_m,
			    .home = home },
	};

	return r < 0 ? r : track_spacemouse_create(out, &params, &gr_clock_monotonic);
}
