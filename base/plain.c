#include "base/plain.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LARGE 1e15
#define SMALL 1e-9

static void drop_zeros(char *text)
{
	size_t len = strlen(text);

	if (!strchr(text, '.'))
		return;
	while (len > 0 && text[len - 1] == '0')
		text[--len] = 0;
	if (len > 0 && text[len - 1] == '.')
		text[len - 1] = 0;
}

struct gr_plain gr_plain(double value, int digits)
{
	struct gr_plain out;
	double size = fabs(value);
	int before, after;

	if (!isfinite(value) || size >= LARGE || (size > 0 && size < SMALL)) {
		snprintf(out.text, sizeof out.text, "%.*g", digits, value);
		return out;
	}
	before = size > 0 ? (int)floor(log10(size)) + 1 : 1;
	after = digits - before;
	if (after >= 0) {
		snprintf(out.text, sizeof out.text, "%.*f", after, value);
		drop_zeros(out.text);
	} else {
		double power = pow(10, -after);

		snprintf(out.text, sizeof out.text, "%.0f", round(value / power) * power);
	}
	return out;
}

struct gr_plain gr_plain_percent(double share)
{
	double percent = 100 * share;
	struct gr_plain out = gr_plain(percent, 2);
	size_t len;

	if (fabs(percent) >= 100 && fabs(percent) < LARGE)
		snprintf(out.text, sizeof out.text, "%.0f", percent);
	len = strlen(out.text);
	snprintf(out.text + len, sizeof out.text - len, " %%");
	return out;
}
