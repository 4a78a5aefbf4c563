/* A calibration's result in a layout's text: what changes, and that nothing else does. */
#include "tests/unit/layout_text.h"

#include "base/result.h"
#include "config/layout_edit.h"

#include <sys/stat.h>
#include <unistd.h>

static const struct layout_edit base_edit = {
	.what = LAYOUT_EDIT_BASE,
	.position = { 0.12345678, -2.5, 3 },
	.angles_deg = { 90.00004, -89.99996, -0.00001 },
	.note = "2026-01-02 03:04 UTC by grotto trackers: 8 points, 0.9 mm rms",
};
#define NOTE "/* calibrated 2026-01-02 03:04 UTC by grotto trackers: 8 points, 0.9 mm rms */"
#define ANGLES "heading_deg = 90.0000; pitch_deg = -90.0000; roll_deg = 0.0000;"

/* The room's text with these trackers, changed; NULL when refused. The caller's to free. */
static char *edited(const char *trackers, const struct layout_edit *edit, struct gr_diag *diag)
{
	char *whole = layout_text_with_trackers(layout_text, trackers), *out = NULL;
	const size_t len = strlen(whole);
	uint8_t *copy = unit_copy(whole, len);
	size_t out_len = 0;
	const int r = layout_edit((const char *)copy, len, "t.cave", edit, &out, &out_len, diag);

	assert_true((r == GR_OK) == (out != NULL));
	if (out)
		assert_int_equal(strlen(out), out_len);
	free(copy);
	free(whole);
	return out;
}

struct edit_case {
	const char *before, *after;
};

static void check_case(const struct edit_case *c, const struct layout_edit *edit)
{
	struct gr_diag diag = { 0 };
	char *wanted = layout_text_with_trackers(layout_text, c->after);
	char *found = edited(c->before, edit, &diag);

	unit_diag_print(&diag);
	if (!found || strcmp(found, wanted) != 0)
		fail_msg("wanted\n%s\nis\n%s", strstr(wanted, "trackers"), found ? strstr(found, "trackers") : "-");
	free(found);
	free(wanted);
	gr_diag_finish(&diag);
}

#define BIND "bind = ( { body = \"wand\"; } );"

static void bases(void **state)
{
	static const struct edit_case cases[] = {
		/* all keys there, in any order, with comments between and in them */
		{ "trackers = ( { name = \"h\"; kind = \"hydra\"; # a hydra; base = { }\n"
		  "  base = { roll_deg = 1.0; heading_deg: 5, // as measured\n"
		  "    position = [1.0, /* x; ] */ 2.0, 3.0]; pitch_deg = 7.0 }; " BIND " } );\n",
		  "trackers = ( { name = \"h\"; kind = \"hydra\"; # a hydra; base = { }\n"
		  "  base = { " NOTE " roll_deg = 0.0000; heading_deg: 90.0000, // as measured\n"
		  "    position = [0.12346, /* x; ] */ -2.50000, 3.00000]; pitch_deg = -90.0000 }; " BIND
		  " } );\n" },
		/* an earlier note gives way; what is missing is put behind the position */
		{ "trackers = ( { name = \"h\"; kind = \"hydra\"; " BIND
		  " base = { /* calibrated before */ position = (1, 2, 3); # here\n scale = 2.0; }; } );\n",
		  "trackers = ( { name = \"h\"; kind = \"hydra\"; " BIND " base = { " NOTE
		  " position = (0.12346, -2.50000, 3.00000); " ANGLES " # here\n scale = 2.0; }; } );\n" },
		{ "trackers = ( { name = \"h\"; kind = \"hydra\"; " BIND " base = { position = [1.0, 2.0, 3.0] } } );\n",
		  "trackers = ( { name = \"h\"; kind = \"hydra\"; " BIND " base = { " NOTE
		  " position = [0.12346, -2.50000, 3.00000]; " ANGLES " } } );\n" },
		/* no position */
		{ "trackers = ( { name = \"h\"; kind = \"hydra\"; base = {scale = 2.0;}; " BIND " } );\n",
		  "trackers = ( { name = \"h\"; kind = \"hydra\"; base = { " NOTE
		  " position = [0.12346, -2.50000, 3.00000]; " ANGLES "scale = 2.0;}; " BIND " } );\n" },
		/* no base: a line of its own */
		{ "trackers = (\n\t{ name = \"h\"; kind = \"hydra\"; // base = {};\n\t  " BIND " } );\n",
		  "trackers = (\n\t{ name = \"h\"; kind = \"hydra\"; // base = {};\n\t  base = { " NOTE
		  " position = [0.12346, -2.50000, 3.00000]; " ANGLES " };\n\t  " BIND " } );\n" },
		{ "trackers = (\n\t{\n\t\tname = \"h\"\n\t\tkind = \"hy\" /* two */ \"dra\" # strings\n\t\t" BIND " } );\n",
		  "trackers = (\n\t{\n\t\tname = \"h\"\n\t\tkind = \"hy\" /* two */ \"dra\"; # strings\n\t\tbase = { " NOTE
		  " position = [0.12346, -2.50000, 3.00000]; " ANGLES " };\n\t\t" BIND " } );\n" },
		{ "trackers = ( { name = \"h\"; " BIND " kind = \"hydra\" } );\n",
		  "trackers = ( { name = \"h\"; " BIND " kind = \"hydra\";\n  base = { " NOTE
		  " position = [0.12346, -2.50000, 3.00000]; " ANGLES " }; } );\n" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		check_case(&cases[i], &base_edit);
}

static void scales_and_lines_that_end_in_cr(void **state)
{
	static const struct edit_case there = {
		"trackers = ( { name = \"h\"; kind = \"hydra\"; " BIND
		" base = { position = [1.0, 2.0, 3.0]; scale = 2.0; }; } );\n",
		"trackers = ( { name = \"h\"; kind = \"hydra\"; " BIND " base = { " NOTE
		" position = [0.12346, -2.50000, 3.00000]; " ANGLES " scale = 0.0254; }; } );\n"
	};
	static const struct edit_case missing = {
		"trackers = ( { name = \"h\"; kind = \"hydra\"; " BIND " base = { position = [1.0, 2.0, 3.0]; }; } );\n",
		"trackers = ( { name = \"h\"; kind = \"hydra\"; " BIND " base = { " NOTE
		" position = [0.12346, -2.50000, 3.00000]; " ANGLES " scale = 2.0; }; } );\n"
	};
	struct layout_edit edit = base_edit;
	struct gr_diag diag = { 0 };
	char *text;

	(void)state;
	edit.scale = 0.0254;
	check_case(&there, &edit);
	edit.scale = 2;
	check_case(&missing, &edit);
	text = edited("trackers = ( { name = \"h\";\r\n kind = \"hydra\";\r\n " BIND "\r\n } );\r\n", &edit, &diag);
	assert_non_null(text);
	/* Lines are as in the text's first one, which ends in LF. */
	assert_non_null(strstr(text, "kind = \"hydra\";\n base = { /* calibrated"));
	free(text);
	gr_diag_finish(&diag);
}

static void offsets(void **state)
{
	static const struct edit_case cases[] = {
		{ "trackers = ( { name = \"h\"; kind = \"hydra\"; bind = ( { body = \"head\"; sensor = \"left\"; },\n"
		  "  { body = \"wand\"; sensor = \"right\" } ); } );\n",
		  "trackers = ( { name = \"h\"; kind = \"hydra\"; bind = ( { body = \"head\"; sensor = \"left\"; },\n"
		  "  { " NOTE " offset = [0.00100, -0.20000, 0.00000]; body = \"wand\"; sensor = \"right\" } ); } );\n" },
		{ "trackers = ( { name = \"h\"; kind = \"hydra\"; bind = ( { body = \"head\"; sensor = \"left\"; },\n"
		  "  { /* calibrated once */ body = \"wand\"; offset = [ 0.0, 1.0,2.0 ] } ); } );\n",
		  "trackers = ( { name = \"h\"; kind = \"hydra\"; bind = ( { body = \"head\"; sensor = \"left\"; },\n"
		  "  { " NOTE " body = \"wand\"; offset = [ 0.00100, -0.20000,0.00000 ] } ); } );\n" },
	};
	struct layout_edit edit = base_edit;

	(void)state;
	edit.what = LAYOUT_EDIT_OFFSET;
	edit.binding = 1;
	memcpy(edit.position, (double[]){ 0.001, -0.2, 0.000001 }, sizeof edit.position);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		check_case(&cases[i], &edit);
}

static void of_several_trackers_one_changes(void **state)
{
	static const char trackers[] =
		"trackers = ( { name = \"a\"; kind = \"hydra\"; base = { position = [1.0, 1.0, 1.0]; };\n"
		"    bind = ( { body = \"head\"; } ); }, // kind = \"hydra\"; }\n"
		"  /* { name = \"none\"; }, */ { name = \"b\"; serial = \"\\\"}{\"; kind = \"hydra\";\n"
		"    base = { position = [2.0, 2.0, 2.0]; }; " BIND " } );\n";
	struct layout_edit edit = base_edit;
	struct gr_diag diag = { 0 };
	struct layout *layout = NULL;
	char *text;

	(void)state;
	edit.tracker = 1;
	text = edited(trackers, &edit, &diag);
	unit_diag_print(&diag);
	assert_non_null(text);
	assert_int_equal(layout_text_parse(text, &layout, &diag), GR_OK);
	assert_vector(layout->trackers[0].room_base.position, 1, 1, 1);
	assert_float_equal(layout->trackers[1].room_base.position[0], 0.12346, 1e-6);
	assert_float_equal(layout->trackers[1].room_base.angles[0], M_PI / 2, 1e-5);
	layout_destroy(&layout);
	free(text);
	edit.tracker = 2;
	assert_null(edited(trackers, &edit, &diag));
	gr_diag_finish(&diag);
}

/* A note ends no comment, whatever the points are called. */
static void notes_are_comments(void **state)
{
	struct layout_edit edit = base_edit;
	struct gr_diag diag = { 0 };
	char *text, *again;

	(void)state;
	edit.note = "without */ evil\n = { /* and \"quoted\"";
	text = edited("trackers = ( { name = \"h\"; kind = \"hydra\"; " BIND " } );\n", &edit, &diag);
	unit_diag_print(&diag);
	assert_non_null(text);
	assert_non_null(strstr(text, "/* calibrated without -/ evil- = { /- and \"quoted\" */"));
	/* and the next one finds its end */
	again = edited(strstr(text, "trackers"), &base_edit, &diag);
	assert_non_null(again);
	assert_null(strstr(again, "evil"));
	free(text);
	free(again);
	gr_diag_finish(&diag);
}

/* ---- the file ---- */

struct folder {
	char dir[64], path[96], link[96];
};

static int setup(void **state)
{
	struct folder *f = calloc(1, sizeof *f);

	strcpy(f->dir, "/tmp/grotto-layout-edit-XXXXXX");
	if (!mkdtemp(f->dir))
		return -1;
	snprintf(f->path, sizeof f->path, "%s/room.cave", f->dir);
	snprintf(f->link, sizeof f->link, "%s/link.cave", f->dir);
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	struct folder *f = *state;

	unlink(f->path);
	unlink(f->link);
	/* Nothing else was left there. */
	if (rmdir(f->dir) < 0)
		return -1;
	free(f);
	return 0;
}

static void put(const char *path, const char *text, mode_t mode)
{
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	fputs(text, file);
	fclose(file);
	assert_int_equal(chmod(path, mode), 0);
}

static void assert_holds(const char *path, const char *text)
{
	char found[64] = "";
	FILE *file = fopen(path, "r");

	assert_non_null(file);
	found[fread(found, 1, sizeof found - 1, file)] = '\0';
	fclose(file);
	assert_string_equal(found, text);
}

static void a_file_is_replaced_as_a_whole(void **state)
{
	struct folder *f = *state;
	struct gr_diag diag = { 0 };
	struct stat before, after;

	put(f->path, "old", 0640);
	assert_int_equal(symlink("room.cave", f->link), 0);
	/* Root may give it to somebody else, and then it stays theirs. */
	if (geteuid() == 0)
		assert_int_equal(chown(f->path, 12345, 54321), 0);
	assert_int_equal(stat(f->path, &before), 0);
	assert_int_equal(layout_replace(f->link, "old", 3, "newer", 5, &diag), GR_OK);
	unit_diag_print(&diag);
	assert_holds(f->path, "newer");
	assert_int_equal(stat(f->path, &after), 0);
	assert_int_equal(after.st_mode, before.st_mode);
	assert_int_equal(after.st_uid, before.st_uid);
	assert_int_equal(after.st_gid, before.st_gid);
	assert_true(after.st_ino != before.st_ino);
	assert_int_equal(lstat(f->link, &after), 0);
	assert_true(S_ISLNK(after.st_mode));
	assert_int_equal(diag.count, 0);
}

static void a_file_that_changed_stays(void **state)
{
	struct folder *f = *state;
	struct gr_diag diag = { 0 };

	put(f->path, "other", 0644);
	assert_int_equal(layout_replace(f->path, "old", 3, "new", 3, &diag), GR_ERR_MISMATCH);
	assert_true(unit_diag_has(&diag, GR_DIAG_ERROR, f->path, "has changed since it was read"));
	assert_holds(f->path, "other");
	/* Longer by what the old one begins with, too. */
	assert_int_equal(layout_replace(f->path, "othe", 4, "new", 3, &diag), GR_ERR_MISMATCH);
	assert_holds(f->path, "other");
	unlink(f->path);
	assert_int_equal(layout_replace(f->path, "other", 5, "new", 3, &diag), GR_ERR_IO);
	assert_true(access(f->path, F_OK) < 0);
	gr_diag_finish(&diag);
}

static void a_file_that_may_not_be_written(void **state)
{
	struct folder *f = *state;
	struct gr_diag diag = { 0 };

	put(f->path, "old", 0444);
	if (geteuid() == 0) {
		printf("# root may write everything\n");
		skip();
	}
	assert_int_equal(layout_replace(f->path, "old", 3, "new", 3, &diag), GR_ERR_IO);
	assert_true(unit_diag_has(&diag, GR_DIAG_ERROR, f->path, "may not be written"));
	assert_holds(f->path, "old");
	gr_diag_finish(&diag);
}

int main(void)
{
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bases),
		cmocka_unit_test(scales_and_lines_that_end_in_cr),
		cmocka_unit_test(offsets),
		cmocka_unit_test(of_several_trackers_one_changes),
		cmocka_unit_test(notes_are_comments),
		WITH(a_file_is_replaced_as_a_whole),
		WITH(a_file_that_changed_stays),
		WITH(a_file_that_may_not_be_written),
	};

	return cmocka_run_group_tests_name("layout_edit", tests, NULL, NULL);
}
