/*
 * The file that a recording is written to: makes blocks of entries and
 * appends them. One thread.
 */
#ifndef GROTTO_RECORD_OUTPUT_H
#define GROTTO_RECORD_OUTPUT_H

#include "record/format.h"

struct record_output_params {
	uint64_t limit_bytes;
	int64_t sync_ns, session_ns;
	const char *hint;
};

struct record_output;
int record_output_create(struct record_output **out, const struct record_output_params *params);
/* Closes without an END block. */
void record_output_destroy(struct record_output **output);

/*
 * Opens or makes the file, and writes the SESSION block of a new recording at
 * its end. GR_ERR_IO or GR_ERR_FORMAT: record_output_error says why.
 */
int record_output_open(struct record_output *output, const char *path, const uint8_t *session,
		       uint32_t len);
bool record_output_open_now(const struct record_output *output);
/* An encoded entry. GR_OK, GR_NOTHING (no room below the limit: end it), GR_ERR_IO. */
int record_output_add(struct record_output *output, const uint8_t *entry, uint32_t len);
/* Writes what is collected; syncs, and repeats the SESSION block, when their time has come. */
int record_output_flush(struct record_output *output, int64_t now_ns);
/* Writes the END block (end->entries is filled in), syncs, closes. */
int record_output_end(struct record_output *output, const struct record_end *end);
void record_output_close(struct record_output *output);

void record_output_error(const struct record_output *output, char *text, size_t size);
/* Of the recording that is open, or was last. */
void record_output_counts(const struct record_output *output, uint64_t *bytes, uint64_t *blocks,
			  uint64_t *entries);

#endif
