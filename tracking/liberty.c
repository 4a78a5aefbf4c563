#include "tracking/liberty.h"

#include "base/cursor.h"
#include "base/result.h"
#include "tracking/report.h"

bool track_liberty_head(const uint8_t *b, struct track_liberty_head *out)
{
	const bool known = (b[0] == 'L' && (b[1] == 'Y' || b[1] == 'U')) ||
			   (b[0] == 'P' && b[1] == 'A');

	*out = (struct track_liberty_head){
		.station = b[2],
		.command = b[3],
		.error = b[4],
		.size = (uint16_t)(b[6] | b[7] << 8),
	};
	if (!known || out->station > TRACK_LIBERTY_STATIONS)
		return false;
	return out->size <= (track_liberty_is_pose(out) ? TRACK_LIBERTY_POSE_MOST
							: TRACK_LIBERTY_BODY_MOST);
}

bool track_liberty_is_pose(const struct track_liberty_head *head)
{
	return (head->command & ~0x20) == 'C' || (head->command & ~0x20) == 'P';
}

static int open_frame(const uint8_t *frame, size_t len, struct track_liberty_head *head,
		      struct gr_reader *body)
{
	if (len < TRACK_LIBERTY_HEAD)
		return -TRACK_FAULT_LENGTH;
	if (!track_liberty_head(frame, head))
		return -TRACK_FAULT_FORMAT;
	if (len != TRACK_LIBERTY_HEAD + (size_t)head->size)
		return -TRACK_FAULT_LENGTH;
	*body = gr_reader(frame + TRACK_LIBERTY_HEAD, head->size);
	return GR_OK;
}

int track_liberty_pose(const uint8_t *frame, size_t len, struct track_liberty_pose *out)
{
	struct track_liberty_head head;
	struct track_liberty_pose pose = { 0 };
	struct gr_reader r;
	const int fault = open_frame(frame, len, &head, &r);

	if (fault < 0)
		return fault;
	if (!track_liberty_is_pose(&head))
		return -TRACK_FAULT_FORMAT;
	if (head.size != TRACK_LIBERTY_BODY && head.size != TRACK_LIBERTY_BODY_PLAIN)
		return -TRACK_FAULT_LENGTH;
	if (head.station < 1)
		return -TRACK_FAULT_SENSOR;
	pose.station = head.station - 1u;
	pose.error = head.error == ' ' ? 0 : head.error;
	pose.stamp_ms = gr_read_u32(&r);
	pose.frame = gr_read_u32(&r);
	pose.distortion = (int32_t)gr_read_u32(&r);
	for (int i = 0; i < 3; i++)
		pose.place_cm[i] = gr_read_f32(&r);
	for (int i = 0; i < 4; i++)
		pose.turn[i] = gr_read_f32(&r);
	pose.has_button = head.size == TRACK_LIBERTY_BODY;
	pose.button = pose.has_button && gr_read_u32(&r) != 0;
	*out = pose;
	return GR_OK;
}

int track_liberty_map(const uint8_t *frame, size_t len, uint16_t *detected, uint16_t *active)
{
	struct track_liberty_head head;
	struct gr_reader r;
	const int fault = open_frame(frame, len, &head, &r);

	if (fault < 0)
		return fault;
	if (head.command != TRACK_LIBERTY_MAP_COMMAND)
		return -TRACK_FAULT_FORMAT;
	if (head.size != 4)
		return -TRACK_FAULT_LENGTH;
	*detected = gr_read_u16(&r);
	*active = gr_read_u16(&r);
	return GR_OK;
}
