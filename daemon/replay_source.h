/*
 * Frames of a recording (record/player.h): each with the state and the number
 * that it had, at the distances in time at which they were begun.
 */
#ifndef GROTTO_DAEMON_REPLAY_SOURCE_H
#define GROTTO_DAEMON_REPLAY_SOURCE_H

#include "base/diag.h"
#include "daemon/frame_source.h"
#include "daemon/json.h"
#include "daemon/replay_check.h"
#include "record/player.h"

#define REPLAY_PAUSE_NS (2 * INT64_C(1000000000)) /* longer ones of the record are cut to this */

struct replay_params {
	const char *path;
	int recording;   /* of the file, from 1 */
	int64_t from_ns; /* after its start */
	double speed;    /* 2: twice as fast */
	bool as_fast;    /* as the barrier allows, whatever the speed */
	bool step;       /* each frame is asked for by replay_source_step */
	uint64_t frames; /* at most so many; 0: all */
};

/* What the record must be of. */
struct replay_room {
	const uint8_t *layout_hash; /* NULL: of any layout */
	const uint8_t *scene_hash;
};

struct replay_source;
/* Reads up to its first frame. Faults go to diag. */
int replay_source_create(struct replay_source **out, const struct replay_params *params,
			 const struct replay_room *room, struct gr_diag *diag);
/* *source may be NULL. */
void replay_source_destroy(struct replay_source **source);
struct frame_source *replay_source_frames(struct replay_source *source);
/* So many frames more may begin. GR_ERR_STATE when it does not go by steps. */
int replay_source_step(struct replay_source *source, uint64_t frames);

/* No more answers come: logs how it went. True when it passed. */
bool replay_source_end(struct replay_source *source);
/* Members of an object. */
void replay_source_write_json(const struct replay_source *source, struct json *json,
			      const char *(*node_name)(const void *ctx, int node), const void *ctx);

#endif
