#include "tracking/bind.h"

#include <math.h>
#include <string.h>

#define PRESS 0.5f   /* of an axis' way */
#define RELEASE 0.4f /* less, or a finger that trembles would press again and again */

void track_assembly_init(struct track_assembly *a, const struct gr_pose *start, unsigned parts)
{
	*a = (struct track_assembly){ .parts = parts, .T_room_body = *start };
}

static float axis_of(const struct track_report *report, unsigned index, bool negative)
{
	const float value = index < report->axis_count ? report->axes[index] : 0;

	return negative ? -value : value;
}

static uint32_t buttons_of(struct track_binding *b, const struct track_report *report)
{
	uint32_t pressed = 0;

	for (unsigned i = 0; i < b->button_count; i++) {
		const struct track_button_from *from = &b->buttons[i];
		const uint32_t bit = UINT32_C(1) << i;

		if (from->kind == TRACK_FROM_BUTTON && (report->has & TRACK_BUTTONS))
			b->held =
				report->buttons >> from->index & 1 ? b->held | bit : b->held & ~bit;
		if (from->kind == TRACK_FROM_AXIS && (report->has & TRACK_AXIS_VALUES)) {
			const float value = axis_of(report, from->index, from->negative);

			b->held = value > (b->held & bit ? RELEASE : PRESS) ? b->held | bit
									    : b->held & ~bit;
		}
		pressed |= b->held & bit;
	}
	return pressed;
}

static void take_input(struct track_binding *b, struct track_assembly *a,
		       const struct track_report *report)
{
	if (report->has & (TRACK_BUTTONS | TRACK_AXIS_VALUES)) {
		a->buttons = buttons_of(b, report);
		a->known |= TRACK_PART_INPUT;
	}
	if (!(report->has & TRACK_AXIS_VALUES))
		return;
	a->axis_count = b->axis_count;
	for (unsigned i = 0; i < b->axis_count; i++)
		a->axes[i] = b->axes[i].given
				     ? axis_of(report, b->axes[i].index, b->axes[i].negative)
				     : 0;
}

/* The parts of a pose that the binding gives and the report has, as enum track_part. */
static unsigned pose_parts(const struct track_binding *b, const struct track_report *report)
{
	unsigned parts = 0;

	if (report->has & TRACK_POSITION)
		parts |= TRACK_PART_POSITION;
	if (report->has & TRACK_ORIENTATION)
		parts |= TRACK_PART_ORIENTATION;
	return parts & b->parts;
}

static void take_pose(const struct track_binding *b, struct track_assembly *a,
		      const struct track_report *report, unsigned parts)
{
	struct gr_pose T_base_sensor = report->T_base_sensor, T_room_sensor, T_room_body;

	if (!(report->has & TRACK_POSITION))
		memset(T_base_sensor.p, 0, sizeof T_base_sensor.p);
	for (int i = 0; i < 3; i++)
		T_base_sensor.p[i] *= b->scale;
	if (!(report->has & TRACK_ORIENTATION)) {
		/* The lever arm turns with what another device says of the body. */
		struct gr_pose T_room_base, T_body_sensor;

		gr_pose_inverse(&b->T_room_base, &T_room_base);
		gr_pose_inverse(&b->T_sensor_body, &T_body_sensor);
		gr_pose_mul(&T_room_base, &a->T_room_body, &T_room_body);
		gr_pose_mul(&T_room_body, &T_body_sensor, &T_room_body);
		glm_quat_copy(T_room_body.q, T_base_sensor.q);
	}
	gr_pose_mul(&b->T_room_base, &T_base_sensor, &T_room_sensor);
	gr_pose_mul(&T_room_sensor, &b->T_sensor_body, &T_room_body);
	if (parts & TRACK_PART_POSITION)
		memcpy(a->T_room_body.p, T_room_body.p, sizeof a->T_room_body.p);
	if (parts & TRACK_PART_ORIENTATION)
		glm_quat_copy(T_room_body.q, a->T_room_body.q);
	a->known |= parts;
}

/* The part whose arrival makes a sample. */
static unsigned leading(const struct track_assembly *a)
{
	if (a->parts & TRACK_PART_POSITION)
		return TRACK_PART_POSITION;
	return a->parts & TRACK_PART_ORIENTATION ? TRACK_PART_ORIENTATION : TRACK_PART_INPUT;
}

bool track_bind(struct track_binding *b, struct track_assembly *a,
		const struct track_report *report, struct track_sample *out)
{
	const unsigned lead = leading(a) & b->parts;
	const unsigned parts = pose_parts(b, report);
	const bool lost = (report->has & TRACK_LOST) != 0;

	if (b->parts & TRACK_PART_INPUT)
		take_input(b, a, report);
	if (parts)
		take_pose(b, a, report, parts);
	if (!lead ||
	    (lead == TRACK_PART_INPUT ? !(report->has & (TRACK_BUTTONS | TRACK_AXIS_VALUES))
				      : !lost && !(parts & lead)))
		return false;
	*out = (struct track_sample){
		.time_ns = report->time_ns - b->latency_ns,
		.body = b->body,
		.T_room_body = a->T_room_body,
		.buttons = a->buttons,
		.valid = !lost,
		.axis_count = a->axis_count,
		.device_timed = (report->has & TRACK_DEVICE_TIME) != 0,
		.device_ns = report->has & TRACK_DEVICE_TIME ? report->device_ns : 0,
	};
	memcpy(out->axes, a->axes, sizeof out->axes);
	return true;
}
