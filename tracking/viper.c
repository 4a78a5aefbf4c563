#include "tracking/viper.h"

#include "base/cursor.h"
#include "base/result.h"
#include "tracking/report.h"

#define SUM 4		/* bytes of the checksum */
#define POSE_HEAD 24	/* before the first sensor */
#define SENSOR 32	/* bytes */
#define REPLY_HEAD 28	/* before the payload */

uint16_t track_viper_checksum(const uint8_t *bytes, size_t len)
{
	unsigned crc = 0;

	for (size_t i = 0; i < len; i++) {
		crc ^= bytes[i];
		for (int bit = 0; bit < 8; bit++)
			crc = crc & 1 ? crc >> 1 ^ 0xA001u : crc >> 1;
	}
	return (uint16_t)crc;
}

bool track_viper_intact(const uint8_t *frame, size_t len)
{
	struct gr_reader r = gr_reader(frame + len - SUM, SUM);

	return gr_read_u32(&r) == track_viper_checksum(frame, len - SUM);
}

float track_viper_metres(uint8_t unit)
{
	static const float metres[] = { 0.0254f, 0.3048f, 0.01f, 1.0f };

	return unit < sizeof metres / sizeof *metres ? metres[unit] : 0;
}

/* The head, length and checksum that all frames have; r stands behind the head then. */
static int open_frame(const uint8_t *frame, size_t len, size_t least, char kind,
		      struct gr_reader *r)
{
	const char magic[4] = { 'V', 'P', 'R', kind };

	if (len < least)
		return -TRACK_FAULT_LENGTH;
	if (memcmp(frame, magic, sizeof magic) != 0)
		return -TRACK_FAULT_FORMAT;
	*r = gr_reader(frame, len);
	(void)gr_read_u32(r);
	if (gr_read_u32(r) != len - TRACK_VIPER_HEAD)
		return -TRACK_FAULT_LENGTH;
	return track_viper_intact(frame, len) ? GR_OK : -TRACK_FAULT_CHECKSUM;
}

static void read_sensor(struct gr_reader *r, struct track_viper_sensor *out)
{
	const uint32_t info = gr_read_u32(r);

	*out = (struct track_viper_sensor){
		.sensor = info & 0x7f,
		.copy = info >> 7 & 1,
		.position_unit = info >> 8 & 3,
		.orientation_unit = info >> 10 & 3,
		.buttons = info >> 12 & 3,
		.distortion = info >> 14 & 0xff,
	};
	for (int i = 0; i < 3; i++)
		out->place[i] = gr_read_f32(r);
	for (int i = 0; i < 4; i++)
		out->turn[i] = gr_read_f32(r);
}

int track_viper_pose(const uint8_t *frame, size_t len, struct track_viper_pose *out)
{
	struct track_viper_pose pose = { 0 };
	struct gr_reader r;
	uint32_t info, count;
	const int fault = open_frame(frame, len, POSE_HEAD + SUM, 'P', &r);

	if (fault < 0)
		return fault;
	pose.unit = gr_read_u32(&r);
	pose.frame = gr_read_u32(&r);
	info = gr_read_u32(&r);
	count = gr_read_u32(&r);
	if (count > TRACK_VIPER_SENSORS || (info & 0xf) != 0)
		return -TRACK_FAULT_FORMAT;
	if (len != POSE_HEAD + count * SENSOR + SUM)
		return -TRACK_FAULT_LENGTH;
	pose.self_test = info >> 4 & 0xf;
	pose.count = count;
	for (unsigned i = 0; i < count; i++)
		read_sensor(&r, &pose.sensors[i]);
	*out = pose;
	return GR_OK;
}

int track_viper_reply(const uint8_t *frame, size_t len, struct track_viper_reply *out)
{
	struct gr_reader r;
	const int fault = open_frame(frame, len, REPLY_HEAD + SUM, 'C', &r);

	if (fault < 0)
		return fault;
	*out = (struct track_viper_reply){ .unit = gr_read_u32(&r) };
	out->command = gr_read_u32(&r);
	out->action = gr_read_u32(&r);
	out->arg1 = gr_read_u32(&r);
	out->arg2 = gr_read_u32(&r);
	out->len = len - REPLY_HEAD - SUM;
	if (out->len > sizeof out->payload)
		out->len = sizeof out->payload;
	memcpy(out->payload, gr_read_bytes(&r, out->len), out->len);
	return GR_OK;
}

size_t track_viper_command(uint8_t out[TRACK_VIPER_COMMAND_MOST], enum track_viper_command command,
			   enum track_viper_action action, uint32_t arg1, uint32_t arg2,
			   const uint8_t *payload, size_t len)
{
	struct gr_writer w = gr_writer(out, TRACK_VIPER_COMMAND_MOST);

	gr_write_bytes(&w, "VPRC", 4);
	gr_write_u32(&w, (uint32_t)(REPLY_HEAD - TRACK_VIPER_HEAD + len + SUM));
	gr_write_u32(&w, 0); /* any unit */
	gr_write_u32(&w, command);
	gr_write_u32(&w, action);
	gr_write_u32(&w, arg1);
	gr_write_u32(&w, arg2);
	gr_write_bytes(&w, payload, len);
	gr_write_u32(&w, track_viper_checksum(out, w.len));
	return w.ok ? w.len : 0;
}
