/*
 * Unfolds a room: lays its walls into one plane, as a box of cardboard is
 * cut open, so that a picture of all of them can be looked at. Walls that
 * share an edge keep sharing it wherever the plane allows it.
 *
 * The wall that faces +Z of the room most squarely (the front, base/pose.h)
 * lies upright in the middle; from it the others are folded out breadth
 * first over shared edges, those to the right first, then left, above and
 * below: left | front | right | back in a row, floor below and ceiling above
 * the front. Nothing depends on names or numbers of walls. A wall that
 * touches none stands apart on the right.
 *
 * Pure functions. Lengths in metres; the plane has x to the right, y up and
 * its origin at the lower left corner of the unfolded room.
 */
#ifndef GROTTO_TOOLS_UNFOLD_H
#define GROTTO_TOOLS_UNFOLD_H

#include <cglm/cglm.h>
#include <stddef.h>

/* Corners as the person inside sees them (config/layout.h). */
struct unfold_wall {
	vec3 lower_left, lower_right, upper_left;
};

#define UNFOLD_NO_PARENT ((size_t)-1)

struct unfold_place {
	double x, y;          /* where the wall's lower left corner comes to lie */
	int turns;            /* quarter turns counter-clockwise, 0..3 */
	double width, height; /* of the wall, before it is turned */
	size_t parent;        /* the wall whose edge it shares, UNFOLD_NO_PARENT for a first one */
};

/* Corners of the axis-parallel rectangle that a place covers. */
struct unfold_box {
	double x0, y0, x1, y1;
};

/*
 * places has room for count. *size gets the width and height of the whole.
 * GR_OK, GR_ERR_RANGE for no walls or a wall that is not finite or has no
 * area, GR_ERR_NOMEM.
 */
int unfold_room(const struct unfold_wall *walls, size_t count, struct unfold_place *places,
		double size[2]);

/* The point of the plane where (u, v) of the wall lies, both 0..1 from its lower left. */
void unfold_point(const struct unfold_place *place, double u, double v, double out[2]);
/* The reverse: u and v of a point of the plane; outside 0..1 when it is not on the wall. */
void unfold_wall_point(const struct unfold_place *place, const double point[2], double *out_u,
		       double *out_v);
struct unfold_box unfold_place_box(const struct unfold_place *place);

#endif
