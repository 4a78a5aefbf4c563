#include "tools/bench/svg.h"

#include <math.h>

/* Mean advance of sans-serif letters and digits, in ems. */
#define ADVANCE 0.57

static void put_escaped(FILE *out, const char *text)
{
	for (; *text; text++) {
		switch (*text) {
		case '&': fputs("&amp;", out); break;
		case '<': fputs("&lt;", out); break;
		case '>': fputs("&gt;", out); break;
		case '"': fputs("&quot;", out); break;
		default:
			/* XML 1.0 has no other control characters */
			if ((unsigned char)*text >= 0x20 || *text == '\t' || *text == '\n')
				fputc(*text, out);
			break;
		}
	}
}

static void put_pen(FILE *out, const struct svg_pen *pen)
{
	if (!pen)
		return;
	fprintf(out, " stroke=\"%s\" stroke-width=\"%.2f\"", pen->stroke, pen->width);
	if (pen->dash)
		fprintf(out, " stroke-dasharray=\"%s\"", pen->dash);
}

void svg_begin(FILE *out, double width, double height, const char *title, const char *description)
{
	fprintf(out,
		"<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
		"viewBox=\"0 0 %.0f %.0f\" role=\"img\" "
		"font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\">\n<title>",
		width, height, width, height);
	put_escaped(out, title);
	fputs("</title>\n<desc>", out);
	put_escaped(out, description);
	fputs("</desc>\n", out);
}

void svg_end(FILE *out)
{
	fputs("</svg>\n", out);
}

void svg_rect(FILE *out, double x, double y, double width, double height, const char *fill,
	      const struct svg_pen *pen)
{
	fprintf(out, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"%s\"", x, y,
		width, height, fill);
	put_pen(out, pen);
	fputs("/>\n", out);
}

void svg_line(FILE *out, double x0, double y0, double x1, double y1, const struct svg_pen *pen)
{
	fprintf(out, "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\"", x0, y0, x1, y1);
	put_pen(out, pen);
	fputs("/>\n", out);
}

void svg_polyline(FILE *out, const double (*points)[2], size_t count, const struct svg_pen *pen)
{
	fputs("<polyline fill=\"none\" stroke-linejoin=\"round\" points=\"", out);
	for (size_t i = 0; i < count; i++)
		fprintf(out, "%s%.2f,%.2f", i ? " " : "", points[i][0], points[i][1]);
	fputc('"', out);
	put_pen(out, pen);
	fputs("/>\n", out);
}

void svg_text(FILE *out, double x, double y, const struct svg_font *font, const char *halo,
	      const char *text)
{
	static const char *const anchors[] = { "start", "middle", "end" };

	fprintf(out, "<text x=\"%.2f\" y=\"%.2f\" font-size=\"%.1f\" fill=\"%s\"", x, y, font->size,
		font->colour);
	if (font->anchor != SVG_START)
		fprintf(out, " text-anchor=\"%s\"", anchors[font->anchor]);
	if (font->bold)
		fputs(" font-weight=\"bold\"", out);
	if (font->turn_deg < 0 || font->turn_deg > 0)
		fprintf(out, " transform=\"rotate(%.0f %.2f %.2f)\"", font->turn_deg, x, y);
	if (halo)
		fprintf(out, " stroke=\"%s\" stroke-width=\"3\" stroke-linejoin=\"round\" "
			"paint-order=\"stroke\"", halo);
	fputc('>', out);
	put_escaped(out, text);
	fputs("</text>\n", out);
}

static void put_polygon(FILE *out, const double (*corners)[2], size_t count, double x, double y,
			double radius)
{
	fputs("<polygon points=\"", out);
	for (size_t i = 0; i < count; i++)
		fprintf(out, "%s%.2f,%.2f", i ? " " : "", x + radius * corners[i][0],
			y + radius * corners[i][1]);
	fputc('"', out);
}

void svg_mark(FILE *out, enum svg_mark mark, double x, double y, double radius, const char *fill,
	      const char *rim)
{
	/* of about the disc's area */
	static const double square[][2] = { { -.89, -.89 }, { .89, -.89 }, { .89, .89 }, { -.89, .89 } };
	static const double diamond[][2] = { { 0, -1.25 }, { 1.25, 0 }, { 0, 1.25 }, { -1.25, 0 } };
	static const double triangle[][2] = { { 0, -1.3 }, { 1.2, .85 }, { -1.2, .85 } };
	static const double cross[][2] = { { -1.2, -.5 }, { -.5, -.5 }, { -.5, -1.2 }, { .5, -1.2 },
					   { .5, -.5 },   { 1.2, -.5 }, { 1.2, .5 },   { .5, .5 },
					   { .5, 1.2 },   { -.5, 1.2 }, { -.5, .5 },   { -1.2, .5 } };

	switch (mark) {
	case SVG_SQUARE: put_polygon(out, square, 4, x, y, radius); break;
	case SVG_DIAMOND: put_polygon(out, diamond, 4, x, y, radius); break;
	case SVG_TRIANGLE: put_polygon(out, triangle, 3, x, y, radius); break;
	case SVG_CROSS: put_polygon(out, cross, 12, x, y, radius); break;
	case SVG_DISC:
	case SVG_MARKS: fprintf(out, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"", x, y, radius); break;
	}
	fprintf(out, " fill=\"%s\" stroke=\"%s\" stroke-width=\"1\"/>\n", fill, rim);
}

double svg_text_width(const char *text, double size)
{
	size_t count = 0;

	/* continuation bytes of UTF-8 are no letters of their own */
	for (; *text; text++)
		count += ((unsigned char)*text & 0xc0) != 0x80;
	return (double)count * ADVANCE * size;
}
