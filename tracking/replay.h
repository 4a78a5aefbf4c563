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

int track_replay_create(struct track_source **out, const char *path, bool loop,
			struct gr_diag *diag);
/* The same from memory: the parser behind it, also the fuzzer's entry. */
int track_replay_parse(const char *text, size_t len, const char *name,
		       struct track_sample **out_samples, size_t *out_count, struct gr_diag *diag);
/* Writes one line in the log's format. */
void track_replay_write(FILE *file, const struct track_sample *sample);

#endif
