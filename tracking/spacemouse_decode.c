/* The SpaceMouse's bytes, and the pose that its cap moves. Pure. */
#include "tracking/spacemouse.h"

#include "base/cursor.h"
#include "base/result.h"

#include <math.h>

#define FULL 350.0f
#define ZONE 0.05f
#define PITCH_MOST 1.5f /* rad; beyond straight up heading and roll would be one */
#define STEP_S 0.1

enum report { MOVE = 1, TURN = 2, BUTTONS = 3, BATTERY = 0x17 };

const char *const track_spacemouse_buttons[TRACK_SPACEMOUSE_BUTTONS + 1] = {
	"1",  "2",  "3",  "4",	"5",  "6",  "7",  "8",	"9",  "10", "11",
	"12", "13", "14", "15", "16", "17", "18", "19", "20", "21", "22",
	"23", "24", "25", "26", "27", "28", "29", "30", "31", NULL,
};

static void read_vector(struct gr_reader *r, int16_t out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = (int16_t)gr_read_u16(r);
}

static bool fits(unsigned number, size_t len)
{
	switch (number) {
	case MOVE: return len == 7 || len == 13;
	case TURN: return len == 7;
	case BUTTONS: return len >= 3 && len <= 7;
	default: return true;
	}
}

int track_spacemouse_decode(const uint8_t *bytes, size_t len, struct track_spacemouse_report *out)
{
	struct track_spacemouse_report report = { 0 };
	struct gr_reader r = gr_reader(bytes, len);
	const unsigned number = gr_read_u8(&r);

	if (!r.ok || !fits(number, len))
		return -TRACK_FAULT_LENGTH;
	switch (number) {
	case MOVE:
		report.moves = true;
		report.turns = len == 13;
		read_vector(&r, report.move);
		if (report.turns)
			read_vector(&r, report.turn);
		break;
	case TURN:
		report.turns = true;
		read_vector(&r, report.turn);
		break;
	case BUTTONS:
		report.presses = true;
		for (unsigned i = 0; i + 1 < len && i < 4; i++)
			report.buttons |= (uint32_t)gr_read_u8(&r) << 8 * i;
		report.buttons &= (UINT32_C(1) << TRACK_SPACEMOUSE_BUTTONS) - 1;
		break;
	case BATTERY: return GR_NOTHING;
	default: return -TRACK_FAULT_FORMAT;
	}
	*out = report;
	return GR_OK;
}

static float part_of(int16_t raw)
{
	const float part = (float)raw / FULL;

	/* A little over full scale is seen, and is full. */
	return part > 1 ? 1 : part < -1 ? -1 : part;
}

/* X right, Y to the user, Z down becomes X right, Y up, Z to the user: a turn, so turns go
 * likewise. */
static void to_base(const int16_t raw[3], float out[3])
{
	out[0] = part_of(raw[0]);
	out[1] = 0 - part_of(raw[2]);
	out[2] = part_of(raw[1]);
}

bool track_spacemouse_moves(const struct track_spacemouse_state *s)
{
	for (int i = 0; i < 3; i++)
		if (s->move[i] != 0 || s->turn[i] != 0)
			return true;
	return false;
}

void track_spacemouse_take(struct track_spacemouse_state *s,
			   const struct track_spacemouse_motion *motion,
			   const struct track_spacemouse_report *report, int64_t now_ns)
{
	if (report->moves)
		to_base(report->move, s->move);
	if (report->turns)
		to_base(report->turn, s->turn);
	if (report->moves || report->turns)
		s->heard_ns = now_ns;
	if (!report->presses)
		return;
	if (report->buttons & ~s->buttons & motion->home) {
		for (int i = 0; i < 3; i++)
			s->place_m[i] = 0;
		s->heading_rad = s->pitch_rad = s->roll_rad = 0;
	}
	s->buttons = report->buttons;
}

/* Fine near the middle, where hands tremble. */
static float speed_of(float part)
{
	const float way = track_dead_zone(part, ZONE);

	return way * fabsf(way);
}

static float wrapped(float angle)
{
	return remainderf(angle, 2 * GLM_PIf);
}

static float within(float value, float most)
{
	return value > most ? most : value < -most ? -most : value;
}

void track_spacemouse_move(struct track_spacemouse_state *s,
			   const struct track_spacemouse_motion *motion, int64_t now_ns)
{
	const double since_s = s->now_ns ? (double)(now_ns - s->now_ns) / 1e9 : 0;
	const float dt_s = (float)(since_s > STEP_S ? STEP_S : since_s > 0 ? since_s : 0);
	const float turn = motion->turn_rad_s * dt_s, way = motion->speed_m_s * dt_s;
	const float sine = sinf(s->heading_rad), cosine = cosf(s->heading_rad);
	float step[3];

	s->now_ns = now_ns;
	if (now_ns - s->heard_ns > TRACK_SPACEMOUSE_HOLD_NS)
		for (int i = 0; i < 3; i++)
			s->move[i] = s->turn[i] = 0;
	for (int i = 0; i < 3; i++)
		step[i] = way * speed_of(s->move[i]);
	s->place_m[0] += cosine * step[0] + sine * step[2];
	s->place_m[1] += step[1];
	s->place_m[2] += cosine * step[2] - sine * step[0];
	for (int i = 0; i < 3; i++)
		s->place_m[i] = within(s->place_m[i], motion->reach_m);
	s->pitch_rad = within(s->pitch_rad + turn * speed_of(s->turn[0]), PITCH_MOST);
	s->heading_rad = wrapped(s->heading_rad + turn * speed_of(s->turn[1]));
	s->roll_rad = wrapped(s->roll_rad + turn * speed_of(s->turn[2]));
}

void track_spacemouse_pose(const struct track_spacemouse_state *s, struct track_report *out)
{
	struct gr_pose pitch = GR_POSE_IDENTITY, roll = GR_POSE_IDENTITY;

	*out = (struct track_report){
		.has = TRACK_POSITION | TRACK_ORIENTATION | TRACK_BUTTONS | TRACK_AXIS_VALUES,
		.buttons = s->buttons,
		.axis_count = 6,
		.axes = { s->move[0], s->move[1], s->move[2], s->turn[0], s->turn[1], s->turn[2] },
	};
	gr_pose_heading(s->place_m, s->heading_rad, &out->T_base_sensor);
	pitch.q[0] = sinf(s->pitch_rad * 0.5f);
	pitch.q[3] = cosf(s->pitch_rad * 0.5f);
	roll.q[2] = sinf(s->roll_rad * 0.5f);
	roll.q[3] = cosf(s->roll_rad * 0.5f);
	gr_pose_mul(&out->T_base_sensor, &pitch, &out->T_base_sensor);
	gr_pose_mul(&out->T_base_sensor, &roll, &out->T_base_sensor);
}
