/*
 * Recordings in files for tests: a folder for them, what the writer makes of a
 * made-up session, and what is read of it.
 */
#ifndef GROTTO_TESTS_RECORD_FILES_H
#define GROTTO_TESTS_RECORD_FILES_H

#include "tests/unit/record_make.h"

#include "record/player.h"
#include "record/survey.h"

#define RECORDING_PATH_BYTES 96

/* A group's set-up and tear-down; the latter fails where a test has left something lying about. */
int recording_folder_make(void **state);
int recording_folder_remove(void **state);
const char *recording_folder(void);
/* A name in that folder; returns out. */
const char *recording_path(const char *name, char out[RECORDING_PATH_BYTES]);

void pause_ms(long ms);
/* A writer's defaults, but flushed every millisecond. */
struct record_writer_params quick_writer(void);
/* Until the writer is in that state; fails the test after 10 s. */
void writer_await(struct record_writer *w, enum record_writer_state state,
		  struct record_writer_status *out);

/* A recording of so many frames; the blocks are as the writer's thread happens to wake. */
void recording_make(struct record_maker *m, const char *path, unsigned frames, bool end);

/* A file's bytes, the caller's to free. */
struct recording_bytes {
	uint8_t *bytes;
	size_t len;
};
struct recording_bytes recording_load(const char *path);
void recording_save(const char *path, const void *bytes, size_t len);

/* Plays a file: how many frames it gives; each must be as made. */
unsigned recording_play(const struct record_maker *m, const char *path,
			struct record_player_counts *out, struct record_damage *out_damage);
/* The survey of the first three recordings of a file; one that is not there has no blocks. */
int recording_survey(const char *path, struct record_survey out[3], struct record_damage *damage);

#endif
