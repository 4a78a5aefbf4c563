/* grotto status: asks a running master how its room is. */
#include "base/clock.h"
#include "base/plain.h"
#include "base/result.h"
#include "config/layout.h"
#include "tools/ask.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/trackers_print.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_SOCKET GROTTO_RUNDIR "/control"
#define PATIENCE_NS (3 * GR_NS_PER_S)

static void print_histogram(struct json_object *status, const char *what, const char *member)
{
	struct json_object *h = report_member(status, member);

	printf("%-22s p50 %8.0f us  p99 %8.0f us  max %8.0f us\n", what, report_number(h, "p50"),
	       report_number(h, "p99"), report_number(h, "max"));
}

/* Of the frames that were swapped in this way, if there are any. */
static void print_skew(struct json_object *status, const char *what, const char *member)
{
	if (report_count(report_member(status, member), "count") > 0)
		print_histogram(status, what, member);
}

#define PACE_MAX 64

/* Whether it keeps up, since when it does not, and when one that was left out for that may come back. */
static void pace_of(struct json_object *node, char text[PACE_MAX])
{
	const double for_s = report_number(node, "pace_for_s"), out_s = report_number(node, "out_for_s");

	if (report_member(node, "out_for_s"))
		snprintf(text, PACE_MAX, "out for %.0f s more", out_s);
	else if (report_member(node, "pace_for_s"))
		snprintf(text, PACE_MAX, "%s %.0f s", report_text(node, "pace"), for_s);
	else
		snprintf(text, PACE_MAX, "%s", report_text(node, "pace"));
}

/* Of a room with several masters. */
static void print_masters(struct json_object *status)
{
	struct json_object *masters = report_member(status, "masters");
	size_t count = json_object_is_type(masters, json_type_array)
			       ? json_object_array_length(masters) : 0;

	for (size_t i = 0; i < count; i++) {
		struct json_object *master = json_object_array_get_idx(masters, i);

		printf("%-14s %-24s %s", report_text(master, "name"), report_text(master, "address"),
		       report_text(master, "state"));
		if (report_member(master, "acked"))
			printf(", has frame %lld", (long long)report_count(master, "acked"));
		printf("\n");
	}
	if (report_member(status, "followed_ms_ago"))
		printf("this one has frame %lld, %.0f ms old\n",
		       (long long)report_count(status, "followed_frame"),
		       report_number(status, "followed_ms_ago"));
}

static void print_nodes(struct json_object *status)
{
	char pace[PACE_MAX];

	struct json_object *nodes = report_member(status, "nodes");
	size_t count = json_object_is_type(nodes, json_type_array)
			       ? json_object_array_length(nodes) : 0;

	printf("\n%-14s %-14s %-8s %-20s %10s %8s %8s %10s %10s %9s %8s\n", "node", "wall", "state", "pace", "swapped",
	       "missed", "differed", "ready ms", "render ms", "clock us", "ppm");
	for (size_t i = 0; i < count; i++) {
		struct json_object *node = json_object_array_get_idx(nodes, i);

		pace_of(node, pace);
		printf("%-14s %-14s %-8s %-20s %10lld %8lld %8lld %10.2f %10.2f",
		       report_text(node, "name"), report_text(node, "wall"),
		       report_text(node, "state"), pace, (long long)report_count(node, "swapped"),
		       (long long)report_count(node, "missed"),
		       (long long)report_count(node, "mismatches"),
		       report_number(node, "ready_after_ms"), report_number(node, "render_ms"));
		/* How far off it may be, at most; the offset itself says nothing to a person. */
		if (json_object_get_boolean(report_member(node, "clock.known")))
			printf(" %9.0f %+8.2f\n", report_number(node, "clock.error_us"),
			       report_number(node, "clock.skew_ppm"));
		else
			printf(" %9s %8s\n", "-", "-");
	}
}

/* Of nodes that are out of step: where their time goes. */
static void print_stages(struct json_object *status)
{
	struct json_object *nodes = report_member(status, "nodes");
	size_t count = json_object_is_type(nodes, json_type_array) ? json_object_array_length(nodes) : 0;

	for (size_t i = 0; i < count; i++) {
		struct json_object *node = json_object_array_get_idx(nodes, i);
		struct json_object *stages = report_member(node, "stages");
		size_t n = json_object_is_type(stages, json_type_array) ? json_object_array_length(stages) : 0;

		if (!report_member(node, "pace_for_s"))
			continue;
		printf("%s does not keep up: ready %.1f ms after a frame begins, draws for %.1f",
		       report_text(node, "name"), report_number(node, "ready_after_ms"),
		       report_number(node, "render_ms"));
		for (size_t k = 0; k < n; k++) {
			struct json_object *stage = json_object_array_get_idx(stages, k);

			printf("%s %s %.1f", k ? "," : ":", report_text(stage, "name"), report_number(stage, "ms"));
		}
		printf("\n");
	}
}

#define LIGHT_MAX 256

/* How a node computes light, and what it expects where it chose itself; "" where it is not said. */
static void light_of(struct json_object *node, char text[LIGHT_MAX])
{
	struct json_object *light = report_member(node, "light");
	size_t len;

	snprintf(text, LIGHT_MAX, "%s",
		 json_object_is_type(light, json_type_string) ? json_object_get_string(light) : "");
	len = strlen(text);
	if (report_member(node, "light_plan"))
		snprintf(text + len, LIGHT_MAX - len, "; expected %s ms a frame, error %s",
			 gr_plain(report_number(node, "light_ms"), 3).text,
			 gr_plain_percent(report_number(node, "light_error")).text);
}

/* One line when all nodes say the same, else one for each. */
static void print_light(struct json_object *status)
{
	struct json_object *nodes = report_member(status, "nodes");
	size_t count = json_object_is_type(nodes, json_type_array)
			       ? json_object_array_length(nodes) : 0;
	char first[LIGHT_MAX] = "", text[LIGHT_MAX];
	bool alike = true;

	for (size_t i = 0; i < count; i++) {
		light_of(json_object_array_get_idx(nodes, i), text);
		alike = alike && (!text[0] || !first[0] || !strcmp(first, text));
		if (!first[0])
			strcpy(first, text);
	}
	if (first[0] && alike)
		printf("light: %s\n", first);
	for (size_t i = 0; i < count && !alike; i++) {
		struct json_object *node = json_object_array_get_idx(nodes, i);

		light_of(node, text);
		if (text[0])
			printf("light of %s: %s\n", report_text(node, "name"), text);
	}
}

/* Of a room whose nodes share out the light. */
static void print_share(struct json_object *status)
{
	if (!json_object_get_boolean(report_member(status, "share.on")))
		return;
	printf("light of %lld nodes: %lld slices, %lld bytes in, %lld out; late %lld, lost %lld, %lld "
	       "pieces repaired\n",
	       (long long)report_count(status, "share.nodes"),
	       (long long)report_count(status, "share.slices"),
	       (long long)report_count(status, "share.bytes_in"),
	       (long long)report_count(status, "share.bytes_out"),
	       (long long)report_count(status, "share.late"),
	       (long long)report_count(status, "share.lost"),
	       (long long)report_count(status, "share.repairs"));
}

/* What is sent ahead of losses, and what that costs. */
static void print_parity(struct json_object *status)
{
	const long long sent = report_count(status, "wire.parity.sent");

	if (sent)
		printf("parity: %lld with the last state's %lld fragments; in all %lld, %.1f %% of the bytes sent\n",
		       (long long)report_count(status, "wire.parity.parity"),
		       (long long)report_count(status, "wire.parity.fragments"), sent,
		       100 * (double)report_count(status, "wire.parity.bytes") /
			       (double)report_count(status, "wire.bytes_out"));
}

static void print_bad(struct json_object *status)
{
	struct json_object *bad = report_member(status, "wire.bad");
	bool any = false;

	if (!json_object_is_type(bad, json_type_object))
		return;
	json_object_object_foreach(bad, kind, count) {
		if (json_object_get_int64(count) > 0) {
			printf("%s%lld %s", any ? ", " : "dropped datagrams: ",
			       (long long)json_object_get_int64(count), kind);
			any = true;
		}
	}
	if (any)
		printf("\n");
}

/* Whoever reads the figures must know that they are of a room that is disturbed. */
static void print_faults(struct json_object *status)
{
	struct json_object *faults = report_member(status, "faults");

	if (json_object_get_boolean(report_member(faults, "on")))
		printf("FAULTS are injected at the master, as asked (grotto faults): %lld lost in, %lld out, %lld "
		       "late, %lld twice\n", (long long)report_count(faults, "lost_in"),
		       (long long)report_count(faults, "lost_out"), (long long)report_count(faults, "delayed"),
		       (long long)report_count(faults, "duplicated"));
}

/* Whose pose is held, since when. */
static void print_lost(struct json_object *status, const char *body, const char *tracked,
		       const char *seen)
{
	/* Of a room without trackers, and one that has only just begun, there is nothing to say. */
	if (json_object_get_boolean(report_member(status, tracked)) || !report_member(status, seen))
		return;
	printf("the %s is lost, last seen %.1f s ago\n", body, report_number(status, seen));
}

static void print_tracking(struct json_object *status)
{
	struct json_object *trackers = report_member(status, "tracking.trackers");

	if (!json_object_is_type(trackers, json_type_array) || !json_object_array_length(trackers))
		return;
	printf("\n");
	trackers_print(trackers);
	print_lost(status, "head", "tracking.head_tracked", "tracking.head_seen_s_ago");
	print_lost(status, "wand", "tracking.wand_tracked", "tracking.wand_seen_s_ago");
	printf("\n");
}

static void print_status(struct json_object *status)
{
	bool running = json_object_get_boolean(report_member(status, "running"));

	const char *role = report_text(status, "role");

	printf("%s, %s: %s, frame %lld, up %.0f s\n", report_text(status, "layout"),
	       report_text(status, "scene"),
	       strcmp(role, "standby") == 0 || strcmp(role, "calling") == 0 ? role
	       : running						      ? "running"
									      : "waiting for nodes",
	       (long long)report_count(status, "frame"), report_number(status, "uptime_s"));
	print_masters(status);
	print_nodes(status);
	print_stages(status);
	print_tracking(status);
	printf("\n");
	print_skew(status, "swap skew, told", "skew_told_us");
	print_skew(status, "swap skew, at a time", "skew_scheduled_us");
	print_histogram(status, "commit to last swap", "commit_to_last_swap_us");
	printf("late %lld, evicted %lld, refused %lld; sent %lld bytes (%lld repairs), heard %lld\n",
	       (long long)report_count(status, "late"), (long long)report_count(status, "evicted"),
	       (long long)report_count(status, "refused"),
	       (long long)report_count(status, "wire.bytes_out"),
	       (long long)report_count(status, "wire.repairs"),
	       (long long)report_count(status, "wire.bytes_in"));
	print_parity(status);
	print_light(status);
	print_share(status);
	print_bad(status);
	print_faults(status);
}

static int ask_and_print(const char *socket, bool json)
{
	static char answer[ASK_ANSWER_MAX]; /* too large for a stack, used once */
	struct json_object *status;
	int result = ask_master(socket, "status", PATIENCE_NS, answer, sizeof answer);
	int exit_status = GR_EXIT_RUNTIME;

	if (result != GR_OK) {
		fprintf(stderr, "grotto status: %s: %s\n", socket,
			result == GR_ERR_IO ? strerror(errno) : gr_result_name(result));
		return GR_EXIT_RUNTIME;
	}
	status = json_tokener_parse(answer);
	if (!json_object_is_type(status, json_type_object)) {
		fprintf(stderr, "grotto status: %s: the answer is not JSON\n", socket);
	} else if (!json_object_get_boolean(report_member(status, "ok"))) {
		fprintf(stderr, "grotto status: %s: %s\n", socket, report_text(status, "error"));
	} else {
		if (json)
			printf("%s\n", answer);
		else
			print_status(status);
		exit_status = GR_EXIT_OK;
	}
	json_object_put(status);
	return exit_status;
}

int command_status(int argc, char **argv)
{
	const char *socket = NULL, *layout_path = NULL;
	bool json = false;
	const struct cli_option options[] = {
		{ "socket", 's', CLI_TEXT, &socket, 0, 0, "PATH",
		  "the master's control socket (" DEFAULT_SOCKET ")" },
		{ "layout", 'l', CLI_TEXT, &layout_path, 0, 0, "FILE", "the socket that this layout names" },
		{ "json", 'j', CLI_FLAG, &json, 0, 0, NULL, "the answer as it came" },
	};
	const struct cli_table table = {
		"grotto status [--socket PATH | --layout FILE] [--json]",
		"Asks the running master how its room is: nodes, frames, timing, datagrams, and\n"
		"how light is computed.",
		options, sizeof options / sizeof options[0]
	};
	struct layout *layout = NULL;
	struct gr_diag diag = { 0 };
	int words;
	int status = GR_EXIT_CONFIG;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (words != 0 || (socket && layout_path)) {
		fprintf(stderr, "grotto status: give --socket PATH or --layout FILE, not both\n");
		return GR_EXIT_CONFIG;
	}
	if (layout_path) {
		int result = layout_load(layout_path, &layout, &diag);

		say_diag(&diag);
		gr_diag_finish(&diag);
		if (result != GR_OK)
			return GR_EXIT_CONFIG;
		socket = layout->control_socket;
	}
	status = ask_and_print(socket ? socket : DEFAULT_SOCKET, json);
	layout_destroy(&layout);
	return status;
}
