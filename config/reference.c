/*
 * reference layout|scene [FILE]
 *
 * Prints the option table as Markdown, or puts it between the two marks of
 * FILE (docs/layout.md, docs/scene.md). A build tool, not installed.
 */
#include "config/layout_options.h"
#include "config/scene_options.h"

#include <stdlib.h>
#include <string.h>

#define MARK_FROM "<!-- options: made by config/reference -->\n"
#define MARK_TO "<!-- end of options -->\n"

static char *read_file(const char *path)
{
	FILE *in = fopen(path, "r");
	char *text = NULL, chunk[4096];
	size_t size, n;
	FILE *memory = open_memstream(&text, &size);

	while (in && memory && (n = fread(chunk, 1, sizeof chunk, in)) > 0)
		fwrite(chunk, 1, n, memory);
	if (memory)
		fclose(memory);
	if (in) {
		fclose(in);
	} else {
		free(text);
		text = NULL;
	}
	return text;
}

static int update(const char *path, const struct option *table)
{
	char *text = read_file(path);
	char *from = text ? strstr(text, MARK_FROM) : NULL;
	char *to = from ? strstr(from, MARK_TO) : NULL;
	FILE *out = to ? fopen(path, "w") : NULL;
	int status = EXIT_FAILURE;

	if (out) {
		fwrite(text, 1, (size_t)(from - text) + strlen(MARK_FROM), out);
		options_print_markdown(out, table);
		fprintf(out, "\n%s", to);
		status = fclose(out) ? EXIT_FAILURE : EXIT_SUCCESS;
	} else {
		fprintf(stderr, "%s: cannot be read or written, or lacks the marks\n", path);
	}
	free(text);
	return status;
}

int main(int argc, char **argv)
{
	const struct option *table = NULL;

	if (argc >= 2 && !strcmp(argv[1], "layout"))
		table = layout_options;
	else if (argc >= 2 && !strcmp(argv[1], "scene"))
		table = scene_options;
	if (!table || argc > 3) {
		fprintf(stderr, "usage: reference layout|scene [FILE]\n");
		return EXIT_FAILURE;
	}
	if (argc == 3)
		return update(argv[2], table);
	options_print_markdown(stdout, table);
	return EXIT_SUCCESS;
}
