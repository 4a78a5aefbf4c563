/* Trackers against each other: every part of head and wand comes from one of them at most. */
#include "config/layout_check.h"

#include <string.h>

enum part { POSITION = 1, ORIENTATION = 2, INPUT = 4, ALL = POSITION | ORIENTATION | INPUT };

static const char *const body_name[] = { "head", "wand" };

static const char *part_name(unsigned parts)
{
	return parts & POSITION ? "position" : parts & ORIENTATION ? "orientation" : "input";
}

static unsigned binding_parts(const struct layout_file_binding *entry, enum layout_body body)
{
	const struct layout_binding *b = &entry->binding;
	const unsigned parts = (b->position ? POSITION : 0u) | (b->orientation ? ORIENTATION : 0u) |
			       (b->input && body == LAYOUT_WAND ? INPUT : 0u);

	return entry->at && b->body == body ? parts : 0;
}

/* What a tracker gives of a body; of a device, its first `bindings`. */
static unsigned tracker_parts(const struct layout_file_tracker *entry, enum layout_body body,
			      size_t bindings)
{
	unsigned parts = 0;

	if (!entry->at || (int)entry->tracker.kind == OPTION_ABSENT)
		return 0;
	if (entry->tracker.kind == LAYOUT_TRACKER_WINDOW && body == LAYOUT_HEAD)
		return 0;
	if (!layout_tracker_is_device(&entry->tracker))
		return (body == LAYOUT_HEAD ? entry->tracker.head : entry->tracker.wand) ? ALL : 0;
	for (size_t i = 0; i < bindings; i++)
		parts |= binding_parts(&entry->bindings[i], body);
	return parts;
}

static void check_names(struct options_reader *reader, const struct layout_file *file, size_t i)
{
	const struct layout_file_tracker *entry = &file->trackers[i];

	for (size_t j = 0; j < i; j++)
		if (file->trackers[j].at && entry->tracker.name[0] &&
		    !strcmp(entry->tracker.name, file->trackers[j].tracker.name))
			options_fault(reader, GR_DIAG_ERROR, entry->at, "name",
				      "tracker \"%s\" is there twice; each needs a name of its own",
				      entry->tracker.name);
}

/* Simulated or replayed: head and wand as a whole. */
static void check_whole(struct options_reader *reader, const struct layout_file *file, size_t i)
{
	const struct layout_file_tracker *entry = &file->trackers[i];

	for (size_t j = 0; j < i; j++)
		for (int body = LAYOUT_HEAD; body <= LAYOUT_WAND; body++) {
			const struct layout_file_tracker *other = &file->trackers[j];

			if (tracker_parts(entry, (enum layout_body)body, 0) &
			    tracker_parts(other, (enum layout_body)body, other->binding_count))
				options_fault(reader, GR_DIAG_ERROR, entry->at, body_name[body],
					      "tracker \"%s\" tracks the %s already; say %s = "
					      "false in one",
					      other->tracker.name, body_name[body],
					      body_name[body]);
		}
	if (!tracker_parts(entry, LAYOUT_HEAD, 0) && !tracker_parts(entry, LAYOUT_WAND, 0))
		options_fault(reader, GR_DIAG_ERROR, entry->at, NULL,
			      "tracks neither head nor wand; leave it out or set one of them");
}

static void check_binding(struct options_reader *reader, const struct layout_file *file, size_t i,
			  size_t k)
{
	const struct layout_file_tracker *entry = &file->trackers[i];
	const struct layout_file_binding *bind = &entry->bindings[k];
	const enum layout_body body = bind->binding.body;
	unsigned parts;

	if (!bind->at || (int)body == OPTION_ABSENT) /* reported already */
		return;
	parts = binding_parts(bind, body);
	if (!parts)
		options_fault(
			reader, GR_DIAG_ERROR, bind->at, NULL,
			"gives nothing of the %s; leave it out or set position, orientation%s",
			body_name[body], body == LAYOUT_WAND ? " or input" : "");
	for (size_t j = 0; j <= i; j++) {
		const struct layout_file_tracker *other = &file->trackers[j];
		const unsigned both =
			parts & tracker_parts(other, body, j < i ? other->binding_count : k);

		if (both)
			options_fault(
				reader, GR_DIAG_ERROR, bind->at, part_name(both),
				"tracker \"%s\" gives the %s's %s already; say %s = false in one",
				other->tracker.name, body_name[body], part_name(both),
				part_name(both));
	}
	if (body == LAYOUT_HEAD && (bind->binding.buttons || bind->binding.axes))
		options_fault(reader, GR_DIAG_ERROR, bind->at,
			      bind->binding.buttons ? "buttons" : "axes",
			      "a head has none; give them to the wand");
}

static void not_used(struct options_reader *reader, const struct layout_file_tracker *entry,
		     const char *key, bool there, const char *of)
{
	if (there)
		options_fault(reader, GR_DIAG_WARNING, entry->at, key, "not used: only %s", of);
}

static void check_polhemus(struct options_reader *reader, const struct layout_file_tracker *entry)
{
	static const int rates_hz[] = { 30, 60, 120, 240, 480, 960 };
	const struct layout_polhemus *p = &entry->polhemus.polhemus;
	bool known = entry->tracker.kind != LAYOUT_TRACKER_VIPER;

	for (size_t i = 0; i < sizeof rates_hz / sizeof *rates_hz; i++)
		known = known || p->rate_hz == rates_hz[i];
	if (!known)
		options_fault(reader, GR_DIAG_ERROR, entry->polhemus.at, "rate_hz",
			      "a VIPER has no %d Hz; it has 30, 60, 120, 240, 480 and 960",
			      p->rate_hz);
	if (p->follow && p->hemisphere[0] == 0 && p->hemisphere[1] == 0 && p->hemisphere[2] == 0)
		options_fault(reader, GR_DIAG_ERROR, entry->polhemus.at, "follow",
			      "from where is not known; say in which half of space the sensors "
			      "begin: hemisphere = [x, y, z]");
}

static void check_device(struct options_reader *reader, const struct layout_file *file, size_t i)
{
	const struct layout_file_tracker *entry = &file->trackers[i];

	if (!entry->binding_count)
		options_fault(
			reader, GR_DIAG_ERROR, entry->at, "bind",
			"missing; say what its sensors are on: bind = ( { body = \"head\"; } )");
	for (size_t k = 0; k < entry->binding_count; k++)
		check_binding(reader, file, i, k);
	if (layout_tracker_is_polhemus(&entry->tracker))
		check_polhemus(reader, entry);
	not_used(reader, entry, "head", !entry->tracker.head,
		 "sim and replay track bodies as a whole; bind says what a device tracks");
	not_used(reader, entry, "wand", !entry->tracker.wand,
		 "sim and replay track bodies as a whole; bind says what a device tracks");
}

static void check_tracker(struct options_reader *reader, const struct layout_file *file, size_t i)
{
	const struct layout_file_tracker *entry = &file->trackers[i];
	const struct layout_tracker *tracker = &entry->tracker;

	if (!entry->at)
		return;
	check_names(reader, file, i);
	if ((int)tracker->kind == OPTION_ABSENT) /* reported already */
		return;
	if (tracker->kind == LAYOUT_TRACKER_REPLAY && !options_given(entry->at, "file"))
		options_fault(reader, GR_DIAG_ERROR, entry->at, "file",
			      "missing; a replay needs the log that it replays");
	not_used(reader, entry, "file", tracker->kind != LAYOUT_TRACKER_REPLAY && tracker->file,
		 "kind = \"replay\" reads a log");
	not_used(reader, entry, "sim", tracker->kind != LAYOUT_TRACKER_SIM && entry->sim.at,
		 "kind = \"sim\" is simulated");
	not_used(reader, entry, "polhemus",
		 !layout_tracker_is_polhemus(tracker) && entry->polhemus.at,
		 "kind = \"viper\", \"liberty\" and \"patriot\" are Polhemus'");
	not_used(reader, entry, "dtrack", tracker->kind != LAYOUT_TRACKER_DTRACK && entry->dtrack.at,
		 "kind = \"dtrack\" has a controller");
	not_used(reader, entry, "vrpn", tracker->kind != LAYOUT_TRACKER_VRPN && entry->vrpn.at,
		 "kind = \"vrpn\" has a server");
	layout_check_tracker_pads(reader, file, i);
	if (layout_tracker_is_device(tracker)) {
		check_device(reader, file, i);
		layout_check_tracker_network(reader, file, i);
		return;
	}
	check_whole(reader, file, i);
	not_used(reader, entry, "base", entry->base.at, "a device has a frame of its own");
	not_used(reader, entry, "bind", entry->binding_count > 0, "a device has sensors");
	not_used(reader, entry, "serial", tracker->serial, "a device has one");
	not_used(reader, entry, "number", tracker->number != 0, "of devices there can be several");
	not_used(reader, entry, "latency_ms", tracker->latency_ns != 0,
		 "a device has it; of the simulated visitor it is in sim");
}

void layout_check_trackers(struct options_reader *reader, const struct layout_file *file)
{
	for (size_t i = 0; i < file->tracker_count; i++)
		check_tracker(reader, file, i);
}
