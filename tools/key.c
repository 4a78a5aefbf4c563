/* grotto key FILE: a new cluster key. */
#include "protocol/key.h"

#include "base/result.h"
#include "tools/command.h"
#include "tools/cli.h"
#include "tools/say.h"

#include <stdio.h>

int command_key(int argc, char **argv)
{
	static const struct cli_table table = {
		"grotto key FILE",
		"Writes a new random cluster key to FILE, readable by its owner and group.\n"
		"Copy it to every machine of the cave and name it as network.key_file in the\n"
		"layout. An existing file is left as it is.",
		NULL, 0
	};
	struct gr_diag diag = { 0 };
	int words;
	int result;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (words != 1) {
		fprintf(stderr, "grotto key: needs one FILE to write\n");
		return GR_EXIT_CONFIG;
	}
	result = fdp_key_create(argv[1], &diag);
	say_diag(&diag);
	gr_diag_finish(&diag);
	if (result != GR_OK)
		return result == GR_ERR_CONFIG ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
	printf("%s: a new key, mode 0640\n", argv[1]);
	return GR_EXIT_OK;
}
