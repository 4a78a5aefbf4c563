#include "tests/unit/mock_polhemus.h"

#include "tests/unit/polhemus_make.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void note(struct mock_polhemus *p, const char *command)
{
	if (p->command_count < MOCK_POLHEMUS_COMMANDS)
		snprintf(p->commands[p->command_count], sizeof p->commands[0], "%.31s", command);
	p->command_count++;
}

static uint32_t stations(const struct mock_polhemus *p)
{
	return p->no_sensors ? 0 : p->sensors ? p->sensors : 1;
}

/* ---- VIPER ---- */

static void reply(struct mock_polhemus *p, uint32_t command, uint32_t action, const void *payload,
		  size_t len)
{
	uint8_t bytes[MAKE_VIPER_MOST];

	mock_usb_push(p->usb, bytes, make_viper_reply(bytes, command, action, payload, len));
}

static void refuse(struct mock_polhemus *p, uint32_t command, uint32_t code, const char *text)
{
	uint8_t payload[180] = { (uint8_t)code };

	snprintf((char *)payload + 4, 128, "%s", text);
	reply(p, command, TRACK_VIPER_NAK, payload, sizeof payload);
}

static void viper_set(struct mock_polhemus *p, uint32_t command, struct gr_reader *r)
{
	switch (command) {
	case TRACK_VIPER_UNITS:
		p->units[0] = gr_read_u32(r);
		p->units[1] = gr_read_u32(r);
		break;
	case TRACK_VIPER_RATE: p->rate = gr_read_u32(r); break;
	case TRACK_VIPER_HEMISPHERE:
		p->hemisphere_bits = gr_read_u32(r);
		for (int i = 0; i < 3; i++)
			p->hemisphere[i] = gr_read_f32(r);
		break;
	case TRACK_VIPER_PREDICTION: p->predicts = gr_read_u32(r) | gr_read_u32(r); break;
	case TRACK_VIPER_FILTER: p->filter_level = gr_read_u32(r); break;
	case TRACK_VIPER_CONTINUOUS: p->sending = true; break;
	default: break;
	}
}

static void viper_command(struct mock_polhemus *p, const uint8_t *bytes, size_t len)
{
	struct track_viper_reply c; /* the same form */
	struct gr_reader r;
	uint8_t who[192] = "Mocked VIPER", map[4] = { 0 };
	char text[32];

	if (p->mute || track_viper_reply(bytes, len, &c) != 0)
		return;
	snprintf(text, sizeof text, "%u %u", c.command, c.action);
	note(p, text);
	if (p->not_ready) {
		refuse(p, c.command, TRACK_VIPER_NOT_READY, "booting");
		return;
	}
	if (p->refuses >> c.command & 1) {
		refuse(p, c.command, 2, "no such command");
		return;
	}
	r = gr_reader(c.payload, c.len);
	if (c.action == TRACK_VIPER_SET)
		viper_set(p, c.command, &r);
	if (c.command == TRACK_VIPER_CONTINUOUS && c.action == TRACK_VIPER_RESET)
		p->sending = false;
	snprintf((char *)who + 64, 32, "%s", p->serial ? p->serial : "V0001");
	map[0] = (uint8_t)stations(p);
	map[1] = (uint8_t)(stations(p) >> 8);
	map[3] = 1;
	if (c.command == TRACK_VIPER_WHO_AM_I)
		reply(p, c.command, TRACK_VIPER_ACK, who, sizeof who);
	else if (c.command == TRACK_VIPER_STATION_MAP)
		reply(p, c.command, TRACK_VIPER_ACK, map, sizeof map);
	else
		reply(p, c.command, TRACK_VIPER_ACK, NULL, 0);
}

/* ---- LIBERTY ---- */

#define POSES_MOST (MAKE_LIBERTY_MOST * TRACK_LIBERTY_STATIONS)

static size_t liberty_poses(struct mock_polhemus *p, uint8_t command, uint8_t bytes[POSES_MOST])
{
	static const char text[] = "01 1.0 2.0 3.0 4.0\r\n", other[] = "LY\1P \0\x0c\0abcdefghijkl";
	const char *what = (p->product & 0xff00) == 0xef00 ? "PA" : "LY";
	const float scale = p->centimetres ? 100 : 1 / 0.0254f;
	size_t len = 0;

	for (unsigned i = 0; i < TRACK_LIBERTY_STATIONS; i++)
		if (stations(p) >> i & 1)
			len += make_liberty_pose(bytes + len, what, command, i, p->frame, scale,
						 p->body == TRACK_LIBERTY_BODY);
	p->frame++;
	if (p->binary && p->body)
		return len;
	memcpy(bytes, p->binary ? other : text, 20);
	return stations(p) ? 20 : 0;
}

static void liberty_line(struct mock_polhemus *p, const char *line)
{
	const uint8_t map[12] = { 'L', 'Y', 0, 21, ' ', 0, 4, 0, (uint8_t)stations(p),
				  (uint8_t)(stations(p) >> 8), 0xff, 0xff };

	note(p, line);
	if (!strcmp(line, "F1"))
		p->binary = true;
	else if (!strcmp(line, "U1"))
		p->centimetres = true;
	else if (!strcmp(line, "\x15" "0"))
		mock_usb_push(p->usb, map, sizeof map);
	else if (!strcmp(line, "O*,8,9,11,3,7,10") && !p->no_button && !p->other_list)
		p->body = TRACK_LIBERTY_BODY;
	else if (!strcmp(line, "O*,8,9,11,3,7") && !p->other_list)
		p->body = TRACK_LIBERTY_BODY_PLAIN;
	else if (line[0] == 'O')
		mock_usb_push(p->usb, (const uint8_t *)"*INVALID COMMAND\r\n", 18);
	else if (line[0] == 'H')
		sscanf(line, "H*,%f,%f,%f", &p->hemisphere[0], &p->hemisphere[1], &p->hemisphere[2]);
	else if (!strcmp(line, "X0,1,0,0") || !strcmp(line, "Y0,1,0,0"))
		p->filter_level = 0;
	else if (!strcmp(line, "C"))
		p->sending = true;
}

static void liberty_bytes(struct mock_polhemus *p, const uint8_t *bytes, size_t len)
{
	uint8_t poses[POSES_MOST];

	if (p->mute)
		return;
	for (size_t i = 0; i < len; i++) {
		if (p->pending_len == 0 && (bytes[i] == 'p' || bytes[i] == 'P')) {
			note(p, (const char[]){ (char)bytes[i], 0 });
			p->sending = false;
			mock_usb_push(p->usb, poses, liberty_poses(p, 'P', poses));
		} else if (bytes[i] == '\r') {
			p->pending[p->pending_len] = '\0';
			p->pending_len = 0;
			liberty_line(p, (const char *)p->pending);
		} else if (p->pending_len < sizeof p->pending - 1) {
			p->pending[p->pending_len++] = bytes[i];
		}
	}
}

/* ---- both ---- */

/* A transfer that fills its last packet goes on until one comes that is not full. */
static int sent(void *ctx, const uint8_t *bytes, size_t len)
{
	struct mock_polhemus *p = ctx;

	pthread_mutex_lock(&p->lock);
	p->empty_packets += len == 0;
	if (!p->viper) {
		liberty_bytes(p, bytes, len);
	} else if (p->pending_len + len <= sizeof p->pending) {
		if (len)
			memcpy(p->pending + p->pending_len, bytes, len);
		p->pending_len += len;
		if (len % p->packet != 0 || len == 0) {
			viper_command(p, p->pending, p->pending_len);
			p->pending_len = 0;
		}
	}
	pthread_mutex_unlock(&p->lock);
	return 0;
}

/* What never stops has the next frame ready whenever it is asked. */
static size_t idle(void *ctx, uint8_t *bytes, size_t room)
{
	struct mock_polhemus *p = ctx;
	size_t len = 0;

	pthread_mutex_lock(&p->lock);
	if (p->never_stops && room >= MAKE_LIBERTY_MOST)
		len = make_liberty_pose(bytes, "LY", 'C', 0, p->frame++, 100, true);
	pthread_mutex_unlock(&p->lock);
	return len;
}

void mock_polhemus_plug(struct mock_polhemus *p, UMockdevTestbed *bed)
{
	pthread_mutexattr_t recursive;

	p->product = p->product ? p->product : p->viper ? 0xbf01 : 0xff20;
	p->number = p->number ? p->number : 2;
	p->packet = p->packet ? p->packet : 64;
	p->predicts = 3;
	p->filter_level = 2;
	p->pending_len = 0;
	/* As it was left by a program that was killed, or as it comes up. */
	p->binary = p->sending;
	p->centimetres = p->sending;
	p->body = p->sending ? TRACK_LIBERTY_BODY : 0;
	/* An answer that is pushed has the node ask for more, from the same thread. */
	pthread_mutexattr_init(&recursive);
	pthread_mutexattr_settype(&recursive, PTHREAD_MUTEX_RECURSIVE);
	pthread_mutex_init(&p->lock, &recursive);
	pthread_mutexattr_destroy(&recursive);
	const struct mock_usb_params params = {
		.bus = 1,
		.number = p->number,
		.vendor = 0x0f44,
		.product = p->product,
		.in = p->no_endpoints ? 0 : 0x88,
		.out = 0x04,
		.packet = p->packet,
		.serial = p->usb_serial,
		.unconfigured = p->unconfigured,
		.denied = p->denied,
		.busy = p->busy,
		.sent = sent,
		.idle = idle,
		.ctx = p,
	};
	p->usb = mock_usb_create(bed, &params);
	mock_usb_plug(p->usb);
}

void mock_polhemus_unplug(struct mock_polhemus *p)
{
	mock_usb_unplug(p->usb);
	pthread_mutex_lock(&p->lock);
	p->sending = false;
	pthread_mutex_unlock(&p->lock);
}

void mock_polhemus_finish(struct mock_polhemus *p)
{
	if (!p->usb)
		return;
	mock_usb_free(&p->usb);
	pthread_mutex_destroy(&p->lock);
}

void mock_polhemus_tick(struct mock_polhemus *p)
{
	uint8_t bytes[POSES_MOST];
	size_t len = 0;

	_Static_assert(sizeof bytes >= MAKE_VIPER_MOST, "either");
	pthread_mutex_lock(&p->lock);
	if (p->sending)
		len = p->viper ? make_viper_pose(bytes, p->frame++, stations(p))
			       : liberty_poses(p, 'C', bytes);
	pthread_mutex_unlock(&p->lock);
	/* After the lock: what is sent to the device takes the two in the other order. */
	mock_usb_push(p->usb, bytes, len);
}

bool mock_polhemus_sends(struct mock_polhemus *p)
{
	pthread_mutex_lock(&p->lock);
	const bool sends = p->sending;
	pthread_mutex_unlock(&p->lock);
	return sends;
}

unsigned mock_polhemus_heard(struct mock_polhemus *p, const char *command)
{
	unsigned count = 0;

	pthread_mutex_lock(&p->lock);
	for (unsigned i = 0; i < p->command_count && i < MOCK_POLHEMUS_COMMANDS; i++)
		count += !strcmp(p->commands[i], command);
	pthread_mutex_unlock(&p->lock);
	return count;
}
