#include "tools/bench/report.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define COLUMNS 20
#define CELL 56

struct table {
	char cells[BENCH_CASES_MAX + 2][COLUMNS][CELL]; /* two rows of heads */
	size_t rows;
};

static const char *const heads[2][COLUMNS] = {
	{ "", "", "", "frame", "gi", "gi", "shade", "once", "GPU", "irradiance", "", "", "dark", "indirect",
	  "picture", "", "", "flicker", "frames to", "work" },
	{ "method", "settings", "surfels", "ms", "ms", "p10..p90", "ms", "s", "MiB", "bias", "nRMSE", "p95", "leak",
	  "nRMSE", "nRMSE", "SSIM", "FLIP", "worst/mean", "10 %/1 %", "stops" },
};
/* The first two columns stand to the left. */
#define LEFT_COLUMNS 2

static void put(char cell[CELL], const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put(char cell[CELL], const char *format, ...)
{
	va_list args;

	va_start(args, format);
	vsnprintf(cell, CELL, format, args);
	va_end(args);
}

/* A dash for what is not known. */
static void put_number(char cell[CELL], double value, const char *format)
{
	if (isnan(value))
		put(cell, "-");
	else
		snprintf(cell, CELL, format, value);
}

static const struct bench_stage *stage_of(const struct bench_result *r, const char *name)
{
	for (int i = 0; i < TIMER_STAGES; i++)
		if (r->stages[i].name && !strcmp(r->stages[i].name, name))
			return &r->stages[i];
	return NULL;
}

static void fill_cost(char cells[COLUMNS][CELL], const struct bench_result *r)
{
	const struct bench_stage *gi = stage_of(r, "gi"), *shade = stage_of(r, "shade");

	if (r->surfels)
		put(cells[2], "%zu", r->surfels);
	else
		put(cells[2], "-");
	put(cells[3], "%.2f", r->frame_ms);
	put_number(cells[4], gi ? gi->ms.median : (double)NAN, "%.2f");
	if (gi)
		put(cells[5], "%.2f..%.2f", gi->ms.p10, gi->ms.p90);
	else
		put(cells[5], "-");
	put_number(cells[6], shade ? shade->ms.median : (double)NAN, "%.2f");
	put(cells[7], "%.1f", r->create_s);
	put(cells[8], "%.2f", (double)r->gpu_bytes / 1048576);
}

static void fill_error(char cells[COLUMNS][CELL], const struct bench_result *r)
{
	put_number(cells[9], 100 * r->irradiance.bias, "%+.1f %%");
	put_number(cells[10], 100 * r->irradiance.nrmse, "%.1f %%");
	put_number(cells[11], 100 * r->irradiance.p95, "%.1f %%");
	put_number(cells[12], 100 * r->leak, "%.3f %%");
	put_number(cells[13], 100 * r->indirect.blocks.nrmse, "%.1f %%");
	put_number(cells[14], 100 * r->total.blocks.nrmse, "%.1f %%");
	put_number(cells[15], r->total.ssim, "%.4f");
	put_number(cells[16], r->total.flip, "%.4f");
}

static void put_frames(char *text, size_t size, size_t frames)
{
	if (frames)
		snprintf(text, size, "%zu", frames);
	else
		snprintf(text, size, ">%d", BENCH_SWITCH_FRAMES);
}

static void fill_time(char cells[COLUMNS][CELL], const struct bench_result *r)
{
	char ten[24], one[24];

	if (isnan(r->flicker.worst)) {
		put(cells[17], "-");
		put(cells[18], "-");
	} else {
		put(cells[17], "%.2f/%.3f %%", 100 * r->flicker.worst, 100 * r->flicker.mean);
		put_frames(ten, sizeof ten, r->frames_to_10);
		put_frames(one, sizeof one, r->frames_to_1);
		put(cells[18], "%s/%s", ten, one);
	}
	if (r->still_frames < 0)
		put(cells[19], "never");
	else
		put(cells[19], "%d", r->still_frames);
}

static void fill_row(char cells[COLUMNS][CELL], const struct bench_result *r)
{
	put(cells[0], "%s", bench_method_name(r->used.gi.method));
	put(cells[1], "%s", r->used.label);
	fill_cost(cells, r);
	fill_error(cells, r);
	fill_time(cells, r);
}

static void print(FILE *out, const struct table *table)
{
	for (size_t row = 0; row < table->rows; row++) {
		for (size_t c = 0; c < COLUMNS; c++) {
			int width = 0;

			for (size_t k = 0; k < table->rows; k++)
				if ((int)strlen(table->cells[k][c]) > width)
					width = (int)strlen(table->cells[k][c]);
			fprintf(out, "%s%*s", c ? "  " : "", c < LEFT_COLUMNS ? -width : width,
				table->cells[row][c]);
		}
		fputc('\n', out);
	}
}

void bench_report_table(FILE *out, const struct bench_report *report)
{
	const struct bench_view *view = report->view;
	struct table *table = calloc(1, sizeof *table);
	char noise[2][CELL];

	fprintf(out, "%s: %zu triangles, camera %s, %d x %d pixels, %s\n", report->scene,
		view->scene->index_count / 3, view->camera.name, view->camera.pixels[0],
		view->camera.pixels[1], report->renderer);
	put_number(noise[0], 100 * view->truth->noise, "%.2f %%");
	put_number(noise[1], 100 * view->truth->picture_noise, "%.2f %%");
	fprintf(out, "truth: %zu points of %d samples, noise %s (taken out of nRMSE); picture of %d samples, noise %s; ",
		view->truth->count, report->point_samples, noise[0], report->picture_samples, noise[1]);
	if (view->truth->kept)
		fprintf(out, "kept from before\n");
	else
		fprintf(out, "traced in %.1f s\n", view->truth->seconds);
	fprintf(out, "times: medians of %d frames with %s\n", view->frames,
		report->count && report->results[0].moves ? "a lamp that moves 8 mm in each"
							  : "air that changes in each, for the scene has no lamp");
	if (!table) {
		fprintf(out, "no memory for the table\n");
		return;
	}
	for (size_t row = 0; row < 2; row++)
		for (size_t c = 0; c < COLUMNS; c++)
			put(table->cells[row][c], "%s", heads[row][c]);
	table->rows = 2;
	for (size_t i = 0; i < report->count && i < BENCH_CASES_MAX; i++)
		fill_row(table->cells[table->rows++], &report->results[i]);
	print(out, table);
	free(table);
	for (size_t i = 0; i < report->count; i++)
		if (report->results[i].nonfinite || report->results[i].gl_errors)
			fprintf(out, "%s, %s: %llu values not finite, %llu GL errors\n",
				bench_method_name(report->results[i].used.gi.method),
				report->results[i].used.label,
				(unsigned long long)report->results[i].nonfinite,
				(unsigned long long)report->results[i].gl_errors);
}
