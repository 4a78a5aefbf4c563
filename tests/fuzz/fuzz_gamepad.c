/* A report descriptor of any bytes, and input reports by what it says. */
#include "base/result.h"
#include "tracking/hid_descriptor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

static uint8_t *exact(const uint8_t *bytes, size_t len)
{
	uint8_t *copy = malloc(len ? len : 1);

	if (!copy)
		abort();
	if (len)
		memcpy(copy, bytes, len);
	return copy;
}

static void check(const struct track_hid_pads *pads, const struct track_hid_values *values)
{
	for (unsigned pad = 0; pad < TRACK_HID_PADS; pad++) {
		const bool there = pad < pads->pad_count;
		struct track_report report;

		if (values->buttons[pad] & ~(there ? pads->has_buttons[pad] : 0))
			abort();
		for (unsigned i = 0; i < TRACK_HID_AXES; i++) {
			const float axis = values->axes[pad][i];

			if (!(fabsf(axis) <= 1) || (i >= TRACK_HID_SLIDER && axis < 0) ||
			    (axis != 0 && !(there && pads->has_axes[pad] >> i & 1)))
				abort();
		}
		track_hid_report(values, pad, &report);
		if (report.sensor != pad || report.axis_count != TRACK_HID_AXES)
			abort();
	}
}

/* Two bytes are the descriptor's length, one which axes are triggers; then it, and reports with a
 * length each. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	static struct track_hid_pads pads;
	struct track_hid_values values;
	uint8_t *descriptor, triggers;
	char why[160] = "";
	size_t n;
	int r;

	if (len < 3)
		return 0;
	n = (size_t)(bytes[0] | bytes[1] << 8);
	triggers = bytes[2];
	bytes += 3;
	len -= 3;
	n = n < len ? n : len;
	descriptor = exact(bytes, n);
	r = track_hid_parse(descriptor, n, triggers & 1, &pads, why, sizeof why);
	free(descriptor);
	if (r < 0) {
		if (!why[0] || strlen(why) >= sizeof why)
			abort();
		return 0;
	}
	if (!pads.field_count || pads.field_count > TRACK_HID_FIELDS ||
	    pads.pad_count > TRACK_HID_PADS)
		abort();
	bytes += n;
	len -= n;
	track_hid_rest(&values);
	while (len > 0) {
		const size_t most = *bytes++;
		const size_t size = most < --len ? most : len;
		uint8_t *report = exact(bytes, size);
		const int which = track_hid_take(&pads, report, size, triggers, &values);

		free(report);
		if (which >= 1 << TRACK_HID_PADS || (which >= 0 && size == 0))
			abort();
		check(&pads, &values);
		bytes += size;
		len -= size;
	}
	return 0;
}
