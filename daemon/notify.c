#include "daemon/notify.h"

#include "base/clock.h"

#include <stdarg.h>
#include <stdio.h>
#include <systemd/sd-daemon.h>

void notify_init(struct notify *notify)
{
	uint64_t limit_us = 0;

	*notify = (struct notify){ 0 };
	if (sd_watchdog_enabled(0, &limit_us) > 0 && limit_us < UINT64_C(1) << 40)
		notify->interval_ns = (int64_t)limit_us * GR_NS_PER_US / 4;
}

static void send_status(const char *before, const char *format, va_list args)
{
	char text[512];
	int n = snprintf(text, sizeof text, "%sSTATUS=", before);

	vsnprintf(text + n, sizeof text - (size_t)n, format, args);
	sd_notify(0, text);
}

void notify_ready(const char *format, ...)
{
	va_list args;

	va_start(args, format);
	send_status("READY=1\n", format, args);
	va_end(args);
}

void notify_status(const char *format, ...)
{
	va_list args;

	va_start(args, format);
	send_status("", format, args);
	va_end(args);
}

void notify_stopping(void)
{
	sd_notify(0, "STOPPING=1");
}

void notify_feed(struct notify *notify, int64_t now_ns)
{
	if (notify->interval_ns == 0)
		return;
	if (notify->last_ns != 0 && now_ns - notify->last_ns < notify->interval_ns)
		return;
	notify->last_ns = now_ns;
	sd_notify(0, "WATCHDOG=1");
}

int64_t notify_next(const struct notify *notify, int64_t now_ns)
{
	return notify->interval_ns ? now_ns + notify->interval_ns : INT64_MAX;
}
