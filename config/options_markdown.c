#include "config/options.h"

#include <string.h>

static const char *type_text(const struct option *option, char *out, size_t size)
{
	static const char *const plain[] = {
		[OPTION_BOOL] = "true or false",  [OPTION_INT] = "whole number",
		[OPTION_PORT] = "whole number",   [OPTION_U32] = "whole number",
		[OPTION_FLOAT] = "number",        [OPTION_TIME] = "number",
		[OPTION_NAME] = "name",           [OPTION_STRING] = "string",
		[OPTION_CHOICE] = "one of",       [OPTION_GROUP] = "group",
		[OPTION_LIST] = "list",
	};

	if (option->count > 1 && option->type == OPTION_LIST)
		snprintf(out, size, "list of up to %u groups", option->count);
	else if (option->count > 1)
		snprintf(out, size, "[%u] %ss", option->count, plain[option->type]);
	else
		snprintf(out, size, "%s", plain[option->type]);
	return out;
}

static void print_range(FILE *file, const struct option *option)
{
	switch (option->type) {
	case OPTION_INT:
	case OPTION_PORT:
	case OPTION_U32:
	case OPTION_FLOAT:
	case OPTION_TIME:
		fprintf(file, "%.10g to %.10g%s%s", option->min, option->max, option->unit ? " " : "",
			option->unit ? option->unit : "");
		break;
	case OPTION_CHOICE:
		for (int i = 0; option->choices[i]; i++)
			fprintf(file, "%s`\"%s\"`", i ? ", " : "", option->choices[i]);
		break;
	case OPTION_NAME:
		fprintf(file, "1 to %d characters", OPTION_NAME_SIZE - 1);
		break;
	default:
		break;
	}
}

/* "0 1.7 0" as [0, 1.7, 0]. */
static void print_vector(FILE *file, const char *text)
{
	fputs("`[", file);
	for (; *text; text++)
		fputs(*text == ' ' ? ", " : (char[]){ *text, '\0' }, file);
	fputs("]`", file);
}

static void print_default(FILE *file, const struct option *option)
{
	if (option->required)
		fputs("**required**", file);
	else if (option->standard && option->count > 1)
		print_vector(file, option->standard);
	else if (option->standard && (option->type == OPTION_NAME || option->type == OPTION_STRING ||
				      option->type == OPTION_CHOICE))
		fprintf(file, "`\"%s\"`", option->standard);
	else if (option->standard)
		fprintf(file, "`%s`", option->standard);
}

static void print_rows(FILE *file, const struct option *table)
{
	char type[64];

	fputs("| key | type | range | default | what it is |\n|---|---|---|---|---|\n", file);
	for (const struct option *option = table; option->key; option++) {
		fprintf(file, "| `%s` | %s | ", option->key, type_text(option, type, sizeof type));
		print_range(file, option);
		fputs(" | ", file);
		print_default(file, option);
		fprintf(file, " | %s |\n", option->help);
	}
}

static void print_tables(FILE *file, const struct option *table, const char *path)
{
	fprintf(file, "\n### %s\n\n", *path ? path : "Top level");
	print_rows(file, table);
	for (const struct option *option = table; option->key; option++) {
		char inner[256];

		if (!option->group)
			continue;
		snprintf(inner, sizeof inner, "%s%s%s%s", path, *path ? "." : "", option->key,
			 option->type == OPTION_LIST ? "[]" : "");
		print_tables(file, option->group, inner);
	}
}

void options_print_markdown(FILE *file, const struct option *table)
{
	print_tables(file, table, "");
}
