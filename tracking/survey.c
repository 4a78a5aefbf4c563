#include "tracking/survey.h"

#include "base/result.h"
#include "tracking/align.h"
#include "tracking/report.h"
#include "tracking/text.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FAULTS_MAX 20
#define NUMBERS_MOST 10
#define UNIT_SLACK 0.02 /* of a quaternion's length, as of a device's */

struct parser {
	const char *name;
	struct gr_diag *diag;
	int line;
	size_t first_error, known;
	struct survey_point *points;
	size_t count, room;
};

__attribute__((format(printf, 3, 4))) static bool fault(struct parser *p, const char *key,
							const char *format, ...)
{
	char what[200];
	va_list args;

	va_start(args, format);
	vsnprintf(what, sizeof what, format, args);
	va_end(args);
	gr_diag_add(p->diag, GR_DIAG_ERROR, p->name, p->line, key, "%s", what);
	return false;
}

/* The first word, up to a blank. */
static bool take_name(struct parser *p, struct track_text *text, char out[SURVEY_NAME_MAX])
{
	size_t len = 0;

	while (text->at < text->end && (*text->at == ' ' || *text->at == '\t'))
		text->at++;
	while ((size_t)(text->end - text->at) > len && text->at[len] != ' ' && text->at[len] != '\t')
		len++;
	if (len >= SURVEY_NAME_MAX)
		return fault(p, NULL, "a name of %zu bytes, at most %d", len, SURVEY_NAME_MAX - 1);
	for (size_t i = 0; i < len; i++)
		if ((unsigned char)text->at[i] < ' ' || text->at[i] == 0x7f)
			return fault(p, NULL, "a control character in the name; this is not a text file");
	memcpy(out, text->at, len);
	out[len] = '\0';
	text->at += len;
	return true;
}

static bool take_turn(struct parser *p, const double q[4], struct rotation *out)
{
	const double n = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);

	if (!(fabs(n - 1) <= UNIT_SLACK))
		return fault(p, "qx qy qz qw", "a quaternion of length %g, must be 1 within %g", n,
			     UNIT_SLACK);
	for (int i = 0; i < 4; i++)
		out->q[i] = q[i] / n;
	return true;
}

static bool take_point(struct parser *p, struct track_text *text, struct survey_point *out)
{
	double v[NUMBERS_MOST];
	int n = 0;

	memset(out, 0, sizeof *out);
	if (!take_name(p, text, out->name))
		return false;
	while (n < NUMBERS_MOST && !track_text_done(text)) {
		v[n++] = track_text_number(text, (double)TRACK_PLACE_MAX_M);
		/* Numbers stand apart: 1-2 is none. */
		if (!text->ok || (text->at < text->end && *text->at != ' ' && *text->at != '\t'))
			return fault(p, NULL, "number %d is none from -%g to %g", n,
				     (double)TRACK_PLACE_MAX_M, (double)TRACK_PLACE_MAX_M);
	}
	if (!track_text_done(text) || (n != 3 && n != 7 && n != 10))
		return fault(p, NULL,
			     "%s%d numbers behind the name, must be 3 (x y z), 10 (and px py pz qx qy qz "
			     "qw) or 7 (these alone)",
			     track_text_done(text) ? "" : "more than ", n);
	out->known = n != 7;
	out->measured = n != 3;
	if (out->known)
		memcpy(out->room, v, sizeof out->room);
	if (!out->measured)
		return true;
	memcpy(out->p, v + n - 7, sizeof out->p);
	return take_turn(p, v + n - 4, &out->q);
}

static bool check_known(struct parser *p, const struct survey_point *point)
{
	if (p->known == ALIGN_POINTS)
		return fault(p, NULL, "more than %d points of the room", ALIGN_POINTS);
	p->known++;
	for (size_t i = 0; i < p->count; i++)
		if (p->points[i].known && !strcmp(p->points[i].name, point->name))
			return fault(p, NULL, "a point \"%s\" is there already", point->name);
	return true;
}

static int append(struct parser *p, const struct survey_point *point)
{
	if (p->count == SURVEY_POINTS_MAX) {
		fault(p, NULL, "more than %d lines", SURVEY_POINTS_MAX);
		return GR_ERR_FORMAT;
	}
	if (p->count == p->room) {
		const size_t room = p->room ? 2 * p->room : 64;
		struct survey_point *grown = realloc(p->points, room * sizeof *grown);

		if (!grown)
			return GR_ERR_NOMEM;
		p->points = grown;
		p->room = room;
	}
	p->points[p->count++] = *point;
	return GR_OK;
}

static int parse_line(struct parser *p, struct track_text line)
{
	const char *comment = line.end > line.at ?
				      memchr(line.at, '#', (size_t)(line.end - line.at)) :
				      NULL;
	struct survey_point point;

	if (comment)
		line.end = comment;
	if (track_text_done(&line))
		return GR_OK;
	if (take_point(p, &line, &point) && (!point.known || check_known(p, &point)))
		return append(p, &point);
	if (p->diag->errors - p->first_error < FAULTS_MAX)
		return GR_OK;
	fault(p, NULL, "%d faults so far; the rest of the file was not read", FAULTS_MAX);
	return GR_ERR_FORMAT;
}

int survey_parse(const char *text, size_t len, const char *name, struct survey_point **out,
		 size_t *out_count, struct gr_diag *diag)
{
	struct parser p = { .name = name, .diag = diag, .first_error = diag->errors };
	struct track_text all = track_text(text, len), line;
	int r = GR_OK;

	*out = NULL;
	while (r == GR_OK && track_text_line(&all, &line)) {
		p.line++;
		r = parse_line(&p, line);
	}
	p.line = 0;
	if (r == GR_OK && diag->errors == p.first_error && p.count == 0)
		fault(&p, NULL, "holds no point, must hold lines of NAME x y z");
	if (r == GR_OK && diag->errors != p.first_error)
		r = GR_ERR_FORMAT;
	if (r < 0) {
		free(p.points);
		return r;
	}
	*out = p.points;
	*out_count = p.count;
	return GR_OK;
}

static int refuse(struct gr_diag *diag, const char *path, const char *what)
{
	gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "%s: %s", what, strerror(errno));
	return GR_ERR_IO;
}

static int read_all(int fd, const char *path, char **out, size_t *out_len, struct gr_diag *diag)
{
	struct stat status;
	ssize_t n = 1;

	if (fstat(fd, &status) < 0)
		return refuse(diag, path, "cannot be looked at");
	if (!S_ISREG(status.st_mode) || status.st_size > SURVEY_BYTES_MAX) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
			    "must be a regular file of at most %ld bytes", SURVEY_BYTES_MAX);
		return GR_ERR_FORMAT;
	}
	*out = malloc((size_t)status.st_size + 1);
	if (!*out)
		return GR_ERR_NOMEM;
	/* Until its end, or as long as it was: it may shrink meanwhile. */
	while (n != 0 && *out_len < (size_t)status.st_size) {
		n = read(fd, *out + *out_len, (size_t)status.st_size - *out_len);
		if (n < 0 && errno != EINTR)
			return refuse(diag, path, "cannot be read");
		*out_len += n > 0 ? (size_t)n : 0;
	}
	return GR_OK;
}

int survey_load(const char *path, struct survey_point **out, size_t *out_count, struct gr_diag *diag)
{
	/* Not to hang in open() should the path name a pipe. */
	const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	char *text = NULL;
	size_t len = 0;
	int r;

	*out = NULL;
	if (fd < 0)
		return refuse(diag, path, "cannot be opened");
	r = read_all(fd, path, &text, &len, diag);
	close(fd);
	if (r == GR_OK)
		r = survey_parse(text, len, path, out, out_count, diag);
	free(text);
	return r;
}

void survey_write(FILE *file, const struct survey_point *point)
{
	fprintf(file, "%s", point->name);
	if (point->known)
		for (int i = 0; i < 3; i++)
			fprintf(file, " %.9f", point->room[i]);
	if (point->measured) {
		for (int i = 0; i < 3; i++)
			fprintf(file, " %.9f", point->p[i]);
		for (int i = 0; i < 4; i++)
			fprintf(file, " %.9f", point->q.q[i]);
	}
	fprintf(file, "\n");
}
