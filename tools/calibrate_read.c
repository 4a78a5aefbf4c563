#include "tools/calibrate.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/tracker_devices.h"
#include "tools/ask.h"
#include "tools/report.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATIENCE_NS (3 * GR_NS_PER_S)
#define BATCH 32

struct calibrate_reader {
	const struct calibrate *of;
	/* Its own device, */
	struct track_device *device;
	struct track_binding bindings[LAYOUT_MAX_BINDINGS];
	struct track_reader reader;
	/* or a master's. */
	const char *socket;
	int64_t reports;
	char state[TRACK_WHY + 32];
	char answer[ASK_ANSWER_MAX];
};

static int open_device(struct calibrate_reader *r, struct gr_diag *diag)
{
	const struct calibrate *c = r->of;
	int result = tracker_device_create(&r->device, c->layout, c->tracker, diag);

	if (result < 0)
		return result;
	result = tracker_bindings(r->bindings, c->layout, c->tracker, r->device->ops, diag);
	if (result < 0)
		return result;
	result = track_device_start(r->device);
	if (result < 0)
		gr_diag_add(diag, GR_DIAG_ERROR, c->layout->path, c->tracker->line, c->tracker->name,
			    "no thread: %s", strerror(errno));
	return result;
}

int calibrate_reader_open(struct calibrate_reader **out, const struct calibrate *c, const char *socket,
			  struct gr_diag *diag)
{
	struct calibrate_reader *r = calloc(1, sizeof *r);
	int result = r ? GR_OK : GR_ERR_NOMEM;

	*out = NULL;
	if (!r)
		return result;
	r->of = c;
	r->socket = socket;
	r->reports = -1;
	if (!socket)
		result = open_device(r, diag);
	if (result < 0)
		calibrate_reader_close(&r);
	*out = r;
	return result;
}

void calibrate_reader_close(struct calibrate_reader **reader)
{
	if (!*reader)
		return;
	track_device_destroy(&(*reader)->device);
	free(*reader);
	*reader = NULL;
}

int64_t calibrate_reader_pause_ns(const struct calibrate_reader *reader)
{
	return (reader->socket ? 20 : 5) * GR_NS_PER_MS;
}

/* ---- its own device ---- */

static int read_device(struct calibrate_reader *r, struct calibrate_report *out, int room)
{
	struct track_report reports[BATCH];
	int count = 0, n;

	do {
		n = track_device_take(r->device, &r->reader, reports, room - count < BATCH ? room - count : BATCH);
		for (int i = 0; i < n; i++) {
			const struct track_report *from = &reports[i];
			struct calibrate_report *to = &out[count];

			if (from->sensor != r->bindings[r->of->binding_index].sensor)
				continue;
			*to = (struct calibrate_report){
				.lost = (from->has & TRACK_LOST) != 0,
				.placed = (from->has & TRACK_POSITION) != 0,
				.turned = (from->has & TRACK_ORIENTATION) != 0,
				.buttons = from->has & TRACK_BUTTONS ? from->buttons : 0,
				.q = ROTATION_NONE,
			};
			for (int k = 0; k < 3; k++)
				to->p[k] = (double)from->T_base_sensor.p[k];
			if (to->turned)
				to->q = rotation_from(from->T_base_sensor.q);
			count++;
		}
	} while (n > 0 && count < room);
	return count;
}

/* ---- a master's ---- */

static bool take_numbers(struct json_object *from, const char *key, int count, double *out)
{
	struct json_object *list = report_member(from, key);

	if (!json_object_is_type(list, json_type_array) ||
	    json_object_array_length(list) != (size_t)count)
		return false;
	for (int i = 0; i < count; i++)
		out[i] = json_object_get_double(json_object_array_get_idx(list, (size_t)i));
	return true;
}

static void take_state(struct calibrate_reader *r, struct json_object *tracker)
{
	snprintf(r->state, sizeof r->state, "%s: %s", report_text(tracker, "state"),
		 report_text(tracker, "why"));
}

/* The sensor of the binding, as the master knows it: GR_OK, GR_NOTHING (nothing new), an error. */
static int take_sensor(struct calibrate_reader *r, struct json_object *root,
		       struct calibrate_report *out)
{
	const struct calibrate *c = r->of;
	struct json_object *tracker = report_named(root, "trackers", c->tracker->name);
	struct json_object *sensors = report_member(tracker, "sensors"), *sensor;
	double q[4];

	sensor = json_object_is_type(sensors, json_type_array) ?
			 json_object_array_get_idx(sensors, c->binding_index) :
			 NULL;
	if (!sensor || strcmp(report_text(sensor, "body"), calibrate_body(c)) != 0 ||
	    (c->binding->sensor[0] && strcmp(report_text(sensor, "sensor"), c->binding->sensor) != 0)) {
		fprintf(stderr, "grotto trackers: the master at %s has no tracker \"%s\" whose %s is on that sensor; "
				"does it run with this layout?\n",
			r->socket, c->tracker->name, calibrate_body(c));
		return GR_ERR_MISMATCH;
	}
	take_state(r, tracker);
	if (report_count(sensor, "reports") == r->reports)
		return GR_NOTHING;
	/* What it said before it was asked first may be old. */
	if (r->reports < 0) {
		r->reports = report_count(sensor, "reports");
		return GR_NOTHING;
	}
	r->reports = report_count(sensor, "reports");
	memset(out, 0, sizeof *out);
	out->lost = json_object_get_boolean(report_member(sensor, "lost"));
	out->placed = take_numbers(sensor, "position_m", 3, out->p);
	out->turned = take_numbers(sensor, "orientation", 4, q);
	out->buttons = (uint32_t)report_count(sensor, "buttons");
	out->q = out->turned ? rotation_from((float[]){ (float)q[0], (float)q[1], (float)q[2], (float)q[3] }) :
			       ROTATION_NONE;
	return GR_OK;
}

static int read_master(struct calibrate_reader *r, struct calibrate_report *out)
{
	struct json_object *root;
	int result = ask_master(r->socket, "trackers", PATIENCE_NS, r->answer, sizeof r->answer);

	if (result != GR_OK) {
		fprintf(stderr, "grotto trackers: %s: %s; --open opens the device itself\n", r->socket,
			result == GR_ERR_IO ? strerror(errno) : gr_result_name(result));
		return GR_ERR_IO;
	}
	root = json_tokener_parse(r->answer);
	result = take_sensor(r, root, out);
	json_object_put(root);
	return result < 0 ? result : result == GR_OK;
}

int calibrate_read(struct calibrate_reader *reader, struct calibrate_report *out, int room)
{
	return reader->socket ? read_master(reader, out) : read_device(reader, out, room);
}

void calibrate_reader_state(struct calibrate_reader *reader, char *text, size_t size)
{
	struct track_status status;

	if (reader->socket) {
		snprintf(text, size, "%s", reader->state);
		return;
	}
	track_device_status(reader->device, &status);
	snprintf(text, size, "%s: %s", track_state_name((enum track_state)status.state), status.why);
}
