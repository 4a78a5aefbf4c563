/* grotto trackers: what the trackers say, from a running master or by opening them. */
#include "base/clock.h"
#include "base/result.h"
#include "config/layout.h"
#include "daemon/trackers.h"
#include "tools/ask.h"
#include "tools/calibrate.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/trackers_print.h"
#include "tracking/replay.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DEFAULT_SOCKET GROTTO_RUNDIR "/control"
#define PATIENCE_NS (3 * GR_NS_PER_S)
#define POLL_NS (5 * GR_NS_PER_MS)
#define SHOW_NS (GR_NS_PER_S / 2)

struct options {
	const char *socket, *layout, *record;
	bool open, watch, json;
	float seconds; /* 0: until it is interrupted */
};

struct own {
	struct trackers trackers;
	FILE *record;
	const char *record_path;
	uint64_t samples, refused; /* recorded; not taken by the history */
	int64_t first_ns;	   /* of the log's time 0; INT64_MIN: nothing is recorded yet */
	int64_t last_ns[TRACK_BODIES];
};

/* True when somebody wants it to end; else after `ns`. The signals are blocked. */
static bool wait_or_end(const sigset_t *ends, int64_t ns)
{
	const struct timespec time = { ns / GR_NS_PER_S, ns % GR_NS_PER_S };

	return sigtimedwait(ends, NULL, &time) > 0;
}

static void block_ends(sigset_t *ends)
{
	sigemptyset(ends);
	sigaddset(ends, SIGINT);
	sigaddset(ends, SIGTERM);
	sigaddset(ends, SIGHUP);
	sigprocmask(SIG_BLOCK, ends, NULL);
}

/* On a terminal in place, else one below the other. */
static int show(const struct options *o, const char *answer)
{
	struct json_object *root = json_tokener_parse(answer);
	int status = GR_EXIT_RUNTIME;

	if (!json_object_is_type(root, json_type_object)) {
		fprintf(stderr, "grotto trackers: the answer is not JSON\n");
	} else if (!json_object_get_boolean(report_member(root, "ok"))) {
		fprintf(stderr, "grotto trackers: %s\n", report_text(root, "error"));
	} else {
		status = GR_EXIT_OK;
		if ((o->watch || o->open) && !o->json && isatty(STDOUT_FILENO))
			printf("\033[H\033[2J");
		if (o->json)
			printf("%s\n", answer);
		else if (json_object_array_length(report_member(root, "trackers")) == 0)
			printf("the layout names no trackers\n");
		else
			trackers_print_poses(report_member(root, "trackers"));
		fflush(stdout);
	}
	json_object_put(root);
	return status;
}

/* ---- from a running master ---- */

static int ask(const struct options *o, const char *socket)
{
	static char answer[ASK_ANSWER_MAX]; /* too large for a stack, used by one thread */
	const int64_t start_ns = gr_clock_now(&gr_clock_monotonic);
	sigset_t ends;

	if (o->watch)
		block_ends(&ends);
	for (;;) {
		int status, r = ask_master(socket, "trackers", PATIENCE_NS, answer, sizeof answer);

		if (r != GR_OK) {
			fprintf(stderr,
				"grotto trackers: %s: %s; --open asks the devices themselves\n",
				socket, r == GR_ERR_IO ? strerror(errno) : gr_result_name(r));
			return GR_EXIT_RUNTIME;
		}
		status = show(o, answer);
		if (status != GR_EXIT_OK || !o->watch || wait_or_end(&ends, SHOW_NS))
			return status;
		if (o->seconds > 0 &&
		    (double)(gr_clock_now(&gr_clock_monotonic) - start_ns) * 1e-9 >=
			    (double)o->seconds)
			return status;
	}
}

/* ---- by opening them ---- */

/* In the log's form: time 0 is the first sample, and per body the times ascend. */
static void on_sample(void *ctx, size_t tracker, const struct track_sample *sample, bool taken)
{
	struct own *own = ctx;
	struct track_sample line = *sample;

	(void)tracker;
	own->refused += !taken;
	if (!own->record || !taken)
		return;
	if (own->first_ns == INT64_MIN)
		own->first_ns = sample->time_ns;
	line.time_ns -= own->first_ns;
	/* Of two devices the second may begin with a sample that is older than the first's. */
	if (line.time_ns < 0 || line.time_ns <= own->last_ns[sample->body])
		return;
	own->last_ns[sample->body] = line.time_ns;
	track_replay_write(own->record, &line);
	own->samples++;
}

static int show_own(const struct options *o, const struct own *own, int64_t now_ns)
{
	static char answer[ASK_ANSWER_MAX];
	size_t len;

	if (trackers_answer(&own->trackers, now_ns, answer, sizeof answer, &len) < 0)
		return GR_EXIT_RUNTIME;
	return show(o, answer);
}

static int run_own(const struct options *o, struct own *own)
{
	const int64_t start_ns = gr_clock_now(&gr_clock_monotonic);
	const int64_t end_ns =
		o->seconds > 0 ? start_ns + llrint((double)o->seconds * 1e9) : INT64_MAX;
	int64_t show_ns = start_ns + SHOW_NS, now_ns;
	sigset_t ends;
	bool end = false;

	block_ends(&ends);
	if (trackers_start(&own->trackers) < 0)
		return GR_EXIT_RUNTIME;
	while (!end) {
		end = wait_or_end(&ends, POLL_NS);
		now_ns = gr_clock_now(&gr_clock_monotonic);
		trackers_poll(&own->trackers, now_ns - start_ns, now_ns);
		end = end || now_ns >= end_ns;
		if (now_ns < show_ns && !end)
			continue;
		/* As JSON one document at the end, or one each time where that is asked for. */
		if ((!o->json || o->watch || end) && show_own(o, own, now_ns) != GR_EXIT_OK)
			return GR_EXIT_RUNTIME;
		show_ns = now_ns + SHOW_NS;
	}
	return GR_EXIT_OK;
}

static int end_record(struct own *own)
{
	const bool failed = ferror(own->record) != 0;

	if (fclose(own->record) != 0 || failed) {
		fprintf(stderr, "grotto trackers: %s: %s\n", own->record_path, strerror(errno));
		return GR_EXIT_RUNTIME;
	}
	fprintf(stderr, "%s: %llu samples, %llu refused\n", own->record_path,
		(unsigned long long)own->samples, (unsigned long long)own->refused);
	return GR_EXIT_OK;
}

static int open_own(const struct options *o, const struct layout *layout)
{
	struct own own = { .first_ns = INT64_MIN, .record_path = o->record, .last_ns = { -1, -1 } };
	struct gr_diag diag = { 0 };
	int r = trackers_open(&own.trackers, layout, &diag), status;

	say_diag(&diag);
	gr_diag_finish(&diag);
	if (r < 0)
		return GR_EXIT_CONFIG;
	own.trackers.tap = (struct trackers_tap){ on_sample, &own };
	if (o->record) {
		own.record = fopen(o->record, "we");
		if (!own.record) {
			fprintf(stderr, "grotto trackers: %s: %s\n", o->record, strerror(errno));
			trackers_close(&own.trackers);
			return GR_EXIT_RUNTIME;
		}
		fprintf(own.record, "# time_s body valid px py pz qx qy qz qw buttons\n");
	}
	status = run_own(o, &own);
	trackers_close(&own.trackers);
	if (own.record && end_record(&own) != GR_EXIT_OK)
		status = GR_EXIT_RUNTIME;
	return status;
}

static int check_options(struct options *o, int words)
{
	const char *wrong = NULL;

	o->open = o->open || o->record != NULL;
	if (words != 0)
		wrong = "takes no words; see --help";
	else if (o->open && !o->layout)
		wrong = "--open and --record need --layout FILE";
	else if (o->open && o->socket)
		wrong = "--open asks no master; leave out --socket";
	else if (cli_same_file(o->record, o->layout))
		wrong = "--record would write over the layout: give it a file of its own";
	else if (o->socket && o->layout)
		wrong = "give --socket PATH or --layout FILE, not both";
	if (wrong)
		fprintf(stderr, "grotto trackers: %s\n", wrong);
	return wrong ? GR_EXIT_CONFIG : GR_EXIT_OK;
}

int command_trackers(int argc, char **argv)
{
	struct options o = { 0 };
	const struct cli_option options[] = {
		{ "socket", 's', CLI_TEXT, &o.socket, 0, 0, "PATH",
		  "the master's control socket (" DEFAULT_SOCKET ")" },
		{ "layout", 'l', CLI_TEXT, &o.layout, 0, 0, "FILE",
		  "the layout whose trackers, or whose master's socket" },
		{ "open", 'o', CLI_FLAG, &o.open, 0, 0, NULL,
		  "open the layout's trackers here, without a master" },
		{ "watch", 'w', CLI_FLAG, &o.watch, 0, 0, NULL,
		  "again and again, until interrupted" },
		{ "seconds", 't', CLI_REAL, &o.seconds, 0, 86400, "S", "end after so long" },
		{ "record", 'r', CLI_TEXT, &o.record, 0, 0, "FILE",
		  "with --open: write a log that kind = \"replay\" reads" },
		{ "json", 'j', CLI_FLAG, &o.json, 0, 0, NULL, "the answer as it came" },
	};
	const struct cli_table table = {
		"grotto trackers [--socket PATH | --layout FILE] [--open] [--watch] [--record "
		"FILE]\n"
		"       grotto trackers calibrate --layout FILE [--points FILE | --pivot] ...",
		"Says what each tracker does: state, rate, evenness, age, drop-outs, battery, "
		"what\n"
		"was refused, and where head and wand are. Asks the running master, or opens the\n"
		"trackers itself. calibrate: where a device is in the room; has options of its own.",
		options, sizeof options / sizeof options[0]
	};
	struct layout *layout = NULL;
	struct gr_diag diag = { 0 };
	int words, status = GR_EXIT_OK;

	if (argc > 1 && !strcmp(argv[1], "calibrate"))
		return trackers_calibrate(argc - 1, argv + 1);
	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (check_options(&o, words) != GR_EXIT_OK)
		return GR_EXIT_CONFIG;
	if (o.layout && layout_load(o.layout, &layout, &diag) != GR_OK)
		status = GR_EXIT_CONFIG;
	say_diag(&diag);
	gr_diag_finish(&diag);
	if (status == GR_EXIT_OK)
		status = o.open ? open_own(&o, layout)
				: ask(&o, layout     ? layout->control_socket
					  : o.socket ? o.socket
						     : DEFAULT_SOCKET);
	layout_destroy(&layout);
	return status;
}
