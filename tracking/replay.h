/*
 * Replays a text log of tracker samples (docs/tracking.md gives the format):
 * one sample a line, "time_s body valid px py pz qx qy qz qw buttons", '#'
 * starts a comment. Times ascend per body and are relative to the first call
 * of poll.
 */
#ifndef GROTTO_TRACKING_REPLAY_H
#define GROTTO_TRACKING_REPLAY_H

#include "tracking/source.h"

#include <stdio.h>

#define TRACK_REPLAY_MAX_SAMPLES 1000000      /* eight minutes of two bodies at 1 kHz */
#define TRACK_REPLAY_MAX_BYTES (128l << 20)   /* of a file */
#define TRACK_REPLAY_MAX_S INT64_C(10000000)  /* the latest time of a sample */

/*
 * Reads the whole log. With `loop` it starts again one mean sample interval
 * after its last sample. GR_ERR_IO or GR_ERR_FORMAT with lines in diag,
 * GR_ERR_NOMEM.
 */
int track_replay_create(struct track_source **out, const char *path, bool loop,
			struct gr_diag *diag);
/*
 * The same from memory: the parser behind it, also the fuzzer's entry. `text`
 * needs no final NUL; `name` stands for the file in messages. *out_samples is
 * sorted by time and the caller's to free; untouched on error.
 */
int track_replay_parse(const char *text, size_t len, const char *name,
		       struct track_sample **out_samples, size_t *out_count, struct gr_diag *diag);
/*
 * Writes one line in the log's format; what it writes is read back bit by bit,
 * but the pose of a sample that is not valid, which is written as identity.
 * The time must not be negative. The caller looks at ferror().
 */
void track_replay_write(FILE *file, const struct track_sample *sample);

#endif
