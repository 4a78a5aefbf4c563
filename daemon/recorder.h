/*
 * What the master tells of itself to a record (record/writer.h): turns what
 * happens in the frame loop into entries. Nothing here waits, allocates or
 * makes a system call while frames run; without a recording each call costs a
 * look at a flag.
 *
 * Thread: the loop's.
 */
#ifndef GROTTO_DAEMON_RECORDER_H
#define GROTTO_DAEMON_RECORDER_H

#include "daemon/json.h"
#include "protocol/master.h"
#include "protocol/params.h"
#include "record/writer.h"
#include "tracking/source.h"

#define RECORDER_WHOLE_NS INT64_C(1000000000) /* a whole state at least so often */

struct recorder {
	struct record_writer *writer;
	char hint[512]; /* what the writer says when it may not write */
	bool need_whole;
	uint64_t last_hash; /* of the frame recorded last: what comes after another goes whole */
	bool running; /* when last looked at */
	int64_t whole_ns;
	uint64_t shown[FDP_MAX_NODES]; /* last frame that it was said of */
	enum record_writer_state told; /* last logged */
};

/* Starts the writer's thread, so after privileges are given up. GR_OK or a negative result. */
int recorder_create(struct recorder **out);
/* Ends a recording and waits until it is on the disk. *recorder may be NULL. */
void recorder_destroy(struct recorder **recorder);

/*
 * Begins soon; recorder_watch logs how that went. The path must be absolute.
 * GR_OK, or a negative result with what would be right in `why`.
 */
int recorder_start(struct recorder *recorder, const char *path, const struct record_session *session,
		   char *why, size_t size);
/*
 * Blocks, at start alone, until the recording runs or has failed. GR_OK, or
 * GR_ERR_IO with its line in the log.
 */
int recorder_await(struct recorder *recorder);
int recorder_stop(struct recorder *recorder, char *why, size_t size);
/* Members of an object: state, path, bytes, entries, lost, error. */
void recorder_write_json(struct recorder *recorder, struct json *json);
/* Logs what became of a recording since the last call. Once a second. */
void recorder_watch(struct recorder *recorder);

/* A frame has begun: `state` is its, hash chained to the one before. */
void recorder_frame(struct recorder *recorder, int64_t now_ns, const struct param_state *state,
		    const struct record_frame *frame);
void recorder_sample(struct recorder *recorder, int64_t now_ns, size_t tracker,
		     const struct track_sample *sample, bool taken);
void recorder_report(struct recorder *recorder, int64_t now_ns, unsigned node, unsigned kind,
		     const struct fdp_report *report);
/* at_ns: when the nodes show it; 0: at once. */
void recorder_swap(struct recorder *recorder, int64_t now_ns, uint64_t frame, int64_t at_ns);
/* What is known of a node's last swap; said once for each frame. */
void recorder_shown(struct recorder *recorder, int64_t now_ns, unsigned node,
		    const struct fdp_peer_status *peer);
/* FDP_MASTER_SWAP is none of these. */
void recorder_event(struct recorder *recorder, int64_t now_ns,
		    const struct fdp_master_event *event);
/* A setting was changed: the words of the request. */
void recorder_setting(struct recorder *recorder, int64_t now_ns, uint64_t frame,
		      char *const *words, int count);

#endif
