/* What is said to a VIPER, and what it says. */
#include "tracking/polhemus_private.h"

#include "base/cursor.h"
#include "base/result.h"

#include <stdio.h>

#define ANSWER_MS 400
#define TRIES 2
#define FILTER_BOTH 0 /* arg2 of the filter command: position and orientation */

static void take_pose(struct polhemus *p, const struct track_viper_pose *pose)
{
	polhemus_begin_frame(p, pose->frame);
	for (unsigned i = 0; i < pose->count; i++) {
		const struct track_viper_sensor *raw = &pose->sensors[i];
		const float metres = track_viper_metres(raw->position_unit);
		struct track_polhemus_sensor sensor = {
			.sensor = raw->sensor,
			.has = TRACK_BUTTONS | TRACK_QUALITY,
			.buttons = raw->buttons,
			.quality = 1.0f - (float)raw->distortion / 255.0f,
		};

		if (raw->copy || raw->sensor >= TRACK_VIPER_SENSORS) {
			track_device_fault(&p->device, TRACK_FAULT_SENSOR);
			continue;
		}
		/* Angles: it was told otherwise meanwhile. */
		if (raw->orientation_unit != TRACK_VIPER_QUATERNION) {
			track_device_fault(&p->device, TRACK_FAULT_FORMAT);
			continue;
		}
		for (int k = 0; k < 3; k++)
			sensor.place_m[k] = metres * raw->place[k];
		memcpy(sensor.turn, raw->turn, sizeof sensor.turn);
		polhemus_publish(p, &sensor);
	}
}

static void frame(struct polhemus *p, const uint8_t *bytes, size_t len)
{
	struct track_viper_reply reply;
	struct track_viper_pose pose;
	int r;

	if (bytes[3] == 'C') {
		if (track_viper_reply(bytes, len, &reply) == GR_OK && !p->answered &&
		    reply.action >= TRACK_VIPER_ACK) {
			p->reply = reply;
			p->answered = true;
		}
		return;
	}
	if (!p->running)
		return;
	r = track_viper_pose(bytes, len, &pose);
	if (r < 0)
		track_device_fault(&p->device, (enum track_fault) - r);
	else
		take_pose(p, &pose);
}

static void refused(const struct polhemus *p, const char *what, char *why, size_t size)
{
	struct gr_reader r = gr_reader(p->reply.payload, p->reply.len);
	const uint32_t code = gr_read_u32(&r);
	const size_t len = gr_reader_left(&r) < 128 ? gr_reader_left(&r) : 128;
	const uint8_t *text = gr_read_bytes(&r, len);
	char said[129] = "";
	size_t n = 0;

	for (size_t i = 0; text && i < len && text[i]; i++)
		if (text[i] >= 0x20 && text[i] < 0x7f)
			said[n++] = (char)text[i];
	said[n] = '\0';
	if (code == TRACK_VIPER_NOT_READY)
		snprintf(why, size, "not ready yet: it starts up or tests itself");
	else
		snprintf(why, size, "refuses %s%s%s", what, n ? ": " : "", said);
}

struct question {
	enum track_viper_command command;
	enum track_viper_action action;
	uint32_t arg1, arg2;
	const uint8_t *payload;
	size_t len;
	const char *what;
};

/* True when it was done; the reply is in p->reply. */
static bool ask(struct polhemus *p, const struct question *q, char *why, size_t size)
{
	uint8_t bytes[TRACK_VIPER_COMMAND_MOST];
	const size_t len = track_viper_command(bytes, q->command, q->action, q->arg1, q->arg2,
					       q->payload, q->len);

	snprintf(why, size, "does not answer; switch it off and on");
	for (int i = 0; i < TRIES && !p->usb.woken; i++) {
		p->answered = false;
		if (track_usb_send(&p->usb, bytes, len, why, size) < 0)
			return false;
		/* A late answer to what was asked before is not this one's. */
		while (polhemus_await(p, ANSWER_MS, why, size)) {
			if (p->reply.command != q->command) {
				p->answered = false;
				continue;
			}
			if (p->reply.action == TRACK_VIPER_NAK) {
				refused(p, q->what, why, size);
				return false;
			}
			why[0] = '\0';
			return true;
		}
		if (p->usb.failed)
			return false;
	}
	return false;
}

static bool stop_sending(struct polhemus *p, char *why, size_t size)
{
	const struct question q = { TRACK_VIPER_CONTINUOUS, TRACK_VIPER_RESET, 0, 0, NULL, 0,
				    "to stop sending" };

	return ask(p, &q, why, size);
}

static bool who_are_you(struct polhemus *p, char *why, size_t size)
{
	const struct question q = { TRACK_VIPER_WHO_AM_I, TRACK_VIPER_GET, 0, 0, NULL, 0,
				    "to say who it is" };
	size_t n = 0;

	if (!ask(p, &q, why, size))
		return false;
	/* 64 characters of name, 32 of serial number, filled up with blanks or zeroes. */
	for (size_t i = 64; i < 96 && i < p->reply.len && p->reply.payload[i]; i++)
		if (p->reply.payload[i] > 0x20 && p->reply.payload[i] < 0x7f)
			p->said_serial[n++] = (char)p->reply.payload[i];
	p->said_serial[n] = '\0';
	return true;
}

static bool set_units_and_rate(struct polhemus *p, char *why, size_t size)
{
	static const int rates_hz[] = { 30, 60, 120, 240, 480, 960 };
	uint8_t units[8], rate[4];
	struct gr_writer u = gr_writer(units, sizeof units), w = gr_writer(rate, sizeof rate);
	const struct question ask_units = { TRACK_VIPER_UNITS, TRACK_VIPER_SET, 0, 0, units,
					    sizeof units, "metres and quaternions" };
	const struct question ask_rate = { TRACK_VIPER_RATE, TRACK_VIPER_SET, 0, 0, rate,
					   sizeof rate, "its rate (polhemus.rate_hz)" };
	uint32_t index = 0;

	while (index < 5 && rates_hz[index] != p->params.rate_hz)
		index++;
	gr_write_u32(&u, TRACK_VIPER_METRES);
	gr_write_u32(&u, TRACK_VIPER_QUATERNION);
	gr_write_u32(&w, index);
	return ask(p, &ask_units, why, size) && ask(p, &ask_rate, why, size);
}

static bool set_hemisphere(struct polhemus *p, char *why, size_t size)
{
	uint8_t payload[16];
	struct gr_writer w = gr_writer(payload, sizeof payload);
	const struct question q = { TRACK_VIPER_HEMISPHERE, TRACK_VIPER_SET, TRACK_VIPER_ALL, 0,
				    payload, sizeof payload, "the hemisphere" };
	vec3 towards;

	if (glm_vec3_norm(p->params.hemisphere) == 0)
		return true;
	track_polhemus_from_base(p->params.hemisphere, towards);
	glm_vec3_normalize(towards);
	gr_write_u32(&w, p->params.follow ? 1 : 0);
	for (int i = 0; i < 3; i++)
		gr_write_f32(&w, towards[i]);
	return ask(p, &q, why, size);
}

/* Prediction and filter off. An older device may not know these; then it is said. */
static bool set_raw(struct polhemus *p, char *note, size_t note_size, char *why, size_t size)
{
	uint8_t off[12] = { 0 }, none[20] = { 0 };
	struct gr_writer w = gr_writer(off + 8, 4);
	const struct question predict = { TRACK_VIPER_PREDICTION, TRACK_VIPER_SET, TRACK_VIPER_ALL,
					  0, off, sizeof off, "to predict nothing" };
	const struct question filter = { TRACK_VIPER_FILTER, TRACK_VIPER_SET, TRACK_VIPER_ALL,
					 FILTER_BOTH, none, sizeof none, "to filter nothing" };

	gr_write_f32(&w, 0.02f); /* the time that it has by itself, and does not use now */
	if (!p->params.filter && !ask(p, &filter, why, size)) {
		if (!p->answered)
			return false;
		snprintf(note, note_size, "its own filter stays as it is, it %s", why);
	}
	if (!ask(p, &predict, why, size)) {
		if (!p->answered)
			return false;
		snprintf(note, note_size, "its own prediction stays as it is, it %s", why);
	}
	return true;
}

static bool look_at_stations(struct polhemus *p, char *note, size_t note_size, char *why,
			     size_t size)
{
	const struct question q = { TRACK_VIPER_STATION_MAP, TRACK_VIPER_GET, 0, 0, NULL, 0,
				    "to say what is plugged into it" };
	struct gr_reader r;
	uint32_t map;

	if (!ask(p, &q, why, size))
		return p->answered; /* refused: so be it */
	r = gr_reader(p->reply.payload, p->reply.len);
	map = gr_read_u32(&r);
	if (r.ok && !(map & 0xffff))
		snprintf(note, note_size, "no sensor is plugged into it");
	else if (r.ok && !(map >> 24 & 0xf))
		snprintf(note, note_size, "no source is plugged into it");
	return true;
}

static enum track_state start(struct polhemus *p, char *why, size_t size)
{
	const struct question go = { TRACK_VIPER_CONTINUOUS, TRACK_VIPER_SET, 0, 0, NULL, 0,
				     "to send" };
	char note[TRACK_WHY] = "";

	if (!stop_sending(p, why, size) || !who_are_you(p, why, size) ||
	    !set_units_and_rate(p, why, size) || !set_hemisphere(p, why, size) ||
	    !set_raw(p, note, sizeof note, why, size) ||
	    !look_at_stations(p, note, sizeof note, why, size) || !ask(p, &go, why, size))
		return p->usb.failed == LIBUSB_ERROR_NO_DEVICE ? TRACK_ABSENT : TRACK_FAILED;
	snprintf(why, size, "%s", note);
	return TRACK_RUNNING;
}

static void stop(struct polhemus *p)
{
	uint8_t bytes[TRACK_VIPER_COMMAND_MOST];
	char why[TRACK_WHY];
	const size_t len = track_viper_command(bytes, TRACK_VIPER_CONTINUOUS, TRACK_VIPER_RESET, 0,
					       0, NULL, 0);

	(void)track_usb_send(&p->usb, bytes, len, why, sizeof why);
}

const struct polhemus_talk polhemus_viper = {
	.style = TRACK_POLHEMUS_VIPER,
	.says_serial = true,
	.start = start,
	.stop = stop,
	.frame = frame,
};
