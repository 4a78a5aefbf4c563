#include "base/log.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *log_name = "grotto";
static enum gr_log_level log_max = GR_LOG_INFO;
static bool log_journal;

void gr_log_init(const char *name, enum gr_log_level max_level)
{
	log_name = name;
	log_max = max_level;
	log_journal = getenv("JOURNAL_STREAM") != NULL && !isatty(STDERR_FILENO);
}

void gr_log_set_level(enum gr_log_level max_level)
{
	log_max = max_level;
}

bool gr_log_enabled(enum gr_log_level level)
{
	return level <= log_max;
}

static const char *level_name(enum gr_log_level level)
{
	switch (level) {
	case GR_LOG_ERROR: return "error: ";
	case GR_LOG_WARNING: return "warning: ";
	case GR_LOG_NOTICE:
	case GR_LOG_INFO: return "";
	case GR_LOG_DEBUG: return "debug: ";
	}
	return "";
}

void gr_log(enum gr_log_level level, const char *format, ...)
{
	char line[2048];
	const size_t room = sizeof line - 1; /* for the newline */
	va_list args;
	int n;
	size_t len;

	if (level > log_max)
		return;
	if (log_journal)
		n = snprintf(line, room, "<%d>", (int)level);
	else
		n = snprintf(line, room, "%s: %s", log_name, level_name(level));
	len = n < 0 ? 0 : (size_t)n;
	va_start(args, format);
	n = vsnprintf(line + len, room - len, format, args);
	va_end(args);
	if (n > 0)
		len += (size_t)n;
	if (len > room - 1)
		len = room - 1;
	line[len++] = '\n';
	/* A log that cannot be written cannot be reported either. */
	ssize_t ignored = write(STDERR_FILENO, line, len);
	(void)ignored;
}

bool gr_log_limit(struct gr_log_limit *limit, int64_t now_ns, uint64_t *out_count)
{
	limit->since++;
	limit->total++;
	if (limit->next_ns != 0 && now_ns < limit->next_ns)
		return false;
	*out_count = limit->since;
	limit->since = 0;
	limit->next_ns = now_ns + INT64_C(60000000000);
	return true;
}
