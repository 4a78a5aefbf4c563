#include "daemon/options.h"

#include "base/log.h"
#include "config.h"

#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OPTIONS_MAX 40

static void print_help(const char *program, const char *summary, const struct option_spec *specs,
		       size_t count)
{
	printf("Usage: %s [OPTION...]\n%s\n\n", program, summary);
	for (size_t i = 0; i < count; i++) {
		char head[64];
		snprintf(head, sizeof head, "--%s%s%s", specs[i].name, specs[i].arg ? " " : "",
			 specs[i].arg ? specs[i].arg : "");
		printf("  %-26s %s\n", head, specs[i].help);
	}
	printf("  %-26s %s\n", "--help", "this text");
	printf("  %-26s %s\n", "--version", "the version");
	printf("\nExit status: 0 done, 1 failed while running, 2 wrong configuration.\n");
}

static bool set_int(const struct option_spec *spec, int *out, const char *text)
{
	char *end;
	long value;

	errno = 0;
	value = strtol(text, &end, 10);
	if (errno || end == text || *end || value < spec->min || value > spec->max) {
		gr_error("--%s '%s': give a whole number from %d to %d", spec->name, text, spec->min,
			 spec->max);
		return false;
	}
	*out = (int)value;
	return true;
}

static bool set_real(const struct option_spec *spec, double *out, const char *text)
{
	char *end;
	double value;

	errno = 0;
	value = strtod(text, &end);
	if (errno || end == text || *end || !(value >= spec->min && value <= spec->max)) {
		gr_error("--%s '%s': give a number from %d to %d", spec->name, text, spec->min, spec->max);
		return false;
	}
	*out = value;
	return true;
}

static bool set_choice(const struct option_spec *spec, int *out, const char *text)
{
	char words[256] = "";
	size_t len = 0;

	for (int i = 0; spec->choices[i]; i++) {
		if (!strcmp(text, spec->choices[i])) {
			*out = i;
			return true;
		}
		len += (size_t)snprintf(words + len, sizeof words - len, "%s%s", i ? ", " : "",
					spec->choices[i]);
		if (len >= sizeof words)
			len = sizeof words - 1;
	}
	gr_error("--%s '%s': give one of %s", spec->name, text, words);
	return false;
}

static bool set_value(const struct option_spec *spec, void *values, const char *text)
{
	void *at = (char *)values + spec->offset;

	switch (spec->kind) {
	case OPTION_TEXT:
		if (!*text) {
			gr_error("--%s: is empty; give %s", spec->name, spec->arg);
			return false;
		}
		*(const char **)at = text;
		return true;
	case OPTION_INT: return set_int(spec, at, text);
	case OPTION_REAL: return set_real(spec, at, text);
	case OPTION_FLAG: *(bool *)at = true; return true;
	case OPTION_CHOICE: return set_choice(spec, at, text);
	}
	return false;
}

enum options_outcome command_line_parse(const char *program, const char *summary,
				   const struct option_spec *specs, size_t count, void *values,
				   int argc, char **argv)
{
	struct option longs[OPTIONS_MAX] = { 0 };
	size_t n = 0;
	int c;

	for (size_t i = 0; i < count && n + 4 < OPTIONS_MAX; i++) {
		int takes = specs[i].kind == OPTION_FLAG ? no_argument : required_argument;
		longs[n++] = (struct option){ specs[i].name, takes, NULL, (int)i + 256 };
		if (specs[i].also)
			longs[n++] = (struct option){ specs[i].also, takes, NULL, (int)i + 256 };
	}
	longs[n++] = (struct option){ "help", no_argument, NULL, 'h' };
	longs[n++] = (struct option){ "version", no_argument, NULL, 'V' };
	optind = 0; /* glibc: start anew, tests parse more than once */
	opterr = 0;
	while ((c = getopt_long(argc, argv, ":hV", longs, NULL)) != -1) {
		if (c == 'h') {
			print_help(program, summary, specs, count);
			return OPTIONS_DONE;
		}
		if (c == 'V') {
			printf("%s (grotto) %s\n", program, PACKAGE_VERSION);
			return OPTIONS_DONE;
		}
		if (c == ':') {
			gr_error("%s: needs a value; see --help", argv[optind - 1]);
			return OPTIONS_WRONG;
		}
		if (c < 256) {
			gr_error("%s: no such option; see --help", argv[optind - 1]);
			return OPTIONS_WRONG;
		}
		if (!set_value(&specs[c - 256], values, optarg))
			return OPTIONS_WRONG;
	}
	if (optind < argc) {
		gr_error("'%s': takes options only; see --help", argv[optind]);
		return OPTIONS_WRONG;
	}
	return OPTIONS_RUN;
}

static const char *const level_words[] = { "emergency", "alert", "critical", "error", "warning",
					   "notice", "info", "debug", NULL };
static const char *const target_words[] = { "layout", "headless", "window", "fullscreen", NULL };

#define AT(type, member) offsetof(struct type, member)
#define COMMON(type)                                                                               \
	{ "layout", OPTION_TEXT, AT(type, common.layout), "FILE", "the cave layout [" GROTTO_SYSCONFDIR "/cave.cave]", 0, 0, NULL, NULL }, \
	{ "scene", OPTION_TEXT, AT(type, common.scene), "FILE", "the scene file [" GROTTO_SYSCONFDIR "/scene.scene]", 0, 0, NULL, NULL }, \
	{ "key", OPTION_TEXT, AT(type, common.key), "FILE", "the cluster key, instead of the layout's", 0, 0, NULL, NULL }, \
	{ "user", OPTION_TEXT, AT(type, common.user), "NAME", "user to become when started as root", 0, 0, NULL, NULL }, \
	{ "report", OPTION_TEXT, AT(type, common.report), "FILE", "JSON figures written at the end", 0, 0, NULL, NULL }, \
	{ "deadline-ms", OPTION_INT, AT(type, common.deadline_ms), "MS", "of the swap barrier, instead of the layout's", 1, 600000, NULL, NULL }, \
	{ "priority", OPTION_INT, AT(type, common.priority), "N", "real-time priority, where the system allows it; 0 none [0]", 0, 99, NULL, NULL }, \
	{ "log-level", OPTION_CHOICE, AT(type, common.log_level), "LEVEL", "error, warning, notice, info or debug [info]", 0, 0, level_words, NULL }

static const struct option_spec master_specs[] = {
	COMMON(master_options),
	{ "control", OPTION_TEXT, AT(master_options, control), "PATH", "control socket instead of the layout's, or none", 0, 0, NULL, NULL },
	{ "record", OPTION_TEXT, AT(master_options, record), "FILE", "record the session at the end of this file", 0, 0, NULL, NULL },
	{ "replay", OPTION_TEXT, AT(master_options, replay), "FILE", "show this recording instead of what trackers and settings say", 0, 0, NULL, NULL },
	{ "speed", OPTION_REAL, AT(master_options, speed), "X", "of the replay, times the recorded one [1]; with --frame-clock as fast as the barrier allows", 0, 1000, NULL, NULL },
	{ "step", OPTION_FLAG, AT(master_options, step), NULL, "replay a frame for each 'step' of the control socket", 0, 0, NULL, NULL },
	{ "from", OPTION_REAL, AT(master_options, from_s), "S", "replay from so many seconds after the recording began", 0, 10000000, NULL, NULL },
	{ "recording", OPTION_INT, AT(master_options, recording), "N", "replay the Nth of the file [1]", 1, 1000000, NULL, NULL },
	{ "other-layout", OPTION_FLAG, AT(master_options, other_layout), NULL, "the recording may be of another layout", 0, 0, NULL, NULL },
	{ "state", OPTION_TEXT, AT(master_options, state), "FILE", "go on from the state left there, and leave it there every second", 0, 0, NULL, NULL },
	{ "standby", OPTION_FLAG, AT(master_options, standby), NULL, "follow the room's master, and take over when it is silent", 0, 0, NULL, NULL },
	{ "address", OPTION_TEXT, AT(master_options, address), "ADDRESS", "which of the layout's masters this is, or ADDRESS:PORT; with --standby the first standby of this machine, else master_address", 0, 0, NULL, NULL },
	{ "frames", OPTION_INT, AT(master_options, frames), "N", "end after N frames", 1, INT_MAX, NULL, NULL },
	{ "frame-clock", OPTION_FLAG, AT(master_options, frame_clock), NULL, "frame N is at N / frame_hz seconds; as fast as the barrier allows", 0, 0, NULL, NULL },
	{ "wait-all", OPTION_FLAG, AT(master_options, wait_all), NULL, "no frame before every node of the layout is there", 0, 0, NULL, NULL },
	{ "expect", OPTION_INT, AT(master_options, expect), "N", "no frame before N nodes are there [1]", 1, 64, NULL, NULL },
};

static const struct option_spec node_specs[] = {
	COMMON(node_options),
	{ "node", OPTION_TEXT, AT(node_options, node), "NAME", "which node of the layout this is", 0, 0, NULL, "name" },
	{ "target", OPTION_CHOICE, AT(node_options, target), "KIND", "headless, window or fullscreen, instead of the layout's", 0, 0, target_words, NULL },
	{ "display", OPTION_TEXT, AT(node_options, display), "NAME", "X display, instead of the layout's", 0, 0, NULL, NULL },
	{ "gpu", OPTION_INT, AT(node_options, gpu), "N", "EGL device, instead of the layout's; -1 the first that works", -1, 63, NULL, NULL },
	{ "once", OPTION_FLAG, AT(node_options, once), NULL, "end when the master ends or refuses", 0, 0, NULL, NULL },
	{ "pictures", OPTION_TEXT, AT(node_options, pictures), "DIR", "save pictures there as NODE-FRAME.png", 0, 0, NULL, NULL },
	{ "every", OPTION_INT, AT(node_options, every), "K", "of frames that K divides; the last always", 1, INT_MAX, NULL, NULL },
	{ "swap-log", OPTION_TEXT, AT(node_options, swap_log), "FILE", "append a line of each swap: session, frame, hash of its state, time in ns", 0, 0, NULL, NULL },
	{ "exr", OPTION_FLAG, AT(node_options, exr), NULL, "save the scene-linear radiance too, as OpenEXR", 0, 0, NULL, NULL },
};

static const struct common_options common_defaults = {
	.layout = GROTTO_SYSCONFDIR "/cave.cave",
	.scene = GROTTO_SYSCONFDIR "/scene.scene",
	.log_level = GR_LOG_INFO,
};

enum options_outcome master_options_parse(struct master_options *options, int argc, char **argv)
{
	enum options_outcome outcome;

	*options = (struct master_options){ .common = common_defaults, .expect = 1, .recording = 1 };
	outcome = command_line_parse("grotto-master",
			     "Runs a room: tracks the visitor, tells every node what to draw, swaps all walls in step.",
			     master_specs, sizeof master_specs / sizeof *master_specs, options, argc,
			     argv);
	if (outcome == OPTIONS_RUN && !options->replay &&
	    (options->speed != 0 || options->step || options->from_s != 0 || options->other_layout ||
	     options->recording != 1)) {
		gr_error("--speed, --step, --from, --recording and --other-layout say how to replay; "
			 "--replay FILE is missing");
		return OPTIONS_WRONG;
	}
	if (outcome == OPTIONS_RUN && options->standby && (options->replay || options->record)) {
		gr_error("--standby: has nothing to %s before it takes over; %s",
			 options->replay ? "replay" : "record",
			 options->replay ? "a replay is one master's" : "start a recording then (grotto record)");
		return OPTIONS_WRONG;
	}
	if (outcome == OPTIONS_RUN && options->speed == 0)
		options->speed = 1;
	return outcome;
}

enum options_outcome node_options_parse(struct node_options *options, int argc, char **argv)
{
	enum options_outcome outcome;

	*options = (struct node_options){ .common = common_defaults, .gpu = -2 };
	outcome = command_line_parse("grotto-node", "Draws one wall of a room for its grotto-master.",
				node_specs, sizeof node_specs / sizeof *node_specs, options, argc,
				argv);
	if (outcome == OPTIONS_RUN && !options->node) {
		gr_error("--node NAME is missing: which node of the layout this is");
		return OPTIONS_WRONG;
	}
	if (outcome == OPTIONS_RUN && !options->pictures && (options->every || options->exr)) {
		gr_error("--every and --exr say which pictures to save; --pictures DIR is missing");
		return OPTIONS_WRONG;
	}
	return outcome;
}
