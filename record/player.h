/*
 * The frames of one recording in their order, each with its whole state. What
 * is damaged is stepped over to the next whole state.
 */
#ifndef GROTTO_RECORD_PLAYER_H
#define GROTTO_RECORD_PLAYER_H

#include "base/diag.h"
#include "record/reader.h"
#include "record/states.h"

struct record_player_params {
	int recording;   /* which of the file's, from 1 */
	int64_t from_ns; /* begins with the first whole state this long after its start */
};

struct record_play {
	uint64_t frame, previous_frame;
	uint64_t hash, previous_hash; /* as recorded; the state's is computed and equal */
	uint64_t live;
	int64_t time_ns; /* when it began, master's clock of the recording */
	bool jumps;      /* frames are missing before it, or it is the first */
};

struct record_player_counts {
	uint64_t frames;  /* given out */
	uint64_t missing; /* numbers between the first and the last that were not */
	uint64_t wrong;   /* entries that were not what their hash says */
};

struct record_player;
/* Reads up to the recording's start. On failure diag says what is wrong with the file. */
int record_player_open(struct record_player **out, const char *path,
		       const struct record_player_params *params, struct gr_diag *diag);
void record_player_destroy(struct record_player **player);
const struct record_session *record_player_session(const struct record_player *player);
/*
 * The next frame; `state` gets its values. GR_OK, GR_NOTHING after the last,
 * GR_ERR_IO. Reads the file: not for the time between a frame's begin and its
 * swap.
 */
int record_player_next(struct record_player *player, struct param_state *state,
		       struct record_play *out);
void record_player_counts(const struct record_player *player, struct record_player_counts *out);
void record_player_damage(const struct record_player *player, struct record_damage *out);

#endif
