#include "tools/demo.h"

#include "base/result.h"
#include "tools/report.h"

#include <config.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of a failed process' log. */
#define LOG_TAIL_BYTES 1500

struct summary {
	const struct demo *demo;
	struct json_object *master;  /* its report, NULL without one */
	struct json_object *nodes[LAYOUT_MAX_NODES];
	struct json_object *faults;  /* array of strings */
	int fault_count;
};

static void add_fault(struct summary *summary, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

static void add_fault(struct summary *summary, const char *format, ...)
{
	char text[512];
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	fprintf(stderr, "fault: %s\n", text);
	json_object_array_add(summary->faults, json_object_new_string(text));
	summary->fault_count++;
}

/* The end of a log, so that a person need not look for it. */
static void show_log(const char *path)
{
	char tail[LOG_TAIL_BYTES + 1];
	FILE *file = fopen(path, "re");
	const char *start = tail;
	size_t n;
	long size;

	if (!file)
		return;
	size = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : 0;
	if (size > LOG_TAIL_BYTES) {
		fseek(file, size - LOG_TAIL_BYTES, SEEK_SET);
	} else {
		rewind(file);
	}
	n = fread(tail, 1, LOG_TAIL_BYTES, file);
	fclose(file);
	tail[n] = '\0';
	if (size > LOG_TAIL_BYTES && strchr(tail, '\n'))
		start = strchr(tail, '\n') + 1;
	fprintf(stderr, "--- end of %s\n%s---\n", path, start);
}

static void judge_process(struct summary *summary, const struct child *child)
{
	char how[96];

	if (child->told || child_ended_well(child))
		return;
	child_describe(child, how, sizeof how);
	add_fault(summary, "%s %s", child->name, how);
	show_log(child->log);
}

static void judge_node(struct summary *summary, size_t i)
{
	const struct demo *demo = summary->demo;
	const char *name = demo->layout->nodes[i].name;
	struct json_object *report = summary->nodes[i];
	struct json_object *peer = report_named(summary->master, "nodes", name);
	int64_t frames = demo->options.frames;
	int64_t mismatches;

	if (!report) {
		add_fault(summary, "%s left no report", name);
		return;
	}
	if (report_count(report, "applied") != frames)
		add_fault(summary, "%s applied %lld of %lld frames", name,
			  (long long)report_count(report, "applied"), (long long)frames);
	if (report_count(report, "swapped") != frames)
		add_fault(summary, "%s swapped %lld of %lld frames", name,
			  (long long)report_count(report, "swapped"), (long long)frames);
	mismatches = report_count(report, "mismatches") + report_count(peer, "mismatches");
	if (mismatches > 0)
		add_fault(summary, "%s held another state than the master in %lld frames", name,
			  (long long)mismatches);
	/* A node whose master has left holds no state any more and says 0. */
	if (summary->master && strspn(report_text(report, "state_hash"), "0") != 16 &&
	    strcmp(report_text(report, "state_hash"),
		   report_text(summary->master, "state_hash")) != 0)
		add_fault(summary, "%s ended with state %s, the master with %s", name,
			  report_text(report, "state_hash"),
			  report_text(summary->master, "state_hash"));
	if (report_count(report, "gl_errors") > 0)
		add_fault(summary, "%s: %lld GL errors", name,
			  (long long)report_count(report, "gl_errors"));
	if (report_count(report, "nonfinite") > 0)
		add_fault(summary, "%s: %lld values that are not finite", name,
			  (long long)report_count(report, "nonfinite"));
}

static struct json_object *load(const struct demo *demo, const char *file)
{
	char *path = demo_path(demo, file, ".json");
	struct json_object *report = path ? report_load(path) : NULL;

	free(path);
	return report;
}

/* The master has compared; its status says the same, but not what. */
static void judge_replay(struct summary *summary)
{
	struct json_object *replay = report_member(summary->master, "replay");

	if (!replay)
		return;
	if (report_count(replay, "different") > 0)
		add_fault(summary, "%lld states differ from the record; the first at frame %lld on %s: %s, recorded %s",
			  (long long)report_count(replay, "different"),
			  (long long)report_count(replay, "first_difference.frame"),
			  report_text(replay, "first_difference.where"),
			  report_text(replay, "first_difference.found"),
			  report_text(replay, "first_difference.recorded"));
	if (report_count(replay, "unanswered") > 0)
		add_fault(summary, "%lld times a node did not say which state it holds",
			  (long long)report_count(replay, "unanswered"));
	if (report_count(replay, "frames_wrong") > 0)
		add_fault(summary, "%lld states of the file are not what their hash says",
			  (long long)report_count(replay, "frames_wrong"));
}

int demo_replayed(const struct demo *demo)
{
	struct json_object *master = load(demo, "master"), *replay = report_member(master, "replay");
	int frames = replay ? (int)report_count(replay, "frames") : -1;

	if (replay)
		printf("replayed %lld frames: %lld states of the master and %lld of nodes as recorded, %lld differ\n",
		       (long long)report_count(replay, "frames"),
		       (long long)report_count(replay, "master_equal"),
		       (long long)report_count(replay, "nodes_equal"),
		       (long long)report_count(replay, "different"));
	if (report_count(replay, "frames_missing") > 0)
		printf("%lld frames of the recording are missing or damaged and were left out\n",
		       (long long)report_count(replay, "frames_missing"));
	if (report_count(replay, "bytes_damaged") > 0)
		printf("%lld bytes of the recording are damaged or no whole block: what they held was left out\n",
		       (long long)report_count(replay, "bytes_damaged"));
	json_object_put(master);
	return frames;
}

static void judge(struct summary *summary)
{
	const struct demo *demo = summary->demo;
	const struct children *children = &demo->children;
	bool blamed;

	if (demo->interrupted)
		add_fault(summary, "interrupted");
	if (demo->stalled)
		add_fault(summary, "no new frame for %d s", demo->options.patience_s);
	for (size_t i = 0; i < children->count; i++)
		judge_process(summary, &children->items[i]);
	/* Those that were told to end because of one of these are not to blame. */
	blamed = summary->fault_count > 0;
	for (size_t i = 0; i < children->count && !blamed; i++)
		if (children->items[i].told)
			add_fault(summary, "%s did not end after the last frame",
				  children->items[i].name);
	if (children->count > 0 && child_ended_well(&children->items[0]) && !summary->master)
		add_fault(summary, "the master left no report");
	judge_replay(summary);
	for (size_t i = 0; i < demo->layout->node_count; i++)
		if (i + 1 < children->count && !children->items[i + 1].told &&
		    child_ended_well(&children->items[i + 1]))
			judge_node(summary, i);
}

/*
 * Do all nodes hold the same light? Bit by bit only nodes with the same GL can be
 * asked to, and those that share one out.
 */
static bool light_agrees(const struct summary *summary)
{
	struct json_object *first = summary->nodes[0];

	for (size_t i = 1; i < summary->demo->layout->node_count; i++) {
		struct json_object *node = summary->nodes[i];

		bool shared = report_count(first, "share.nodes") > 1 &&
			      report_count(node, "share.nodes") > 1;

		if ((shared || strcmp(report_text(node, "renderer"),
				      report_text(first, "renderer")) == 0) &&
		    strcmp(report_text(node, "light_hash"), report_text(first, "light_hash")) != 0)
			return false;
	}
	return true;
}

/* Copies a member of a report under the same name; null when it is missing. */
static void copy_member(struct json_object *to, struct json_object *from, const char *name)
{
	json_object_object_add(to, name, json_object_get(report_member(from, name)));
}

static struct json_object *node_json(const struct summary *summary, size_t i)
{
	static const char *const members[] = {
		"applied", "drawn", "swapped", "mismatches", "joined", "skipped_eyes",
		"shadow_updates", "gi_updates", "gl_errors", "nonfinite", "state_hash",
		"light_hash", "share", "cpu_ms_a_frame", "renderer", "platform", "width", "height", "pictures", "wire", "stages",
	};
	const struct demo *demo = summary->demo;
	const struct layout_node *node = &demo->layout->nodes[i];
	struct json_object *out = json_object_new_object();
	char how[96] = "was not started";

	if (i + 1 < demo->children.count)
		child_describe(&demo->children.items[i + 1], how, sizeof how);
	json_object_object_add(out, "name", json_object_new_string(node->name));
	json_object_object_add(out, "wall",
			       json_object_new_string(demo->layout->walls[node->wall].name));
	json_object_object_add(out, "process", json_object_new_string(how));
	for (size_t k = 0; k < sizeof members / sizeof members[0]; k++)
		copy_member(out, summary->nodes[i], members[k]);
	return out;
}

static struct json_object *summary_json(struct summary *summary)
{
	static const char *const members[] = {
		"frames_complete", "frames_incomplete", "late", "evicted", "state_hash", "skew_us",
		"skew_told_us", "skew_scheduled_us",
		"commit_to_applied_us", "commit_to_swap_sent_us", "commit_to_last_swap_us", "share", "wire",
		"replay",
	};
	const struct demo *demo = summary->demo;
	struct json_object *out = json_object_new_object();
	struct json_object *nodes = json_object_new_array();
	double seconds = (double)demo->took_ns * 1e-9;

	json_object_object_add(out, "ok", json_object_new_boolean(summary->fault_count == 0));
	json_object_object_add(out, "faults", json_object_get(summary->faults));
	json_object_object_add(out, "grotto", json_object_new_string(PACKAGE_VERSION));
	json_object_object_add(out, "layout", json_object_new_string(demo->layout->name));
	json_object_object_add(out, "scene", json_object_new_string(demo->scene->name));
	json_object_object_add(out, "frames", json_object_new_int(demo->options.frames));
	json_object_object_add(out, "frame_hz",
			       json_object_new_double((double)demo->layout->rates.frame_hz));
	json_object_object_add(out, "real_time",
			       json_object_new_boolean(demo->options.rate_hz > 0));
	json_object_object_add(out, "seconds", json_object_new_double(seconds));
	json_object_object_add(out, "light_agrees",
			       json_object_new_boolean(light_agrees(summary)));
	for (size_t k = 0; k < sizeof members / sizeof members[0]; k++)
		copy_member(out, summary->master, members[k]);
	for (size_t i = 0; i < demo->layout->node_count; i++)
		json_object_array_add(nodes, node_json(summary, i));
	json_object_object_add(out, "nodes", nodes);
	return out;
}

static void print_nodes(const struct summary *summary)
{
	printf("%-12s %-12s %8s %8s %8s %11s %11s\n", "node", "wall", "applied", "swapped",
	       "differed", "bytes in", "bytes out");
	for (size_t i = 0; i < summary->demo->layout->node_count; i++) {
		const struct layout_node *node = &summary->demo->layout->nodes[i];
		struct json_object *report = summary->nodes[i];

		printf("%-12s %-12s %8lld %8lld %8lld %11lld %11lld\n", node->name,
		       summary->demo->layout->walls[node->wall].name,
		       (long long)report_count(report, "applied"),
		       (long long)report_count(report, "swapped"),
		       (long long)report_count(report, "mismatches"),
		       (long long)report_count(report, "wire.bytes_in"),
		       (long long)report_count(report, "wire.bytes_out"));
	}
}

/* A light that the nodes share out: what it cost, what was missing, and that all hold the same. */
static void print_share(const struct summary *summary)
{
	int64_t sent = 0, received = 0, late = 0, lost = 0, bytes = 0;
	int frames = summary->demo->options.frames;

	if (!json_object_get_boolean(report_member(summary->nodes[0], "share.on")))
		return;
	for (size_t i = 0; i < summary->demo->layout->node_count; i++) {
		struct json_object *node = summary->nodes[i];

		sent += report_count(node, "share.sent");
		bytes += report_count(node, "share.bytes_sent");
		received += report_count(node, "share.received");
		late += report_count(node, "share.late");
		lost += report_count(node, "share.lost");
	}
	printf("light shared by %lld nodes: %lld slices sent, %lld received, %lld late, %lld lost; "
	       "%.0f bytes a frame made, %.0f passed on\n",
	       (long long)report_count(summary->nodes[0], "share.nodes"), (long long)sent,
	       (long long)received, (long long)late, (long long)lost,
	       (double)bytes / frames, report_number(summary->master, "share.bytes_out") / frames);
	if (light_agrees(summary))
		printf("all nodes hold the same light, %s\n",
		       report_text(summary->nodes[0], "light_hash"));
}

/* One line a stage: the mean over the nodes that run it, and the slowest. */
static void print_stages(const struct summary *summary)
{
	size_t node_count = summary->demo->layout->node_count;
	const char *shown[64];
	size_t shown_count = 0;

	for (size_t i = 0; i < node_count; i++) {
		struct json_object *stages = report_member(summary->nodes[i], "stages");
		size_t count = json_object_is_type(stages, json_type_array)
				       ? json_object_array_length(stages) : 0;

		for (size_t k = 0; k < count; k++) {
			const char *name = report_text(json_object_array_get_idx(stages, k), "name");
			const char *slowest = "?";
			double sum = 0, worst = -1;
			int nodes = 0;
			bool seen = false;

			for (size_t s = 0; s < shown_count; s++)
				seen = seen || strcmp(shown[s], name) == 0;
			if (seen || shown_count == sizeof shown / sizeof shown[0])
				continue;
			shown[shown_count++] = name;
			for (size_t n = 0; n < node_count; n++) {
				struct json_object *stage =
					report_named(summary->nodes[n], "stages", name);
				double mean = report_number(stage, "mean_ms");

				if (!stage || report_count(stage, "count") == 0)
					continue;
				sum += mean;
				nodes++;
				if (mean > worst) {
					worst = mean;
					slowest = summary->demo->layout->nodes[n].name;
				}
			}
			if (nodes > 0)
				printf("  %-20s %9.3f ms mean of %d node%s, %9.3f ms on %s\n", name,
				       sum / nodes, nodes, nodes == 1 ? "" : "s", worst, slowest);
		}
	}
}

static void print_timing(struct json_object *master, const char *what, const char *member)
{
	struct json_object *h = report_member(master, member);

	printf("%-24s p50 %10.0f us  p99 %10.0f us  max %10.0f us  (%lld frames)\n", what,
	       report_number(h, "p50"), report_number(h, "p99"), report_number(h, "max"),
	       (long long)report_count(h, "count"));
}

/* Of the frames that were swapped in this way, if there are any. */
static void print_skew(struct json_object *master, const char *what, const char *member)
{
	if (report_count(report_member(master, member), "count") > 0)
		print_timing(master, what, member);
}

/* What was asked for is only said of a run that did it. */
static void print_frames(const struct summary *summary)
{
	int frames = summary->demo->options.frames;
	int64_t complete = report_count(summary->master, "frames_complete");

	if (summary->fault_count == 0 || complete == frames)
		printf("%d frame%s", frames, frames == 1 ? "" : "s");
	else if (report_member(summary->master, "frames_complete"))
		printf("%lld of %d frame%s complete", (long long)complete, frames,
		       frames == 1 ? "" : "s");
	else
		printf("%d frame%s asked for, the master told none", frames,
		       frames == 1 ? "" : "s");
}

static void print_summary(const struct summary *summary)
{
	if (summary->demo->children.count > 1)
		print_nodes(summary);
	if (summary->master) {
		print_skew(summary->master, "swap skew, told", "skew_told_us");
		print_skew(summary->master, "swap skew, at a time", "skew_scheduled_us");
		print_timing(summary->master, "commit to last swap", "commit_to_last_swap_us");
		printf("master sent %lld bytes in %lld datagrams (%lld repairs), heard %lld bytes\n",
		       (long long)report_count(summary->master, "wire.bytes_out"),
		       (long long)report_count(summary->master, "wire.datagrams_out"),
		       (long long)report_count(summary->master, "wire.repairs"),
		       (long long)report_count(summary->master, "wire.bytes_in"));
	}
	print_share(summary);
	print_stages(summary);
	if (!light_agrees(summary))
		fprintf(stderr, "warning: nodes that should hold the same light do not\n");
	if (report_member(summary->nodes[0], "renderer"))
		printf("%s; ", report_text(summary->nodes[0], "renderer"));
	print_frames(summary);
	printf(" in %.1f s with start and end\n", (double)summary->demo->took_ns * 1e-9);
}

static int save_json(const struct demo *demo, struct json_object *json)
{
	char *path = demo_path(demo, "summary", ".json");
	int result = GR_ERR_IO;

	if (path && json_object_to_file_ext(path, json,
					    JSON_C_TO_STRING_PRETTY | JSON_C_TO_STRING_SPACED |
						    JSON_C_TO_STRING_NOSLASHESCAPE) == 0)
		result = GR_OK;
	if (result != GR_OK)
		fprintf(stderr, "%s/summary.json: cannot be written\n", demo->options.out);
	free(path);
	return result;
}

int demo_summary(const struct demo *demo)
{
	struct summary summary = { .demo = demo, .faults = json_object_new_array() };
	struct json_object *json;
	int result;

	summary.master = load(demo, "master");
	for (size_t i = 0; i < demo->layout->node_count; i++) {
		char file[LAYOUT_NAME_MAX + 8];

		demo_node_file(&demo->layout->nodes[i], file);
		summary.nodes[i] = load(demo, file);
	}
	judge(&summary);
	print_summary(&summary);
	json = summary_json(&summary);
	result = save_json(demo, json);
	json_object_put(json);
	json_object_put(summary.faults);
	json_object_put(summary.master);
	for (size_t i = 0; i < demo->layout->node_count; i++)
		json_object_put(summary.nodes[i]);
	return result == GR_OK ? summary.fault_count : -1;
}
