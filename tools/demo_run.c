#include "tools/demo.h"

#include "base/clock.h"
#include "base/result.h"
#include "tools/ask.h"
#include "tools/programs.h"

#include <errno.h>
#include <json-c/json.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ARGUMENTS_MAX 32
#define PROGRESS_NS (GR_NS_PER_S / 4)
#define ASK_NS (GR_NS_PER_S / 5)
/* After the master's end the nodes save their last pictures; at most, in seconds. */
#define NODES_END_S 60
/* After SIGTERM. */
#define END_NS (10 * GR_NS_PER_S)

struct arguments {
	char *items[ARGUMENTS_MAX]; /* owned; ends with NULL */
	size_t count;
	bool complete;
};

static void add_argument(struct arguments *arguments, const char *text)
{
	char *copy = arguments->count + 1 < ARGUMENTS_MAX && text ? strdup(text) : NULL;

	if (copy)
		arguments->items[arguments->count++] = copy;
	else
		arguments->complete = false;
}

static void add_option(struct arguments *arguments, const char *name, const char *value)
{
	add_argument(arguments, name);
	add_argument(arguments, value);
}

static void add_number(struct arguments *arguments, const char *name, int value)
{
	char text[16];

	snprintf(text, sizeof text, "%d", value);
	add_option(arguments, name, text);
}

static int spawn(struct demo *demo, const char *name, const char *file,
		 const struct arguments *arguments)
{
	char *log = demo_path(demo, file, ".log");
	int result = GR_ERR_NOMEM;

	if (log && arguments->complete)
		result = children_spawn(&demo->children, name, arguments->items, log);
	if (result != GR_OK)
		fprintf(stderr, "%s: cannot start %s: %s\n", name,
			arguments->count ? arguments->items[0] : "it",
			result == GR_ERR_IO ? strerror(errno) : gr_result_name(result));
	free(log);
	return result;
}

static void arguments_finish(struct arguments *arguments)
{
	for (size_t i = 0; i < arguments->count; i++)
		free(arguments->items[i]);
}

/* What both daemons are told. */
static struct arguments arguments_start(const struct demo *demo, const char *program,
					const char *file)
{
	struct arguments arguments = { .complete = true };
	char *report = demo_path(demo, file, ".json");

	add_argument(&arguments, program);
	add_option(&arguments, "--layout", demo->layout_path);
	add_option(&arguments, "--scene", demo->scene_path);
	add_option(&arguments, "--report", report);
	if (demo->options.deadline_ms > 0)
		add_number(&arguments, "--deadline-ms", demo->options.deadline_ms);
	/* A report of an earlier run must not pass for this one's. */
	if (report)
		unlink(report);
	free(report);
	return arguments;
}

static void add_real(struct arguments *arguments, const char *name, float value)
{
	char text[32];

	snprintf(text, sizeof text, "%.9g", (double)value);
	add_option(arguments, name, text);
}

static void add_replay(struct arguments *arguments, const struct demo_replay *replay)
{
	add_option(arguments, "--replay", replay->file);
	add_number(arguments, "--recording", replay->recording);
	if (replay->from_s > 0)
		add_real(arguments, "--from", replay->from_s);
	if (replay->fast)
		add_argument(arguments, "--frame-clock");
	else
		add_real(arguments, "--speed", replay->speed);
	if (replay->step)
		add_argument(arguments, "--step");
	/* The planned layout has other addresses; the one that it is made from was compared. */
	if (replay->other_layout || !replay->room)
		add_argument(arguments, "--other-layout");
}

static int spawn_master(struct demo *demo, const char *program)
{
	struct arguments arguments = arguments_start(demo, program, "master");
	int result;

	add_number(&arguments, "--frames", demo->options.frames);
	add_argument(&arguments, "--wait-all");
	add_option(&arguments, "--control", demo->socket);
	if (demo->options.record)
		add_option(&arguments, "--record", demo->options.record);
	if (demo->options.replay)
		add_replay(&arguments, demo->options.replay);
	/* At a rate the visitor walks in real time, else as fast as the walls are drawn. */
	else if (demo->options.rate_hz <= 0)
		add_argument(&arguments, "--frame-clock");
	result = spawn(demo, "master", "master", &arguments);
	arguments_finish(&arguments);
	return result;
}

static int spawn_node(struct demo *demo, const char *program, const struct layout_node *node)
{
	char file[LAYOUT_NAME_MAX + 8];
	struct arguments arguments;
	int result;

	demo_node_file(node, file);
	arguments = arguments_start(demo, program, file);
	add_option(&arguments, "--node", node->name);
	add_argument(&arguments, "--once");
	add_option(&arguments, "--pictures", demo->options.out);
	if (demo->options.every > 0)
		add_number(&arguments, "--every", demo->options.every);
	if (demo->options.exr)
		add_argument(&arguments, "--exr");
	result = spawn(demo, node->name, file, &arguments);
	arguments_finish(&arguments);
	return result;
}

static size_t started_nodes(const struct demo *demo)
{
	return demo->options.replay && demo->options.replay->room ? 0 : demo->layout->node_count;
}

static int spawn_all(struct demo *demo)
{
	char *master = programs_find("grotto-master");
	char *node = programs_find("grotto-node");
	int result = GR_ERR_IO;

	if (!master || !node)
		fprintf(stderr, "%s: %s is neither beside this program nor in %s\n", demo->command,
			master ? "grotto-node" : "grotto-master", GROTTO_SBINDIR);
	else
		result = spawn_master(demo, master);
	for (size_t i = 0; i < started_nodes(demo) && result == GR_OK; i++)
		result = spawn_node(demo, node, &demo->layout->nodes[i]);
	free(master);
	free(node);
	return result;
}

/* How many frames the master has begun, and how many all swapped; -1 while it does not say. */
static void ask_frames(const struct demo *demo, int64_t *out_begun, int64_t *out_complete)
{
	static char answer[ASK_ANSWER_MAX]; /* too large for a stack, used by one thread */
	struct json_object *root, *count;

	*out_begun = *out_complete = -1;
	if (ask_master(demo->socket, "status", ASK_NS, answer, sizeof answer) != GR_OK)
		return;
	root = json_tokener_parse(answer);
	if (root && json_object_object_get_ex(root, "frames", &count))
		*out_begun = json_object_get_int64(count);
	if (root && json_object_object_get_ex(root, "frames_complete", &count))
		*out_complete = json_object_get_int64(count);
	json_object_put(root);
}

struct progress {
	bool terminal;
	int64_t frame, shown; /* last known, last printed; -1 none */
	int64_t changed_ns;
	/* Of a replay by steps: frames that a person asked for, and that the master was told of. */
	int64_t asked, told;
	bool input_ended; /* there will be no more of them */
};

static void show_progress(struct progress *progress, int frames)
{
	int64_t step = frames / 10 > 0 ? frames / 10 : 1;

	if (progress->frame < 0 || progress->frame == progress->shown)
		return;
	if (progress->terminal)
		printf("\rframe %lld/%d ", (long long)progress->frame, frames);
	else if (progress->shown < 0 || progress->frame / step > progress->shown / step)
		printf("frame %lld/%d\n", (long long)progress->frame, frames);
	else
		return;
	fflush(stdout);
	progress->shown = progress->frame;
}

static bool ask_to(const struct demo *demo, const char *request)
{
	static char answer[ASK_ANSWER_MAX]; /* as above */

	return ask_master(demo->socket, request, ASK_NS, answer, sizeof answer) == GR_OK;
}

/* The master may not listen yet: then at the next tick. */
static void tell_steps(const struct demo *demo, struct progress *progress)
{
	char request[32];

	snprintf(request, sizeof request, "step %lld", (long long)(progress->asked - progress->told));
	if (progress->asked > progress->told && ask_to(demo, request))
		progress->told = progress->asked;
}

/* A line on the standard input is a frame. */
static void step(struct demo *demo, struct progress *progress)
{
	char bytes[512];
	ssize_t n = read(STDIN_FILENO, bytes, sizeof bytes);

	for (ssize_t i = 0; i < n; i++)
		progress->asked += bytes[i] == '\n';
	tell_steps(demo, progress);
	if (n <= 0) {
		children_input(&demo->children, -1);
		progress->input_ended = true;
	}
}

/* True while there is hope. */
static bool watch_progress(struct demo *demo, struct progress *progress)
{
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
	int64_t frame, complete;

	ask_frames(demo, &frame, &complete);

	if (frame >= 0 && frame != progress->frame) {
		progress->frame = frame;
		progress->changed_ns = now_ns;
	}
	show_progress(progress, demo->options.frames);
	tell_steps(demo, progress);
	if (progress->input_ended && complete >= progress->asked)
		ask_to(demo, "quit");
	/* A person may think for long. */
	if (demo->options.replay && demo->options.replay->step && complete >= progress->told)
		progress->changed_ns = now_ns;
	demo->stalled = now_ns - progress->changed_ns > demo->options.patience_s * GR_NS_PER_S;
	return !demo->stalled;
}

/* Whether the others should go on after this one ended. */
static bool go_on(const struct demo *demo, size_t ended)
{
	return child_ended_well(&demo->children.items[ended]);
}

static int64_t nodes_end_ns(const struct demo *demo)
{
	int seconds = demo->options.patience_s;

	return (seconds < NODES_END_S ? seconds : NODES_END_S) * GR_NS_PER_S;
}

static void watch(struct demo *demo)
{
	struct children *children = &demo->children;
	struct progress progress = { .terminal = isatty(STDOUT_FILENO) == 1, .frame = -1, .shown = -1,
				     .changed_ns = gr_clock_now(&gr_clock_monotonic) };
	int64_t until_ns = INT64_MAX; /* set when the master has ended */
	bool well = true;

	while (children->running > 0 && well) {
		int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
		int64_t patience = until_ns == INT64_MAX ? -1 : until_ns - now_ns;
		size_t ended;

		if (until_ns != INT64_MAX && patience <= 0)
			break;
		switch (children_wait(children, patience, &ended)) {
		case CHILDREN_ENDED:
			well = go_on(demo, ended);
			if (ended == 0) {
				children_tick(children, 0);
				until_ns = gr_clock_now(&gr_clock_monotonic) + nodes_end_ns(demo);
			}
			break;
		case CHILDREN_TICK:
			well = watch_progress(demo, &progress);
			break;
		case CHILDREN_INPUT:
			step(demo, &progress);
			break;
		case CHILDREN_SIGNAL:
			demo->interrupted = true;
			well = false;
			break;
		case CHILDREN_TIMEOUT:
		case CHILDREN_FAILED:
			well = false;
			break;
		}
	}
	if (well && progress.shown >= 0 && !progress.input_ended && child_ended_well(&children->items[0])) {
		progress.frame = demo->options.frames;
		show_progress(&progress, demo->options.frames);
	}
	if (progress.terminal && progress.shown >= 0)
		printf("\n");
}

int demo_run(struct demo *demo)
{
	int64_t start_ns = gr_clock_now(&gr_clock_monotonic);
	int result;

	demo_clear_pictures(demo);
	result = spawn_all(demo);
	if (result == GR_OK) {
		children_tick(&demo->children, PROGRESS_NS);
		if (demo->options.replay && demo->options.replay->step)
			children_input(&demo->children, STDIN_FILENO);
		watch(demo);
	}
	children_end(&demo->children, END_NS);
	demo->took_ns = gr_clock_now(&gr_clock_monotonic) - start_ns;
	return result;
}
