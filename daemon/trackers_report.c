/* What a person is told of the trackers. */
#include "daemon/trackers.h"

#include "base/result.h"
#include "daemon/json.h"

static void write_faults(struct json *json, const struct track_counters *counters)
{
	json_open(json, "faults", '{');
	for (int fault = TRACK_FAULT_NONE + 1; fault < TRACK_FAULTS; fault++)
		if (counters->faults[fault])
			json_u64(json, track_fault_name((enum track_fault)fault),
				 counters->faults[fault]);
	json_close(json, '}');
}

static void write_device(struct json *json, const struct tracker *t, int64_t now_ns)
{
	struct track_counters counters;
	struct track_status status;

	track_device_status(t->device, &status);
	track_device_counters(t->device, &counters);
	json_string(json, "kind", t->device->ops->kind);
	json_string(json, "state", track_state_name((enum track_state)status.state));
	if (status.since_ns)
		json_f64(json, "since_s", (double)(now_ns - status.since_ns) * 1e-9);
	json_string(json, "why", status.why);
	json_u64(json, "opened", counters.opened);
	json_u64(json, "reports", counters.reports);
	json_u64(json, "missed", counters.missed);
	json_u64(json, "unread", t->reader.missed);
	json_u64(json, "clock_steps", counters.steps);
	write_faults(json, &counters);
}

static void write_numbers(struct json *json, const char *key, const float *values, size_t count)
{
	json_open(json, key, '[');
	for (size_t i = 0; i < count; i++)
		json_f64(json, NULL, (double)values[i]);
	json_close(json, ']');
}

static void write_poses(struct json *json, const struct tracker *t, int64_t now_ns)
{
	json_open(json, "poses", '[');
	for (int body = 0; body < TRACK_BODIES; body++) {
		const struct tracker_body *b = &t->bodies[body];

		if (!b->said)
			continue;
		json_open(json, NULL, '{');
		json_string(json, "body", track_body_name((enum track_body)body));
		json_bool(json, "tracked", b->last.valid);
		json_f64(json, "age_ms", (double)(now_ns - b->arrived_ns) * 1e-6);
		write_numbers(json, "position_m", b->last.T_room_body.p, 3);
		write_numbers(json, "orientation", b->last.T_room_body.q, 4);
		json_u64(json, "buttons", b->last.buttons);
		write_numbers(json, "axes", b->last.axes, b->last.axis_count);
		json_close(json, '}');
	}
	json_close(json, ']');
}

/* As a calibration needs them: not where the layout takes them to be. */
static void write_sensors(struct json *json, const struct tracker *t, int64_t now_ns)
{
	json_open(json, "sensors", '[');
	for (size_t k = 0; k < t->of->binding_count; k++) {
		const struct tracker_sensor *s = &t->sensors[k];
		const struct track_report *r = &s->last;

		json_open(json, NULL, '{');
		json_string(json, "body", track_body_name(t->bindings[k].body));
		json_string(json, "sensor", t->device->ops->sensors[t->bindings[k].sensor]);
		json_u64(json, "reports", s->reports);
		if (s->reports) {
			json_f64(json, "age_ms", (double)(now_ns - r->arrived_ns) * 1e-6);
			json_bool(json, "lost", (r->has & TRACK_LOST) != 0);
		}
		if (r->has & TRACK_POSITION)
			write_numbers(json, "position_m", r->T_base_sensor.p, 3);
		if (r->has & TRACK_ORIENTATION)
			write_numbers(json, "orientation", r->T_base_sensor.q, 4);
		if (r->has & TRACK_BUTTONS)
			json_u64(json, "buttons", r->buttons);
		json_close(json, '}');
	}
	json_close(json, ']');
}

static void write_tracker(struct json *json, const struct tracker *t, int64_t now_ns, bool poses)
{
	json_open(json, NULL, '{');
	json_string(json, "name", t->of->name);
	if (t->device) {
		write_device(json, t, now_ns);
	} else {
		json_string(json, "kind", t->source->ops->kind);
		json_string(json, "state", track_state_name(TRACK_RUNNING));
		json_u64(json, "reports", t->stats.heard);
	}
	json_f64(json, "rate_hz", t->stats.rate_hz);
	json_f64(json, "jitter_ms", t->stats.jitter_ms);
	if (t->stats.heard)
		json_f64(json, "age_ms", (double)(now_ns - t->stats.heard_ns) * 1e-6);
	json_u64(json, "dropouts", t->stats.dropouts);
	if (t->stats.battery >= 0)
		json_f64(json, "battery", (double)t->stats.battery);
	json_open(json, "tracked", '[');
	for (int body = 0; body < TRACK_BODIES; body++)
		if (t->stats.tracked[body])
			json_string(json, NULL, track_body_name((enum track_body)body));
	json_close(json, ']');
	if (poses)
		write_poses(json, t, now_ns);
	if (poses && t->device)
		write_sensors(json, t, now_ns);
	json_close(json, '}');
}

void trackers_write_json(const struct trackers *trackers, struct json *json, const char *key,
			 int64_t now_ns, bool poses)
{
	json_open(json, key, '[');
	for (size_t i = 0; i < trackers->count; i++)
		write_tracker(json, &trackers->all[i], now_ns, poses);
	json_close(json, ']');
	json_open(json, "filters", '[');
	for (int body = 0; body < TRACK_BODIES; body++) {
		const struct track_filter *f = &trackers->history.filters[body];

		json_open(json, NULL, '{');
		json_string(json, "body", track_body_name((enum track_body)body));
		json_string(json, "kind", track_filter_name(f->params.kind));
		json_u64(json, "gated", f->gated);
		json_u64(json, "restarts", f->restarts);
		json_close(json, '}');
	}
	json_close(json, ']');
}

int trackers_answer(const struct trackers *trackers, int64_t now_ns, char *text, size_t size,
		    size_t *out_len)
{
	struct json json = json_start(text, size);

	json_open(&json, NULL, '{');
	json_bool(&json, "ok", true);
	trackers_write_json(trackers, &json, "trackers", now_ns, true);
	json_close(&json, '}');
	*out_len = json.len;
	return json.ok ? GR_OK : GR_ERR_RANGE;
}
