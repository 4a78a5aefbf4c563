/*
 * Command line options from a table: the table gives type, range and help,
 * and the parser, the refusals and `--help` come from it.
 *
 * Plain functions, no process state; not thread safe for one table.
 */
#ifndef GROTTO_TOOLS_CLI_H
#define GROTTO_TOOLS_CLI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum cli_kind {
	CLI_FLAG, /* bool, no argument */
	CLI_INT,  /* int in [min, max] */
	CLI_REAL, /* float in [min, max] */
	CLI_TEXT, /* const char *, points into argv */
	CLI_SIZE, /* int[2], WIDTHxHEIGHT, each in [min, max] */
};

struct cli_option {
	const char *name; /* without the dashes */
	char letter;      /* 0 for none */
	enum cli_kind kind;
	void *value; /* of the kind's type; holds the default before parsing */
	double min, max;
	const char *argument; /* its name in the help, NULL for a flag */
	const char *help;
};

struct cli_table {
	const char *usage;   /* "grotto check FILE..." */
	const char *summary; /* what it does, lines without indentation */
	const struct cli_option *options;
	size_t count;
};

enum cli_result { CLI_RUN, CLI_HELP, CLI_WRONG };

/*
 * Takes argv[1..argc-1]: options may stand anywhere, "--" ends them. What is
 * not an option is moved to argv[1..] in order and counted in *out_words.
 * CLI_HELP after --help or -h (printed to stdout), CLI_WRONG after a
 * fault (printed to stderr, with what would be right).
 */
enum cli_result cli_parse(const struct cli_table *table, int argc, char **argv,
				  int *out_words);
void cli_help(const struct cli_table *table, FILE *out);
/* Whether two paths (NULL: none) name one regular file, by whatever links: to write one is to lose the other. */
bool cli_same_file(const char *a, const char *b);

#endif
