/* grotto record: begins, ends and looks at recordings of a room. */
#include "config.h" /* asprintf */

#include "base/clock.h"
#include "base/result.h"
#include "config/layout.h"
#include "tools/ask.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/record_info.h"
#include "tools/report.h"
#include "tools/say.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define DEFAULT_SOCKET GROTTO_RUNDIR "/control"
#define PATIENCE_NS (3 * GR_NS_PER_S)
#define SETTLE_NS (30 * GR_NS_PER_S) /* for the disk to take what there is */
#define LOOK_NS (20 * GR_NS_PER_MS)

struct record_options {
	const char *socket, *layout, *export, *table;
	bool stop, info, json;
	int recording;
};

/* The master's answer, NULL after a line on stderr. Free: json_object_put. */
static struct json_object *ask(const char *socket, const char *request)
{
	static char answer[ASK_ANSWER_MAX]; /* too large for a stack, used by one thread */
	int result = ask_master(socket, request, PATIENCE_NS, answer, sizeof answer);
	struct json_object *root = result == GR_OK ? json_tokener_parse(answer) : NULL;

	if (result != GR_OK)
		fprintf(stderr, "grotto record: %s: %s\n", socket,
			result == GR_ERR_IO ? strerror(errno) : gr_result_name(result));
	else if (!json_object_is_type(root, json_type_object))
		fprintf(stderr, "grotto record: %s: the answer is not JSON\n", socket);
	else if (!json_object_get_boolean(report_member(root, "ok")))
		fprintf(stderr, "grotto record: %s\n", report_text(root, "error"));
	else
		return root;
	json_object_put(root);
	return NULL;
}

/* Until the master is no longer at it: opening or ending. NULL after a line on stderr. */
static struct json_object *settled(const char *socket)
{
	const struct timespec pause = { 0, LOOK_NS };
	const int64_t until = gr_clock_now(&gr_clock_monotonic) + SETTLE_NS;

	for (;;) {
		struct json_object *root = ask(socket, "record");
		const char *state = root ? report_text(root, "record.state") : "";

		if (!root || (strcmp(state, "opening") != 0 && strcmp(state, "ending") != 0))
			return root;
		json_object_put(root);
		if (gr_clock_now(&gr_clock_monotonic) > until) {
			fprintf(stderr, "grotto record: the master's disk does not answer\n");
			return NULL;
		}
		nanosleep(&pause, NULL);
	}
}

static int print_state(const char *socket, bool json)
{
	struct json_object *root = ask(socket, "record");
	const char *path = root ? report_text(root, "record.path") : "";

	if (!root)
		return GR_EXIT_RUNTIME;
	if (json)
		printf("%s\n", json_object_to_json_string_ext(report_member(root, "record"),
							      JSON_C_TO_STRING_PLAIN));
	else if (!*path)
		printf("nothing was recorded yet\n");
	else
		printf("%s: %s, %lld entries, %lld bytes, %lld lost%s%s\n",
		       report_text(root, "record.state"), path,
		       (long long)report_count(root, "record.entries"),
		       (long long)report_count(root, "record.bytes"),
		       (long long)report_count(root, "record.lost"),
		       *report_text(root, "record.error") ? "; failed: " : "",
		       report_text(root, "record.error"));
	json_object_put(root);
	return GR_EXIT_OK;
}

/* The file as the master must name it, whose folder is not ours. NULL after a line on stderr. */
static char *absolute(const char *path)
{
	char *folder = path[0] == '/' ? NULL : realpath(".", NULL);
	char *whole = NULL;

	if (asprintf(&whole, "%s%s%s", folder ? folder : "", folder ? "/" : "", path) < 0)
		whole = NULL;
	free(folder);
	for (const char *c = whole; c && *c; c++)
		if (*c <= ' ' || *c > '~') {
			fprintf(stderr, "grotto record: '%s': a path of printable ASCII without blanks is "
				"what the control socket takes; choose another\n", whole);
			free(whole);
			return NULL;
		}
	return whole;
}

static int start(const char *socket, const char *path)
{
	char *whole = absolute(path), *request = NULL;
	struct json_object *root;
	int status = GR_EXIT_RUNTIME;

	if (!whole)
		return GR_EXIT_CONFIG;
	if (asprintf(&request, "record start %s", whole) < 0) {
		free(whole);
		return GR_EXIT_RUNTIME;
	}
	root = ask(socket, request);
	if (root) {
		json_object_put(root);
		root = settled(socket);
	}
	if (root && *report_text(root, "record.error")) {
		fprintf(stderr, "grotto record: %s\n", report_text(root, "record.error"));
	} else if (root) {
		printf("recording into %s; grotto record --stop ends it\n", whole);
		status = GR_EXIT_OK;
	}
	json_object_put(root);
	free(request);
	free(whole);
	return status;
}

static int stop(const char *socket)
{
	struct json_object *root = ask(socket, "record stop");
	bool failed;

	if (!root)
		return GR_EXIT_RUNTIME;
	json_object_put(root);
	root = settled(socket);
	failed = !root || *report_text(root, "record.error");
	json_object_put(root);
	return print_state(socket, false) == GR_EXIT_OK && !failed ? GR_EXIT_OK : GR_EXIT_RUNTIME;
}

static int ask_the_master(const struct record_options *o, const char *path)
{
	struct layout *layout = NULL;
	struct gr_diag diag = { 0 };
	const char *socket = o->socket ? o->socket : DEFAULT_SOCKET;
	int status = GR_EXIT_CONFIG, result = GR_OK;

	if (o->layout) {
		result = layout_load(o->layout, &layout, &diag);
		say_diag(&diag);
		gr_diag_finish(&diag);
		socket = layout ? layout->control_socket : NULL;
	}
	if (result == GR_OK && o->stop)
		status = stop(socket);
	else if (result == GR_OK)
		status = path ? start(socket, path) : print_state(socket, o->json);
	layout_destroy(&layout);
	return status;
}

static const char *wrong(const struct record_options *o, int words)
{
	if (o->socket && o->layout)
		return "give --socket PATH or --layout FILE, not both";
	if (o->stop + o->info + (o->export != NULL) > 1)
		return "give one of --stop, --info and --export";
	if ((o->info || o->export) && words != 1)
		return "give one FILE to look at";
	if (o->stop && words != 0)
		return "--stop takes no file: a master makes one recording at a time";
	if (words > 1)
		return "give one FILE";
	if (o->table && !o->export)
		return "--table says what to --export";
	return NULL;
}

int command_record(int argc, char **argv)
{
	struct record_options o = { .recording = 1 };
	const struct cli_option options[] = {
		{ "stop", 0, CLI_FLAG, &o.stop, 0, 0, NULL, "end the recording" },
		{ "info", 'i', CLI_FLAG, &o.info, 0, 0, NULL, "what is in FILE, gaps, damage" },
		{ "export", 'e', CLI_TEXT, &o.export, 0, 0, "DIR",
		  "write head, wand, frames, reports and events of FILE there as CSV" },
		{ "table", 't', CLI_TEXT, &o.table, 0, 0, "NAME",
		  "only this one of them; then --export names a file, or - for the standard output" },
		{ "recording", 'n', CLI_INT, &o.recording, 1, 1000000, "N",
		  "which of the file's recordings to export (1)" },
		{ "socket", 's', CLI_TEXT, &o.socket, 0, 0, "PATH",
		  "the master's control socket (" DEFAULT_SOCKET ")" },
		{ "layout", 'l', CLI_TEXT, &o.layout, 0, 0, "FILE", "the socket that this layout names" },
		{ "json", 'j', CLI_FLAG, &o.json, 0, 0, NULL, "state or info as JSON" },
	};
	const struct cli_table table = {
		"grotto record [FILE | --stop | --info FILE | --export DIR FILE] [OPTION...]",
		"Has the running master record its session at the end of FILE: trackers, states,\n"
		"answers of the nodes, events. Without FILE it says what is being recorded. The master\n"
		"opens the file, so its user must be able to write there. grotto replay shows it again.",
		options, sizeof options / sizeof options[0]
	};
	const char *fault;
	int words;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	fault = wrong(&o, words);
	if (fault) {
		fprintf(stderr, "grotto record: %s\n", fault);
		return GR_EXIT_CONFIG;
	}
	if (o.info)
		return record_info(argv[1], o.json);
	if (o.export)
		return record_export(argv[1], o.export, o.table, o.recording);
	return ask_the_master(&o, words == 1 ? argv[1] : NULL);
}
