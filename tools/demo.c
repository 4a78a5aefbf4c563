/* grotto demo: a whole cave on this machine. */
#include <config.h> /* asprintf */

#include "tools/demo.h"

#include "base/clock.h"
#include "base/result.h"
#include "renderer/scene/scene.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/demo_plan.h"
#include "tools/programs.h"
#include "tools/say.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DEFAULT_LAYOUT "layouts/cave4.cave"
#define DEFAULT_SCENE "scenes/grotto.scene"

char *demo_path(const struct demo *demo, const char *name, const char *suffix)
{
	char *path = NULL;

	if (asprintf(&path, "%s/%s%s", demo->options.out, name, suffix) < 0)
		return NULL;
	return path;
}

void demo_node_file(const struct layout_node *node, char name[LAYOUT_NAME_MAX + 8])
{
	snprintf(name, LAYOUT_NAME_MAX + 8, "node-%s", node->name);
}

/* Every folder of the path. */
static int make_folders(const char *path)
{
	char *copy = strdup(path);
	int result = GR_OK;

	if (!copy)
		return GR_ERR_NOMEM;
	for (char *at = copy + 1; result == GR_OK; at++) {
		char saved = *at;

		if (saved != '/' && saved != '\0')
			continue;
		*at = '\0';
		if (mkdir(copy, 0755) != 0 && errno != EEXIST)
			result = GR_ERR_IO;
		*at = saved;
		if (saved == '\0')
			break;
	}
	free(copy);
	return result;
}

/* In a folder of its own under /tmp: a socket's path may only be short. */
static int make_socket_path(struct demo *demo)
{
	char folder[] = "/tmp/grotto-XXXXXX";

	if (!mkdtemp(folder))
		return GR_ERR_IO;
	snprintf(demo->socket_folder, sizeof demo->socket_folder, "%s", folder);
	snprintf(demo->socket, sizeof demo->socket, "%s/control", folder);
	return GR_OK;
}

/* A file that cannot be used is a wrong path or a wrong file: not this run's fault. */
static int input_result(int result)
{
	switch (result) {
	case GR_ERR_IO:
	case GR_ERR_RANGE:
	case GR_ERR_FORMAT: return GR_ERR_CONFIG;
	default: return result;
	}
}

/* Addresses will be others than recorded, so the master cannot compare it any more. */
static int check_layout(const struct demo *demo, struct gr_diag *diag)
{
	const struct demo_replay *replay = demo->options.replay;

	if (!replay || replay->other_layout ||
	    memcmp(demo->layout->hash, replay->layout_hash, sizeof replay->layout_hash) == 0)
		return GR_OK;
	gr_diag_add(diag, GR_DIAG_ERROR, demo->options.layout, 0, NULL,
		    "is not the layout of the recording %s; give that one, or --other-layout",
		    replay->file);
	return GR_ERR_CONFIG;
}

/* All of it before anything is started: the daemons would refuse it one by one. */
static int load(struct demo *demo, struct gr_diag *diag)
{
	struct scene *scene = NULL;
	int result = layout_load(demo->options.layout, &demo->layout, diag);
	int scene_result = scene_file_load(demo->options.scene, &demo->scene, diag);

	if (scene_result == GR_OK)
		scene_result = scene_import(demo->scene, &scene, diag);
	scene_destroy(&scene);
	if (result == GR_OK)
		result = check_layout(demo, diag);
	return input_result(result != GR_OK ? result : scene_result);
}

/* The out folder, made where it is missing, into which files can be written. */
static int make_out(const char *path, struct gr_diag *diag)
{
	struct stat status;
	int result = make_folders(path);
	const char *why = NULL;

	if (result == GR_ERR_NOMEM)
		return result;
	if (result == GR_OK && stat(path, &status) == 0 && !S_ISDIR(status.st_mode))
		why = "is there and no folder";
	else if (result != GR_OK || access(path, W_OK | X_OK) != 0)
		why = strerror(errno);
	if (!why)
		return GR_OK;
	gr_diag_add(diag, GR_DIAG_ERROR, path, 0, "--out",
		    "%s; give a folder that can be made and written to", why);
	return GR_ERR_CONFIG;
}

static int write_layout(const struct demo *demo)
{
	FILE *file = fopen(demo->layout_path, "we");
	int result;

	if (!file)
		return GR_ERR_IO;
	result = layout_write(file, demo->layout);
	if (fclose(file) != 0 && result == GR_OK)
		result = GR_ERR_IO;
	return result;
}

/* The room's own nodes show it: their layout is used as it is. */
static bool in_room(const struct demo *demo)
{
	return demo->options.replay && demo->options.replay->room;
}

static int prepare(struct demo *demo, struct gr_diag *diag)
{
	struct demo_plan plan = {
		.control_socket = demo->socket,
		.pixels_scale = demo->options.pixels_scale,
		.window = demo->options.window,
		.stereo = demo->options.stereo,
		.rate_hz = demo->options.rate_hz,
	};
	int result = make_out(demo->options.out, diag);

	if (result != GR_OK)
		return result;
	result = make_socket_path(demo);
	if (result != GR_OK) {
		gr_diag_add(diag, GR_DIAG_ERROR, "/tmp", 0, NULL, "no folder for a socket: %s",
			    strerror(errno));
		return result;
	}
	demo->scene_path = realpath(demo->options.scene, NULL);
	if (in_room(demo)) {
		demo->layout_path = realpath(demo->options.layout, NULL);
		return demo->layout_path && demo->scene_path ? GR_OK : GR_ERR_NOMEM;
	}
	result = demo_plan_apply(&plan, demo->layout, diag);
	if (result != GR_OK)
		return result;
	demo->layout_path = demo_path(demo, "layout", ".cave");
	if (!demo->layout_path || !demo->scene_path)
		return GR_ERR_NOMEM;
	result = write_layout(demo);
	if (result != GR_OK)
		gr_diag_add(diag, GR_DIAG_ERROR, demo->layout_path, 0, NULL, "%s",
			    result == GR_ERR_IO ? strerror(errno) : gr_result_name(result));
	return result;
}

static void demo_finish(struct demo *demo)
{
	if (demo->socket_folder[0]) {
		unlink(demo->socket); /* the master's, should it have been killed */
		rmdir(demo->socket_folder);
	}
	free(demo->layout_path);
	free(demo->scene_path);
	layout_destroy(&demo->layout);
	scene_file_destroy(&demo->scene);
}

static bool all_ended_well(const struct demo *demo)
{
	for (size_t i = 0; i < demo->children.count; i++)
		if (!child_ended_well(&demo->children.items[i]))
			return false;
	return demo->children.count == demo->layout->node_count + 1;
}

/* How many faults there were; -1 when that cannot be said. */
static int judge(struct demo *demo)
{
	int frames = demo->options.replay ? demo_replayed(demo) : demo->options.frames;

	/* Somebody who steps through a recording may end before its end. */
	if (frames >= 0)
		demo->options.frames = frames;
	return demo_summary(demo);
}

static int run(struct demo *demo)
{
	int faults;

	if (children_start(&demo->children) != GR_OK) {
		fprintf(stderr, "%s: %s\n", demo->command, strerror(errno));
		return GR_EXIT_RUNTIME;
	}
	printf("%s: %zu wall%s, %zu node%s, %d frame%s of %s into %s\n", demo->layout->name,
	       demo->layout->wall_count, demo->layout->wall_count == 1 ? "" : "s",
	       demo->layout->node_count, demo->layout->node_count == 1 ? "" : "s",
	       demo->options.frames, demo->options.frames == 1 ? "" : "s", demo->scene->name,
	       demo->options.out);
	fflush(stdout);
	faults = demo_run(demo) == GR_OK ? judge(demo) : -1;
	if (!in_room(demo) && all_ended_well(demo) && demo_room(demo) != GR_OK)
		faults = -1;
	children_finish(&demo->children);
	return faults == 0 ? GR_EXIT_OK : GR_EXIT_RUNTIME;
}

static int plan_and_run(struct demo *demo)
{
	struct gr_diag diag = { 0 };
	int result = load(demo, &diag);

	if (result == GR_OK)
		result = prepare(demo, &diag);
	say_diag(&diag);
	gr_diag_finish(&diag);
	if (result == GR_ERR_CONFIG)
		return GR_EXIT_CONFIG;
	return result == GR_OK ? run(demo) : GR_EXIT_RUNTIME;
}

int demo_main(struct demo *demo)
{
	int status = plan_and_run(demo);

	demo_finish(demo);
	return status;
}

int command_demo(int argc, char **argv)
{
	struct demo d = { .command = "grotto demo", .options = { .out = "grotto-demo", .frames = 120, .deadline_ms = 600000,
				       .patience_s = 600, .pixels_scale = 1 } };
	struct demo_options *o = &d.options;
	const struct cli_option options[] = {
		{ "layout", 0, CLI_TEXT, &o->layout, 0, 0, "FILE", "the cave (the shipped four walls)" },
		{ "scene", 0, CLI_TEXT, &o->scene, 0, 0, "FILE", "what is in it (the shipped grotto)" },
		{ "frames", 0, CLI_INT, &o->frames, 1, 10000000, "N", "how many (120)" },
		{ "out", 'o', CLI_TEXT, &o->out, 0, 0, "DIR", "where results go (grotto-demo)" },
		{ "every", 0, CLI_INT, &o->every, 1, 10000000, "K",
		  "save pictures of every Kth frame; the last always" },
		{ "exr", 0, CLI_FLAG, &o->exr, 0, 0, NULL, "save scene-linear radiance too" },
		{ "window", 0, CLI_FLAG, &o->window, 0, 0, NULL, "show the walls in windows" },
		{ "pixels-scale", 0, CLI_REAL, &o->pixels_scale, 0.001, 16, "S",
		  "walls of S times the layout's pixels (1)" },
		{ "stereo", 0, CLI_FLAG, &o->stereo, 0, 0, NULL,
		  "both eyes side by side where the layout has one" },
		{ "rate", 0, CLI_REAL, &o->rate_hz, 0.1, 1000, "HZ",
		  "frames a second in real time; else as fast as all walls can" },
		{ "deadline-ms", 0, CLI_INT, &o->deadline_ms, 1, 600000, "MS",
		  "of the swap barrier: later nodes miss the frame (600000)" },
		{ "record", 0, CLI_TEXT, &o->record, 0, 0, "FILE",
		  "the master records the session at the end of this file" },
		{ "patience", 0, CLI_INT, &o->patience_s, 1, 86400, "S",
		  "give up after so long without a new frame (600)" },
	};
	const struct cli_table table = {
		"grotto demo [--layout FILE] [--scene FILE] [--frames N] [--out DIR]",
		"Runs grotto-master and a grotto-node per node of the layout on this machine, over\n"
		"real UDP on 127.0.0.1. Leaves in DIR the pictures of each wall, room.png (the\n"
		"unfolded room), summary.json, and each process' log and report. Fails when a node\n"
		"missed a frame, held another state than the master, or died.",
		options, sizeof options / sizeof options[0]
	};
	char *layout, *scene;
	int words;
	int status = GR_EXIT_CONFIG;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	layout = o->layout ? NULL : programs_data(DEFAULT_LAYOUT);
	scene = o->scene ? NULL : programs_data(DEFAULT_SCENE);
	if (layout)
		o->layout = layout;
	if (scene)
		o->scene = scene;
	if (words != 0)
		fprintf(stderr, "grotto demo: '%s' is no option; a layout is given by --layout\n",
			argv[1]);
	else if (!o->layout || !o->scene)
		fprintf(stderr, "grotto demo: the shipped %s is not installed: give --%s FILE\n",
			o->layout ? DEFAULT_SCENE : DEFAULT_LAYOUT,
			o->layout ? "scene" : "layout");
	else
		status = demo_main(&d);
	free(layout);
	free(scene);
	return status;
}
