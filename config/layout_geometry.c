#include "config/layout_geometry.h"

#include <math.h>

/* cos of the largest angle between edges that are meant to meet, 10 degrees. */
#define PARALLEL_COS 0.984807753

struct edge {
	double from[3], along[3]; /* along is unit */
	double length;
	double out[3]; /* unit, in the wall's plane, away from the wall */
};

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double unit(double v[3])
{
	double length = sqrt(dot(v, v));

	for (int i = 0; i < 3; i++)
		v[i] /= length;
	return length;
}

const char *layout_edge_name(enum layout_edge edge)
{
	static const char *const names[] = { "bottom", "right", "top", "left" };

	return names[edge];
}

static void wall_edge(const struct layout_wall *wall, enum layout_edge which, struct edge *out)
{
	double right[3], up[3];
	bool level = which == LAYOUT_EDGE_BOTTOM || which == LAYOUT_EDGE_TOP;

	for (int i = 0; i < 3; i++) {
		right[i] = (double)wall->lower_right[i] - wall->lower_left[i];
		up[i] = (double)wall->upper_left[i] - wall->lower_left[i];
		out->from[i] = wall->lower_left[i] + (which == LAYOUT_EDGE_TOP ? up[i] : 0) +
			       (which == LAYOUT_EDGE_RIGHT ? right[i] : 0);
	}
	for (int i = 0; i < 3; i++) {
		out->along[i] = level ? right[i] : up[i];
		out->out[i] = level ? up[i] : right[i];
		if (which == LAYOUT_EDGE_BOTTOM || which == LAYOUT_EDGE_LEFT)
			out->out[i] = -out->out[i];
	}
	out->length = unit(out->along);
	unit(out->out);
}

/* The point of an edge's line at the height `s` along the other edge's direction. */
static void point_at(const struct edge *edge, const double origin[3], const double axis[3],
		     double s, double out[3])
{
	double from[3], t;

	for (int i = 0; i < 3; i++)
		from[i] = edge->from[i] - origin[i];
	t = (s - dot(from, axis)) / dot(edge->along, axis);
	for (int i = 0; i < 3; i++)
		out[i] = edge->from[i] + edge->along[i] * t;
}

static void measure_end(const struct edge *a, const struct edge *b, double s,
			struct layout_meeting_end *out)
{
	double on_b[3], between[3], a_grows, b_grows;

	for (int i = 0; i < 3; i++)
		out->at[i] = a->from[i] + a->along[i] * s;
	point_at(b, a->from, a->along, s, on_b);
	for (int i = 0; i < 3; i++)
		between[i] = on_b[i] - out->at[i];
	a_grows = dot(between, a->out);
	b_grows = -dot(between, b->out);
	out->gap = fabs(a_grows) >= fabs(b_grows) ? a_grows : b_grows;
	out->distance = sqrt(dot(between, between));
}

static bool edges_meet(const struct edge *a, const struct edge *b, struct layout_meeting *out)
{
	double from[3], first, last, low, high, shorter = fmin(a->length, b->length);
	double turn = dot(a->along, b->along);

	if (fabs(turn) < PARALLEL_COS)
		return false;
	for (int i = 0; i < 3; i++)
		from[i] = b->from[i] - a->from[i];
	first = dot(from, a->along);
	last = first + b->length * turn;
	low = fmax(0, fmin(first, last));
	high = fmin(a->length, fmax(first, last));
	if (high - low < shorter / 2)
		return false;
	measure_end(a, b, low, &out->end[0]);
	measure_end(a, b, high, &out->end[1]);
	out->length = high - low;
	out->shift = 0;
	if (fabs(a->length - b->length) < LAYOUT_MEET_M &&
	    fabs(fmin(first, last)) < LAYOUT_MEET_M)
		out->shift = fmax(fabs(fmin(first, last)), fabs(fmax(first, last) - a->length));
	return out->end[0].distance <= LAYOUT_MEET_M && out->end[1].distance <= LAYOUT_MEET_M;
}

bool layout_walls_meet(const struct layout_wall *a, const struct layout_wall *b,
		       struct layout_meeting *out)
{
	double best = INFINITY;

	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++) {
			struct layout_meeting meeting;
			struct edge edge_a, edge_b;
			double worst;

			wall_edge(a, (enum layout_edge)i, &edge_a);
			wall_edge(b, (enum layout_edge)j, &edge_b);
			if (!edges_meet(&edge_a, &edge_b, &meeting))
				continue;
			worst = fmax(meeting.end[0].distance, meeting.end[1].distance);
			if (worst >= best)
				continue;
			best = worst;
			*out = meeting;
			out->edge_a = (enum layout_edge)i;
			out->edge_b = (enum layout_edge)j;
		}
	return isfinite(best);
}

static const char *gap_text(const struct layout_meeting_end *end, char *out, size_t size)
{
	/* Below a tenth of a millimetre is below what a room is measured to. */
	if (end->distance < 0.5e-4)
		snprintf(out, size, "joined");
	else if (fabs(end->gap) < 0.5 * end->distance)
		snprintf(out, size, "step of %.1f mm", end->distance * 1e3);
	else
		snprintf(out, size, "%s of %.1f mm", end->gap > 0 ? "gap" : "overlap",
			 fabs(end->gap) * 1e3);
	return out;
}

static void report_wall(const struct layout *layout, const struct layout_wall *wall,
			struct gr_diag *diag)
{
	double right[3], up[3], width, height;

	for (int i = 0; i < 3; i++) {
		right[i] = (double)wall->lower_right[i] - wall->lower_left[i];
		up[i] = (double)wall->upper_left[i] - wall->lower_left[i];
	}
	width = unit(right);
	height = unit(up);
	gr_diag_add(diag, GR_DIAG_NOTE, layout->path, wall->line, wall->name,
		    "%.3f x %.3f m, %d x %d pixels of %.2f x %.2f mm", width, height,
		    wall->pixels[0], wall->pixels[1], width / wall->pixels[0] * 1e3,
		    height / wall->pixels[1] * 1e3);
}

static void report_meeting(const struct layout *layout, const struct layout_wall *a,
			   const struct layout_wall *b, struct gr_diag *diag)
{
	struct layout_meeting meeting;
	char names[2 * LAYOUT_NAME_MAX + 4], first[64], last[64], shift[96] = "";
	double worst;

	if (!layout_walls_meet(a, b, &meeting))
		return;
	snprintf(names, sizeof names, "%s-%s", a->name, b->name);
	gap_text(&meeting.end[0], first, sizeof first);
	gap_text(&meeting.end[1], last, sizeof last);
	if (meeting.shift >= 0.5e-4)
		snprintf(shift, sizeof shift, "; their ends miss each other by %.1f mm along the edge",
			 meeting.shift * 1e3);
	worst = fmax(fmax(meeting.end[0].distance, meeting.end[1].distance), meeting.shift);
	gr_diag_add(diag, worst >= LAYOUT_GAP_WARN_M ? GR_DIAG_WARNING : GR_DIAG_NOTE, layout->path,
		    b->line, names,
		    "%s edge of %s meets %s edge of %s: %s at [%.3f, %.3f, %.3f], %s at "
		    "[%.3f, %.3f, %.3f]%s",
		    layout_edge_name(meeting.edge_a), a->name, layout_edge_name(meeting.edge_b),
		    b->name, first, meeting.end[0].at[0], meeting.end[0].at[1], meeting.end[0].at[2],
		    last, meeting.end[1].at[0], meeting.end[1].at[1], meeting.end[1].at[2], shift);
}

void layout_report_geometry(const struct layout *layout, struct gr_diag *diag)
{
	for (size_t i = 0; i < layout->wall_count; i++)
		report_wall(layout, &layout->walls[i], diag);
	for (size_t i = 0; i < layout->wall_count; i++)
		for (size_t j = i + 1; j < layout->wall_count; j++)
			report_meeting(layout, &layout->walls[i], &layout->walls[j], diag);
}
