/* What the tests of layouts share: a room's text that is right, to be changed, and reading a text. */
#ifndef GROTTO_TESTS_LAYOUT_TEXT_H
#define GROTTO_TESTS_LAYOUT_TEXT_H

#include "config/layout.h"
#include "tests/unit/unit_config.h"

/* Two nodes on one wall and one on another, and two trackers. */
static const char layout_text[] =
	"name = \"room\";\n"
	"walls = (\n"
	"	{\n"
	"		name = \"front\";\n"
	"		lower_left = [-1.5, 0.0, -1.5];\n"
	"		lower_right = [1.5, 0.0, -1.5];\n"
	"		upper_left = [-1.5, 2.0, -1.5];\n"
	"		pixels = [600, 400];\n"
	"		eyes = \"mono\";\n"
	"		nodes = ( { name = \"n1\"; address = \"127.0.0.1\"; port = 5001;\n"
	"			part = [0.0, 0.0, 0.5, 1.0]; },\n"
	"			{ name = \"n2\"; address = \"127.0.0.1\"; port = 5002;\n"
	"			part = [0.5, 0.0, 1.0, 1.0]; } );\n"
	"	},\n"
	"	{\n"
	"		name = \"floor\";\n"
	"		center = [0.0, 0.0, 0.0];\n"
	"		size = [3.0, 3.0];\n"
	"		pitch_deg = -90.0;\n"
	"		pixels = [600, 600];\n"
	"		nodes = ( { address = \"127.0.0.1\"; port = 5003; } );\n"
	"	}\n"
	");\n"
	"network = { master_address = \"127.0.0.1\"; master_port = 5000;\n"
	"	mtu = 1500; };\n"
	"rates = { frame_hz = 60.0; };\n"
	"start = { head = [0.0, 1.7, 0.5]; };\n"
	"trackers = ( { name = \"t1\"; kind = \"sim\"; wand = false; },\n"
	"	{ name = \"t2\"; kind = \"replay\"; head = false; file = \"x.log\"; } );\n";

/* As layout_parse, of "t.cave"; no byte after the text is there. */
static inline int layout_text_parse(const char *text, struct layout **out, struct gr_diag *diag)
{
	size_t len = strlen(text);
	char *copy = (char *)unit_copy(text, len);
	int result = layout_parse(copy, len, "t.cave", out, diag);

	free(copy);
	return result;
}

/* The room with other trackers: the text of the group, "trackers = ( ... );". The caller's to free. */
static inline char *layout_text_with_trackers(const char *room, const char *trackers)
{
	const size_t len = (size_t)(strstr(room, "trackers = ") - room);
	char *whole = malloc(len + strlen(trackers) + 1);

	if (!whole)
		abort();
	memcpy(whole, room, len);
	strcpy(whole + len, trackers);
	return whole;
}

/* In good trackers, `find` is replaced; what is said about it, of the line on which `mark` stands. */
struct layout_fault {
	const char *find, *replace, *mark, *key, *message;
	unsigned errors; /* in all; 0: it is a warning, as is what is not used */
};

/* 1 when the fault is not named as it should be. */
static inline unsigned layout_text_check_fault(const struct layout_fault *fault, const char *room,
					       const char *trackers)
{
	char *text = unit_replace(trackers, fault->find, fault->replace);
	char *whole = layout_text_with_trackers(room, text);
	const enum gr_severity severity =
		!fault->errors || strstr(fault->message, "not used") ? GR_DIAG_WARNING : GR_DIAG_ERROR;
	struct gr_diag diag = { 0 };
	struct layout *layout = NULL;
	char start[256];
	unsigned bad = 0;

	layout_text_parse(whole, &layout, &diag);
	snprintf(start, sizeof start, "t.cave:%d: %s: ", unit_line(whole, fault->mark), fault->key);
	if (!unit_diag_has(&diag, severity, start, fault->message) || diag.errors != fault->errors) {
		printf("# wanted %s...%s... and %u errors\n", start, fault->message, fault->errors);
		unit_diag_print(&diag);
		bad = 1;
	}
	layout_destroy(&layout);
	gr_diag_finish(&diag);
	free(whole);
	free(text);
	return bad;
}

#endif
