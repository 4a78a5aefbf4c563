#include "config.h" /* _GNU_SOURCE */

#include "record/reader.h"

#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define SCAN_BYTES 16384
/*
 * A header may lie about its length, so what follows a payload that is not
 * sound is looked through for the next header. Made-up headers could have the
 * same bytes summed over and over: past so many times the file's length the
 * headers are believed.
 */
#define SUMMED_TIMES 4

struct record_reader {
	struct record_bytes source;
	int fd; /* -1: not ours */
	uint64_t at, summed;
	struct record_damage damage;
	struct record_session session;
	uint64_t recording, next_sequence; /* recording 0: none has begun */
	bool gap;
	uint8_t payload[RECORD_PAYLOAD_MAX];
};

static int64_t read_file(void *ctx, uint64_t at, void *bytes, size_t n)
{
	const struct record_reader *r = ctx;
	size_t done = 0;

	while (done < n) {
		const ssize_t got = pread(r->fd, (uint8_t *)bytes + done, n - done, (off_t)(at + done));

		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0)
			return -1;
		if (got == 0)
			break;
		done += (size_t)got;
	}
	return (int64_t)done;
}

int record_reader_create(struct record_reader **out, const struct record_bytes *bytes)
{
	struct record_reader *r = calloc(1, sizeof *r);

	*out = r;
	if (!r)
		return GR_ERR_NOMEM;
	r->source = *bytes;
	r->fd = -1;
	return GR_OK;
}

int record_reader_open(struct record_reader **out, const char *path, struct gr_diag *diag)
{
	const struct record_bytes none = { read_file, NULL, 0 };
	struct stat status = { 0 };
	const char *why = NULL;
	int r = record_reader_create(out, &none);

	if (r < 0)
		return r;
	(*out)->fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
	if ((*out)->fd < 0 || fstat((*out)->fd, &status) < 0)
		why = strerror(errno);
	else if (!S_ISREG(status.st_mode))
		why = "is no regular file; give the file of a recording";
	else if (status.st_size == 0)
		why = "is empty; give the file of a recording";
	if (why) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "%s", why);
		record_reader_destroy(out);
		return GR_ERR_IO;
	}
	(*out)->source.ctx = *out;
	(*out)->source.size = (uint64_t)status.st_size;
	return GR_OK;
}

void record_reader_destroy(struct record_reader **reader)
{
	if (!*reader)
		return;
	if ((*reader)->fd >= 0)
		close((*reader)->fd);
	free(*reader);
	*reader = NULL;
}

const struct record_session *record_reader_session(const struct record_reader *r)
{
	return &r->session;
}

void record_reader_damage(const struct record_reader *r, struct record_damage *out)
{
	*out = r->damage;
}

uint64_t record_reader_size(const struct record_reader *r)
{
	return r->source.size;
}

/* From r->at on, the next place where a magic stands, or the file's end. */
static int find_magic(struct record_reader *r)
{
	uint8_t bytes[SCAN_BYTES];

	while (r->at < r->source.size) {
		const int64_t n = r->source.read_at(r->source.ctx, r->at, bytes, sizeof bytes);
		const uint8_t *found;

		if (n < 0)
			return GR_ERR_IO;
		found = memmem(bytes, (size_t)n, "GREC", 4);
		if (found) {
			r->at += (uint64_t)(found - bytes);
			return GR_OK;
		}
		if (n < (int64_t)sizeof bytes)
			break;
		r->at += (uint64_t)n - 3; /* one may lie across the edge */
	}
	r->at = r->source.size;
	return GR_NOTHING;
}

static bool entries_sound(const struct record_reader *r, const struct record_head *head)
{
	struct gr_reader bytes = gr_reader(r->payload, head->len);
	struct record_entry entry;
	bool whole = false;

	for (uint32_t i = 0; i < head->count; i++) {
		if (!record_entry_decode(&bytes, &r->session, &entry))
			return false;
		if (i == 0)
			whole = entry.kind == RECORD_STATE;
	}
	return gr_reader_done(&bytes) && whole == !!(head->flags & RECORD_WHOLE);
}

/* The block begins, or goes on with, a recording. False when it is not its turn. */
static bool in_order(struct record_reader *r, const struct record_head *head,
		     struct record_block *out)
{
	out->first = false;
	if (head->recording != r->recording) {
		if (head->kind != RECORD_SESSION)
			return false;
		r->recording = head->recording;
		r->next_sequence = 0;
		r->gap = false;
		out->first = true;
	}
	if (head->sequence < r->next_sequence || head->sequence == UINT64_MAX)
		return false;
	r->damage.missing += head->sequence - r->next_sequence;
	out->gap = r->gap || head->sequence > r->next_sequence;
	r->gap = false;
	r->next_sequence = head->sequence + 1;
	return true;
}

/* A block whose checksums are right. GR_OK: out is set; GR_NOTHING: it is of no use. */
static int take(struct record_reader *r, const struct record_head *head, struct record_block *out)
{
	struct record_session session;
	bool sound = true;

	if (head->kind == RECORD_SESSION)
		sound = record_session_decode(r->payload, head->len, &session) == GR_OK;
	else if (head->kind == RECORD_END)
		sound = record_end_decode(r->payload, head->len, &out->end) == GR_OK;
	else if (head->recording == r->recording)
		sound = entries_sound(r, head);
	if (!sound) {
		r->damage.bad++;
		r->gap = true;
		return GR_NOTHING;
	}
	if (!in_order(r, head, out)) {
		r->damage.unordered++;
		return GR_NOTHING;
	}
	if (out->first)
		r->session = session;
	out->head = *head;
	out->at = r->at;
	out->payload = r->payload;
	return GR_OK;
}

/* Steps over n bytes that are no sound block. */
static void step(struct record_reader *r, uint64_t n)
{
	r->at += n;
	r->damage.bytes += n;
	r->gap = true;
}

/* No header stands at r->at: to where one may. */
static int step_to_magic(struct record_reader *r)
{
	uint64_t from;
	int result;

	step(r, 1);
	from = r->at;
	result = find_magic(r);
	r->damage.bytes += r->at - from;
	return result;
}

/* A block whose header is sound stands at r->at. GR_OK, GR_NOTHING: stepped over. */
static int read_block(struct record_reader *r, const struct record_head *head,
		      struct record_block *out)
{
	const uint64_t len = RECORD_HEAD_BYTES + (uint64_t)head->len;
	const int64_t n = r->source.read_at(r->source.ctx, r->at + RECORD_HEAD_BYTES, r->payload, head->len);
	int result;

	if (n < 0)
		return GR_ERR_IO;
	r->summed += (uint64_t)n;
	if (n < (int64_t)head->len) {
		/* Cut off here, or its length is a lie: what it covers is looked at. */
		step(r, RECORD_HEAD_BYTES);
		return GR_NOTHING;
	}
	if (!record_payload_sound(head, r->payload)) {
		r->damage.bad++;
		step(r, r->summed > SUMMED_TIMES * r->source.size ? len : RECORD_HEAD_BYTES);
		return GR_NOTHING;
	}
	result = take(r, head, out);
	if (result == GR_OK)
		r->at += len;
	else
		step(r, len);
	return result;
}

int record_reader_next(struct record_reader *r, struct record_block *out)
{
	const uint64_t start = r->at, before = r->damage.bytes;

	for (;;) {
		uint8_t bytes[RECORD_HEAD_BYTES];
		struct record_head head;
		const int64_t n = r->source.read_at(r->source.ctx, r->at, bytes, sizeof bytes);
		int result;

		if (n < 0)
			return GR_ERR_IO;
		if (n < (int64_t)sizeof bytes) {
			/* Nothing sound follows: all from the last sound block on is the tail. */
			r->damage.bytes = before;
			r->damage.tail += r->source.size - start;
			r->at = r->source.size;
			return GR_NOTHING;
		}
		result = record_head_decode(bytes, &head);
		if (result == GR_OK) {
			result = read_block(r, &head, out);
			if (result != GR_NOTHING)
				return result;
			continue;
		}
		r->damage.versions += result == GR_ERR_VERSION;
		if (step_to_magic(r) == GR_ERR_IO)
			return GR_ERR_IO;
	}
}

struct record_cursor record_block_entries(const struct record_reader *reader,
					  const struct record_block *block)
{
	return (struct record_cursor){
		.bytes = gr_reader(block->payload, block->head.len),
		.session = &reader->session,
		.left = block->head.kind == RECORD_ENTRIES ? block->head.count : 0,
	};
}

bool record_cursor_next(struct record_cursor *cursor, struct record_entry *out)
{
	if (cursor->left == 0)
		return false;
	cursor->left--;
	return record_entry_decode(&cursor->bytes, cursor->session, out);
}
