#include "config.h" /* _GNU_SOURCE */

#include "record/output.h"

#include "base/clock.h"
#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define END_ROOM (RECORD_HEAD_BYTES + RECORD_END_BYTES) /* kept free below the limit */

struct record_output {
	struct record_output_params params;
	int fd; /* -1: closed */
	char path[RECORD_PATH_BYTES];
	uint64_t size; /* of the file: all whole blocks */
	uint64_t begun, blocks, entries;
	uint64_t recording, sequence, frame;
	struct record_head head; /* of the block that is being filled */
	uint32_t session_len;
	int64_t synced_ns, session_ns;
	bool dirty;
	char error[512];
	uint8_t session[RECORD_SESSION_MAX];
	/* The block's header is put before its payload, so that one write holds both. */
	uint8_t block[RECORD_HEAD_BYTES + RECORD_PAYLOAD_MAX];
};

int record_output_create(struct record_output **out, const struct record_output_params *params)
{
	struct record_output *o = calloc(1, sizeof *o);

	*out = o;
	if (!o)
		return GR_ERR_NOMEM;
	o->params = *params;
	o->fd = -1;
	return GR_OK;
}

void record_output_destroy(struct record_output **output)
{
	if (!*output)
		return;
	record_output_close(*output);
	free(*output);
	*output = NULL;
}

bool record_output_open_now(const struct record_output *o)
{
	return o->fd >= 0;
}

void record_output_close(struct record_output *o)
{
	if (o->fd >= 0)
		close(o->fd);
	o->fd = -1;
}

void record_output_error(const struct record_output *o, char *text, size_t size)
{
	snprintf(text, size, "%s", o->error);
}

void record_output_counts(const struct record_output *o, uint64_t *bytes, uint64_t *blocks,
			  uint64_t *entries)
{
	*bytes = o->size - o->begun;
	*blocks = o->blocks;
	*entries = o->entries;
}

static int io_failed(struct record_output *o, const char *what)
{
	const int error = errno;
	const bool denied = error == EACCES || error == EPERM || error == EROFS || error == ENOENT;

	snprintf(o->error, sizeof o->error, "%.*s: %s: %s%s%s", 200, o->path, what, strerror(error),
		 denied && o->params.hint ? "; " : "", denied && o->params.hint ? o->params.hint : "");
	return GR_ERR_IO;
}

/* A block at the end of the file, whole or not at all. */
static int append(struct record_output *o, uint8_t *block, struct record_head *head)
{
	const size_t len = RECORD_HEAD_BYTES + head->len;
	size_t done = 0;

	head->recording = o->recording;
	head->sequence = o->sequence;
	record_head_sum(head, block + RECORD_HEAD_BYTES);
	record_head_encode(head, block);
	while (done < len) {
		const ssize_t n = write(o->fd, block + done, len - done);

		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0) {
			const int r = io_failed(o, "cannot be written");
			if (ftruncate(o->fd, (off_t)o->size) < 0)
				o->dirty = true; /* the torn block stays; readers step over it */
			return r;
		}
		done += (size_t)n;
	}
	o->size += len;
	o->sequence++;
	o->blocks++;
	o->dirty = true;
	return GR_OK;
}

static int append_session(struct record_output *o, int64_t now_ns)
{
	uint8_t block[RECORD_HEAD_BYTES + RECORD_SESSION_MAX];
	struct record_head head = { .kind = RECORD_SESSION, .len = o->session_len, .frame = o->frame };

	memcpy(block + RECORD_HEAD_BYTES, o->session, o->session_len);
	o->session_ns = now_ns;
	return append(o, block, &head);
}

/* What is there already must be a recording: nothing else is ever written into. */
static int check_content(struct record_output *o)
{
	uint8_t bytes[RECORD_HEAD_BYTES];
	struct record_head head;
	struct stat status;
	int r = GR_ERR_FORMAT;

	if (fstat(o->fd, &status) < 0)
		return io_failed(o, "cannot be looked at");
	if (!S_ISREG(status.st_mode)) {
		snprintf(o->error, sizeof o->error, "%.200s: is no regular file; give another name", o->path);
		return GR_ERR_FORMAT;
	}
	o->size = o->begun = (uint64_t)status.st_size;
	if (status.st_size == 0)
		return GR_OK;
	if (pread(o->fd, bytes, sizeof bytes, 0) == (ssize_t)sizeof bytes)
		r = record_head_decode(bytes, &head);
	if (r == GR_OK)
		return GR_OK;
	snprintf(o->error, sizeof o->error, r == GR_ERR_VERSION ?
		 "%.200s: holds recordings of another version of grotto; give another name" :
		 "%.200s: is there and holds no recording; give another name", o->path);
	return GR_ERR_FORMAT;
}

static int open_file(struct record_output *o)
{
	/* Not to hang in open() should the path name a pipe. */
	o->fd = open(o->path, O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_NOCTTY | O_NONBLOCK | O_CLOEXEC,
		     0640);
	if (o->fd < 0)
		return io_failed(o, "cannot be opened for writing");
	if (flock(o->fd, LOCK_EX | LOCK_NB) < 0) {
		if (errno != EWOULDBLOCK)
			return io_failed(o, "cannot be locked");
		snprintf(o->error, sizeof o->error, "%.200s: another recording is being written there", o->path);
		return GR_ERR_IO;
	}
	return check_content(o);
}

int record_output_open(struct record_output *o, const char *path, const uint8_t *session,
		       uint32_t len)
{
	const int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
	int r;

	strcpy(o->path, path);
	memcpy(o->session, session, len);
	o->session_len = len;
	o->error[0] = '\0';
	o->sequence = o->frame = o->blocks = o->entries = o->size = o->begun = 0;
	o->head = (struct record_head){ 0 };
	o->synced_ns = now_ns;
	do
		randombytes_buf(&o->recording, sizeof o->recording);
	while (o->recording == 0);
	r = open_file(o);
	if (r == GR_OK)
		r = append_session(o, now_ns);
	if (r < 0)
		record_output_close(o);
	return r;
}

static int write_block(struct record_output *o)
{
	int r;

	if (o->head.count == 0)
		return GR_OK;
	if (o->size + RECORD_HEAD_BYTES + o->head.len + END_ROOM > o->params.limit_bytes)
		return GR_NOTHING;
	o->head.kind = RECORD_ENTRIES;
	r = append(o, o->block, &o->head);
	if (r == GR_OK)
		o->entries += o->head.count;
	o->head = (struct record_head){ .frame = o->frame };
	return r;
}

int record_output_add(struct record_output *o, const uint8_t *entry, uint32_t len)
{
	const bool whole = entry[0] == RECORD_STATE;
	int r = GR_OK;

	/* A whole state stands at the start of a block, where it is found by the header alone. */
	if (whole || o->head.len + len > RECORD_PAYLOAD_MAX)
		r = write_block(o);
	if (r != GR_OK)
		return r;
	if (o->head.count == 0)
		o->head = (struct record_head){ .frame = o->frame, .flags = whole ? RECORD_WHOLE : 0 };
	memcpy(o->block + RECORD_HEAD_BYTES + o->head.len, entry, len);
	o->head.len += len;
	o->head.count++;
	if (whole || entry[0] == RECORD_DELTA) {
		struct gr_reader r_frame = gr_reader(entry + RECORD_ENTRY_HEAD, 8);
		o->frame = gr_read_u64(&r_frame);
	}
	return GR_OK;
}

static int sync_file(struct record_output *o, int64_t now_ns)
{
	if (o->dirty && fdatasync(o->fd) < 0)
		return io_failed(o, "cannot be brought to the disk");
	o->dirty = false;
	o->synced_ns = now_ns;
	return GR_OK;
}

int record_output_flush(struct record_output *o, int64_t now_ns)
{
	int r = write_block(o);

	if (r == GR_OK && now_ns - o->session_ns >= o->params.session_ns &&
	    o->size + RECORD_HEAD_BYTES + o->session_len + END_ROOM <= o->params.limit_bytes)
		r = append_session(o, now_ns);
	if (r == GR_OK && now_ns - o->synced_ns >= o->params.sync_ns)
		r = sync_file(o, now_ns);
	return r;
}

int record_output_end(struct record_output *o, const struct record_end *end)
{
	uint8_t block[RECORD_HEAD_BYTES + RECORD_END_BYTES];
	struct record_head head = { .kind = RECORD_END, .len = RECORD_END_BYTES, .frame = o->frame };
	struct record_end whole = *end;
	int r;

	whole.entries = o->entries;
	record_end_encode(&whole, block + RECORD_HEAD_BYTES);
	r = append(o, block, &head);
	if (r == GR_OK)
		r = sync_file(o, 0);
	record_output_close(o);
	return r;
}
