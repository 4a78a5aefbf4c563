#include "config/layout_check.h"

#include <math.h>

#define DEG_PER_RAD 57.29577951308232

static const char *const corner_keys[3] = { "lower_left", "lower_right", "upper_left" };

/* Radians in a float miss a right angle by up to 2e-7: a floor at -90 degrees is to be level. */
static double snap(double value)
{
	return fabs(value) < 2e-7 ? 0 : value;
}

/*
 * Corners of a wall given by centre, size and orientation. A person who faces
 * it looks along Ry(heading) Rx(pitch) (0, 0, -1); roll turns about that line.
 */
static void corners_from_center(struct layout_file_wall *wall)
{
	double ch = snap(cos(wall->heading)), sh = snap(sin(wall->heading));
	double cp = snap(cos(wall->pitch)), sp = snap(sin(wall->pitch));
	double cr = snap(cos(wall->roll)), sr = snap(sin(wall->roll));
	/* First two columns of Ry Rx: the wall's right and up before the roll. */
	double x[3] = { ch, 0, -sh }, y[3] = { sh * sp, cp, ch * sp };

	for (int i = 0; i < 3; i++) {
		double right = (x[i] * cr + y[i] * sr) * wall->size[0] / 2;
		double up = (y[i] * cr - x[i] * sr) * wall->size[1] / 2;

		wall->lower_left[i] = (float)(wall->center[i] - right - up);
		wall->lower_right[i] = (float)(wall->center[i] + right - up);
		wall->upper_left[i] = (float)(wall->center[i] - right + up);
	}
}

/* Whether the file gives the wall in one whole way; completes the corners. */
static bool resolve(struct options_reader *reader, struct layout_file_wall *wall)
{
	static const char *const center_keys[] = { "center", "size", "heading_deg", "pitch_deg",
						   "roll_deg" };
	int corners = 0, others = 0;

	for (int i = 0; i < 3; i++)
		corners += options_given(wall->at, corner_keys[i]);
	for (size_t i = 0; i < sizeof center_keys / sizeof *center_keys; i++)
		others += options_given(wall->at, center_keys[i]);
	if (corners && others) {
		options_fault(reader, GR_DIAG_ERROR, wall->at, NULL,
			      "given by corners and by center and size; keep one of the two");
		return false;
	}
	if (corners) {
		for (int i = 0; i < 3; i++)
			if (!options_given(wall->at, corner_keys[i]))
				options_fault(reader, GR_DIAG_ERROR, wall->at, corner_keys[i],
					      "missing; a wall needs lower_left, lower_right and upper_left");
	} else {
		for (int i = 0; i < 2; i++)
			if (!options_given(wall->at, center_keys[i]))
				options_fault(reader, GR_DIAG_ERROR, wall->at, center_keys[i],
					      "missing; a wall needs three corners, or center and size");
		if (isfinite(wall->center[0]) && isfinite(wall->size[0]))
			corners_from_center(wall);
	}
	return isfinite(wall->lower_left[0]) && isfinite(wall->lower_right[0]) &&
	       isfinite(wall->upper_left[0]);
}

static double side(const float *from, const float *to, double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = (double)to[i] - from[i];
	return sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
}

static void check_rectangle(struct options_reader *reader, const struct layout_file_wall *wall)
{
	double right[3], up[3], dot, angle, corner[3];
	double width = side(wall->lower_left, wall->lower_right, right);
	double height = side(wall->lower_left, wall->upper_left, up);

	if (width < LAYOUT_SIDE_MIN || height < LAYOUT_SIDE_MIN) {
		options_fault(reader, GR_DIAG_ERROR, wall->at,
			      width < LAYOUT_SIDE_MIN ? "lower_right" : "upper_left",
			      "%.4g m from lower_left; a wall's sides are at least %g m",
			      width < LAYOUT_SIDE_MIN ? width : height, LAYOUT_SIDE_MIN);
		return;
	}
	dot = right[0] * up[0] + right[1] * up[1] + right[2] * up[2];
	angle = acos(fmax(-1, fmin(1, dot / (width * height)))) * DEG_PER_RAD;
	if (fabs(angle - 90) <= LAYOUT_RIGHT_ANGLE_DEG)
		return;
	/* Nearest corner that makes a rectangle of the same height. */
	for (int i = 0; i < 3; i++)
		corner[i] = up[i] - right[i] * dot / (width * width);
	dot = sqrt(corner[0] * corner[0] + corner[1] * corner[1] + corner[2] * corner[2]);
	if (dot < 1e-6 * height) {
		options_fault(reader, GR_DIAG_ERROR, wall->at, "upper_left",
			      "all three corners are on one line; that is not a wall");
		return;
	}
	options_fault(reader, GR_DIAG_ERROR, wall->at, "upper_left",
		      "the corner at lower_left measures %.2f degrees, a rectangle's 90 (%g allowed); "
		      "with the other two, [%.4f, %.4f, %.4f] would be right",
		      angle, LAYOUT_RIGHT_ANGLE_DEG, wall->lower_left[0] + corner[0] * height / dot,
		      wall->lower_left[1] + corner[1] * height / dot,
		      wall->lower_left[2] + corner[2] * height / dot);
}

void layout_check_walls(struct options_reader *reader, struct layout_file *file)
{
	for (size_t i = 0; i < file->wall_count; i++) {
		struct layout_file_wall *wall = &file->walls[i];

		if (wall->at && resolve(reader, wall))
			check_rectangle(reader, wall);
	}
}
