#include "tools/bench/trackers.h"

#include "base/result.h"
#include "tools/bench/logged.h"
#include "tools/bench/predict.h"
#include "tools/cli.h"

#include <json-c/json.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define DEG (180 / M_PI)

static const double horizons_s[] = { 0, 0.01, 0.0167, 0.033, 0.05 };
#define HORIZONS (sizeof horizons_s / sizeof horizons_s[0])
static const double rates_hz[] = { 60, 120, 240, 1000 };
#define RATES (sizeof rates_hz / sizeof rates_hz[0])

struct options {
	const char *log, *body, *json;
	float noise_m, noise_deg, rate_hz, seconds;
	int seed;
};

/* One line: what is made of samples, and what comes of it. */
struct row {
	const char *name;
	const struct track_filter_params *params; /* NULL: as it is */
	struct predict_rest rest;
	struct predict_error errors[HORIZONS];
};

static bool measure(struct row *row, const struct predict_motion *motion, const struct predict_samples *samples)
{
	row->rest = predict_rest(samples, row->params);
	for (size_t i = 0; i < HORIZONS; i++)
		if (!predict_measure(motion, samples, row->params, horizons_s[i], &row->errors[i]))
			return false;
	return true;
}

static void print_head(void)
{
	printf("%6s  %-11s  %-16s %8s ", "", "", "at rest", "lag");
	for (size_t i = 0; i < HORIZONS; i++)
		printf("%9.0f ms     ", horizons_s[i] * 1e3);
	printf("\n%6s  %-11s  %-16s %8s ", "Hz", "filter", "mm / deg", "ms");
	for (size_t i = 0; i < HORIZONS; i++)
		printf("%16s ", "rms mm / deg");
	printf("\n");
}

static void print_row(double rate_hz, const struct row *row)
{
	printf("%6.0f  %-11s  %.3f / %.4f   %8.2f ", rate_hz, row->name, row->rest.m * 1e3,
	       row->rest.rad * DEG, row->errors[0].lag_s * 1e3);
	for (size_t i = 0; i < HORIZONS; i++)
		printf("%8.2f / %5.3f ", row->errors[i].rms_m * 1e3, row->errors[i].rms_rad * DEG);
	printf("\n");
}

static void add(struct json_object *to, const char *key, double value)
{
	json_object_object_add(to, key, isfinite(value) ? json_object_new_double(value) : NULL);
}

static void add_row(struct json_object *rows, double rate_hz, const struct row *row)
{
	struct json_object *o = json_object_new_object(), *list = json_object_new_array();

	add(o, "rate_hz", rate_hz);
	json_object_object_add(o, "filter", json_object_new_string(row->name));
	add(o, "rest_mm", row->rest.m * 1e3);
	add(o, "rest_deg", row->rest.rad * DEG);
	add(o, "lag_ms", row->errors[0].lag_s * 1e3);
	for (size_t i = 0; i < HORIZONS; i++) {
		struct json_object *e = json_object_new_object();

		add(e, "horizon_ms", horizons_s[i] * 1e3);
		add(e, "rms_mm", row->errors[i].rms_m * 1e3);
		add(e, "p99_mm", row->errors[i].p99_m * 1e3);
		add(e, "rms_deg", row->errors[i].rms_rad * DEG);
		add(e, "p99_deg", row->errors[i].p99_rad * DEG);
		json_object_array_add(list, e);
	}
	json_object_object_add(o, "errors", list);
	json_object_array_add(rows, o);
}

/* All filters at one rate. */
static bool compare(const struct options *o, const struct predict_motion *motion, double rate_hz,
		    struct json_object *rows)
{
	const struct predict_samples samples = { rate_hz, (double)o->noise_m, (double)o->noise_deg / DEG,
						 (uint64_t)o->seed };

	for (int kind = -1; kind < TRACK_FILTER_KINDS; kind++) {
		struct track_filter_params params = track_filter_defaults((enum track_filter_kind)(kind < 0 ? 0 : kind));
		struct row row = { .name = kind < 0 ? "as it is" : track_filter_name((enum track_filter_kind)kind),
				   .params = kind < 0 ? NULL : &params };

		if (!measure(&row, motion, &samples))
			return false;
		print_row(rate_hz, &row);
		add_row(rows, rate_hz, &row);
	}
	fflush(stdout);
	return true;
}

static int write_json(const char *path, struct json_object *rows)
{
	if (json_object_to_file_ext(path, rows, JSON_C_TO_STRING_PRETTY) == 0)
		return GR_EXIT_OK;
	fprintf(stderr, "grotto bench trackers: %s cannot be written: %s\n", path, json_util_get_last_err());
	return GR_EXIT_RUNTIME;
}

static int run(const struct options *o, const struct predict_motion *motion, double log_rate_hz)
{
	struct json_object *rows = json_object_new_array();
	int status = GR_EXIT_OK;

	printf("%.0f s, noise of a sample %.2f mm and %.2f degrees an axis, seed %d\n\n", motion->seconds,
	       (double)o->noise_m * 1e3, (double)o->noise_deg, o->seed);
	print_head();
	if (o->rate_hz > 0 || log_rate_hz > 0) {
		if (!compare(o, motion, o->rate_hz > 0 ? (double)o->rate_hz : log_rate_hz, rows))
			status = GR_EXIT_RUNTIME;
	} else {
		for (size_t i = 0; i < RATES && status == GR_EXIT_OK; i++)
			if (!compare(o, motion, rates_hz[i], rows))
				status = GR_EXIT_RUNTIME;
	}
	if (status != GR_EXIT_OK)
		fprintf(stderr, "grotto bench trackers: no memory\n");
	else if (o->json)
		status = write_json(o->json, rows);
	json_object_put(rows);
	return status;
}

static int run_log(const struct options *o)
{
	const enum track_body body = strcmp(o->body, "wand") == 0 ? TRACK_WAND : TRACK_HEAD;
	struct logged *logged = NULL;
	struct gr_diag diag = { 0 };
	struct predict_motion motion;
	int result, status;

	if (strcmp(o->body, "head") != 0 && strcmp(o->body, "wand") != 0) {
		fprintf(stderr, "grotto bench trackers: --body '%s': give head or wand\n", o->body);
		return GR_EXIT_CONFIG;
	}
	result = logged_open(&logged, o->log, body, &diag);
	gr_diag_log(&diag);
	gr_diag_finish(&diag);
	if (result != GR_OK)
		return result == GR_ERR_NOMEM ? GR_EXIT_RUNTIME : GR_EXIT_CONFIG;
	motion = logged_motion(logged);
	status = run(o, &motion, logged_rate_hz(logged));
	logged_destroy(&logged);
	return status;
}

static struct hand_pose hand(const void *ctx, double t)
{
	return hand_at(ctx, t);
}

static int run_hand(const struct options *o)
{
	struct hand *made = hand_create((double)o->seconds, (uint64_t)o->seed);
	const struct predict_motion motion = { hand, made, (double)o->seconds };
	int status;

	if (!made) {
		fprintf(stderr, "grotto bench trackers: no memory\n");
		return GR_EXIT_RUNTIME;
	}
	status = run(o, &motion, 0);
	hand_destroy(made);
	return status;
}

int bench_trackers(int argc, char **argv)
{
	struct options o = { .body = "head", .noise_m = NAN, .noise_deg = NAN, .seconds = 120, .seed = 1 };
	const struct cli_option options[] = {
		{ "log", 0, CLI_TEXT, &o.log, 0, 0, "FILE", "the motion of a tracker log, instead of a made one" },
		{ "body", 0, CLI_TEXT, &o.body, 0, 0, "BODY", "of the log: head or wand (head)" },
		{ "rate", 0, CLI_REAL, &o.rate_hz, 1, 10000, "HZ", "samples a second (60, 120, 240, 1000; of a log: its own)" },
		{ "noise-m", 0, CLI_REAL, &o.noise_m, 0, 1, "M", "standard deviation added to positions (0.0003; to a log: 0)" },
		{ "noise-deg", 0, CLI_REAL, &o.noise_deg, 0, 45, "DEG", "and to orientations (0.1; to a log: 0)" },
		{ "seconds", 0, CLI_REAL, &o.seconds, 10, 3600, "S", "of made motion (120)" },
		{ "seed", 0, CLI_INT, &o.seed, 0, 1 << 30, "N", "of motion and noise (1)" },
		{ "json", 0, CLI_TEXT, &o.json, 0, 0, "FILE", "the same for programs, with 99th percentiles" },
	};
	const struct cli_table table = {
		"grotto bench trackers [--log FILE] [--rate HZ] [--noise-m M] [--noise-deg DEG] [--json FILE]",
		"How far each filter is from the truth some time ahead of the last sample, how much it\n"
		"lags, and how much of a resting hand's noise it lets through; with the default constants\n"
		"of a layout. The made motion is a hand's: reaches of 5 to 60 cm, turns, and rests.",
		options, sizeof options / sizeof options[0]
	};
	int words;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (words > 0) {
		fprintf(stderr, "grotto bench trackers: '%s' is no option; a log is given by --log FILE\n", argv[1]);
		return GR_EXIT_CONFIG;
	}
	if (isnan(o.noise_m))
		o.noise_m = o.log ? 0.0f : 0.0003f;
	if (isnan(o.noise_deg))
		o.noise_deg = o.log ? 0.0f : 0.1f;
	return o.log ? run_log(&o) : run_hand(&o);
}
