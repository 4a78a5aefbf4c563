/* grotto faults: disturbs a running room on purpose, where its layout allows it. */
#include <config.h> /* asprintf */

#include "base/clock.h"
#include "base/result.h"
#include "config/layout.h"
#include "tools/ask.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/report.h"
#include "tools/say.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STANDARD_LAYOUT GROTTO_SYSCONFDIR "/cave.cave"
#define PATIENCE_NS (3 * GR_NS_PER_S)
#define VALUES 8
#define REQUEST 512

struct faults_options {
	const char *layout, *node;
	bool master, clear, kill, json;
	float values[VALUES]; /* NaN: not given */
	int seed;             /* -1: the daemon draws one */
};

static const struct value {
	const char *option, *name, *unit;
} values[VALUES] = {
	{ "loss-in", "loss_in", " %" }, { "loss-out", "loss_out", " %" },
	{ "delay", "delay_ms", " ms" }, { "jitter", "jitter_ms", " ms" },
	{ "duplicate", "duplicate", " %" }, { "reorder", "reorder", " %" },
	{ "stall", "stall_ms", " ms" }, { "stall-every", "stall_every", " frames" },
};

/* "" where nothing is to be changed. */
static void make_request(const struct faults_options *o, char request[REQUEST])
{
	size_t len;

	strcpy(request, o->clear ? "faults clear" : o->kill ? "faults kill" : "faults set");
	len = strlen(request);
	for (size_t i = 0; i < VALUES; i++)
		if (!isnan(o->values[i]))
			len += (size_t)snprintf(request + len, REQUEST - len, " %s %g", values[i].name,
						(double)o->values[i]);
	if (o->seed >= 0)
		snprintf(request + len, REQUEST - len, " seed %d", o->seed);
	if (!strcmp(request, "faults set"))
		strcpy(request, "faults");
}

static void print_faults(const char *who, struct json_object *faults)
{
	bool any = false;

	printf("%-12s", who);
	for (size_t i = 0; i < VALUES; i++) {
		double value = report_number(faults, values[i].name);

		if (value > 0)
			printf("%s %s %g%s", any ? "," : "", values[i].option, value, values[i].unit);
		any = any || value > 0;
	}
	if (any)
		printf("; seed %lld", (long long)report_count(faults, "seed"));
	else
		printf(" none");
	printf("; so far %lld lost in, %lld out, %lld late, %lld twice, %lld out of order, %lld stalls\n",
	       (long long)report_count(faults, "lost_in"), (long long)report_count(faults, "lost_out"),
	       (long long)report_count(faults, "delayed"), (long long)report_count(faults, "duplicated"),
	       (long long)report_count(faults, "reordered"), (long long)report_count(faults, "stalls"));
}

/* Takes no answer for a fault where a daemon may be on another machine. */
static bool ask_one(const struct faults_options *o, const char *who, const char *socket, bool must)
{
	static char answer[ASK_ANSWER_MAX]; /* too large for a stack, used by one thread */
	char request[REQUEST];
	struct json_object *root;
	bool right = false;
	int r;

	make_request(o, request);
	r = ask_master(socket, request, PATIENCE_NS, answer, sizeof answer);
	if (r == GR_ERR_IO && !must) {
		if (!o->json)
			printf("%-12s does not run on this machine\n", who);
		return true;
	}
	root = r == GR_OK ? json_tokener_parse(answer) : NULL;
	if (r != GR_OK)
		fprintf(stderr, "grotto faults: %s: %s: %s\n", who, socket,
			r == GR_ERR_IO ? strerror(errno) : gr_result_name(r));
	else if (!json_object_get_boolean(report_member(root, "ok")))
		fprintf(stderr, "grotto faults: %s: %s\n", who, report_text(root, "error"));
	else
		right = true;
	if (right && o->json)
		printf("{\"name\":\"%s\",\"faults\":%s}\n", who,
		       json_object_to_json_string_ext(report_member(root, "faults"), JSON_C_TO_STRING_PLAIN));
	else if (right && o->kill)
		printf("%-12s dies\n", who);
	else if (right)
		print_faults(who, report_member(root, "faults"));
	json_object_put(root);
	return right;
}

static bool ask_node(const struct faults_options *o, const struct layout *layout, size_t i, bool must)
{
	char *socket = NULL;
	bool right;

	if (asprintf(&socket, "%s.%s", layout->control_socket, layout->nodes[i].name) < 0)
		return false;
	right = ask_one(o, layout->nodes[i].name, socket, must);
	free(socket);
	return right;
}

static int ask_all(const struct faults_options *o, const struct layout *layout)
{
	bool all = !o->master && !o->node, right = true;
	int node = o->node ? layout_find_node(layout, o->node) : -1;

	if (!layout->test.faults) {
		fprintf(stderr, "grotto faults: %s does not allow faults; test = { faults = true; } in it, and a "
			"restart, would\n", layout->path);
		return GR_EXIT_CONFIG;
	}
	if (o->node && node < 0) {
		fprintf(stderr, "grotto faults: %s has no node '%s'\n", layout->path, o->node);
		return GR_EXIT_CONFIG;
	}
	if (all || o->master)
		right = ask_one(o, "master", layout->control_socket, o->master);
	if (node >= 0)
		right = ask_node(o, layout, (size_t)node, true) && right;
	for (size_t i = 0; all && i < layout->node_count; i++)
		right = ask_node(o, layout, i, false) && right;
	return right ? GR_EXIT_OK : GR_EXIT_RUNTIME;
}

static const char *wrong(const struct faults_options *o, int words)
{
	bool sets = o->seed >= 0;

	for (size_t i = 0; i < VALUES; i++)
		sets = sets || !isnan(o->values[i]);
	if (words != 0)
		return "takes options only";
	if (o->clear + o->kill + sets > 1)
		return "give one of --clear, --kill, and what to set";
	if (o->kill && !o->master && !o->node)
		return "--kill whom? --master or --node NAME";
	return NULL;
}

static int with_layout(const struct faults_options *o)
{
	struct layout *layout = NULL;
	struct gr_diag diag = { 0 };
	int status = GR_EXIT_CONFIG;

	if (layout_load(o->layout, &layout, &diag) == GR_OK)
		status = ask_all(o, layout);
	say_diag(&diag);
	gr_diag_finish(&diag);
	layout_destroy(&layout);
	return status;
}

int command_faults(int argc, char **argv)
{
	struct faults_options o = { .layout = STANDARD_LAYOUT, .seed = -1 };
	const struct cli_option options[] = {
		{ "layout", 'l', CLI_TEXT, &o.layout, 0, 0, "FILE", "the room's layout (" STANDARD_LAYOUT ")" },
		{ "master", 'm', CLI_FLAG, &o.master, 0, 0, NULL, "the master alone" },
		{ "node", 'n', CLI_TEXT, &o.node, 0, 0, "NAME", "that node alone" },
		{ "loss-in", 0, CLI_REAL, &o.values[0], 0, 100, "PERCENT", "lose what arrives" },
		{ "loss-out", 0, CLI_REAL, &o.values[1], 0, 100, "PERCENT", "lose what is sent" },
		{ "delay", 0, CLI_REAL, &o.values[2], 0, 1000, "MS", "what arrives comes later" },
		{ "jitter", 0, CLI_REAL, &o.values[3], 0, 1000, "MS", "and up to so much later still" },
		{ "duplicate", 0, CLI_REAL, &o.values[4], 0, 100, "PERCENT", "what arrives comes twice" },
		{ "reorder", 0, CLI_REAL, &o.values[5], 0, 100, "PERCENT", "hold back 2 ms, so that others overtake" },
		{ "stall", 0, CLI_REAL, &o.values[6], 0, 60000, "MS", "a node sleeps in its next frame" },
		{ "stall-every", 0, CLI_REAL, &o.values[7], 0, 1000000, "N", "and in all that N divides" },
		{ "seed", 0, CLI_INT, &o.seed, 0, 2147483647, "N", "of what is drawn; else the daemons take one each" },
		{ "clear", 0, CLI_FLAG, &o.clear, 0, 0, NULL, "no more faults" },
		{ "kill", 0, CLI_FLAG, &o.kill, 0, 0, NULL, "the daemon dies at once, by SIGKILL" },
		{ "json", 'j', CLI_FLAG, &o.json, 0, 0, NULL, "a JSON document for each daemon" },
	};
	const struct cli_table table = {
		"grotto faults [--layout FILE] [--master | --node NAME] [OPTION...]",
		"Disturbs a running room on purpose, for acceptance tests: loss, delay, duplicates,\n"
		"disorder, stalls, death. The layout must allow it: test = { faults = true; }. It asks\n"
		"the master and those nodes that run on this machine; without anything to set it prints\n"
		"what is set.",
		options, sizeof options / sizeof options[0]
	};
	const char *fault;
	int words;

	for (size_t i = 0; i < VALUES; i++)
		o.values[i] = NAN;
	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	fault = wrong(&o, words);
	if (fault) {
		fprintf(stderr, "grotto faults: %s\n", fault);
		return GR_EXIT_CONFIG;
	}
	return with_layout(&o);
}
