#include "tracking/device_private.h"

#include "base/result.h"
#include "tracking/hotplug.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

#define BACK_OFF_LEAST_NS (100 * GR_NS_PER_MS)
#define BACK_OFF_MOST_NS (2 * GR_NS_PER_S)
#define TURN_MS 1000 /* the longest that a thread waits in one go */

_Static_assert(sizeof(struct track_status) % sizeof(uint64_t) == 0, "handed over in words");
_Static_assert(sizeof(struct track_counters) % sizeof(uint64_t) == 0, "whole numbers alone");

const char *track_state_name(enum track_state state)
{
	static const char *const name[TRACK_STATES] = {
		[TRACK_OFF] = "off",   [TRACK_ABSENT] = "absent", [TRACK_DENIED] = "denied",
		[TRACK_BUSY] = "busy", [TRACK_FAILED] = "failed", [TRACK_RUNNING] = "running",
	};

	return (unsigned)state < TRACK_STATES ? name[state] : "unknown";
}

int track_device_alloc(void *out, size_t size, const struct track_device_ops *ops,
		       const struct gr_clock *clock)
{
	struct track_device *device = calloc(1, size);

	if (!device)
		return GR_ERR_NOMEM;
	device->ops = ops;
	device->clock = clock;
	device->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (device->wake_fd < 0) {
		free(device);
		return GR_ERR_IO;
	}
	track_clock_init(&device->times);
	*(void **)out = device;
	return GR_OK;
}

/* ---- status: written by the device's thread, read by any ---- */

static void tell(struct track_device *d, enum track_state state, const char *why)
{
	if (d->status_stamp && d->status.state == state && !strcmp(d->status.why, why))
		return;
	if (!d->status_stamp || d->status.state != state)
		d->status.since_ns = gr_clock_now(d->clock);
	d->status.state = state;
	memset(d->status.why, 0, sizeof d->status.why);
	snprintf(d->status.why, sizeof d->status.why, "%s", why);
	d->status_stamp += 2;
	gr_seqlock_write(&d->status_sequence, d->status_words, d->status_stamp, &d->status,
			 sizeof d->status);
}

void track_device_status(const struct track_device *d, struct track_status *out)
{
	uint64_t stamp;

	/* The writer needs nanoseconds and writes seldom: a second try is rare, a third unheard of.
	 */
	while (!gr_seqlock_read(&d->status_sequence, d->status_words, &stamp, out, sizeof *out))
		;
	if (!stamp)
		*out = (struct track_status){ .state = TRACK_OFF };
}

void track_device_counters(const struct track_device *d, struct track_counters *out)
{
	uint64_t words[GR_SEQLOCK_WORDS(struct track_counters)];

	for (size_t i = 0; i < GR_SEQLOCK_WORDS(struct track_counters); i++)
		words[i] = atomic_load_explicit(&d->counters[i], memory_order_relaxed);
	memcpy(out, words, sizeof *out);
}

int track_device_take(const struct track_device *d, struct track_reader *reader,
		      struct track_report *out, int room)
{
	return track_handover_take(&d->handover, reader, out, room);
}

int track_device_wake_fd(const struct track_device *d)
{
	return d->wake_fd;
}

int64_t track_device_now(const struct track_device *d)
{
	return gr_clock_now(d->clock);
}

/* ---- life ---- */

static void open_now(struct track_device *d)
{
	char why[TRACK_WHY] = "";
	const enum track_state state = d->ops->open(d, why, sizeof why);

	tell(d, state, why);
	if (state == TRACK_RUNNING) {
		d->is_open = true;
		track_hotplug_destroy(&d->hotplug); /* nobody would read it */
		d->back_off_ns = 0;
		/* Another device, or the same after a pause: its clock may be another. */
		track_clock_init(&d->times);
		d->seen = 0;
		track_device_count(d, TRACK_COUNTER(opened), 1);
		return;
	}
	d->back_off_ns = d->back_off_ns ? d->back_off_ns * 2 : BACK_OFF_LEAST_NS;
	if (d->back_off_ns > BACK_OFF_MOST_NS)
		d->back_off_ns = BACK_OFF_MOST_NS;
	d->retry_ns = gr_clock_now(d->clock) + d->back_off_ns;
}

static void close_now(struct track_device *d, enum track_state state, const char *why)
{
	d->ops->close(d);
	d->is_open = false;
	tell(d, state, why);
	d->back_off_ns = BACK_OFF_LEAST_NS;
	d->retry_ns = gr_clock_now(d->clock) + BACK_OFF_LEAST_NS;
}

/* Until the next try, the end, or something is plugged in. */
static void wait_for_try(struct track_device *d, int64_t left_ns, int timeout_ms)
{
	const int64_t left_ms = (left_ns + GR_NS_PER_MS - 1) / GR_NS_PER_MS;
	struct pollfd fds[2] = {
		{ .fd = d->wake_fd, .events = POLLIN },
		{ .fd = track_hotplug_fd(d->hotplug),
		  .events = POLLIN }, /* -1: poll passes it by */
	};

	if (poll(fds, 2, left_ms < timeout_ms ? (int)left_ms : timeout_ms) > 0 && fds[1].revents &&
	    track_hotplug_added(d->hotplug)) {
		d->back_off_ns = 0;
		d->retry_ns = 0;
	}
}

void track_device_turn(struct track_device *d, int timeout_ms)
{
	char why[TRACK_WHY] = "";
	int64_t left_ns;
	int r;

	if (d->is_open) {
		r = d->ops->read(d, timeout_ms, why, sizeof why);
		if (r < 0)
			close_now(d, r == GR_ERR_IO ? TRACK_ABSENT : TRACK_FAILED, why);
		return;
	}
	/* Before it is looked for, so that nothing is plugged in unseen between the two. */
	if (!d->hotplug && d->ops->subsystem)
		d->hotplug = track_hotplug_create(d->ops->subsystem);
	left_ns = d->retry_ns - gr_clock_now(d->clock);
	if (d->status_stamp && left_ns > 0)
		wait_for_try(d, left_ns, timeout_ms);
	else
		open_now(d);
}

static void *run(void *ctx)
{
	struct track_device *d = ctx;

	while (!atomic_load_explicit(&d->stop, memory_order_acquire))
		track_device_turn(d, TURN_MS);
	return NULL;
}

int track_device_start(struct track_device *d)
{
	sigset_t all, before;
	int r;

	/* Signals are the loop's. */
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	r = pthread_create(&d->thread, NULL, run, d);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	d->started = r == 0;
	errno = r;
	return r == 0 ? GR_OK : GR_ERR_IO;
}

void track_device_destroy(struct track_device **device)
{
	struct track_device *d = *device;
	const uint64_t one = 1;

	*device = NULL;
	if (!d)
		return;
	atomic_store_explicit(&d->stop, true, memory_order_release);
	if (d->started && write(d->wake_fd, &one, sizeof one) == (ssize_t)sizeof one)
		pthread_join(d->thread, NULL);
	if (d->is_open)
		d->ops->close(d);
	track_hotplug_destroy(&d->hotplug);
	close(d->wake_fd);
	d->ops->destroy(d);
}
