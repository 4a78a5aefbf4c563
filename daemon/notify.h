/*
 * What the service manager hears (sd_notify(3)): READY, STATUS, WATCHDOG,
 * STOPPING. Without a manager every call does nothing.
 *
 * The watchdog is fed by proof of work, never by a bare timer: by frames that
 * were swapped, and by waiting for a peer, which is healthy. A daemon that
 * stops doing either is restarted by the manager.
 *
 * Thread: the loop's.
 */
#ifndef GROTTO_DAEMON_NOTIFY_H
#define GROTTO_DAEMON_NOTIFY_H

#include <stdint.h>

struct notify {
	int64_t interval_ns; /* between two WATCHDOG=1 at most half the limit; 0: no watchdog */
	int64_t last_ns;
};

void notify_init(struct notify *notify);
void notify_ready(const char *format, ...) __attribute__((format(printf, 1, 2)));
void notify_status(const char *format, ...) __attribute__((format(printf, 1, 2)));
void notify_stopping(void);
/* Feeds the watchdog when it is time to; cheap to call every frame. */
void notify_feed(struct notify *notify, int64_t now_ns);
/* When a daemon that waits for its peer should call notify_feed again; INT64_MAX without watchdog. */
int64_t notify_next(const struct notify *notify, int64_t now_ns);

#endif
