#include "daemon/recorder.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "protocol/message.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define HINT_FOLDER "/var/lib/grotto"

_Static_assert(RECORD_AXES == TRACK_AXES, "a sample's axes must have room");

int recorder_create(struct recorder **out)
{
	/* Where the shipped unit lets it write, see systemd.exec(5). */
	const char *folder = getenv("STATE_DIRECTORY");
	struct record_writer_params params = RECORD_WRITER_DEFAULTS;
	struct recorder *r = calloc(1, sizeof *r);
	int result;

	*out = NULL;
	if (!r)
		return GR_ERR_NOMEM;
	snprintf(r->hint, sizeof r->hint, "the master's user must be able to write there%s%s",
		 folder ? ": this one may write below " : ", under the shipped unit only below ",
		 folder ? folder : HINT_FOLDER);
	params.hint = r->hint;
	result = record_writer_create(&r->writer, &params);
	if (result < 0) {
		free(r);
		return result;
	}
	*out = r;
	return GR_OK;
}

void recorder_destroy(struct recorder **recorder)
{
	struct recorder *r = *recorder;

	*recorder = NULL;
	if (!r)
		return;
	record_writer_destroy(&r->writer);
	free(r);
}

int recorder_start(struct recorder *r, const char *path, const struct record_session *session,
		   char *why, size_t size)
{
	int result;

	if (path[0] != '/') {
		snprintf(why, size, "record '%.80s': give an absolute path", path);
		return GR_ERR_RANGE;
	}
	result = record_writer_start(r->writer, path, session);
	if (result == GR_ERR_STATE)
		snprintf(why, size, "a recording is under way; stop it first");
	else if (result < 0)
		snprintf(why, size, "record '%.80s': the path is too long, or a name in the room is", path);
	else
		r->told = RECORD_WRITER_OPENING;
	return result;
}

int recorder_await(struct recorder *r)
{
	const struct timespec pause = { 0, 2 * GR_NS_PER_MS };
	struct record_writer_status status;

	for (;;) {
		record_writer_status(r->writer, &status);
		if (status.state != RECORD_WRITER_OPENING)
			break;
		nanosleep(&pause, NULL);
	}
	recorder_watch(r);
	return status.state == RECORD_WRITER_RUNNING ? GR_OK : GR_ERR_IO;
}

int recorder_stop(struct recorder *r, char *why, size_t size)
{
	const int result = record_writer_stop(r->writer, RECORD_END_ASKED);

	if (result < 0)
		snprintf(why, size, "no recording is under way");
	return result;
}

void recorder_write_json(struct recorder *r, struct json *json)
{
	struct record_writer_status status;

	record_writer_status(r->writer, &status);
	json_string(json, "state", record_writer_state_name(status.state));
	json_string(json, "path", status.path);
	json_u64(json, "bytes", status.bytes);
	json_u64(json, "entries", status.entries);
	json_u64(json, "lost", status.lost);
	json_string(json, "error", status.error);
}

void recorder_watch(struct recorder *r)
{
	struct record_writer_status status;

	if (r->told == RECORD_WRITER_IDLE)
		return;
	record_writer_status(r->writer, &status);
	if (status.state == r->told)
		return;
	if (status.state == RECORD_WRITER_RUNNING)
		gr_notice("recording into %s", status.path);
	else if (status.state == RECORD_WRITER_IDLE && status.error[0])
		gr_error("the recording failed: %s", status.error);
	else if (status.state == RECORD_WRITER_IDLE)
		gr_notice("the recording is over: %s, %" PRIu64 " entries, %" PRIu64 " bytes%s", status.path,
			  status.entries, status.bytes,
			  status.lost ? "; some entries are missing, the disk was too slow" : "");
	r->told = status.state;
}

/* Looks once where a call begins, so that a recording that starts meanwhile starts with the next. */
static bool runs(struct recorder *r)
{
	const bool now = r && record_writer_runs(r->writer);

	if (r && now != r->running) {
		r->running = now;
		r->need_whole = true;
	}
	return now;
}

void recorder_frame(struct recorder *r, int64_t now_ns, const struct param_state *state,
		    const struct record_frame *frame)
{
	uint8_t delta[RECORD_BODY_MAX - RECORD_FRAME_HEAD];
	struct record_entry entry = { .kind = RECORD_DELTA, .time_ns = now_ns, .frame = *frame };
	long len;

	if (!runs(r))
		return;
	if (r->need_whole || frame->previous_frame == 0 || frame->previous_hash != r->last_hash ||
	    now_ns - r->whole_ns >= RECORDER_WHOLE_NS)
		entry.kind = RECORD_STATE;
	len = param_delta_encode(state, entry.kind == RECORD_STATE ? 0 : frame->previous_frame, delta,
				 sizeof delta);
	entry.frame.delta = delta;
	entry.frame.delta_len = len > 0 ? (size_t)len : 0;
	r->last_hash = frame->hash;
	r->need_whole = len < 0 || !record_writer_put(r->writer, &entry);
	if (!r->need_whole && entry.kind == RECORD_STATE)
		r->whole_ns = now_ns;
}

void recorder_sample(struct recorder *r, int64_t now_ns, size_t tracker,
		     const struct track_sample *sample, bool taken)
{
	struct record_entry entry = { .kind = RECORD_SAMPLE, .time_ns = now_ns };

	if ((unsigned)sample->body >= TRACK_BODIES || !runs(r))
		return;
	entry.sample = (struct record_sample){
		.tracker = (uint8_t)tracker,
		.body = (uint8_t)sample->body,
		.flags = (uint8_t)((sample->valid ? RECORD_VALID : 0) | (taken ? RECORD_TAKEN : 0) |
				   (sample->device_timed ? RECORD_TIMED : 0)),
		.axis_count = (uint8_t)sample->axis_count,
		.device_ns = sample->device_ns,
		.time_ns = sample->time_ns,
		.T_room_body = sample->T_room_body,
		.buttons = sample->buttons,
	};
	memcpy(entry.sample.axes, sample->axes, sizeof entry.sample.axes);
	record_writer_put(r->writer, &entry);
}

void recorder_report(struct recorder *r, int64_t now_ns, unsigned node, unsigned kind,
		     const struct fdp_report *report)
{
	struct record_entry entry = { .kind = RECORD_REPORT, .time_ns = now_ns };

	if (!runs(r))
		return;
	entry.report = (struct record_report){
		.node = (uint8_t)node, .kind = (uint8_t)kind,
		.frame = report->frame, .hash = report->hash,
		.swapped_frame = report->swapped_frame, .swapped_count = report->swapped_count,
		.swap_ns = report->swap_ns, .render_us = report->render_us, .slice = report->slice,
	};
	record_writer_put(r->writer, &entry);
}

void recorder_swap(struct recorder *r, int64_t now_ns, uint64_t frame, int64_t at_ns)
{
	const struct record_entry entry = { .kind = RECORD_SWAP, .time_ns = now_ns,
					    .swap = { frame, at_ns } };

	if (runs(r))
		record_writer_put(r->writer, &entry);
}

void recorder_shown(struct recorder *r, int64_t now_ns, unsigned node,
		    const struct fdp_peer_status *peer)
{
	struct record_entry entry = { .kind = RECORD_SHOWN, .time_ns = now_ns };

	if (peer->swapped_frame == 0 || !runs(r) || r->shown[node] == peer->swapped_frame)
		return;
	r->shown[node] = peer->swapped_frame;
	entry.shown = (struct record_shown){
		.node = (uint8_t)node, .frame = peer->swapped_frame,
		.node_ns = peer->swap_local_ns, .master_ns = peer->swap_ns,
	};
	record_writer_put(r->writer, &entry);
}

static uint8_t event_kind(enum fdp_master_event_kind kind)
{
	switch (kind) {
	case FDP_MASTER_JOINED: return RECORD_JOINED;
	case FDP_MASTER_LEFT: return RECORD_LEFT;
	case FDP_MASTER_REFUSED: return RECORD_REFUSED;
	case FDP_MASTER_LATE: return RECORD_LATE;
	case FDP_MASTER_EVICTED: return RECORD_EVICTED;
	case FDP_MASTER_MISMATCH: return RECORD_MISMATCH;
	default: return 0;
	}
}

void recorder_event(struct recorder *r, int64_t now_ns, const struct fdp_master_event *event)
{
	struct record_entry entry = { .kind = RECORD_EVENT, .time_ns = now_ns };

	if (!event_kind(event->kind) || !runs(r))
		return;
	entry.event.kind = event_kind(event->kind);
	entry.event.node = event->node < 0 ? RECORD_ALL_NODES : (uint8_t)event->node;
	entry.event.frame = event->frame;
	entry.event.ours = event->ours;
	entry.event.theirs = event->theirs;
	if (event->reason)
		snprintf(entry.event.text, sizeof entry.event.text, "%s", event->reason);
	record_writer_put(r->writer, &entry);
}

void recorder_setting(struct recorder *r, int64_t now_ns, uint64_t frame, char *const *words,
		      int count)
{
	struct record_entry entry = { .kind = RECORD_EVENT, .time_ns = now_ns };
	size_t len = 0, size = sizeof entry.event.text;

	if (!runs(r))
		return;
	entry.event.kind = RECORD_SETTING;
	entry.event.node = RECORD_ALL_NODES;
	entry.event.frame = frame;
	for (int i = 0; i < count && len < size; i++)
		len += (size_t)snprintf(entry.event.text + len, size - len, "%s%s", i ? " " : "", words[i]);
	record_writer_put(r->writer, &entry);
}
