/* What a bench run found, for people (a table), for programs (JSON) and for the eye (a plot). */
#ifndef GROTTO_TOOLS_BENCH_REPORT_H
#define GROTTO_TOOLS_BENCH_REPORT_H

#include "tools/bench/measure.h"

#include <json-c/json.h>
#include <stdio.h>

/* One scene's results; the first is of method none. */
struct bench_report {
	const char *scene;    /* its name */
	const char *path;     /* of its file */
	const char *renderer; /* GL's name of the machine that drew */
	const struct bench_view *view;
	int point_samples, picture_samples;
	const struct bench_result *results;
	size_t count;
};

/* What a frame costs more than one without indirect light, ms; NaN when that is not known. */
double bench_added_ms(const struct bench_report *report, size_t i);

void bench_report_table(FILE *out, const struct bench_report *report);
/* NULL without memory. Free: json_object_put. */
struct json_object *bench_report_json(const struct bench_report *report);
/* As plot_write. */
int bench_report_plot(FILE *out, const struct bench_report *report);
/* Points for the planner's error model: a line a case (docs/bench.md). */
void bench_report_fit(FILE *out, const struct bench_report *report);

#endif
