#include "tracking/replay.h"

#include "base/clock.h"
#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct track_replay {
	struct track_source source;
	struct track_sample *samples; /* sorted by time */
	size_t count, next;
	bool loop, started;
	int64_t base_ns;   /* the file's time 0 on the caller's clock */
	int64_t period_ns; /* from one round to the next */
};

static int64_t due(const struct track_replay *r)
{
	return r->base_ns + r->samples[r->next].time_ns;
}

static void start_round(struct track_replay *r, int64_t now_ns)
{
	int64_t late = now_ns - r->base_ns - r->samples[r->count - 1].time_ns;

	/* Rounds that lie wholly in the past are not worth delivering. */
	r->base_ns += late > r->period_ns ? late / r->period_ns * r->period_ns : r->period_ns;
	r->next = 0;
}

static int replay_poll(struct track_source *source, int64_t now_ns, struct track_sample *out,
		       int room)
{
	struct track_replay *r = (struct track_replay *)source;
	int count = 0;

	if (!r->started) {
		r->started = true;
		r->base_ns = now_ns;
	}
	while (count < room) {
		if (r->next == r->count) {
			if (!r->loop)
				break;
			start_round(r, now_ns);
		}
		if (due(r) > now_ns)
			break;
		out[count] = r->samples[r->next];
		out[count++].time_ns = due(r);
		r->next++;
	}
	return count;
}

static int replay_fd(const struct track_source *source)
{
	(void)source;
	return -1;
}

static int64_t replay_next(const struct track_source *source, int64_t now_ns)
{
	const struct track_replay *r = (const struct track_replay *)source;

	if (!r->started)
		return now_ns;
	if (r->next < r->count)
		return due(r);
	return r->loop ? r->base_ns + r->period_ns + r->samples[0].time_ns : INT64_MAX;
}

static void replay_destroy(struct track_source *source)
{
	struct track_replay *r = (struct track_replay *)source;

	free(r->samples);
	free(r);
}

static const struct track_source_ops replay_ops = {
	.kind = "replay",
	.poll = replay_poll,
	.fd = replay_fd,
	.next = replay_next,
	.destroy = replay_destroy,
};

/* From the first sample round to itself again: the length and one mean interval. */
static int64_t round_length(const struct track_sample *samples, size_t count)
{
	int64_t length = samples[count - 1].time_ns - samples[0].time_ns;
	int64_t times = 1;

	for (size_t i = 1; i < count; i++)
		times += samples[i].time_ns != samples[i - 1].time_ns;
	return length + (times > 1 ? length / (times - 1) : GR_NS_PER_S / 100);
}

static int io_fault(struct gr_diag *diag, const char *path, const char *what)
{
	gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "%s: %s", what, strerror(errno));
	return GR_ERR_IO;
}

static int read_all(int fd, const char *path, char **out, size_t *out_len, struct gr_diag *diag)
{
	struct stat st;
	size_t len = 0;
	char *text;

	if (fstat(fd, &st) != 0)
		return io_fault(diag, path, "cannot look at the log");
	if (!S_ISREG(st.st_mode) || st.st_size > TRACK_REPLAY_MAX_BYTES) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
			    "must be a regular file of at most %ld bytes", TRACK_REPLAY_MAX_BYTES);
		return GR_ERR_FORMAT;
	}
	text = malloc((size_t)st.st_size + 1);
	if (!text)
		return GR_ERR_NOMEM;
	while (len < (size_t)st.st_size) {
		ssize_t n = read(fd, text + len, (size_t)st.st_size - len);

		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0) {
			free(text);
			return io_fault(diag, path, "cannot read the log");
		}
		if (n == 0) /* it shrank meanwhile */
			break;
		len += (size_t)n;
	}
	*out = text;
	*out_len = len;
	return GR_OK;
}

static int load(struct track_replay *r, const char *path, struct gr_diag *diag)
{
	/* Not to hang in open() should the path name a pipe. */
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK), result;
	char *text = NULL;
	size_t len = 0;

	if (fd < 0)
		return io_fault(diag, path, "cannot open the log");
	result = read_all(fd, path, &text, &len, diag);
	close(fd);
	if (result == GR_OK)
		result = track_replay_parse(text, len, path, &r->samples, &r->count, diag);
	free(text);
	return result;
}

int track_replay_create(struct track_source **out, const char *path, bool loop,
			struct gr_diag *diag)
{
	struct track_replay *r = calloc(1, sizeof *r);
	int result = r ? load(r, path, diag) : GR_ERR_NOMEM;

	if (result != GR_OK) {
		free(r);
		return result;
	}
	if (r->samples[0].time_ns > 10 * GR_NS_PER_S)
		gr_diag_add(diag, GR_DIAG_WARNING, path, 0, "time_s",
			    "the first sample is at %.3f s: nothing is tracked until then",
			    (double)r->samples[0].time_ns * 1e-9);
	r->source.ops = &replay_ops;
	r->loop = loop;
	r->period_ns = round_length(r->samples, r->count);
	*out = &r->source;
	return GR_OK;
}
