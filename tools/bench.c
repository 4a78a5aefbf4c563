/* grotto bench: speed beside error, of scenes here or of the lattice in a program of its own. */
#include "base/result.h"
#include "tools/bench/scenes.h"
#include "tools/bench/trackers.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/programs.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SIZES_MOST 16
#define CELLS_LEAST 4
#define CELLS_MOST 256

static const char program[] = "bench-lattice";

static bool is_size(const char *text)
{
	char *end;
	long cells;

	errno = 0;
	cells = strtol(text, &end, 10);
	return !errno && end != text && !*end && cells >= CELLS_LEAST && cells <= CELLS_MOST;
}

static int become_lattice(int count, char **sizes)
{
	char *arguments[SIZES_MOST + 2] = { NULL };
	char *path;

	for (int i = 0; i < count; i++) {
		if (i >= SIZES_MOST || !is_size(sizes[i])) {
			fprintf(stderr, "grotto bench lattice: '%s': give up to %d sizes, each %d to %d cells\n",
				sizes[i], SIZES_MOST, CELLS_LEAST, CELLS_MOST);
			return GR_EXIT_CONFIG;
		}
		arguments[i + 1] = sizes[i];
	}
	path = programs_own(program);
	if (!path) {
		fprintf(stderr, "grotto bench lattice: %s is neither beside this program nor in %s\n",
			program, GROTTO_PKGLIBEXECDIR);
		return GR_EXIT_RUNTIME;
	}
	arguments[0] = path;
	execv(path, arguments);
	fprintf(stderr, "grotto bench lattice: cannot start %s: %s\n", path, strerror(errno));
	free(path);
	return GR_EXIT_RUNTIME;
}

/* The program checks its options itself. */
static int become_barrier(char **words)
{
	char *path = programs_own("bench-barrier");

	if (!path) {
		fprintf(stderr, "grotto bench barrier: bench-barrier is neither beside this program nor in %s\n",
			GROTTO_PKGLIBEXECDIR);
		return GR_EXIT_RUNTIME;
	}
	words[0] = path;
	execv(path, words);
	fprintf(stderr, "grotto bench barrier: cannot start %s: %s\n", path, strerror(errno));
	free(path);
	return GR_EXIT_RUNTIME;
}

static int run_scenes(const struct bench_options *options, char *const *paths, int count)
{
	int result = bench_scenes(options, paths, (size_t)count);

	if (result == GR_OK)
		return GR_EXIT_OK;
	fprintf(stderr, "grotto bench: %s\n", gr_result_name(result));
	return result == GR_ERR_CONFIG ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
}

int command_bench(int argc, char **argv)
{
	struct bench_options o = BENCH_OPTIONS;
	const struct cli_option options[] = {
		{ "methods", 'm', CLI_TEXT, &o.methods, 0, 0, "LIST",
		  "of none, lpv, surfels, probes, auto (lpv,surfels,probes)" },
		{ "settings", 0, CLI_TEXT, &o.settings, 0, 0, "CASES",
		  "\"lpv.lattice=16 lpv.lattice=32,lpv.steps=4\" (a small sweep)" },
		{ "camera", 'c', CLI_TEXT, &o.camera, 0, 0, "NAME", "a camera of the scene file (the first)" },
		{ "pixels", 0, CLI_SIZE, o.pixels, 16, 4096, "WxH", "of the pictures (256x256)" },
		{ "frames", 'f', CLI_INT, &o.frames, 3, 400, "N", "timed and looked at for flicker (24)" },
		{ "points", 0, CLI_INT, &o.points, 16, 100000, "N",
		  "of surfaces where light is compared (600)" },
		{ "reference-samples", 0, CLI_INT, &o.samples, 2, 1000000, "N",
		  "of the truth a pixel; points get 128 times as many (128)" },
		{ "until-error", 0, CLI_REAL, &o.until_error_percent, 0, 100, "PERCENT",
		  "stop the truth sooner, at this standard error (0: do not)" },
		{ "out", 'o', CLI_TEXT, &o.out, 0, 0, "DIR",
		  "plots, bench.json, and the truth for the next run (grotto-bench)" },
		{ "json", 0, CLI_TEXT, &o.json, 0, 0, "FILE", "instead of bench.json there" },
		{ "svg", 0, CLI_TEXT, &o.svg, 0, 0, "FILE", "the plot of the one SCENE" },
		{ "fit", 0, CLI_FLAG, &o.fit, 0, 0, NULL, "lines for the planner's model of error, too" },
		{ "gpu", 0, CLI_INT, &o.gpu, -1, 64, "N", "EGL device, -1: the first that works (-1)" },
	};
	const struct cli_table table = {
		"grotto bench SCENE... [--methods LIST] [--out DIR]\n"
		"       grotto bench lattice [CELLS...]\n"
		"       grotto bench barrier [--nodes N] [--rate HZ] [--frames N] [--runs N] [--multicast 1]\n"
		"       grotto bench trackers [--log FILE] [--rate HZ] [--noise-m M] [--noise-deg DEG]",
		"Draws scenes with each method of indirect light and prints what it costs on this\n"
		"machine's OpenGL beside how far it is from path-traced truth.\n"
		"lattice: propagates light through lattices of CELLS a side (32 64) with the thesis'\n"
		"own kernel and with ours, and prints the time and error of each.\n"
		"barrier: how far apart nodes that draw nothing leave the swap barrier, told and at a\n"
		"time, in turns; in network namespaces where that is allowed, else over loopback.\n"
		"trackers: how far filters are from where head or hand will be; has options of its own.",
		options, sizeof options / sizeof options[0]
	};
	int words;

	if (argc > 1 && strcmp(argv[1], "barrier") == 0)
		return become_barrier(argv + 1);
	if (argc > 1 && strcmp(argv[1], "trackers") == 0)
		return bench_trackers(argc - 1, argv + 1);
	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (words < 1) {
		fprintf(stderr, "grotto bench: needs what to measure: a SCENE, or lattice\n");
		return GR_EXIT_CONFIG;
	}
	if (strcmp(argv[1], "lattice") == 0)
		return become_lattice(words - 1, argv + 2);
	return run_scenes(&o, argv + 1, words);
}
