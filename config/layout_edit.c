#include "config/layout_edit.h"

#include "base/plain.h"
#include "base/result.h"
#include "config/layout.h"
#include "config/setting_place.h"
#include "config/text_changes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NOTE "/* calibrated "
#define LENGTH_DIGITS 5 /* after the point, metres */
#define ANGLE_DIGITS 4  /* degrees */
#define SHOWN_M 1e-4    /* a float of 1000 m, and half the last digit */

/* With a point, as libconfig wants a float, and no minus before zeros. */
static void append_number(struct text_change *change, double value, int digits)
{
	char text[64];

	snprintf(text, sizeof text, "%.*f", digits, value);
	text_change_append(change, "%s", strspn(text, "-0.") == strlen(text) && text[0] == '-' ? text + 1 : text);
}

static void append_scale(struct text_change *change, double value)
{
	const struct gr_plain plain = gr_plain(value, 7);

	text_change_append(change, "%s%s", plain.text, strpbrk(plain.text, ".e") ? "" : ".0");
}

static void append_vector(struct text_change *change, const double v[3])
{
	text_change_append(change, "[");
	for (int i = 0; i < 3; i++) {
		text_change_append(change, i ? ", " : "");
		append_number(change, v[i], LENGTH_DIGITS);
	}
	text_change_append(change, "]");
}

static void append_note(struct text_change *change, const char *note)
{
	text_change_append(change, " %s", NOTE);
	/* No name may end the comment. */
	for (; *note; note++)
		text_change_append(change, "%c", *note == '*' || (unsigned char)*note < ' ' ? '-' : *note);
	text_change_append(change, " */");
}

/* The note behind a group's '{', where an old one gives way. */
static struct text_change *note_group(const struct setting_text *t, const struct setting_place *group,
				 struct text_changes *c, const char *note)
{
	size_t at = group->begin + 1, end = at;
	struct text_change *change;

	while (end < group->end && (t->bytes[end] == ' ' || t->bytes[end] == '\t'))
		end++;
	if (group->end - end > strlen(NOTE) && memcmp(t->bytes + end, NOTE, strlen(NOTE)) == 0) {
		const char *close = strstr(t->bytes + end, "*/");

		end = close ? (size_t)(close - t->bytes) + 2 : at;
	} else {
		end = at;
	}
	change = text_changes_add(c, at, end);
	append_note(change, note);
	return change;
}

/* The elements of a vector one by one, so that a comment between them stays. */
static bool change_vector(const struct setting_text *t, const struct setting_place *list,
			  const double v[3], struct text_changes *c)
{
	for (size_t i = 0; i < 3; i++) {
		struct setting_place element;

		if (!setting_place_element(t, list, i, &element))
			return false;
		append_number(text_changes_add(c, element.begin, element.end), v[i], LENGTH_DIGITS);
	}
	return true;
}

static const char *const angle_keys[] = { "heading_deg", "pitch_deg", "roll_deg" };

/* What `base` has is changed; what it has not goes behind `position`, or the '{'. */
static bool change_base(const struct setting_text *t, const struct setting_place *base,
			const struct layout_edit *edit, struct text_changes *c)
{
	struct setting_place place, position;
	struct text_change *rest = note_group(t, base, c, edit->note);

	if (setting_place_member(t, base, "position", &position)) {
		if (!change_vector(t, &position, edit->position, c))
			return false;
		rest = text_changes_add(c, position.after, position.after);
		text_change_append(rest, position.after == position.end ? ";" : "");
	} else {
		text_change_append(rest, " position = ");
		append_vector(rest, edit->position);
		text_change_append(rest, ";");
	}
	for (int i = 0; i < 3; i++) {
		const bool there = setting_place_member(t, base, angle_keys[i], &place);
		struct text_change *change = there ? text_changes_add(c, place.begin, place.end) : rest;

		if (!there)
			text_change_append(change, " %s = ", angle_keys[i]);
		append_number(change, edit->angles_deg[i], ANGLE_DIGITS);
		text_change_append(change, there ? "" : ";");
	}
	if (edit->scale > 0) {
		const bool there = setting_place_member(t, base, "scale", &place);
		struct text_change *change = there ? text_changes_add(c, place.begin, place.end) : rest;

		if (!there)
			text_change_append(change, " scale = ");
		append_scale(change, edit->scale);
		text_change_append(change, there ? "" : ";");
	}
	/* With nothing behind it, position needs no end. */
	if (!strcmp(rest->text, ";"))
		rest->text[0] = '\0';
	return true;
}

/* The end of the line where that holds nothing but a comment, else `at`. */
static size_t behind_comment(const struct setting_text *t, size_t at)
{
	size_t end = at + strspn(t->bytes + at, " \t");

	if (t->bytes[end] == '#' || !strncmp(t->bytes + end, "//", 2))
		end += strcspn(t->bytes + end, "\r\n");
	return t->bytes[end] == '\r' || t->bytes[end] == '\n' ? end : at;
}

/* A line of its own behind `kind`, as far to the right as that. */
static bool add_base(const struct setting_text *t, const struct setting_place *tracker,
		     const struct layout_edit *edit, struct text_changes *c)
{
	struct setting_place kind;
	struct text_change *change;
	size_t line, blanks, at;
	const char *feed = strchr(t->bytes, '\n');

	if (!setting_place_member(t, tracker, "kind", &kind))
		return false;
	for (line = kind.key; line > 0 && t->bytes[line - 1] != '\n'; line--)
		;
	blanks = strspn(t->bytes + line, " \t");
	at = behind_comment(t, kind.after);
	/* The ';' goes before a comment, which would take it in. */
	if (kind.after == kind.end && at > kind.end)
		text_change_append(text_changes_add(c, kind.end, kind.end), ";");
	change = text_changes_add(c, at, at);
	text_change_append(change, kind.after == kind.end && at == kind.end ? ";" : "");
	text_change_append(change, "%s\n%.*s%sbase = {", feed && feed > t->bytes && feed[-1] == '\r' ? "\r" : "",
	       (int)(blanks < 100 ? blanks : 100), t->bytes + line,
	       line + blanks < kind.key ? "  " : "");
	append_note(change, edit->note);
	text_change_append(change, " position = ");
	append_vector(change, edit->position);
	for (int i = 0; i < 3; i++) {
		text_change_append(change, "; %s = ", angle_keys[i]);
		append_number(change, edit->angles_deg[i], ANGLE_DIGITS);
	}
	if (edit->scale > 0) {
		text_change_append(change, "; scale = ");
		append_scale(change, edit->scale);
	}
	text_change_append(change, "; };");
	return true;
}

static bool change_offset(const struct setting_text *t, const struct setting_place *tracker,
			  const struct layout_edit *edit, struct text_changes *c)
{
	struct setting_place list, binding, offset;
	struct text_change *note;

	if (!setting_place_member(t, tracker, "bind", &list) ||
	    !setting_place_element(t, &list, edit->binding, &binding))
		return false;
	note = note_group(t, &binding, c, edit->note);
	if (setting_place_member(t, &binding, "offset", &offset))
		return change_vector(t, &offset, edit->position, c);
	text_change_append(note, " offset = ");
	append_vector(note, edit->position);
	text_change_append(note, ";");
	return true;
}

static bool make_changes(const struct setting_text *t, const struct layout_edit *edit,
			 struct text_changes *c)
{
	const struct setting_place root = setting_place_root(t);
	struct setting_place trackers, tracker, base;

	if (!setting_place_member(t, &root, "trackers", &trackers) ||
	    !setting_place_element(t, &trackers, edit->tracker, &tracker))
		return false;
	if (edit->what == LAYOUT_EDIT_OFFSET)
		return change_offset(t, &tracker, edit, c);
	return setting_place_member(t, &tracker, "base", &base) ? change_base(t, &base, edit, c) :
								  add_base(t, &tracker, edit, c);
}

/* ---- whether it came out as it was meant ---- */

/* As layout_write has it; NULL: no memory. The caller frees. */
static char *written(const struct layout *layout)
{
	char *text = NULL;
	size_t len;
	FILE *file = open_memstream(&text, &len);
	int r = file ? layout_write(file, layout) : GR_ERR_NOMEM;

	if (file && fclose(file) != 0)
		r = GR_ERR_NOMEM;
	if (r == GR_OK)
		return text;
	free(text);
	return NULL;
}

static bool near(const vec3 found, const double wanted[3])
{
	for (int i = 0; i < 3; i++)
		if (!(fabs((double)found[i] - wanted[i]) <= SHOWN_M))
			return false;
	return true;
}

/* `now` has what was asked for, and `before` with that is `now`. */
static int check(struct layout *before, const struct layout *now, const struct layout_edit *edit)
{
	struct layout_tracker *old = &before->trackers[edit->tracker];
	const struct layout_tracker *new = &now->trackers[edit->tracker];
	char *a, *b;
	bool right;
	int r = GR_ERR_NOMEM;

	if (before->tracker_count != now->tracker_count || old->binding_count != new->binding_count)
		return GR_ERR_FORMAT;
	if (edit->what == LAYOUT_EDIT_BASE) {
		right = near(new->room_base.position, edit->position);
		for (int i = 0; i < 3; i++)
			right = right && fabs((double)new->room_base.angles[i] * (180 / M_PI) -
					      edit->angles_deg[i]) <= 1e-3;
		old->room_base = new->room_base;
		if (edit->scale > 0) {
			right = right && fabs((double)new->scale / edit->scale - 1) <= 1e-5;
			old->scale = new->scale;
		}
	} else {
		right = near(new->bindings[edit->binding].sensor_body.position, edit->position);
		old->bindings[edit->binding].sensor_body = new->bindings[edit->binding].sensor_body;
	}
	a = written(before);
	b = written(now);
	if (a && b)
		r = right && !strcmp(a, b) ? GR_OK : GR_ERR_FORMAT;
	free(a);
	free(b);
	return r;
}

int layout_edit(const char *text, size_t len, const char *path, const struct layout_edit *edit,
		char **out, size_t *out_len, struct gr_diag *diag)
{
	struct layout *before = NULL, *now = NULL;
	struct text_changes *changes = calloc(1, sizeof *changes);
	/* A NUL behind it: searches end there. */
	char *copy = malloc(len + 1), *made = NULL;
	struct gr_diag own = { 0 };
	int r = GR_ERR_NOMEM;

	*out = NULL;
	if (!copy || !changes)
		goto out;
	memcpy(copy, text, len);
	copy[len] = '\0';
	r = layout_parse(text, len, path, &before, diag);
	if (r < 0)
		goto out;
	r = GR_ERR_FORMAT;
	if (edit->tracker >= before->tracker_count ||
	    !make_changes(&(struct setting_text){ copy, len }, edit, changes))
		goto out;
	made = text_changes_apply(changes, copy, len, out_len);
	r = made ? layout_parse(made, *out_len, path, &now, &own) : GR_ERR_NOMEM;
	if (r == GR_OK)
		r = check(before, now, edit);
	else if (r == GR_ERR_CONFIG)
		r = GR_ERR_FORMAT;
	if (r == GR_OK) {
		*out = made;
		made = NULL;
	}
out:
	if (r == GR_ERR_FORMAT)
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
			    "is written in a way that cannot be changed without touching the rest%s%s; "
			    "put the values in by hand",
			    own.count ? ": " : "", own.count ? own.items[0].text : "");
	gr_diag_finish(&own);
	layout_destroy(&before);
	layout_destroy(&now);
	free(changes);
	free(copy);
	free(made);
	return r;
}
