/*
 * A tracking device that does what a test says, on the test's own thread and
 * clock: what it is to open as, what it has to say.
 */
#ifndef GROTTO_TESTS_UNIT_FAKE_DEVICE_H
#define GROTTO_TESTS_UNIT_FAKE_DEVICE_H

#include "base/result.h"
#include "tracking/device.h"

#include <poll.h>
#include <stdlib.h>

#define FAKE_QUEUE 4096

struct fake_device {
	struct track_device device;
	enum track_state opens_as;
	bool gone; /* the next read fails */
	struct track_report queue[FAKE_QUEUE];
	size_t queued, said;
	int opened, closed;
	bool waits; /* read blocks until the thread is woken */
};

static enum track_state fake_open(struct track_device *device, char *why, size_t size)
{
	struct fake_device *f = (struct fake_device *)device;

	snprintf(why, size, "%s", f->opens_as == TRACK_RUNNING ? "opened" : "not now");
	f->opened += f->opens_as == TRACK_RUNNING;
	return f->opens_as;
}

static int fake_read(struct track_device *device, int timeout_ms, char *why, size_t size)
{
	struct fake_device *f = (struct fake_device *)device;
	struct pollfd wake = { .fd = track_device_wake_fd(device), .events = POLLIN };

	if (f->gone) {
		f->gone = false;
		snprintf(why, size, "unplugged");
		return GR_ERR_IO;
	}
	if (f->waits)
		(void)poll(&wake, 1, timeout_ms);
	if (f->said == f->queued)
		return GR_NOTHING;
	(void)track_device_publish(device, &f->queue[f->said++]);
	return GR_OK;
}

static void fake_close(struct track_device *device)
{
	((struct fake_device *)device)->closed++;
}

static void fake_destroy(struct track_device *device)
{
	free(device);
}

static const char *const fake_sensors[] = { "a", "b", NULL };
static const char *const fake_buttons[] = { "one", "two", NULL };
static const char *const fake_axes[] = { "x", "y", "trigger", NULL };

static const struct track_device_ops fake_ops = {
	.kind = "fake",
	.sensors = fake_sensors,
	.buttons = fake_buttons,
	.axes = fake_axes,
	.open = fake_open,
	.read = fake_read,
	.close = fake_close,
	.destroy = fake_destroy,
};

struct fake_clock {
	int64_t now_ns;
	struct gr_clock clock;
};

static int64_t fake_now(void *ctx)
{
	return ((struct fake_clock *)ctx)->now_ns;
}

static inline struct fake_device *fake_create(struct fake_clock *clock)
{
	struct fake_device *f;

	clock->clock = (struct gr_clock){ fake_now, clock };
	if (track_device_alloc(&f, sizeof *f, &fake_ops, &clock->clock) < 0)
		abort();
	f->opens_as = TRACK_RUNNING;
	return f;
}

/* A whole report of sensor 0 at x metres, at a device time. */
static inline struct track_report fake_report(int64_t device_ns, float x)
{
	return (struct track_report){
		.device_ns = device_ns,
		.has = TRACK_POSITION | TRACK_ORIENTATION | TRACK_DEVICE_TIME,
		.T_base_sensor = { { x, 1, 2 }, { 0, 0, 0, 1 } },
	};
}

#endif
