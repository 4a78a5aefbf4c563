/*
 * Writes recordings to files from a thread of its own. Whoever records hands
 * entries over through a bounded ring and never waits: not for the disk, not
 * for a lock. Entries that find the ring full are counted, and a LOST entry
 * says so where they are missing.
 *
 * The thread wakes flush_ns after the last time, makes blocks of what is
 * there and writes each with one write(2), so a crash of the process costs
 * what came since (the system's cache outlives it). fdatasync every sync_ns
 * bounds what a crash of the machine costs.
 *
 * Threads: all functions from one thread, the recording one. Only
 * record_writer_put is made for a frame loop; the others take a lock that the
 * writer's thread never holds during input or output.
 */
#ifndef GROTTO_RECORD_WRITER_H
#define GROTTO_RECORD_WRITER_H

#include "record/format.h"

struct record_writer_params {
	size_t ring_bytes;    /* a power of two */
	uint64_t limit_bytes; /* of a file; then its recording ends */
	int64_t flush_ns, sync_ns;
	int64_t session_ns; /* the SESSION block again after this: one that is damaged costs little */
	const char *hint;   /* appended when a file may not be written: what would be right; or NULL; kept, not copied */
};
#define RECORD_WRITER_DEFAULTS ((struct record_writer_params){ \
	1u << 20, UINT64_C(64) << 30, 100 * INT64_C(1000000), INT64_C(1000000000), \
	10 * INT64_C(1000000000), NULL })

enum record_writer_state {
	RECORD_WRITER_IDLE,
	RECORD_WRITER_OPENING,
	RECORD_WRITER_RUNNING,
	RECORD_WRITER_ENDING,
};
const char *record_writer_state_name(enum record_writer_state state);

struct record_writer_status {
	enum record_writer_state state;
	char path[RECORD_PATH_BYTES]; /* of this recording, or the last one; "" before the first */
	uint64_t bytes, blocks, entries; /* written in it */
	uint64_t lost;   /* entries that found the ring full */
	char error[512]; /* why the last recording failed, "" when it did not */
};

struct record_writer;
/* Starts the thread, with ordinary priority whatever the caller's. GR_OK or a negative result. */
int record_writer_create(struct record_writer **out, const struct record_writer_params *params);
/* Ends a recording (RECORD_END_MASTER) and the thread; waits for the disk. *writer may be NULL. */
void record_writer_destroy(struct record_writer **writer);

/*
 * Begins a recording of `session` at the end of the file `path`, which is
 * made when it is missing; one that holds something else is left alone. Opens
 * it later, in the thread: the status says how that went. GR_ERR_STATE while
 * a recording is not over, GR_ERR_RANGE for a session or path that cannot be.
 */
int record_writer_start(struct record_writer *writer, const char *path,
			const struct record_session *session);
/* What was put before is still written. GR_ERR_STATE when nothing runs. */
int record_writer_stop(struct record_writer *writer, enum record_end_reason reason);
void record_writer_status(struct record_writer *writer, struct record_writer_status *out);

/* True from the moment that entries are taken to the end of the recording. */
bool record_writer_runs(const struct record_writer *writer);
/*
 * Hands over an entry. Never blocks, never allocates, makes no system call.
 * False when it is lost: nothing runs, or the ring is full.
 */
bool record_writer_put(struct record_writer *writer, const struct record_entry *entry);

#endif
