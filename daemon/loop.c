#include "daemon/loop.h"

#include "base/clock.h"
#include "base/result.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#define LOOP_BATCH 16

struct loop_slot {
	int fd; /* -1: free */
	uint32_t generation;
	loop_fd_fn fn;
	void *ctx;
};

struct loop_timer {
	struct loop *loop;
	int fd; /* -1: free */
	int64_t at_ns;
	loop_timer_fn fn;
	void *ctx;
};

struct loop {
	int epoll;
	int signal_fd;
	int signal;
	bool stopped;
	struct loop_slot slots[LOOP_FDS];
	struct loop_timer timers[LOOP_TIMERS];
};

int loop_create(struct loop **out)
{
	struct loop *loop = calloc(1, sizeof *loop);

	*out = NULL;
	if (!loop)
		return GR_ERR_NOMEM;
	loop->signal_fd = -1;
	for (int i = 0; i < LOOP_FDS; i++)
		loop->slots[i].fd = -1;
	for (int i = 0; i < LOOP_TIMERS; i++)
		loop->timers[i].fd = -1;
	loop->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (loop->epoll < 0) {
		free(loop);
		return GR_ERR_IO;
	}
	*out = loop;
	return GR_OK;
}

void loop_destroy(struct loop **loop)
{
	struct loop *l = *loop;

	if (!l)
		return;
	for (int i = 0; i < LOOP_TIMERS; i++)
		if (l->timers[i].fd >= 0)
			close(l->timers[i].fd);
	if (l->signal_fd >= 0)
		close(l->signal_fd);
	close(l->epoll);
	free(l);
	*loop = NULL;
}

static int find_slot(const struct loop *loop, int fd)
{
	for (int i = 0; i < LOOP_FDS; i++)
		if (loop->slots[i].fd == fd)
			return i;
	return -1;
}

/* The generation tells an event of a slot's former owner from one of the present. */
static uint64_t slot_key(const struct loop *loop, int i)
{
	return (uint64_t)loop->slots[i].generation << 32 | (uint32_t)i;
}

int loop_add(struct loop *loop, int fd, uint32_t events, loop_fd_fn fn, void *ctx)
{
	struct epoll_event event = { .events = events };
	int i;

	if (fd < 0 || find_slot(loop, fd) >= 0)
		return GR_ERR_RANGE;
	i = find_slot(loop, -1);
	if (i < 0)
		return GR_ERR_RANGE;
	loop->slots[i].generation++;
	event.data.u64 = slot_key(loop, i);
	if (epoll_ctl(loop->epoll, EPOLL_CTL_ADD, fd, &event) < 0)
		return GR_ERR_IO;
	loop->slots[i].fd = fd;
	loop->slots[i].fn = fn;
	loop->slots[i].ctx = ctx;
	return GR_OK;
}

int loop_modify(struct loop *loop, int fd, uint32_t events)
{
	struct epoll_event event = { .events = events };
	int i = fd < 0 ? -1 : find_slot(loop, fd);

	if (i < 0)
		return GR_ERR_RANGE;
	event.data.u64 = slot_key(loop, i);
	return epoll_ctl(loop->epoll, EPOLL_CTL_MOD, fd, &event) < 0 ? GR_ERR_IO : GR_OK;
}

void loop_remove(struct loop *loop, int fd)
{
	int i = fd < 0 ? -1 : find_slot(loop, fd);

	if (i < 0)
		return;
	epoll_ctl(loop->epoll, EPOLL_CTL_DEL, fd, NULL);
	loop->slots[i].fd = -1;
	loop->slots[i].generation++;
}

static void timer_fired(void *ctx, uint32_t events)
{
	struct loop_timer *timer = ctx;
	uint64_t expirations;

	(void)events;
	/* Nothing to read: a callback before us set the timer anew. */
	if (read(timer->fd, &expirations, sizeof expirations) != (ssize_t)sizeof expirations)
		return;
	timer->at_ns = LOOP_NEVER;
	timer->fn(timer->ctx, gr_clock_now(&gr_clock_monotonic));
}

int loop_timer_create(struct loop *loop, loop_timer_fn fn, void *ctx)
{
	int i = 0, r;

	while (i < LOOP_TIMERS && loop->timers[i].fd >= 0)
		i++;
	if (i == LOOP_TIMERS)
		return GR_ERR_RANGE;
	struct loop_timer *timer = &loop->timers[i];
	int fd = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
	if (fd < 0)
		return GR_ERR_IO;
	r = loop_add(loop, fd, EPOLLIN, timer_fired, timer);
	if (r < 0) {
		close(fd);
		return r;
	}
	*timer = (struct loop_timer){ loop, fd, LOOP_NEVER, fn, ctx };
	return i;
}

int loop_timer_set(struct loop *loop, int timer, int64_t at_ns)
{
	struct itimerspec spec = { 0 };

	if (timer < 0 || timer >= LOOP_TIMERS || loop->timers[timer].fd < 0)
		return GR_ERR_RANGE;
	if (loop->timers[timer].at_ns == at_ns)
		return GR_OK;
	loop->timers[timer].at_ns = at_ns;
	if (at_ns != LOOP_NEVER) {
		int64_t at = at_ns > 0 ? at_ns : 1; /* zero would disarm */
		spec.it_value.tv_sec = at / GR_NS_PER_S;
		spec.it_value.tv_nsec = at % GR_NS_PER_S;
	}
	return timerfd_settime(loop->timers[timer].fd, TFD_TIMER_ABSTIME, &spec, NULL) < 0 ?
		       GR_ERR_IO : GR_OK;
}

static void signal_came(void *ctx, uint32_t events)
{
	struct loop *loop = ctx;
	struct signalfd_siginfo info;

	(void)events;
	if (read(loop->signal_fd, &info, sizeof info) != (ssize_t)sizeof info)
		return;
	loop->signal = (int)info.ssi_signo;
	loop->stopped = true;
}

static const int ends[] = { SIGTERM, SIGINT, SIGHUP };
#define ENDS (sizeof ends / sizeof *ends)

bool loop_signal_waits(void)
{
	sigset_t waiting;

	if (sigpending(&waiting) < 0)
		return false;
	for (size_t i = 0; i < ENDS; i++)
		if (sigismember(&waiting, ends[i]) == 1)
			return true;
	return false;
}

int loop_catch_signals(struct loop *loop)
{
	sigset_t set;

	sigemptyset(&set);
	for (size_t i = 0; i < ENDS; i++)
		sigaddset(&set, ends[i]);
	if (sigprocmask(SIG_BLOCK, &set, NULL) < 0)
		return GR_ERR_IO;
	loop->signal_fd = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
	if (loop->signal_fd < 0)
		return GR_ERR_IO;
	return loop_add(loop, loop->signal_fd, EPOLLIN, signal_came, loop);
}

int loop_signal(const struct loop *loop)
{
	return loop->signal;
}

void loop_stop(struct loop *loop)
{
	loop->stopped = true;
}

bool loop_stopped(const struct loop *loop)
{
	return loop->stopped;
}

int loop_once(struct loop *loop, int timeout_ms)
{
	struct epoll_event events[LOOP_BATCH];
	int n = epoll_wait(loop->epoll, events, LOOP_BATCH, timeout_ms);

	if (n < 0)
		return errno == EINTR ? GR_NOTHING : GR_ERR_IO;
	for (int i = 0; i < n; i++) {
		struct loop_slot *slot = &loop->slots[events[i].data.u64 & 0xffffffffu];
		uint32_t generation = (uint32_t)(events[i].data.u64 >> 32);

		if (slot->fd >= 0 && slot->generation == generation)
			slot->fn(slot->ctx, events[i].events);
	}
	return n > 0 ? GR_OK : GR_NOTHING;
}
