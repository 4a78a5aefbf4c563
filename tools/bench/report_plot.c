#include "tools/bench/plot.h"
#include "tools/bench/report.h"

#include "base/result.h"

#include "renderer/gi/plan.h"

#include <math.h>
#include <string.h>

double bench_added_ms(const struct bench_report *report, size_t i)
{
	if (!report->count || report->results[0].used.gi.method != SCENE_GI_NONE)
		return NAN;
	return report->results[i].frame_ms - report->results[0].frame_ms;
}

/* Spread of the light's own stage about its median, on top of what is added in all. */
static void whisker(struct plot_point *p, const struct bench_result *r)
{
	for (int i = 0; i < TIMER_STAGES; i++) {
		if (!r->stages[i].name || strcmp(r->stages[i].name, "gi") != 0)
			continue;
		p->cost_low = p->cost - r->stages[i].ms.median + r->stages[i].ms.p10;
		p->cost_high = p->cost - r->stages[i].ms.median + r->stages[i].ms.p90;
	}
}

int bench_report_plot(FILE *out, const struct bench_report *report)
{
	const struct bench_view *view = report->view;
	struct plot_point points[BENCH_CASES_MAX];
	char title[160], subtitle[256], cost[96], noise[32];
	struct plot plot = {
		.title = title, .subtitle = subtitle, .cost_label = cost,
		.error_label = "nRMSE of the light on surfaces, %", .points = points,
	};

	for (size_t i = 0; i < report->count && i < BENCH_CASES_MAX; i++) {
		const struct bench_result *r = &report->results[i];
		struct plot_point *p = &points[plot.count];

		if (r->used.gi.method == SCENE_GI_NONE) {
			plot.level_label = "no indirect light";
			plot.level = 100 * r->irradiance.nrmse;
			continue;
		}
		*p = (struct plot_point){ bench_method_name(r->used.gi.method), r->used.label,
					  bench_added_ms(report, i), 100 * r->irradiance.nrmse, NAN, NAN };
		whisker(p, r);
		plot.count++;
	}
	snprintf(title, sizeof title, "%s: error of the indirect light over its cost", report->scene);
	if (isnan(view->truth->noise))
		snprintf(noise, sizeof noise, "not known");
	else
		snprintf(noise, sizeof noise, "%.1f %%", 100 * view->truth->noise);
	snprintf(subtitle, sizeof subtitle, "%s; medians and 10..90 %% of %d frames, %s; noise of the truth %s",
		 report->renderer, view->frames,
		 report->count && report->results[0].moves ? "a lamp moving" : "the air changing",
		 noise);
	snprintf(cost, sizeof cost, "what it adds to a frame of %d × %d pixels, ms", view->camera.pixels[0],
		 view->camera.pixels[1]);
	return plot_write(out, &plot);
}

void bench_report_fit(FILE *out, const struct bench_report *report)
{
	struct gi_facts facts;

	gi_facts_take(&facts, report->view->scene, report->view->file);
	gi_facts_count(&facts, report->view->scene);
	for (size_t i = 0; i < report->count; i++) {
		const struct bench_result *r = &report->results[i];
		const struct scene_gi *gi = &r->used.gi;

		if (gi->method == SCENE_GI_NONE || !isfinite(r->irradiance.nrmse))
			continue;
		fprintf(out, "fit %s %s %.4f lattice %d steps %d spacing %.4f links %d gathers %d probes %d added %.4f expected %.4f\n",
			report->scene, bench_method_name(gi->method), r->irradiance.nrmse, gi->lattice,
			gi->steps, (double)gi->spacing_m, gi->links, gi->gathers, gi->probes,
			bench_added_ms(report, i), gi_plan_error(&facts, gi));
	}
}
