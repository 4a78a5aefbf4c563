/*
 * A recording from outside, read whole: every block, every state, the survey
 * and all tables. The first byte, when odd, has the checksums put right first,
 * so that what they protect is reached.
 */
#include "base/result.h"
#include "record/csv.h"
#include "record/states.h"
#include "record/survey.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

struct memory {
	uint8_t *bytes;
	size_t len;
};

static int64_t read_memory(void *ctx, uint64_t at, void *bytes, size_t n)
{
	const struct memory *m = ctx;

	if (at >= m->len)
		return 0;
	if (n > m->len - at)
		n = m->len - at;
	memcpy(bytes, m->bytes + at, n);
	return (int64_t)n;
}

static uint32_t u32_at(const uint8_t *bytes)
{
	struct gr_reader r = gr_reader(bytes, 4);

	return gr_read_u32(&r);
}

/* Header and payload as they stand get the sums that they should have. */
static void mend(struct memory *m)
{
	size_t at = 0;

	while (m->len - at >= RECORD_HEAD_BYTES) {
		const uint32_t len = u32_at(m->bytes + at + 8);
		struct record_head head = { .len = len };

		if (memcmp(m->bytes + at, "GREC", 4) != 0 || len > RECORD_PAYLOAD_MAX ||
		    len > m->len - at - RECORD_HEAD_BYTES)
			return;
		head.kind = m->bytes[at + 5];
		head.flags = m->bytes[at + 6];
		head.count = u32_at(m->bytes + at + 12);
		memcpy(&head.recording, m->bytes + at + 16, 8);
		memcpy(&head.sequence, m->bytes + at + 24, 8);
		memcpy(&head.frame, m->bytes + at + 32, 8);
		record_head_sum(&head, m->bytes + at + RECORD_HEAD_BYTES);
		record_head_encode(&head, m->bytes + at);
		at += RECORD_HEAD_BYTES + len;
	}
}

static void forget(void *ctx, const struct record_survey *survey)
{
	(void)ctx;
	if (survey->frames_wrong > survey->frames || survey->wholes > survey->frames)
		abort();
}

static void read_states(struct record_reader *reader)
{
	struct record_states states;
	struct record_block block;
	struct record_entry entry;

	if (record_states_init(&states) != GR_OK)
		abort();
	while (record_reader_next(reader, &block) == GR_OK) {
		struct record_cursor cursor = record_block_entries(reader, &block);
		while (record_cursor_next(&cursor, &entry))
			if ((entry.kind == RECORD_STATE || entry.kind == RECORD_DELTA) &&
			    record_states_take(&states, &entry) == GR_OK &&
			    param_state_hash(states.state, entry.frame.previous_hash) != entry.frame.hash)
				abort();
		if (cursor.left || !gr_reader_done(&cursor.bytes))
			if (block.head.kind == RECORD_ENTRIES)
				abort(); /* a block is given out whole or not at all */
	}
	record_states_finish(&states);
}

static struct record_reader *reader_of(struct memory *m)
{
	const struct record_bytes source = { read_memory, m, m->len };
	struct record_reader *reader;

	if (record_reader_create(&reader, &source) != GR_OK)
		abort();
	return reader;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	struct memory m = { malloc(len ? len : 1), len ? len - 1 : 0 };
	struct record_reader *reader;
	FILE *files[RECORD_TABLES], *sink = fopen("/dev/null", "we");

	if (!m.bytes || !sink)
		abort();
	if (m.len)
		memcpy(m.bytes, bytes + 1, m.len);
	if (len && bytes[0] & 1)
		mend(&m);
	for (int i = 0; i < RECORD_TABLES; i++)
		files[i] = sink;
	reader = reader_of(&m);
	read_states(reader);
	record_reader_destroy(&reader);
	reader = reader_of(&m);
	record_survey(reader, forget, NULL);
	record_reader_destroy(&reader);
	reader = reader_of(&m);
	record_csv_write(reader, 1, files);
	record_reader_destroy(&reader);
	fclose(sink);
	free(m.bytes);
	return 0;
}
