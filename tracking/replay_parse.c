#include "tracking/replay.h"

#include "base/clock.h"
#include "base/result.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FIELDS 11
#define WORD_MAX 48         /* bytes of one number */
#define FAULTS_MAX 20       /* then the rest is not looked at */
#define PLACE_MAX_M 1000.0  /* as far as the protocol carries a pose */

struct word {
	const char *text;
	size_t len;
};

struct parser {
	const char *name;
	int line;
	struct gr_diag *diag;
	size_t first_error;
	struct track_sample *samples;
	size_t count, room;
	int64_t last_ns[TRACK_BODIES];
	int last_line[TRACK_BODIES];
};

static const char *const field_name[FIELDS] = {
	"time_s", "body", "valid", "px", "py", "pz", "qx", "qy", "qz", "qw", "buttons",
};

/* A word as part of a message: short, and nothing that a terminal would obey. */
static const char *shown(const struct word *word, char buffer[WORD_MAX])
{
	size_t n = word->len < WORD_MAX - 4 ? word->len : WORD_MAX - 4;

	for (size_t i = 0; i < n; i++)
		buffer[i] = word->text[i] >= 0x20 && word->text[i] < 0x7f ? word->text[i] : '?';
	memcpy(buffer + n, n < word->len ? "..." : "", n < word->len ? 4 : 1);
	return buffer;
}

static bool fault(struct parser *p, int field, const struct word *word, const char *right)
{
	char text[WORD_MAX];

	gr_diag_add(p->diag, GR_DIAG_ERROR, p->name, p->line, field_name[field],
		    "is \"%s\", must be %s", shown(word, text), right);
	return false;
}

/* The line's words; one more than FIELDS says that there are too many. */
static int split(const char *line, size_t len, struct word words[FIELDS + 1])
{
	int count = 0;
	size_t at = 0;

	while (count <= FIELDS) {
		size_t from;

		while (at < len && (line[at] == ' ' || line[at] == '\t' || line[at] == '\r'))
			at++;
		if (at == len || line[at] == '#')
			break;
		from = at;
		while (at < len && line[at] != ' ' && line[at] != '\t' && line[at] != '\r' &&
		       line[at] != '#')
			at++;
		words[count++] = (struct word){ line + from, at - from };
	}
	return count;
}

static bool is(const struct word *word, const char *text)
{
	return word->len == strlen(text) && memcmp(word->text, text, word->len) == 0;
}

/*
 * Seconds with up to nine decimals, exactly: a double would round the
 * nanoseconds of a clock that has run for some months.
 */
static bool parse_time(const struct word *word, int64_t *out)
{
	int64_t ns = 0, unit = GR_NS_PER_S;
	size_t at = 0, digits = 0;

	for (; at < word->len && word->text[at] >= '0' && word->text[at] <= '9'; at++, digits++) {
		ns = ns * 10 + (word->text[at] - '0');
		if (ns > TRACK_REPLAY_MAX_S)
			return false;
	}
	ns *= GR_NS_PER_S;
	if (at < word->len && word->text[at] == '.')
		for (at++; at < word->len && word->text[at] >= '0' && word->text[at] <= '9';
		     at++, digits++) {
			unit /= 10;
			ns += unit * (word->text[at] - '0');
		}
	*out = ns;
	return at == word->len && digits > 0 && ns <= TRACK_REPLAY_MAX_S * GR_NS_PER_S;
}

/* Decimal notation alone: strtod also takes "nan", "inf" and hexadecimal. */
static bool parse_number(const struct word *word, double *out)
{
	char text[WORD_MAX];
	char *end;

	if (word->len == 0 || word->len >= sizeof text)
		return false;
	for (size_t i = 0; i < word->len; i++)
		if (!strchr("+-.0123456789eE", word->text[i]) || word->text[i] == '\0')
			return false;
	memcpy(text, word->text, word->len);
	text[word->len] = '\0';
	*out = strtod(text, &end);
	return *end == '\0' && isfinite(*out);
}

static bool parse_buttons(const struct word *word, uint32_t *out)
{
	uint64_t value = 0;

	if (word->len == 0 || word->len > 10)
		return false;
	for (size_t i = 0; i < word->len; i++) {
		if (word->text[i] < '0' || word->text[i] > '9')
			return false;
		value = value * 10 + (uint64_t)(word->text[i] - '0');
	}
	*out = (uint32_t)value;
	return value <= UINT32_MAX;
}

static bool parse_pose(struct parser *p, const struct word *words, struct gr_pose *out)
{
	double value[7], norm = 0;

	for (int i = 0; i < 7; i++) {
		if (!parse_number(&words[i], &value[i]))
			return fault(p, 3 + i, &words[i], "a finite decimal number");
		if (i < 3 && fabs(value[i]) > PLACE_MAX_M)
			return fault(p, 3 + i, &words[i], "within 1000 m of the room's origin");
		if (i >= 3)
			norm += value[i] * value[i];
	}
	norm = sqrt(norm);
	if (!(fabs(norm - 1.0) <= 1e-3)) {
		gr_diag_add(p->diag, GR_DIAG_ERROR, p->name, p->line, "qx qy qz qw",
			    "quaternion has length %g, must be 1 within 0.001", norm);
		return false;
	}
	for (int i = 0; i < 3; i++)
		out->p[i] = (float)value[i];
	for (int i = 0; i < 4; i++)
		out->q[i] = (float)value[3 + i];
	return true;
}

static bool parse_sample(struct parser *p, const struct word *w, struct track_sample *out)
{
	*out = (struct track_sample){ 0 };
	if (!parse_time(&w[0], &out->time_ns))
		return fault(p, 0, &w[0], "seconds from 0 to 10000000, with up to nine decimals");
	if (is(&w[1], "head"))
		out->body = TRACK_HEAD;
	else if (is(&w[1], "wand"))
		out->body = TRACK_WAND;
	else
		return fault(p, 1, &w[1], "head or wand");
	if (!is(&w[2], "0") && !is(&w[2], "1"))
		return fault(p, 2, &w[2], "0 (lost) or 1 (tracked)");
	out->valid = is(&w[2], "1");
	if (!parse_pose(p, &w[3], &out->T_room_body))
		return false;
	if (!parse_buttons(&w[10], &out->buttons))
		return fault(p, 10, &w[10], "a decimal number from 0 to 4294967295");
	if (p->last_line[out->body] && out->time_ns <= p->last_ns[out->body]) {
		gr_diag_add(p->diag, GR_DIAG_ERROR, p->name, p->line, "time_s",
			    "is not later than the %s's sample before it, in line %d",
			    track_body_name(out->body), p->last_line[out->body]);
		return false;
	}
	p->last_ns[out->body] = out->time_ns;
	p->last_line[out->body] = p->line;
	return true;
}

static int append(struct parser *p, const struct track_sample *sample)
{
	if (p->count == TRACK_REPLAY_MAX_SAMPLES) {
		gr_diag_add(p->diag, GR_DIAG_ERROR, p->name, p->line, NULL,
			    "more than %d samples: cut the log", TRACK_REPLAY_MAX_SAMPLES);
		return GR_ERR_FORMAT;
	}
	if (p->count == p->room) {
		size_t room = p->room ? p->room * 2 : 256;
		struct track_sample *grown = realloc(p->samples, room * sizeof *grown);

		if (!grown)
			return GR_ERR_NOMEM;
		p->samples = grown;
		p->room = room;
	}
	p->samples[p->count++] = *sample;
	return GR_OK;
}

static int parse_line(struct parser *p, const char *line, size_t len)
{
	struct word words[FIELDS + 1];
	struct track_sample sample;
	int count = split(line, len, words);

	if (count == 0)
		return GR_OK;
	if (count != FIELDS)
		gr_diag_add(p->diag, GR_DIAG_ERROR, p->name, p->line, NULL,
			    "has %s%d fields, must have %d: time_s body valid px py pz qx qy qz qw "
			    "buttons",
			    count > FIELDS ? "more than " : "", count > FIELDS ? FIELDS : count, FIELDS);
	else if (parse_sample(p, words, &sample))
		return append(p, &sample);
	if (p->diag->errors - p->first_error < FAULTS_MAX)
		return GR_OK;
	gr_diag_add(p->diag, GR_DIAG_ERROR, p->name, p->line, NULL,
		    "%d faults so far; the rest of the file was not read", FAULTS_MAX);
	return GR_ERR_FORMAT;
}

/* Per body the times ascend, so (time, body) tells any two samples apart. */
static int by_time(const void *a, const void *b)
{
	const struct track_sample *x = a, *y = b;

	if (x->time_ns != y->time_ns)
		return x->time_ns < y->time_ns ? -1 : 1;
	return (int)x->body - (int)y->body;
}

int track_replay_parse(const char *text, size_t len, const char *name,
		       struct track_sample **out_samples, size_t *out_count, struct gr_diag *diag)
{
	struct parser p = { .name = name, .diag = diag, .first_error = diag->errors };
	int result = GR_OK;
	bool clean;

	for (size_t at = 0; at < len && result == GR_OK;) {
		const char *newline = memchr(text + at, '\n', len - at);
		size_t end = newline ? (size_t)(newline - text) : len;

		p.line++;
		result = parse_line(&p, text + at, end - at);
		at = end + 1;
	}
	clean = result == GR_OK && diag->errors == p.first_error;
	if (clean && p.count == 0)
		gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL,
			    "holds no sample, must hold at least one line: time_s body valid px py "
			    "pz qx qy qz qw buttons");
	if (!clean || p.count == 0) {
		free(p.samples);
		return result == GR_OK ? GR_ERR_FORMAT : result;
	}
	qsort(p.samples, p.count, sizeof *p.samples, by_time);
	*out_samples = p.samples;
	*out_count = p.count;
	return GR_OK;
}

void track_replay_write(FILE *file, const struct track_sample *sample)
{
	const struct gr_pose identity = GR_POSE_IDENTITY;
	const struct gr_pose *T = sample->valid ? &sample->T_room_body : &identity;

	/* Nine significant digits bring every float back. */
	fprintf(file, "%" PRId64 ".%09" PRId64 " %s %d", sample->time_ns / GR_NS_PER_S,
		sample->time_ns % GR_NS_PER_S, track_body_name(sample->body), sample->valid ? 1 : 0);
	for (int i = 0; i < 3; i++)
		fprintf(file, " %.9g", (double)T->p[i]);
	for (int i = 0; i < 4; i++)
		fprintf(file, " %.9g", (double)T->q[i]);
	fprintf(file, " %" PRIu32 "\n", sample->buttons);
}
