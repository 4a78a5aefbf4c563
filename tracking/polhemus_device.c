/* The life of a Polhemus tracker; what is said to it is in polhemus_viper.c, polhemus_liberty.c. */
#include "tracking/polhemus_private.h"

#include "base/result.h"

#include <stdio.h>
#include <stdlib.h>

#define SILENCE_NS (2 * GR_NS_PER_S) /* then it is set up again */

/* ---- what comes ---- */

void polhemus_take(void *ctx, const uint8_t *bytes, size_t len)
{
	struct polhemus *p = ctx;
	const uint8_t *frame;
	size_t frame_len;
	int r;

	while (len > 0) {
		const size_t n = track_polhemus_stream_push(&p->stream, bytes, len);

		bytes += n;
		len -= n;
		while ((r = track_polhemus_stream_next(&p->stream, &frame, &frame_len)) !=
		       GR_NOTHING) {
			if (r == GR_OK) {
				p->heard_ns = track_device_now(&p->device);
				p->talk->frame(p, frame, frame_len);
			} else if (p->running) {
				track_device_fault(&p->device, (enum track_fault) - r);
			}
		}
	}
}

void polhemus_begin_frame(struct polhemus *p, uint32_t number)
{
	struct track_report report;
	uint64_t missed;
	const uint32_t lost = track_polhemus_frame(&p->state, number,
						   track_device_now(&p->device), &missed);

	track_device_missed(&p->device, missed);
	for (unsigned i = 0; i < TRACK_POLHEMUS_SENSORS; i++) {
		if (!(lost >> i & 1))
			continue;
		track_polhemus_lost(&p->state, i, &report);
		(void)track_device_publish(&p->device, &report);
	}
}

void polhemus_publish(struct polhemus *p, const struct track_polhemus_sensor *sensor)
{
	struct track_report report;

	track_polhemus_report(&p->state, sensor, &report);
	(void)track_device_publish(&p->device, &report);
}

/* ---- for the dialogues ---- */

bool polhemus_await(struct polhemus *p, int timeout_ms, char *why, size_t size)
{
	const int64_t end_ns = track_device_now(&p->device) + timeout_ms * GR_NS_PER_MS;
	int64_t left_ns;

	while (!p->answered && (left_ns = end_ns - track_device_now(&p->device)) > 0) {
		const int ms = (int)((left_ns + GR_NS_PER_MS - 1) / GR_NS_PER_MS);

		if (track_usb_receive(&p->usb, track_device_wake_fd(&p->device), ms, why, size) < 0)
			return false;
		if (p->usb.woken)
			break;
	}
	return p->answered;
}

bool polhemus_drain(struct polhemus *p, int quiet_ms, int most_ms)
{
	const int64_t end_ns = track_device_now(&p->device) + most_ms * GR_NS_PER_MS;
	char why[TRACK_WHY];
	int r;

	do {
		r = track_usb_receive(&p->usb, track_device_wake_fd(&p->device), quiet_ms, why,
				      sizeof why);
	} while (r == GR_OK && !p->usb.woken && track_device_now(&p->device) < end_ns);
	return r != GR_OK;
}

enum track_state polhemus_start(struct polhemus *p, char *why, size_t size)
{
	enum track_state state;

	p->running = false;
	track_polhemus_stream_begin(&p->stream, p->talk->style);
	state = p->talk->start(p, why, size);
	p->heard_ns = track_device_now(&p->device);
	track_polhemus_begin(&p->state, p->rate_hz);
	p->running = state == TRACK_RUNNING;
	return state;
}

void polhemus_be_silent(struct polhemus *p)
{
	p->running = false;
	if (p->usb.failed)
		return;
	p->talk->stop(p);
	(void)polhemus_drain(p, 20, 200);
}

/* ---- the calls ---- */

static void close_polhemus(struct track_device *device)
{
	struct polhemus *p = (struct polhemus *)device;

	polhemus_be_silent(p);
	track_usb_end(&p->usb);
	p->node = NULL;
}

static enum track_state open_polhemus(struct track_device *device, char *why, size_t size)
{
	return polhemus_find((struct polhemus *)device, why, size);
}

static int read_polhemus(struct track_device *device, int timeout_ms, char *why, size_t size)
{
	struct polhemus *p = (struct polhemus *)device;
	const int r = track_usb_receive(&p->usb, track_device_wake_fd(device), timeout_ms, why, size);

	/* Bytes that are no frames are silence, too. */
	if (r < 0 || track_device_now(device) - p->heard_ns < SILENCE_NS)
		return r;
	/* It may have been switched off and on, or told to stop by its own panel. */
	switch (polhemus_start(p, why, size)) {
	case TRACK_RUNNING: return GR_NOTHING;
	case TRACK_ABSENT: return GR_ERR_IO;
	default: return GR_ERR_STATE;
	}
}

static void destroy_polhemus(struct track_device *device)
{
	free(device);
}

static const char *const sensors[] = { "1", "2",  "3",	"4",  "5",  "6",  "7",	"8",  "9",
				       "10", "11", "12", "13", "14", "15", "16", NULL };
static const char *const stylus_buttons[] = { "button", "button2", NULL };
static const char *const no_axes[] = { NULL };

#define OPS(kind_)                                                                               \
	{ .kind = kind_, .subsystem = "usb", .sensors = sensors, .buttons = stylus_buttons,      \
	  .axes = no_axes, .open = open_polhemus, .read = read_polhemus, .close = close_polhemus, \
	  .destroy = destroy_polhemus }

static const struct track_device_ops ops[TRACK_POLHEMUS_MODELS] = {
	[TRACK_POLHEMUS_MODEL_VIPER] = OPS("viper"),
	[TRACK_POLHEMUS_MODEL_LIBERTY] = OPS("liberty"),
	[TRACK_POLHEMUS_MODEL_PATRIOT] = OPS("patriot"),
};

static bool copy_text(char *to, size_t size, const char *from)
{
	const size_t len = from ? strlen(from) : 0;

	if (len >= size)
		return false;
	memcpy(to, from ? from : "", len + 1);
	return true;
}

int track_polhemus_create(struct track_device **out, const struct track_polhemus_params *params,
			  const struct gr_clock *clock)
{
	static const int rates_hz[] = { 30, 60, 120, 240, 480, 960 };
	const struct polhemus_model *m = &polhemus_models[params->model];
	bool known = m->talk != &polhemus_viper;
	struct polhemus *p;
	int r;

	for (size_t i = 0; i < sizeof rates_hz / sizeof *rates_hz; i++)
		known = known || params->rate_hz == rates_hz[i];
	if (!known)
		return GR_ERR_RANGE;
	r = track_device_alloc(&p, sizeof *p, &ops[params->model], clock);
	if (r < 0)
		return r;
	*out = &p->device;
	p->talk = m->talk;
	p->params = *params;
	p->params.serial = p->params.path = NULL;
	p->rate_hz = m->talk == &polhemus_viper ? params->rate_hz : m->rate_hz;
	if (copy_text(p->serial, sizeof p->serial, params->serial) &&
	    copy_text(p->path, sizeof p->path, params->path))
		return GR_OK;
	track_device_destroy(out);
	return GR_ERR_RANGE;
}
