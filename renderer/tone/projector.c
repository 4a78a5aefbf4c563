#include "renderer/tone/projector.h"

#include "base/plain.h"
#include "base/result.h"
#include "renderer/image/read_file.h"
#include "renderer/tone/srgb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int fault(struct gr_diag *diag, const char *name, int line, const char *what)
{
	gr_diag_add(diag, GR_DIAG_ERROR, name, line, NULL,
		    "%s; a row is code, red, green, blue: codes rise from 0 to 1, light never falls",
		    what);
	return GR_ERR_CONFIG;
}

/* Four numbers and nothing else; GR_NOTHING for a line without any. */
static int parse_line(char *line, double out[4])
{
	char *at = line, *end;

	line[strcspn(line, "#\r\n")] = 0;
	for (int i = 0; i < 4; i++) {
		at += strspn(at, i ? ", \t" : " \t");
		if (!i && !*at)
			return GR_NOTHING;
		out[i] = strtod(at, &end);
		if (end == at || !isfinite(out[i]))
			return GR_ERR_CONFIG;
		at = end;
	}
	return at[strspn(at, " \t")] ? GR_ERR_CONFIG : GR_OK;
}

/* One more row, in order. */
static const char *add_row(struct projector *p, const double row[4])
{
	if (p->rows == PROJECTOR_ROWS_MAX)
		return "too many rows";
	if (p->rows ? !(row[0] > p->code[p->rows - 1]) : row[0] != 0)
		return p->rows ? "the code is not above the one before" : "the first code is not 0";
	for (int c = 0; c < 3; c++) {
		if (row[1 + c] < 0)
			return "light below 0";
		if (p->rows && row[1 + c] < p->light[p->rows - 1][c])
			return "less light than in the row before";
		p->light[p->rows][c] = row[1 + c];
	}
	p->code[p->rows++] = row[0];
	return NULL;
}

static const char *check_whole(const struct projector *p)
{
	if (p->rows < 2 || p->code[p->rows - 1] != 1)
		return "the last code is not 1";
	for (int c = 0; c < 3; c++)
		if (!(p->light[p->rows - 1][c] > p->light[0][c]))
			return "a band has the same light for all codes";
	return NULL;
}

int projector_parse(const uint8_t *text, size_t len, const char *name, struct projector *out,
		    struct gr_diag *diag)
{
	const char *wrong;
	int number = 0;
	size_t at = 0;

	out->rows = 0;
	while (at < len) {
		const uint8_t *end = memchr(text + at, '\n', len - at);
		size_t length = end ? (size_t)(end - text) - at : len - at;
		double row[4];
		char line[256];
		int result;

		number++;
		if (length >= sizeof line || memchr(text + at, 0, length))
			return fault(diag, name, number, "not a line of text");
		memcpy(line, text + at, length);
		line[length] = 0;
		at += length + 1;
		result = parse_line(line, row);
		if (result == GR_NOTHING)
			continue;
		wrong = result == GR_OK ? add_row(out, row) : "not four numbers";
		if (wrong)
			return fault(diag, name, number, wrong);
	}
	wrong = check_whole(out);
	return wrong ? fault(diag, name, number, wrong) : GR_OK;
}

static bool is_plain(const struct layout_projector *said)
{
	for (int c = 0; c < 3; c++)
		if (said->black[c] != 0 || said->gain[c] != 1)
			return false;
	return !said->table && isnan(said->gamma[0]);
}

static double display_gamma(const struct scene_tone *tone)
{
	return tone->srgb ? 2.2 : (double)tone->gamma_display;
}

int projector_load(const struct layout *layout, const struct layout_projector *said,
		   const struct scene_tone *tone, struct projector *out, struct gr_diag *diag)
{
	uint8_t *text;
	size_t len;
	char *path;
	int result;

	memset(out, 0, sizeof *out);
	if (is_plain(said))
		return GR_NOTHING;
	for (int c = 0; c < 3; c++) {
		out->black[c] = (double)said->black[c];
		out->gain[c] = (double)said->gain[c];
		out->gamma[c] = isnan(said->gamma[0]) ? display_gamma(tone) : (double)said->gamma[c];
	}
	if (!said->table)
		return GR_OK;
	path = layout_beside(layout, said->table);
	if (!path)
		return GR_ERR_NOMEM;
	result = read_file(path, PROJECTOR_TABLE_BYTES_MAX, &text, &len, diag, "projector");
	if (result == GR_OK) {
		result = projector_parse(text, len, path, out, diag);
		free(text);
	}
	free(path);
	return result;
}

double projector_light(const struct projector *projector, int band, double x)
{
	const struct projector *p = projector;
	size_t row = 1;

	if (!p->rows)
		return p->black[band] + (p->gain[band] - p->black[band]) * pow(x, p->gamma[band]);
	while (row < p->rows - 1 && p->code[row] < x)
		row++;
	return p->light[row - 1][band] + (p->light[row][band] - p->light[row - 1][band]) *
						 (x - p->code[row - 1]) /
						 (p->code[row] - p->code[row - 1]);
}

double projector_code(const struct projector *projector, int band, double light)
{
	const struct projector *p = projector;
	const double darkest = projector_light(p, band, 0), brightest = projector_light(p, band, 1);
	size_t row = 1;

	if (light <= darkest)
		return 0;
	if (light >= brightest)
		return 1;
	if (!p->rows)
		return pow((light - darkest) / (brightest - darkest), 1 / p->gamma[band]);
	while (p->light[row][band] < light)
		row++;
	return p->code[row - 1] + (p->code[row] - p->code[row - 1]) *
					  (light - p->light[row - 1][band]) /
					  (p->light[row][band] - p->light[row - 1][band]);
}

void projector_map(const struct projector *projector, const struct scene_tone *tone,
		   float out[PROJECTOR_MAP][3])
{
	for (int i = 0; i < PROJECTOR_MAP; i++) {
		double encoded = (double)i / (PROJECTOR_MAP - 1);
		double light = tone->srgb ? srgb_decode(encoded)
					  : pow(encoded, (double)tone->gamma_display);

		for (int c = 0; c < 3; c++)
			out[i][c] = (float)projector_code(projector, c, light);
	}
}
