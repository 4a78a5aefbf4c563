/* Files of a calibration: what is read must be written and read again, and be fitted or refused. */
#include "base/result.h"
#include "tracking/align.h"
#include "tracking/survey.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

/* Whatever was measured: a fit is finite and turns nothing inside out. */
static void fit(const struct survey_point *points, size_t count)
{
	struct align_point set[ALIGN_POINTS];
	struct align_fit out;
	char why[ALIGN_WHY];
	size_t n = 0;

	for (size_t i = 0; i < count && n < 8; i++) {
		if (!points[i].known || !points[i].measured)
			continue;
		memset(&set[n], 0, sizeof set[n]);
		memcpy(set[n].room, points[i].room, sizeof set[n].room);
		memcpy(set[n].base, points[i].p, sizeof set[n].base);
		n++;
	}
	for (int scale = 0; scale < 2; scale++) {
		const struct align_params params = { .scale = scale, .most_m = 0.03 };

		if (align_fit(set, n, &params, &out, why, sizeof why) != GR_OK)
			continue;
		if (!(fabs(dmat3_det(&out.R) - 1) < 1e-9) || !isfinite(out.t[0] + out.t[1] + out.t[2]) ||
		    !(out.scale > 0) || !(out.rms_m <= 0.03))
			abort();
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	struct survey_point *points, *again;
	struct gr_diag diag = { 0 };
	size_t count, count_again, text_len;
	char *copy = malloc(len ? len : 1), *text = NULL;
	FILE *file;

	if (!copy)
		abort();
	if (len)
		memcpy(copy, bytes, len);
	if (survey_parse(copy, len, "fuzz", &points, &count, &diag) == GR_OK) {
		file = open_memstream(&text, &text_len);
		if (!file || diag.errors || count == 0)
			abort();
		for (size_t i = 0; i < count; i++)
			survey_write(file, &points[i]);
		fclose(file);
		if (survey_parse(text, text_len, "again", &again, &count_again, &diag) != GR_OK ||
		    count_again != count)
			abort();
		for (size_t i = 0; i < count; i++)
			if (strcmp(points[i].name, again[i].name) != 0 || points[i].known != again[i].known ||
			    points[i].measured != again[i].measured)
				abort();
		fit(points, count);
		free(again);
	} else if (diag.errors == 0 || points) {
		abort();
	}
	free(points);
	free(text);
	free(copy);
	gr_diag_finish(&diag);
	return 0;
}
