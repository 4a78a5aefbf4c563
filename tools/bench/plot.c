#include "tools/bench/plot.h"

#include "base/result.h"
#include "tools/bench/axis.h"
#include "tools/bench/stats.h"
#include "tools/bench/svg.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define WIDTH 760.0
#define HEIGHT 480.0
#define LEFT 74.0
#define RIGHT 22.0
#define TOP 80.0
#define BOTTOM 58.0
#define MARK 5.0
#define LABEL_SIZE 11.0
#define LEGEND_ROW 18.0

#define INK "#222222"
#define FAINT "#6b6b6b"
#define GRID "#e4e4e4"
#define GRID_FINE "#f2f2f2"
#define PAPER "#ffffff"
#define FRONT "#444444"

/* Told apart by the colour-blind (Okabe and Ito 2008), and by their shape without colour. */
static const char *const colours[PLOT_SERIES_MAX] = { "#0072b2", "#d55e00", "#009e73", "#cc79a7",
						      "#e69f00", "#56b4e9", "#8a7d00", "#000000" };
static const enum svg_mark marks[PLOT_SERIES_MAX] = { SVG_DISC,     SVG_SQUARE, SVG_TRIANGLE,
						      SVG_DIAMOND,  SVG_CROSS,  SVG_SQUARE,
						      SVG_TRIANGLE, SVG_DISC };

struct box {
	double x0, y0, x1, y1;
};

struct drawing {
	FILE *out;
	const struct plot *plot;
	struct axis cost, error;
	const char *series[PLOT_SERIES_MAX];
	size_t series_count;
	struct box taken[5 * PLOT_POINTS_MAX + 4]; /* by marks, whiskers, labels and the front */
	size_t taken_count;
};

static bool shown(const struct plot_point *p)
{
	return isfinite(p->cost) && p->cost > 0 && isfinite(p->error) && p->error > 0;
}

static double x_of(const struct drawing *d, double cost)
{
	return LEFT + axis_place(&d->cost, cost) * (WIDTH - LEFT - RIGHT);
}

static double y_of(const struct drawing *d, double error)
{
	return HEIGHT - BOTTOM - axis_place(&d->error, error) * (HEIGHT - TOP - BOTTOM);
}

static int take_series(struct drawing *d)
{
	for (size_t i = 0; i < d->plot->count; i++) {
		size_t s = 0;

		if (!shown(&d->plot->points[i]))
			continue;
		while (s < d->series_count && strcmp(d->series[s], d->plot->points[i].series) != 0)
			s++;
		if (s < d->series_count)
			continue;
		if (s >= PLOT_SERIES_MAX)
			return GR_ERR_RANGE;
		d->series[d->series_count++] = d->plot->points[i].series;
	}
	return GR_OK;
}

static size_t series_of(const struct drawing *d, const struct plot_point *p)
{
	size_t s = 0;

	while (s + 1 < d->series_count && strcmp(d->series[s], p->series) != 0)
		s++;
	return s;
}

static bool has_level(const struct plot *plot)
{
	return plot->level_label && isfinite(plot->level) && plot->level > 0;
}

static void fit(struct drawing *d)
{
	double costs[3 * PLOT_POINTS_MAX], errors[PLOT_POINTS_MAX + 1];
	size_t n = 0, m = 0;

	for (size_t i = 0; i < d->plot->count; i++) {
		const struct plot_point *p = &d->plot->points[i];

		if (!shown(p))
			continue;
		costs[n++] = p->cost;
		costs[n++] = p->cost_low;
		costs[n++] = p->cost_high;
		errors[m++] = p->error;
	}
	if (has_level(d->plot))
		errors[m++] = d->plot->level;
	axis_fit(&d->cost, costs, n);
	axis_fit(&d->error, errors, m);
}

static void draw_axes(const struct drawing *d)
{
	const struct svg_pen fine = { GRID_FINE, 1, NULL }, grid = { GRID, 1, NULL };
	const struct svg_pen line = { INK, 1, NULL };
	const struct svg_font tick = { 11.5, INK, SVG_MIDDLE, 0, 0 };
	const struct svg_font side = { 11.5, INK, SVG_END, 0, 0 };
	const struct svg_font name = { 13, INK, SVG_MIDDLE, 0, 0 };
	const struct svg_font turned = { 13, INK, SVG_MIDDLE, 0, -90 };
	const double low = HEIGHT - BOTTOM, right = WIDTH - RIGHT;

	for (size_t i = 0; i < d->cost.tick_count; i++) {
		const struct axis_tick *t = &d->cost.ticks[i];
		double x = x_of(d, t->value);

		svg_line(d->out, x, TOP, x, low, t->labelled ? &grid : &fine);
		svg_line(d->out, x, low, x, low + (t->labelled ? 5 : 3), &line);
		if (t->labelled)
			svg_text(d->out, x, low + 19, &tick, NULL, t->label);
	}
	for (size_t i = 0; i < d->error.tick_count; i++) {
		const struct axis_tick *t = &d->error.ticks[i];
		double y = y_of(d, t->value);

		svg_line(d->out, LEFT, y, right, y, t->labelled ? &grid : &fine);
		svg_line(d->out, LEFT - (t->labelled ? 5 : 3), y, LEFT, y, &line);
		if (t->labelled)
			svg_text(d->out, LEFT - 9, y + 4, &side, NULL, t->label);
	}
	svg_line(d->out, LEFT, low, right, low, &line);
	svg_line(d->out, LEFT, TOP, LEFT, low, &line);
	svg_text(d->out, (LEFT + right) / 2, HEIGHT - 14, &name, NULL, d->plot->cost_label);
	svg_text(d->out, 20, (TOP + low) / 2, &turned, NULL, d->plot->error_label);
}

static void take(struct drawing *d, double x0, double y0, double x1, double y1, double rim)
{
	d->taken[d->taken_count++] = (struct box){ fmin(x0, x1) - rim, fmin(y0, y1) - rim,
						   fmax(x0, x1) + rim, fmax(y0, y1) + rim };
}

/* Stairs: what a point reaches is reached at any higher cost, too. */
static void draw_front(struct drawing *d)
{
	const struct svg_pen pen = { FRONT, 1.4, "5 3" };
	struct stats_point points[PLOT_POINTS_MAX];
	size_t front[PLOT_POINTS_MAX], count, n = 0;
	double line[2 * PLOT_POINTS_MAX + 2][2];

	for (size_t i = 0; i < d->plot->count; i++) {
		bool counts = shown(&d->plot->points[i]);

		points[i].cost = counts ? d->plot->points[i].cost : (double)NAN;
		points[i].error = counts ? d->plot->points[i].error : (double)NAN;
	}
	count = stats_pareto(points, d->plot->count, front);
	if (!count)
		return;
	line[n][0] = x_of(d, points[front[0]].cost);
	line[n++][1] = TOP;
	for (size_t i = 0; i < count; i++) {
		double x = x_of(d, points[front[i]].cost), y = y_of(d, points[front[i]].error);

		if (i > 0) {
			line[n][0] = x;
			line[n][1] = line[n - 1][1];
			n++;
		}
		line[n][0] = x;
		line[n++][1] = y;
	}
	line[n][0] = WIDTH - RIGHT;
	line[n][1] = line[n - 1][1];
	svg_polyline(d->out, line, n + 1, &pen);
	for (size_t i = 0; i < n; i++)
		take(d, line[i][0], line[i][1], line[i + 1][0], line[i + 1][1], 1);
}

static void draw_level(struct drawing *d)
{
	const struct svg_pen pen = { FAINT, 1, "2 3" };
	const struct svg_font font = { LABEL_SIZE, FAINT, SVG_END, 0, 0 };
	double y = y_of(d, d->plot->level);
	double width = svg_text_width(d->plot->level_label, LABEL_SIZE);

	svg_line(d->out, LEFT, y, WIDTH - RIGHT, y, &pen);
	svg_text(d->out, WIDTH - RIGHT - 6, y - 5, &font, PAPER, d->plot->level_label);
	take(d, WIDTH - RIGHT - 6 - width, y - 16, WIDTH - RIGHT, y, 0);
}

static double overlap(const struct box *a, const struct box *b)
{
	double w = fmin(a->x1, b->x1) - fmax(a->x0, b->x0);
	double h = fmin(a->y1, b->y1) - fmax(a->y0, b->y0);

	return w > 0 && h > 0 ? w * h : 0;
}

/* What is in a label's way there, as an area; outside of the plot counts most. */
static double crowding(const struct drawing *d, const struct box *box)
{
	const struct box plot = { LEFT, TOP - 12, WIDTH - 2, HEIGHT - BOTTOM - 1 };
	double area = (box->x1 - box->x0) * (box->y1 - box->y0);
	double sum = 4 * (area - overlap(box, &plot));

	for (size_t i = 0; i < d->taken_count; i++)
		sum += overlap(box, &d->taken[i]);
	return sum;
}

/* Beside its mark where there is most room; nearer places first. */
static void place_label(struct drawing *d, const struct plot_point *p)
{
	static const double ways[][2] = { { 1, 0 }, { 1, -1 }, { 1, 1 }, { -1, 0 },
					  { -1, -1 }, { -1, 1 }, { 0, -1 }, { 0, 1 } };
	const struct svg_pen leader = { FAINT, 0.7, NULL };
	struct svg_font font = { LABEL_SIZE, INK, SVG_START, 0, 0 };
	double width = svg_text_width(p->label, LABEL_SIZE), x = x_of(d, p->cost), y = y_of(d, p->error);
	double least = INFINITY, reach_best = 0;
	struct box best = { 0 };

	for (double reach = 11; reach < 60 && least > 0.5; reach += 8) {
		for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
			double far = ways[i][0] * ways[i][1] != 0 ? 0.75 * reach : reach;
			double cx = x + ways[i][0] * (far + width / 2);
			double cy = y + ways[i][1] * (far + LABEL_SIZE / 2 - 2);
			struct box box = { cx - width / 2, cy - LABEL_SIZE / 2 - 1, cx + width / 2,
					   cy + LABEL_SIZE / 2 + 1 };
			double here = crowding(d, &box) + 0.02 * reach;

			if (here < least) {
				least = here;
				best = box;
				reach_best = reach;
			}
		}
	}
	if (reach_best > 26)
		svg_line(d->out, x, y, fmin(fmax(x, best.x0), best.x1), fmin(fmax(y, best.y0), best.y1),
			 &leader);
	svg_text(d->out, best.x0, best.y1 - 3.5, &font, PAPER, p->label);
	d->taken[d->taken_count++] = best;
}

static void draw_points(struct drawing *d)
{
	const struct plot *plot = d->plot;

	for (size_t i = 0; i < plot->count; i++) {
		const struct plot_point *p = &plot->points[i];
		struct svg_pen whisker = { colours[0], 1.2, NULL };

		if (!shown(p))
			continue;
		whisker.stroke = colours[series_of(d, p)];
		if (isfinite(p->cost_low) && isfinite(p->cost_high) && p->cost_low > 0) {
			double x0 = x_of(d, p->cost_low), x1 = x_of(d, p->cost_high);

			svg_line(d->out, x0, y_of(d, p->error), x1, y_of(d, p->error), &whisker);
			take(d, x0, y_of(d, p->error), x1, y_of(d, p->error), 1);
		}
		take(d, x_of(d, p->cost), y_of(d, p->error), x_of(d, p->cost), y_of(d, p->error), MARK + 2);
	}
	for (size_t i = 0; i < plot->count; i++)
		if (shown(&plot->points[i]))
			place_label(d, &plot->points[i]);
	for (size_t i = 0; i < plot->count; i++) {
		const struct plot_point *p = &plot->points[i];
		size_t s;

		if (!shown(p))
			continue;
		s = series_of(d, p);
		svg_mark(d->out, marks[s], x_of(d, p->cost), y_of(d, p->error), MARK, colours[s], PAPER);
	}
}

/* One row above the plot, from the right. */
static void draw_legend(const struct drawing *d)
{
	const struct svg_pen front = { FRONT, 1.4, "5 3" };
	const struct svg_font font = { 12, INK, SVG_START, 0, 0 };
	const char *last = "Pareto front";
	double y = TOP - 14, x = WIDTH - RIGHT - svg_text_width(last, 12) - 36;

	for (size_t s = 0; s < d->series_count; s++)
		x -= svg_text_width(d->series[s], 12) + 34;
	x = fmax(x, LEFT);
	for (size_t s = 0; s < d->series_count; s++) {
		svg_mark(d->out, marks[s], x + 6, y - 4, MARK, colours[s], PAPER);
		svg_text(d->out, x + 16, y, &font, NULL, d->series[s]);
		x += svg_text_width(d->series[s], 12) + 34;
	}
	svg_line(d->out, x, y - 4, x + 28, y - 4, &front);
	svg_text(d->out, x + 34, y, &font, NULL, last);
}

static void draw(struct drawing *d)
{
	const struct svg_font title = { 16, INK, SVG_START, 1, 0 };
	const struct svg_font subtitle = { 11.5, FAINT, SVG_START, 0, 0 };
	const struct svg_font nothing = { 14, FAINT, SVG_MIDDLE, 0, 0 };
	const struct plot *plot = d->plot;

	svg_begin(d->out, WIDTH, HEIGHT, plot->title, plot->subtitle);
	svg_rect(d->out, 0, 0, WIDTH, HEIGHT, PAPER, NULL);
	svg_text(d->out, LEFT, 24, &title, NULL, plot->title);
	svg_text(d->out, LEFT, 41, &subtitle, NULL, plot->subtitle);
	draw_axes(d);
	draw_front(d);
	if (has_level(plot))
		draw_level(d);
	draw_points(d);
	draw_legend(d);
	if (!d->series_count)
		svg_text(d->out, WIDTH / 2, HEIGHT / 2, &nothing, NULL, "nothing to show");
	svg_end(d->out);
}

int plot_write(FILE *out, const struct plot *plot)
{
	struct drawing d = { .out = out, .plot = plot };

	if (plot->count > PLOT_POINTS_MAX || take_series(&d) != GR_OK)
		return GR_ERR_RANGE;
	fit(&d);
	draw(&d);
	return ferror(out) ? GR_ERR_IO : GR_OK;
}
