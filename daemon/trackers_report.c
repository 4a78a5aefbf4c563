/* What a person is told of the trackers. */
#include "daemon/trackers.h"

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

static void write_tracker(struct json *json, const struct tracker *t, int64_t now_ns)
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
	json_close(json, '}');
}

void trackers_write_json(const struct trackers *trackers, struct json *json, const char *key,
			 int64_t now_ns)
{
	json_open(json, key, '[');
	for (size_t i = 0; i < trackers->count; i++)
		write_tracker(json, &trackers->all[i], now_ns);
	json_close(json, ']');
}
