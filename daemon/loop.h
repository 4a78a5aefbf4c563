/*
 * An event loop on epoll: file descriptors, absolute timers (timerfd) and
 * the signals that ask for the end (signalfd). All tables have a fixed size;
 * nothing is allocated after loop_create.
 *
 * Thread: one thread owns a loop. Callbacks run inside loop_once and may
 * add, change and remove any descriptor or timer, themselves included.
 */
#ifndef GROTTO_DAEMON_LOOP_H
#define GROTTO_DAEMON_LOOP_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/epoll.h>

#define LOOP_FDS 64
#define LOOP_TIMERS 16
#define LOOP_NEVER INT64_MAX

struct loop;
/* events: EPOLLIN, EPOLLOUT, EPOLLHUP, ... */
typedef void (*loop_fd_fn)(void *ctx, uint32_t events);
typedef void (*loop_timer_fn)(void *ctx, int64_t now_ns);

int loop_create(struct loop **out);
/* Closes what the loop opened (timers, signals), not the descriptors added. */
void loop_destroy(struct loop **loop);

/* GR_OK; GR_ERR_RANGE when the table is full or fd is in it; GR_ERR_IO. */
int loop_add(struct loop *loop, int fd, uint32_t events, loop_fd_fn fn, void *ctx);
int loop_modify(struct loop *loop, int fd, uint32_t events);
/* Before the descriptor is closed. An event of it that is already read is not delivered. */
void loop_remove(struct loop *loop, int fd);

/* A timer that is not armed; its number (>= 0) or a negative result. */
int loop_timer_create(struct loop *loop, loop_timer_fn fn, void *ctx);
/* Fires once when CLOCK_MONOTONIC reaches at_ns (at once when it is past); LOOP_NEVER disarms. */
int loop_timer_set(struct loop *loop, int timer, int64_t at_ns);

/*
 * SIGTERM, SIGINT and SIGHUP stop the loop. Blocks them for the calling
 * thread and those that it will make: call it before any library starts one.
 */
int loop_catch_signals(struct loop *loop);
/* One of these has come, and waits for loop_once: for work that is long. Any loop's. */
bool loop_signal_waits(void);
/* The signal that stopped the loop, 0 for none. */
int loop_signal(const struct loop *loop);

void loop_stop(struct loop *loop);
bool loop_stopped(const struct loop *loop);

/*
 * Waits for events (timeout_ms -1: until there is one, 0: not at all) and
 * runs their callbacks. GR_OK, GR_NOTHING when none came, GR_ERR_IO.
 */
int loop_once(struct loop *loop, int timeout_ms);

#endif
