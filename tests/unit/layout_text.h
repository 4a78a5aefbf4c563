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

#endif
