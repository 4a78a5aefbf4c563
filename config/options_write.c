#include "config/options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void indent(FILE *file, int depth)
{
	for (int i = 0; i < depth; i++)
		fputc('\t', file);
}

/*
 * Shortest of the usual precisions that gives the float back after the change
 * of unit; always with a point or exponent, as libconfig wants one type in [ ].
 */
static void write_float(FILE *file, const struct option *option, float value)
{
	double scale = option->scale != 0 ? option->scale : 1;
	char text[40];

	for (int digits = 6; digits <= 17; digits++) {
		snprintf(text, sizeof text, "%.*g", digits, (double)value / scale);
		if ((float)(strtod(text, NULL) * scale) == value)
			break;
	}
	fprintf(file, "%s%s", text, strpbrk(text, ".e") ? "" : ".0");
}

static void write_time(FILE *file, const struct option *option, int64_t value)
{
	double scale = option->scale != 0 ? option->scale : 1;
	char text[40];

	for (int digits = 6; digits <= 17; digits++) {
		snprintf(text, sizeof text, "%.*g", digits, (double)value / scale);
		if (llround(strtod(text, NULL) * scale) == value)
			break;
	}
	fprintf(file, "%s%s", text, strpbrk(text, ".e") ? "" : ".0");
}

static void write_string(FILE *file, const char *text)
{
	fputc('"', file);
	for (; *text; text++) {
		if (*text == '"' || *text == '\\')
			fputc('\\', file);
		fputc(*text, file);
	}
	fputc('"', file);
}

static void write_numbers(FILE *file, const struct option *option, const void *at)
{
	unsigned count = option->count > 1 ? option->count : 1;

	if (count > 1)
		fputc('[', file);
	for (unsigned i = 0; i < count; i++) {
		if (i)
			fputs(", ", file);
		switch (option->type) {
		case OPTION_INT:
			fprintf(file, "%d", ((const int *)at)[i]);
			break;
		case OPTION_PORT:
			fprintf(file, "%u", *(const uint16_t *)at);
			break;
		case OPTION_U32:
			/* libconfig's plain integers are signed and of 32 bits: L makes it 64. */
			fprintf(file, "%lluL", (unsigned long long)*(const uint32_t *)at);
			break;
		case OPTION_TIME:
			write_time(file, option, *(const int64_t *)at);
			break;
		default:
			write_float(file, option, ((const float *)at)[i]);
			break;
		}
	}
	if (count > 1)
		fputc(']', file);
}

/* What the reader leaves in a struct when a key without default is not given. */
static bool absent(const struct option *option, const void *at)
{
	switch (option->type) {
	case OPTION_FLOAT:
		return isnan(*(const float *)at);
	case OPTION_NAME:
		return !*(const char *)at;
	case OPTION_STRING:
		return !*(char *const *)at;
	case OPTION_CHOICE:
		return *(const int *)at == OPTION_ABSENT;
	default:
		return false;
	}
}

static void write_table(FILE *file, const struct option *table, const void *base, int depth);

static void write_list(FILE *file, const struct option *option, const char *base, int depth)
{
	const char *elements = *(char *const *)(base + option->offset);
	size_t count = *(const size_t *)(base + option->count_offset);

	fputs("(", file);
	for (size_t i = 0; i < count; i++) {
		fputs(i ? ",\n" : "\n", file);
		indent(file, depth + 1);
		fputs("{\n", file);
		write_table(file, option->group, elements + i * option->size, depth + 2);
		indent(file, depth + 1);
		fputs("}", file);
	}
	if (count) {
		fputc('\n', file);
		indent(file, depth);
	}
	fputc(')', file);
}

static void write_one(FILE *file, const struct option *option, const char *base, int depth)
{
	const void *at = base + option->offset;

	switch (option->type) {
	case OPTION_BOOL:
		fputs(*(const bool *)at ? "true" : "false", file);
		break;
	case OPTION_NAME:
		write_string(file, at);
		break;
	case OPTION_STRING:
		write_string(file, *(char *const *)at);
		break;
	case OPTION_CHOICE:
		write_string(file, option->choices[*(const int *)at]);
		break;
	case OPTION_GROUP:
		fputs("{\n", file);
		write_table(file, option->group, at, depth + 1);
		indent(file, depth);
		fputs("}", file);
		break;
	case OPTION_LIST:
		write_list(file, option, base, depth);
		break;
	default:
		write_numbers(file, option, at);
		break;
	}
}

static void write_table(FILE *file, const struct option *table, const void *base, int depth)
{
	for (const struct option *option = table; option->key; option++) {
		const char *at = (const char *)base + option->offset;

		if (absent(option, at))
			continue;
		/* A group whose first value is absent is absent. */
		if (option->type == OPTION_GROUP && absent(option->group, at + option->group->offset))
			continue;
		indent(file, depth);
		fprintf(file, "%s = ", option->key);
		write_one(file, option, base, depth);
		fputs(";\n", file);
	}
}

void options_write(FILE *file, const struct option *table, const void *base)
{
	write_table(file, table, base, 0);
}
