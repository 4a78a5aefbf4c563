/*
 * libFuzzer target: any bytes are a layout or are refused with a message; what
 * is taken writes, reads back and hashes to the same, and takes a calibration
 * or says that it cannot.
 */
#include "base/result.h"
#include "config/layout.h"
#include "config/layout_edit.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);
const char *__lsan_default_suppressions(void);

/* libconfig 1.5 forgets the string that it was reading when a file does not parse. */
const char *__lsan_default_suppressions(void)
{
	return "leak:libconfig.so\n";
}

static void check(const struct layout *layout, struct gr_diag *diag)
{
	struct layout *again;
	char *text = NULL, *key = layout_key_path(layout);
	size_t size;
	FILE *out = open_memstream(&text, &size);
	vec3 corner[3];
	int pixels[2];

	for (size_t i = 0; i < layout->node_count; i++) {
		layout_node_corners(layout, i, corner[0], corner[1], corner[2]);
		layout_node_pixels(layout, i, pixels);
		if (pixels[0] < 1 || pixels[1] < 1 || layout_find_node(layout, layout->nodes[i].name) != (int)i)
			abort();
	}
	layout_report_geometry(layout, diag);
	if (!out || layout_write(out, layout) != GR_OK || fclose(out))
		abort();
	if (layout_parse(text, size, layout->path, &again, diag) != GR_OK ||
	    memcmp(again->hash, layout->hash, sizeof again->hash))
		abort();
	layout_destroy(&again);
	free(text);
	free(key);
}

/* layout_edit itself reads what it makes, and compares. */
static void calibrate(const struct layout *layout, const char *text, size_t len)
{
	struct layout_edit edit = { .position = { 1, -2, 0.5 }, .angles_deg = { 10, 20, -30 }, .note = "now */" };

	for (edit.tracker = 0; edit.tracker < layout->tracker_count; edit.tracker++) {
		struct gr_diag diag = { 0 };
		size_t out_len = 0;
		char *out;
		int result;

		if (!layout_tracker_is_device(&layout->trackers[edit.tracker]))
			continue;
		edit.what = edit.what == LAYOUT_EDIT_BASE ? LAYOUT_EDIT_OFFSET : LAYOUT_EDIT_BASE;
		edit.scale = edit.tracker % 2 ? 0.0254 : 0;
		result = layout_edit(text, len, layout->path, &edit, &out, &out_len, &diag);
		if ((result == GR_OK) != !!out || (result == GR_OK && strlen(out) != out_len) ||
		    (result < 0 && !diag.errors))
			abort();
		free(out);
		gr_diag_finish(&diag);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	struct gr_diag diag = { 0 };
	struct layout *layout;
	int result = layout_parse((const char *)bytes, len, "fuzz/fuzz.cave", &layout, &diag);

	if ((result == GR_OK) != !!layout || (result == GR_OK) != !diag.errors)
		abort();
	if (layout) {
		check(layout, &diag);
		calibrate(layout, (const char *)bytes, len);
	}
	layout_destroy(&layout);
	gr_diag_finish(&diag);
	return 0;
}
