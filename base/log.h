/*
 * Log lines. Daemons under systemd write "<priority>text" to stderr (the
 * journal reads the priority, see sd-daemon(3)); on a terminal the line is
 * "name: level: text". Lines are written whole, by one write(2).
 *
 * Thread safety: all functions but gr_log_init and gr_log_set_level may be
 * called from any thread.
 */
#ifndef GROTTO_BASE_LOG_H
#define GROTTO_BASE_LOG_H

#include <stdbool.h>
#include <stdint.h>

enum gr_log_level {
	GR_LOG_ERROR = 3, /* syslog numbers */
	GR_LOG_WARNING = 4,
	GR_LOG_NOTICE = 5,
	GR_LOG_INFO = 6,
	GR_LOG_DEBUG = 7,
};

/* `name` is kept, not copied: the process' or the node's name. */
void gr_log_init(const char *name, enum gr_log_level max_level);
void gr_log_set_level(enum gr_log_level max_level);
bool gr_log_enabled(enum gr_log_level level);

void gr_log(enum gr_log_level level, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

#define gr_error(...) gr_log(GR_LOG_ERROR, __VA_ARGS__)
#define gr_warning(...) gr_log(GR_LOG_WARNING, __VA_ARGS__)
#define gr_notice(...) gr_log(GR_LOG_NOTICE, __VA_ARGS__)
#define gr_info(...) gr_log(GR_LOG_INFO, __VA_ARGS__)
#define gr_debug(...) gr_log(GR_LOG_DEBUG, __VA_ARGS__)

/*
 * For what outsiders can cause at any rate (bad datagrams): counts every
 * event, lets one line through a minute. Returns true when the caller should
 * log now, and then stores in *out_count how many events happened since the
 * last line. now_ns is monotonic.
 */
struct gr_log_limit {
	int64_t next_ns;
	uint64_t since;
	uint64_t total;
};
bool gr_log_limit(struct gr_log_limit *limit, int64_t now_ns, uint64_t *out_count);

#endif
