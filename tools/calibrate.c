/* grotto trackers calibrate: where a device is in the room, and how long the arm from its sensor is. */
#include "tools/calibrate.h"

#include "base/result.h"
#include "config/layout_edit.h"
#include "tools/cli.h"
#include "tools/say.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_SOCKET GROTTO_RUNDIR "/control"

struct options {
	const char *layout, *tracker, *body, *points, *keep, *socket;
	bool open, pivot, arm, scale, dry_run;
	float still_mm, most_mm, seconds;
};

static int wrong(const char *what)
{
	fprintf(stderr, "grotto trackers calibrate: %s\n", what);
	return GR_EXIT_CONFIG;
}

static int check_options(const struct options *o, int words)
{
	if (words != 0)
		return wrong("takes no words; see --help");
	if (!o->layout)
		return wrong("needs --layout FILE, which it writes the result to");
	if (!o->points && !o->pivot)
		return wrong("needs --points FILE: a line NAME x y z for each known point of the room, metres");
	if (o->pivot && o->arm)
		return wrong("--pivot and --arm are two ways to the same: give one");
	if (o->scale && (o->pivot || o->arm))
		return wrong("--scale is of the base, --pivot and --arm take it as the layout has it");
	if (o->open && o->socket)
		return wrong("--open asks no master; leave out --socket");
	if (cli_same_file(o->keep, o->layout))
		return wrong("--keep would write over the layout: give it a file of its own");
	return GR_EXIT_OK;
}

/* ---- which tracker, which binding ---- */

static const struct layout_tracker *find_tracker(const struct layout *layout, const char *name,
						 size_t *index)
{
	const struct layout_tracker *found = NULL;
	size_t devices = 0;

	for (size_t i = 0; i < layout->tracker_count; i++) {
		const struct layout_tracker *t = &layout->trackers[i];

		devices += layout_tracker_is_device(t);
		if (name ? strcmp(t->name, name) != 0 : !layout_tracker_is_device(t))
			continue;
		found = t;
		*index = i;
	}
	if (!found || (!name && devices > 1))
		fprintf(stderr, "grotto trackers calibrate: %s: %s%s%s\n", layout->path,
			name	    ? "has no tracker \"" :
			devices > 1 ? "has several devices; say which by --tracker NAME" :
				      "has no device among its trackers",
			name ? name : "", name ? "\"" : "");
	else if (!layout_tracker_is_device(found))
		fprintf(stderr, "grotto trackers calibrate: \"%s\" is simulated or replayed, in the room's own "
				"frame: there is nothing to calibrate\n",
			found->name);
	else
		return found;
	return NULL;
}

/* Of the body that is asked for, else of the wand before the head. */
static const struct layout_binding *find_binding(const struct layout_tracker *tracker, const char *body,
						 size_t *index)
{
	const struct layout_binding *found = NULL;

	for (size_t k = 0; k < tracker->binding_count; k++) {
		const struct layout_binding *b = &tracker->bindings[k];
		const bool head = b->body == LAYOUT_HEAD;

		if (!b->position || (body ? strcmp(body, head ? "head" : "wand") != 0 : found && head))
			continue;
		found = b;
		*index = k;
	}
	if (!found)
		fprintf(stderr, "grotto trackers calibrate: no binding of \"%s\" gives the position of %s%s\n",
			tracker->name, body ? "the " : "a body", body ? body : "");
	return found;
}

/* ---- what was measured ---- */

static size_t count_open(const struct survey_point *points, size_t count)
{
	size_t open = 0;

	for (size_t i = 0; i < count; i++)
		open += points[i].known && !points[i].measured;
	return open;
}

static int keep(const char *path, const struct calibrate *c, const struct survey_point *points, size_t count)
{
	FILE *file = fopen(path, "we");
	bool failed;

	if (!file) {
		fprintf(stderr, "grotto trackers calibrate: %s: %s\n", path, strerror(errno));
		return GR_ERR_IO;
	}
	fprintf(file, "# tracker \"%s\", sensor \"%s\", %s\n# name %spx py pz qx qy qz qw\n", c->tracker->name,
		c->binding->sensor, calibrate_body(c), c->what == CALIBRATE_PIVOT ? "" : "x y z ");
	for (size_t i = 0; i < count; i++)
		survey_write(file, &points[i]);
	failed = ferror(file) != 0;
	if (fclose(file) == 0 && !failed)
		return GR_OK;
	fprintf(stderr, "grotto trackers calibrate: %s: %s\n", path, strerror(errno));
	return GR_ERR_IO;
}

/* What the file leaves open is asked for. */
static int ask(const struct options *o, const struct calibrate *c, struct survey_point **points, size_t *count)
{
	const char *master = c->layout->control_socket ? c->layout->control_socket : DEFAULT_SOCKET;
	struct calibrate_reader *reader;
	struct gr_diag diag = { 0 };
	int r = calibrate_reader_open(&reader, c, o->open ? NULL : o->socket ? o->socket : master, &diag);

	say_diag(&diag);
	gr_diag_finish(&diag);
	if (r < 0)
		return r;
	r = *points ? calibrate_ask_points(c, reader, *points, *count) :
		      calibrate_ask_pivot(c, reader, points, count);
	calibrate_reader_close(&reader);
	if (r == GR_NOTHING)
		fprintf(stderr, "given up; nothing was changed\n");
	return r;
}

static int measure(const struct options *o, const struct calibrate *c, struct survey_point **points,
		   size_t *count)
{
	struct gr_diag diag = { 0 };
	int r = GR_OK;

	if (o->points) {
		r = survey_load(o->points, points, count, &diag);
		say_diag(&diag);
		gr_diag_finish(&diag);
	}
	if (r == GR_OK && (!o->points || (c->what != CALIBRATE_PIVOT && count_open(*points, *count) > 0)))
		r = ask(o, c, points, count);
	if (r == GR_OK && o->keep)
		r = keep(o->keep, c, *points, *count);
	return r;
}

/* ---- the whole ---- */

static int write_back(const struct options *o, const char *text, size_t len, const struct layout_edit *edit)
{
	struct gr_diag diag = { 0 };
	char *changed = NULL;
	size_t changed_len;
	int r = layout_edit(text, len, o->layout, edit, &changed, &changed_len, &diag);

	if (r == GR_OK && !o->dry_run)
		r = layout_replace(o->layout, text, len, changed, changed_len, &diag);
	say_diag(&diag);
	gr_diag_finish(&diag);
	free(changed);
	if (r == GR_OK && o->dry_run)
		printf("%s: left as it is\n", o->layout);
	else if (r == GR_OK)
		printf("%s: written; a master that runs must be started anew to use it\n", o->layout);
	return r;
}

static int exit_of(int result)
{
	return result == GR_OK ? GR_EXIT_OK : result == GR_ERR_CONFIG ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
}

static int run(const struct options *o, const struct layout *layout, const char *text, size_t len)
{
	struct calibrate c = {
		.what = o->pivot ? CALIBRATE_PIVOT : o->arm ? CALIBRATE_ARM : CALIBRATE_BASE,
		.layout = layout,
		.scale = o->scale,
		.most_m = (double)o->most_mm * 1e-3,
		.still_m = (double)o->still_mm * 1e-3,
		.seconds = o->seconds > 0 ? (double)o->seconds : o->pivot ? 15 : 1,
	};
	struct survey_point *points = NULL;
	struct layout_edit edit;
	char note[CALIBRATE_NOTE] = "";
	size_t count = 0;
	int r;

	c.tracker = find_tracker(layout, o->tracker, &c.tracker_index);
	c.binding = c.tracker ? find_binding(c.tracker, o->body, &c.binding_index) : NULL;
	if (!c.binding)
		return GR_EXIT_CONFIG;
	r = measure(o, &c, &points, &count);
	if (r == GR_OK)
		r = calibrate_solve(&c, points, count, &edit, note);
	if (r == GR_OK)
		r = write_back(o, text, len, &edit);
	free(points);
	return exit_of(r);
}

int trackers_calibrate(int argc, char **argv)
{
	struct options o = { .still_mm = 3, .most_mm = 30 };
	const struct cli_option options[] = {
		{ "layout", 'l', CLI_TEXT, &o.layout, 0, 0, "FILE", "the layout, which gets the result" },
		{ "points", 'p', CLI_TEXT, &o.points, 0, 0, "FILE",
		  "lines of NAME x y z, and what was measured, if it was" },
		{ "tracker", 't', CLI_TEXT, &o.tracker, 0, 0, "NAME", "of the layout (its only device)" },
		{ "body", 'b', CLI_TEXT, &o.body, 0, 0, "BODY", "wand or head (the wand, if it is bound)" },
		{ "pivot", 0, CLI_FLAG, &o.pivot, 0, 0, NULL,
		  "the arm to the wand's tip, by turning it about a fixed point" },
		{ "arm", 0, CLI_FLAG, &o.arm, 0, 0, NULL,
		  "the arm by known points, with the base of the layout: for the eyes" },
		{ "scale", 0, CLI_FLAG, &o.scale, 0, 0, NULL, "how long the device's metre is, too" },
		{ "open", 'o', CLI_FLAG, &o.open, 0, 0, NULL, "open the device here, without a master" },
		{ "socket", 's', CLI_TEXT, &o.socket, 0, 0, "PATH", "the master's control socket (the layout's)" },
		{ "seconds", 0, CLI_REAL, &o.seconds, 0.1, 600, "S", "of samples at a point (1), of a pivot (15)" },
		{ "still-mm", 0, CLI_REAL, &o.still_mm, 0.01, 1000, "MM",
		  "it may move by so much at a point, rms (3)" },
		{ "most-mm", 0, CLI_REAL, &o.most_mm, 0.01, 1000, "MM", "residual that is too much, rms (30)" },
		{ "keep", 'k', CLI_TEXT, &o.keep, 0, 0, "FILE", "write what was measured, to be given to --points" },
		{ "dry-run", 'n', CLI_FLAG, &o.dry_run, 0, 0, NULL, "write nothing into the layout" },
	};
	const struct cli_table table = {
		"grotto trackers calibrate --layout FILE --points FILE [--scale] [--open]\n"
		"       grotto trackers calibrate --layout FILE --pivot [--open]\n"
		"       grotto trackers calibrate --layout FILE --arm --body head --points FILE [--open]",
		"Finds where a device's frame is in the room, from known points that the wand's tip is held\n"
		"at, or the arm from a sensor to wand's tip or eyes. Names points that do not agree, and\n"
		"writes the result into the layout, whose other text stays as it is.",
		options, sizeof options / sizeof options[0]
	};
	struct layout *layout = NULL;
	struct gr_diag diag = { 0 };
	char *text = NULL;
	size_t len = 0;
	int words, status, r;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	status = check_options(&o, words);
	if (status != GR_EXIT_OK)
		return status;
	r = layout_text_load(o.layout, &text, &len, &diag);
	if (r == GR_OK)
		r = layout_parse(text, len, o.layout, &layout, &diag);
	say_diag(&diag);
	gr_diag_finish(&diag);
	status = r == GR_OK ? run(&o, layout, text, len) : GR_EXIT_CONFIG;
	layout_destroy(&layout);
	free(text);
	return status;
}
