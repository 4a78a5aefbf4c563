/* grotto bench: hands over to a benchmark, each of which is a program of its own. */
#include "base/result.h"
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

int command_bench(int argc, char **argv)
{
	static const struct cli_table table = {
		"grotto bench lattice [CELLS...]",
		"Propagates light through lattices of CELLS a side (16 32 64) with the thesis' own\n"
		"kernel and with ours, and prints the time of each on this machine's OpenGL and its\n"
		"error against traced paths. Takes about a minute.",
		NULL, 0
	};
	int words;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (words < 1 || strcmp(argv[1], "lattice") != 0) {
		fprintf(stderr, "grotto bench: needs what to measure: lattice\n");
		return GR_EXIT_CONFIG;
	}
	return become_lattice(words - 1, argv + 2);
}
