#include "config/layout_check.h"

#include <math.h>
#include <string.h>

/* A room thinner than this along an axis was not measured: its box must be given. */
#define ROOM_THIN_M 0.5f
/* An eye this near a wall's plane has no picture. */
#define EYE_NEAR_M 1e-3

/* Metres from the wall's plane, positive in front of it; NaN for no wall or one without area. */
static double in_front(const struct layout_file_wall *wall, const double point[3])
{
	double a[3], b[3], n[3], length, distance = 0;

	for (int i = 0; i < 3; i++) {
		a[i] = (double)wall->lower_right[i] - wall->lower_left[i];
		b[i] = (double)wall->upper_left[i] - wall->lower_left[i];
	}
	for (int i = 0; i < 3; i++)
		n[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
	length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int i = 0; i < 3; i++)
		distance += (point[i] - wall->lower_left[i]) * n[i] / length;
	return distance;
}

static bool wall_known(const struct layout_file_wall *wall)
{
	static const double origin[3];

	return wall->at && isfinite(in_front(wall, origin));
}

static void include(struct layout_file_room *room, const float point[3])
{
	for (int i = 0; i < 3; i++) {
		room->min[i] = fminf(room->min[i], point[i]);
		room->max[i] = fmaxf(room->max[i], point[i]);
	}
}

/* The box around all corners of all walls, the fourth ones too; none when a wall is faulty. */
static bool room_from_walls(struct options_reader *reader, struct layout_file *file)
{
	struct layout_file_room *room = &file->room;

	for (int i = 0; i < 3; i++) {
		room->min[i] = INFINITY;
		room->max[i] = -INFINITY;
	}
	for (size_t w = 0; w < file->wall_count; w++) {
		const struct layout_file_wall *wall = &file->walls[w];
		float last[3];

		if (!wall_known(wall))
			return false;
		for (int i = 0; i < 3; i++)
			last[i] = wall->lower_right[i] + wall->upper_left[i] - wall->lower_left[i];
		include(room, wall->lower_left);
		include(room, wall->lower_right);
		include(room, wall->upper_left);
		include(room, last);
	}
	for (int i = 0; file->wall_count && i < 3; i++)
		if (room->max[i] - room->min[i] < ROOM_THIN_M) {
			options_fault(reader, GR_DIAG_ERROR, file->at, "room",
				      "missing; the walls enclose %.2f m along %c, so say where eyes may be: "
				      "room = { min = [x, y, z]; max = [x, y, z]; }",
				      (double)(room->max[i] - room->min[i]), "xyz"[i]);
			return false;
		}
	return file->wall_count > 0;
}

static bool room_given(struct options_reader *reader, struct layout_file *file)
{
	const struct layout_file_room *room = &file->room;

	for (int i = 0; i < 3; i++) {
		if (!isfinite(room->min[i]) || !isfinite(room->max[i]))
			return false;
		if (!(room->min[i] < room->max[i])) {
			options_fault(reader, GR_DIAG_ERROR, room->at, "min",
				      "%c is %g and max has %g; min must be the smaller one", "xyz"[i],
				      (double)room->min[i], (double)room->max[i]);
			return false;
		}
	}
	return true;
}

/* Both eyes at the start pose: the head's x axis is where its right eye is. */
static void start_eyes(const struct layout_file *file, double eyes[2][3])
{
	const float *angles = file->start.head_angles;
	double ch = cos(angles[0]), sh = sin(angles[0]), sp = sin(angles[1]), cp = cos(angles[1]);
	double cr = cos(angles[2]), sr = sin(angles[2]);
	double right[3] = { ch * cr + sh * sp * sr, cp * sr, -sh * cr + ch * sp * sr };

	for (int i = 0; i < 3; i++) {
		double half = right[i] * file->eye_separation_m / 2;

		eyes[0][i] = file->start.head[i] - half;
		eyes[1][i] = file->start.head[i] + half;
	}
}

static bool eyes_inside(struct options_reader *reader, const struct layout_file *file,
			double eyes[2][3])
{
	const struct layout_file_room *room = &file->room;

	for (int eye = 0; eye < 2; eye++)
		for (int i = 0; i < 3; i++)
			if (eyes[eye][i] < room->min[i] || eyes[eye][i] > room->max[i]) {
				options_fault(reader, GR_DIAG_ERROR, file->at, "start.head",
					      "the %s eye is outside the room: %c is %.3f m, the room has "
					      "%.3f to %.3f; move the head or give room = { min, max }",
					      eye ? "right" : "left", "xyz"[i], eyes[eye][i],
					      (double)room->min[i], (double)room->max[i]);
				return false;
			}
	return true;
}

/*
 * A wall whose front looks away from eye and room has its corners swapped; one
 * that looks at the room's middle but not at the eye has the eye behind it.
 */
static void check_wall(struct options_reader *reader, const struct layout_file *file,
		       const struct layout_file_wall *wall, double eyes[2][3], bool inside)
{
	double middle[3], nearest = fmin(in_front(wall, eyes[0]), in_front(wall, eyes[1]));
	double from_middle;

	for (int i = 0; i < 3; i++)
		middle[i] = ((double)file->room.min[i] + file->room.max[i]) / 2;
	from_middle = in_front(wall, middle);
	if (!isfinite(nearest) || nearest > EYE_NEAR_M)
		return;
	if (from_middle < EYE_NEAR_M && nearest < -EYE_NEAR_M)
		options_fault(reader, GR_DIAG_ERROR, wall->at, "lower_left",
			      "wall \"%s\" is left-handed: seen from the start pose its front faces away; "
			      "exchange lower_left and lower_right, or look again at upper_left",
			      wall->name);
	else if (inside)
		options_fault(reader, GR_DIAG_ERROR, file->at, "start.head",
			      "an eye is %.3f m behind wall \"%s\"; move the head in front of it",
			      -nearest, wall->name);
}

void layout_check_room(struct options_reader *reader, struct layout_file *file)
{
	double eyes[2][3];
	bool known = file->room.at ? room_given(reader, file) : room_from_walls(reader, file);
	bool inside;

	if (!known)
		return;
	start_eyes(file, eyes);
	inside = eyes_inside(reader, file, eyes);
	for (size_t w = 0; w < file->wall_count; w++)
		if (wall_known(&file->walls[w]))
			check_wall(reader, file, &file->walls[w], eyes, inside);
}
