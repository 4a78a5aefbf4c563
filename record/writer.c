#include "config.h" /* _GNU_SOURCE */

#include "record/writer.h"

#include "base/clock.h"
#include "base/result.h"
#include "record/output.h"
#include "record/ring.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct record_writer {
	struct record_writer_params params;
	struct record_ring ring;
	pthread_t thread;
	_Atomic bool running;     /* entries are taken */
	_Atomic uint64_t lost;    /* of this recording */

	/* The putting thread's alone. */
	struct record_lost pending;

	/* The writer thread's alone. */
	struct record_output *output;

	pthread_mutex_t lock;
	pthread_cond_t change;
	/* Under the lock. */
	struct record_writer_status status;
	uint8_t session[RECORD_SESSION_MAX];
	uint32_t session_len;
	bool open, stop, quit;
	enum record_end_reason reason;
};

const char *record_writer_state_name(enum record_writer_state state)
{
	static const char *const names[] = { "idle", "opening", "recording", "ending" };

	return (unsigned)state < sizeof names / sizeof *names ? names[state] : "unknown";
}

/* From state `from`; a wish that came meanwhile stays. */
static void settle(struct record_writer *w, enum record_writer_state from,
		   enum record_writer_state to, const char *error)
{
	pthread_mutex_lock(&w->lock);
	if (w->status.state == from || to == RECORD_WRITER_IDLE)
		w->status.state = to;
	record_output_counts(w->output, &w->status.bytes, &w->status.blocks, &w->status.entries);
	if (error)
		strcpy(w->status.error, error);
	if (to == RECORD_WRITER_IDLE)
		w->stop = false;
	pthread_mutex_unlock(&w->lock);
}

/* Entries of an earlier recording that failed; nobody puts while nothing runs. */
static void empty_ring(struct record_writer *w)
{
	uint32_t len;

	while (record_ring_peek(&w->ring, &len))
		record_ring_drop(&w->ring);
}

static void fail(struct record_writer *w)
{
	char error[sizeof w->status.error];

	atomic_store(&w->running, false);
	record_output_error(w->output, error, sizeof error);
	record_output_close(w->output);
	settle(w, RECORD_WRITER_RUNNING, RECORD_WRITER_IDLE, error);
}

static void open_output(struct record_writer *w)
{
	char path[RECORD_PATH_BYTES];
	uint8_t session[RECORD_SESSION_MAX];
	uint32_t len;

	pthread_mutex_lock(&w->lock);
	strcpy(path, w->status.path);
	memcpy(session, w->session, w->session_len);
	len = w->session_len;
	w->open = false;
	pthread_mutex_unlock(&w->lock);
	empty_ring(w);
	if (record_output_open(w->output, path, session, len) < 0) {
		fail(w);
		return;
	}
	settle(w, RECORD_WRITER_OPENING, RECORD_WRITER_RUNNING, NULL);
	atomic_store(&w->running, true);
}

static void end_output(struct record_writer *w, enum record_end_reason reason)
{
	const struct record_end end = { .reason = reason, .lost = atomic_load(&w->lost) };

	atomic_store(&w->running, false);
	if (record_output_end(w->output, &end) < 0) {
		fail(w);
		return;
	}
	settle(w, RECORD_WRITER_RUNNING, RECORD_WRITER_IDLE, NULL);
}

/* What is in the ring goes into the file. False when the recording is over. */
static bool drain(struct record_writer *w)
{
	const uint8_t *entry;
	uint32_t len;
	int r = GR_OK;

	while (r == GR_OK && (entry = record_ring_peek(&w->ring, &len))) {
		r = record_output_add(w->output, entry, len);
		record_ring_drop(&w->ring);
	}
	if (r == GR_OK)
		r = record_output_flush(w->output, gr_clock_now(&gr_clock_monotonic));
	if (r < 0) {
		fail(w);
		return false;
	}
	if (r == GR_NOTHING) {
		end_output(w, RECORD_END_SIZE);
		return false;
	}
	settle(w, RECORD_WRITER_RUNNING, RECORD_WRITER_RUNNING, NULL);
	return true;
}

/* Until something is asked for, or it is time to flush. Returns holding the lock. */
static void await(struct record_writer *w)
{
	struct timespec until;

	pthread_mutex_lock(&w->lock);
	if (w->status.state != RECORD_WRITER_RUNNING) {
		while (!w->open && !w->stop && !w->quit)
			pthread_cond_wait(&w->change, &w->lock);
		return;
	}
	clock_gettime(CLOCK_MONOTONIC, &until);
	until.tv_sec += w->params.flush_ns / GR_NS_PER_S;
	until.tv_nsec += w->params.flush_ns % GR_NS_PER_S;
	until.tv_sec += until.tv_nsec / GR_NS_PER_S;
	until.tv_nsec %= GR_NS_PER_S;
	while (!w->stop && !w->quit &&
	       pthread_cond_timedwait(&w->change, &w->lock, &until) == 0)
		;
}

static void *run(void *arg)
{
	struct record_writer *w = arg;
	bool quit = false;

	pthread_setname_np(pthread_self(), "record");
	while (!quit) {
		enum record_end_reason reason;
		bool open, stop, runs;

		await(w);
		open = w->open;
		quit = w->quit;
		stop = w->stop || quit;
		reason = w->stop ? w->reason : RECORD_END_MASTER;
		pthread_mutex_unlock(&w->lock);
		if (open)
			open_output(w);
		runs = record_output_open_now(w->output);
		if (runs && stop)
			atomic_store(&w->running, false);
		if (runs && drain(w) && stop)
			end_output(w, reason);
		else if (!record_output_open_now(w->output) && stop)
			settle(w, RECORD_WRITER_RUNNING, RECORD_WRITER_IDLE, NULL);
	}
	return NULL;
}

static int start_thread(struct record_writer *w)
{
	const struct sched_param ordinary = { 0 };
	pthread_attr_t attr;
	int r;

	if (pthread_attr_init(&attr) != 0)
		return GR_ERR_NOMEM;
	/* The caller's may be a real-time one: the disk is no work for that. */
	pthread_attr_setinheritsched(&attr, PTHREAD_EXPLICIT_SCHED);
	pthread_attr_setschedpolicy(&attr, SCHED_OTHER);
	pthread_attr_setschedparam(&attr, &ordinary);
	r = pthread_create(&w->thread, &attr, run, w);
	pthread_attr_destroy(&attr);
	return r == 0 ? GR_OK : GR_ERR_NOMEM;
}

static void free_writer(struct record_writer *w)
{
	record_output_destroy(&w->output);
	record_ring_finish(&w->ring);
	free(w);
}

int record_writer_create(struct record_writer **out, const struct record_writer_params *params)
{
	struct record_writer *w = calloc(1, sizeof *w);
	const struct record_output_params output = { params->limit_bytes, params->sync_ns,
						     params->session_ns, params->hint };
	pthread_condattr_t monotonic;
	int r;

	*out = NULL;
	if (!w)
		return GR_ERR_NOMEM;
	w->params = *params;
	r = record_ring_init(&w->ring, params->ring_bytes);
	if (r == GR_OK)
		r = record_output_create(&w->output, &output);
	if (r < 0) {
		free_writer(w);
		return r;
	}
	atomic_init(&w->running, false);
	atomic_init(&w->lost, 0);
	pthread_mutex_init(&w->lock, NULL);
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&w->change, &monotonic);
	pthread_condattr_destroy(&monotonic);
	r = start_thread(w);
	if (r < 0) {
		pthread_cond_destroy(&w->change);
		pthread_mutex_destroy(&w->lock);
		free_writer(w);
		return r;
	}
	*out = w;
	return GR_OK;
}

void record_writer_destroy(struct record_writer **writer)
{
	struct record_writer *w = *writer;

	*writer = NULL;
	if (!w)
		return;
	pthread_mutex_lock(&w->lock);
	w->quit = true;
	pthread_cond_signal(&w->change);
	pthread_mutex_unlock(&w->lock);
	pthread_join(w->thread, NULL);
	pthread_cond_destroy(&w->change);
	pthread_mutex_destroy(&w->lock);
	free_writer(w);
}

int record_writer_start(struct record_writer *w, const char *path,
			const struct record_session *session)
{
	size_t len = strlen(path), session_len;
	int r = GR_OK;

	if (len == 0 || len >= sizeof w->status.path)
		return GR_ERR_RANGE;
	pthread_mutex_lock(&w->lock);
	session_len = record_session_encode(session, w->session, sizeof w->session);
	if (w->status.state != RECORD_WRITER_IDLE) {
		r = GR_ERR_STATE;
	} else if (session_len == 0) {
		r = GR_ERR_RANGE;
	} else {
		w->status = (struct record_writer_status){ .state = RECORD_WRITER_OPENING };
		memcpy(w->status.path, path, len + 1);
		w->session_len = (uint32_t)session_len;
		w->open = true;
		w->pending = (struct record_lost){ 0 };
		atomic_store(&w->lost, 0);
		pthread_cond_signal(&w->change);
	}
	pthread_mutex_unlock(&w->lock);
	return r;
}

int record_writer_stop(struct record_writer *w, enum record_end_reason reason)
{
	int r = GR_OK;

	pthread_mutex_lock(&w->lock);
	if (w->status.state != RECORD_WRITER_RUNNING && w->status.state != RECORD_WRITER_OPENING) {
		r = GR_ERR_STATE;
	} else {
		/* From here on nothing is put, so that all that was is drained. */
		atomic_store(&w->running, false);
		w->status.state = RECORD_WRITER_ENDING;
		w->stop = true;
		w->reason = reason;
		pthread_cond_signal(&w->change);
	}
	pthread_mutex_unlock(&w->lock);
	return r;
}

void record_writer_status(struct record_writer *w, struct record_writer_status *out)
{
	pthread_mutex_lock(&w->lock);
	*out = w->status;
	pthread_mutex_unlock(&w->lock);
	out->lost = atomic_load(&w->lost);
}

bool record_writer_runs(const struct record_writer *w)
{
	return atomic_load_explicit(&((struct record_writer *)(uintptr_t)w)->running, memory_order_relaxed);
}

static bool put(struct record_writer *w, const struct record_entry *entry)
{
	uint8_t bytes[RECORD_ENTRY_MAX];
	const size_t len = record_entry_encode(entry, bytes, sizeof bytes);

	return len > 0 && record_ring_put(&w->ring, bytes, (uint32_t)len);
}

bool record_writer_put(struct record_writer *w, const struct record_entry *entry)
{
	if (!atomic_load_explicit(&w->running, memory_order_acquire))
		return false;
	if (w->pending.entries > 0) {
		const struct record_entry lost = { .kind = RECORD_LOST, .time_ns = entry->time_ns,
						   .lost = w->pending };
		if (put(w, &lost))
			w->pending = (struct record_lost){ 0 };
	}
	if (w->pending.entries == 0 && put(w, entry))
		return true;
	if (w->pending.entries == 0)
		w->pending.since_ns = entry->time_ns;
	w->pending.entries++;
	w->pending.frames += entry->kind == RECORD_STATE || entry->kind == RECORD_DELTA;
	atomic_fetch_add_explicit(&w->lost, 1, memory_order_relaxed);
	return false;
}
