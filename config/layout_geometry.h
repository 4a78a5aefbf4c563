/*
 * How neighbouring walls meet. Private to config/ (and its tests).
 */
#ifndef GROTTO_CONFIG_LAYOUT_GEOMETRY_H
#define GROTTO_CONFIG_LAYOUT_GEOMETRY_H

#include "config/layout.h"

/* Edges farther apart than this are not meant to meet, metres. */
#define LAYOUT_MEET_M 0.15
/* From here on a gap or overlap is a warning, metres. */
#define LAYOUT_GAP_WARN_M 0.005

enum layout_edge { LAYOUT_EDGE_BOTTOM, LAYOUT_EDGE_RIGHT, LAYOUT_EDGE_TOP, LAYOUT_EDGE_LEFT };
const char *layout_edge_name(enum layout_edge edge);

/* How wall a's edge and wall b's edge lie at one end of their common length. */
struct layout_meeting_end {
	double at[3]; /* on a's edge, room, metres */
	/*
	 * How far the two pictures would have to grow in their own planes to
	 * touch: positive a gap, negative an overlap (one reaches past the
	 * other). The larger of the two walls' figures, metres.
	 */
	double gap;
	double distance; /* between the edges, with what is out of both planes (a step) */
};

struct layout_meeting {
	enum layout_edge edge_a, edge_b;
	struct layout_meeting_end end[2]; /* first: where a's edge begins, bottom or left */
	double length;                    /* common length of the two edges, metres */
	double shift; /* how far the ends of edges of equal length miss each other along them */
};

/*
 * The pair of edges along which two walls meet: nearly parallel (10 degrees),
 * side by side for at least half of the shorter one and nowhere farther apart
 * than LAYOUT_MEET_M. False when there is none.
 */
bool layout_walls_meet(const struct layout_wall *a, const struct layout_wall *b,
		       struct layout_meeting *out);

#endif
