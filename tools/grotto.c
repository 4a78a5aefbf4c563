/* `grotto`: everything that a person does by hand. */
#include "base/log.h"
#include "base/result.h"
#include "config/suggest.h"
#include "tools/command.h"

#include <config.h>
#include <stdio.h>
#include <string.h>

static const struct command {
	const char *name;
	int (*run)(int argc, char **argv);
	const char *summary;
} commands[] = {
	{ "bake", command_bake, "compute a scene's surfels before the room starts" },
	{ "bench", command_bench, "measure a part of grotto on this machine" },
	{ "check", command_check, "check layout and scene files, report gaps between walls" },
	{ "demo", command_demo, "run a whole cave on this machine, leave its pictures and figures" },
	{ "doctor", command_doctor, "look whether this machine is fit for its part in a room" },
	{ "faults", command_faults, "disturb a running room on purpose, where its layout allows it" },
	{ "key", command_key, "make a cluster key" },
	{ "record", command_record, "record a running room, look at recordings" },
	{ "reference", command_reference, "path-trace what the renderer should show" },
	{ "render", command_render, "draw one still of a scene" },
	{ "replay", command_replay, "show a recording again, and check every state" },
	{ "status", command_status, "ask the running master how its room is" },
	{ "trackers", command_trackers, "show what the trackers say, record it" },
};

#define COMMAND_COUNT (sizeof commands / sizeof commands[0])

static void print_help(FILE *out)
{
	fprintf(out, "usage: grotto COMMAND [ARGUMENT...]\n\n");
	for (size_t i = 0; i < COMMAND_COUNT; i++)
		fprintf(out, "  %-9s %s\n", commands[i].name, commands[i].summary);
	fprintf(out, "\ngrotto COMMAND --help explains one; --version says which grotto this is.\n"
		     "exit status: 0 done, 1 failed, 2 what was given is wrong\n");
}

int main(int argc, char **argv)
{
	struct suggest suggest;
	const char *meant;

	gr_log_init("grotto", GR_LOG_NOTICE);
	if (argc < 2) {
		print_help(stderr);
		return GR_EXIT_CONFIG;
	}
	if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 ||
	    strcmp(argv[1], "help") == 0) {
		print_help(stdout);
		return GR_EXIT_OK;
	}
	if (strcmp(argv[1], "--version") == 0) {
		printf("grotto %s\n", PACKAGE_VERSION);
		return GR_EXIT_OK;
	}
	for (size_t i = 0; i < COMMAND_COUNT; i++)
		if (strcmp(argv[1], commands[i].name) == 0)
			return commands[i].run(argc - 1, argv + 1);
	suggest_start(&suggest, argv[1]);
	for (size_t i = 0; i < COMMAND_COUNT; i++)
		suggest_offer(&suggest, commands[i].name);
	meant = suggest_answer(&suggest);
	fprintf(stderr, "grotto: no command '%s'", argv[1]);
	if (meant)
		fprintf(stderr, ": did you mean '%s'?", meant);
	fprintf(stderr, "\n");
	print_help(stderr);
	return GR_EXIT_CONFIG;
}
