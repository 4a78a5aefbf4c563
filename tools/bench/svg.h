/*
 * Scalable Vector Graphics 1.1, as much as a plot needs. Units are pixels of
 * the picture, y down. Texts are escaped; numbers have two decimals, so equal
 * plots are equal bytes.
 */
#ifndef GROTTO_TOOLS_BENCH_SVG_H
#define GROTTO_TOOLS_BENCH_SVG_H

#include <stddef.h>
#include <stdio.h>

enum svg_anchor { SVG_START, SVG_MIDDLE, SVG_END };
enum svg_mark { SVG_DISC, SVG_SQUARE, SVG_DIAMOND, SVG_TRIANGLE, SVG_CROSS, SVG_MARKS };

struct svg_pen {
	const char *stroke; /* a colour */
	double width;
	const char *dash; /* NULL: unbroken; "4 3" */
};

struct svg_font {
	double size; /* of the type */
	const char *colour;
	enum svg_anchor anchor;
	int bold;
	double turn_deg; /* clockwise about the text's own place */
};

/* title and description are for readers that cannot see the picture. */
void svg_begin(FILE *out, double width, double height, const char *title, const char *description);
void svg_end(FILE *out);
void svg_rect(FILE *out, double x, double y, double width, double height, const char *fill,
	      const struct svg_pen *pen);
void svg_line(FILE *out, double x0, double y0, double x1, double y1, const struct svg_pen *pen);
void svg_polyline(FILE *out, const double (*points)[2], size_t count, const struct svg_pen *pen);
/* halo: a rim in this colour that keeps the text readable over lines; NULL: none. */
void svg_text(FILE *out, double x, double y, const struct svg_font *font, const char *halo,
	      const char *text);
void svg_mark(FILE *out, enum svg_mark mark, double x, double y, double radius, const char *fill,
	      const char *rim);
/* Width that a text will about have. */
double svg_text_width(const char *text, double size);

#endif
