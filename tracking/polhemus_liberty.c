/* What is said to a LIBERTY or PATRIOT, and what it says. */
#include "tracking/polhemus_private.h"

#include "base/result.h"

#include <stdio.h>

#define SETTLE_MS 40 /* for a command that has no answer */
#define QUIET_MS 100 /* longer than between two frames of the slowest rate */
#define DRAIN_MS 500
#define TRIES 3
#define ANSWER_MS 500

static void take_pose(struct polhemus *p, const struct track_liberty_pose *pose)
{
	struct track_polhemus_sensor sensor = {
		.sensor = pose->station,
		.has = TRACK_QUALITY | (pose->has_button ? TRACK_BUTTONS : 0u),
		.buttons = pose->button,
		.quality = pose->error ? 0 : 1,
	};

	for (int i = 0; i < 3; i++)
		sensor.place_m[i] = 0.01f * pose->place_cm[i];
	memcpy(sensor.turn, pose->turn, sizeof sensor.turn);
	polhemus_begin_frame(p, pose->frame);
	polhemus_publish(p, &sensor);
}

static void frame(struct polhemus *p, const uint8_t *bytes, size_t len)
{
	struct track_liberty_head head;
	struct track_liberty_pose pose;
	int r;

	if (!track_liberty_head(bytes, &head))
		return;
	if (!track_liberty_is_pose(&head)) {
		if (track_liberty_map(bytes, len, &p->detected, &p->active) == GR_OK)
			p->answered = true;
		return;
	}
	if (!p->running) {
		p->body = head.size;
		p->answered = p->answered || (head.command & ~0x20) == 'P';
		return;
	}
	r = track_liberty_pose(bytes, len, &pose);
	if (r < 0)
		track_device_fault(&p->device, (enum track_fault) - r);
	else
		take_pose(p, &pose);
}

static bool say(struct polhemus *p, const char *text, char *why, size_t size)
{
	return track_usb_send(&p->usb, (const uint8_t *)text, strlen(text), why, size) == GR_OK;
}

/* And waits for what it may have to say to that, which nobody wants to know. */
static bool tell(struct polhemus *p, const char *text, char *why, size_t size)
{
	if (!say(p, text, why, size))
		return false;
	(void)polhemus_drain(p, SETTLE_MS, DRAIN_MS);
	return !p->usb.woken;
}

/* It may be in the middle of a line, or sending since a program that was killed. */
static bool silence(struct polhemus *p, char *why, size_t size)
{
	for (int i = 0; i < TRIES && !p->usb.woken; i++) {
		if (!say(p, "\r", why, size) || !say(p, "p", why, size))
			return false;
		if (polhemus_drain(p, QUIET_MS, DRAIN_MS))
			return !p->usb.failed;
	}
	snprintf(why, size, "does not stop sending; switch it off and on");
	return false;
}

static bool set_hemisphere(struct polhemus *p, char *why, size_t size)
{
	char text[64];
	vec3 towards;

	if (glm_vec3_norm(p->params.hemisphere) == 0)
		return true;
	track_polhemus_from_base(p->params.hemisphere, towards);
	glm_vec3_normalize(towards);
	snprintf(text, sizeof text, "H*,%.4f,%.4f,%.4f\r", (double)towards[0], (double)towards[1],
		 (double)towards[2]);
	return tell(p, text, why, size);
}

static bool look_at_stations(struct polhemus *p, char *why, size_t size)
{
	p->answered = false;
	if (!say(p, "\x15" "0\r", why, size))
		return false;
	if (polhemus_await(p, ANSWER_MS, why, size))
		return true;
	if (!p->usb.failed)
		snprintf(why, size, "does not say which stations it has (Ctrl-U); switch it off and "
			 "on");
	return false;
}

/* Asks for a pose in this form. False: it comes in another, or not at all. */
static bool try_list(struct polhemus *p, const char *list, size_t body, char *why, size_t size)
{
	p->body = 0;
	if (!tell(p, list, why, size))
		return false;
	p->answered = false;
	if (!say(p, "P", why, size))
		return false;
	(void)polhemus_await(p, ANSWER_MS, why, size);
	/* Of other stations, too. */
	(void)polhemus_drain(p, SETTLE_MS, DRAIN_MS);
	return !p->usb.failed && p->body == body;
}

static bool set_list(struct polhemus *p, char *why, size_t size)
{
	/* The stylus' button is the last item; what has none may not know it. */
	if (try_list(p, TRACK_LIBERTY_LIST, TRACK_LIBERTY_BODY, why, size) ||
	    try_list(p, TRACK_LIBERTY_LIST_PLAIN, TRACK_LIBERTY_BODY_PLAIN, why, size))
		return true;
	if (!p->usb.failed && p->body)
		snprintf(why, size, "sends poses of %zu bytes where %d were asked for (O command)",
			 p->body, TRACK_LIBERTY_BODY_PLAIN);
	else if (!p->usb.failed)
		snprintf(why, size, "sends no pose when asked for one");
	return false;
}

static enum track_state start(struct polhemus *p, char *why, size_t size)
{
	const bool raw = !p->params.filter;

	if (!silence(p, why, size) || !tell(p, "F1\r", why, size) || !tell(p, "U1\r", why, size) ||
	    (raw && (!tell(p, "X0,1,0,0\r", why, size) || !tell(p, "Y0,1,0,0\r", why, size))) ||
	    !set_hemisphere(p, why, size) || !look_at_stations(p, why, size) ||
	    ((p->detected & p->active) && !set_list(p, why, size)) ||
	    (!(p->detected & p->active) && !tell(p, TRACK_LIBERTY_LIST, why, size)) ||
	    !say(p, "C\r", why, size))
		return p->usb.failed == LIBUSB_ERROR_NO_DEVICE ? TRACK_ABSENT : TRACK_FAILED;
	snprintf(why, size, "%s",
		 p->detected & p->active ? "" : "no sensor is plugged into it");
	return TRACK_RUNNING;
}

static void stop(struct polhemus *p)
{
	char why[TRACK_WHY];

	(void)say(p, "p", why, sizeof why);
}

const struct polhemus_talk polhemus_liberty = {
	.style = TRACK_POLHEMUS_LIBERTY,
	.start = start,
	.stop = stop,
	.frame = frame,
};
