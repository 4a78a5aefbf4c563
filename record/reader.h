/*
 * Reads recordings block by block, from bytes that may be damaged, cut short
 * or made up: what is not sound is stepped over and counted, and reading goes
 * on with the next sound block. The work is bounded by the length of the file.
 */
#ifndef GROTTO_RECORD_READER_H
#define GROTTO_RECORD_READER_H

#include "base/diag.h"
#include "record/format.h"

/* Where the bytes come from: up to n of them from `at` on; fewer at the end; negative: an error. */
struct record_bytes {
	int64_t (*read_at)(void *ctx, uint64_t at, void *bytes, size_t n);
	void *ctx;
	uint64_t size;
};

struct record_damage {
	uint64_t bad;       /* blocks whose payload or entries are not sound */
	uint64_t bytes;     /* stepped over */
	uint64_t missing;   /* blocks that are not there, by the sequence numbers */
	uint64_t unordered; /* sound blocks out of order, or of no recording that began */
	uint64_t tail;      /* bytes at the end that are no whole block: a writer's crash, or it still writes */
	uint64_t versions;  /* blocks of another version */
};

struct record_block {
	struct record_head head;
	uint64_t at;          /* in the file */
	const uint8_t *payload; /* valid until the next block */
	bool first;           /* of its recording */
	bool gap;             /* something before it is missing */
	struct record_end end; /* of an END block */
};

struct record_reader;
int record_reader_create(struct record_reader **out, const struct record_bytes *bytes);
/* A regular file. Faults go to diag. */
int record_reader_open(struct record_reader **out, const char *path, struct gr_diag *diag);
void record_reader_destroy(struct record_reader **reader);

/*
 * The next sound block: its entries all decode. GR_OK, GR_NOTHING at the end,
 * GR_ERR_IO.
 */
int record_reader_next(struct record_reader *reader, struct record_block *out);
/* Of the recording that the last block is of. */
const struct record_session *record_reader_session(const struct record_reader *reader);
void record_reader_damage(const struct record_reader *reader, struct record_damage *out);
uint64_t record_reader_size(const struct record_reader *reader);

/* The entries of an ENTRIES block, one by one; false after the last. */
struct record_cursor {
	struct gr_reader bytes;
	const struct record_session *session;
	uint32_t left;
};
struct record_cursor record_block_entries(const struct record_reader *reader,
					  const struct record_block *block);
bool record_cursor_next(struct record_cursor *cursor, struct record_entry *out);

#endif
