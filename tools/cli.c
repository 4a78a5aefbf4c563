#include "tools/cli.h"

#include "base/plain.h"
#include "config/suggest.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

void cli_help(const struct cli_table *table, FILE *out)
{
	fprintf(out, "usage: %s\n\n%s\n\n", table->usage, table->summary);
	for (size_t i = 0; i < table->count; i++) {
		const struct cli_option *spec = &table->options[i];
		char left[64];
		int n = 0;

		if (spec->letter)
			n = snprintf(left, sizeof left, "-%c, ", spec->letter);
		else
			n = snprintf(left, sizeof left, "    ");
		snprintf(left + n, sizeof left - (size_t)n, "--%s%s%s", spec->name,
			 spec->argument ? " " : "", spec->argument ? spec->argument : "");
		fprintf(out, "  %-28s %s\n", left, spec->help);
	}
	fprintf(out, "  %-28s %s\n", "-h, --help", "say this");
}

static bool parse_number(const char *text, double *out)
{
	char *end;

	errno = 0;
	*out = strtod(text, &end);
	return end != text && *end == '\0' && errno == 0 && isfinite(*out);
}

static bool parse_size(const char *text, int size[2])
{
	char *end;

	for (int i = 0; i < 2; i++) {
		long n;

		errno = 0;
		n = strtol(text, &end, 10);
		if (end == text || errno != 0 || n < 1 || n > INT32_MAX ||
		    *end != (i == 0 ? 'x' : '\0'))
			return false;
		size[i] = (int)n;
		text = end + 1;
	}
	return true;
}

static bool set_number(const struct cli_option *spec, const char *text)
{
	double number;
	bool integer = spec->kind == CLI_INT;

	if (!parse_number(text, &number) || (integer && number != floor(number)) ||
	    number < spec->min || number > spec->max) {
		fprintf(stderr, "--%s: '%s' is not %s from %s to %s\n", spec->name, text,
			integer ? "a whole number" : "a number", gr_plain(spec->min, 15).text,
			gr_plain(spec->max, 15).text);
		return false;
	}
	if (integer)
		*(int *)spec->value = (int)number;
	else
		*(float *)spec->value = (float)number;
	return true;
}

static bool set_size(const struct cli_option *spec, const char *text)
{
	int size[2];

	if (!parse_size(text, size) || size[0] < spec->min || size[0] > spec->max ||
	    size[1] < spec->min || size[1] > spec->max) {
		fprintf(stderr, "--%s: '%s' is not WIDTHxHEIGHT, each from %s to %s\n", spec->name,
			text, gr_plain(spec->min, 15).text, gr_plain(spec->max, 15).text);
		return false;
	}
	memcpy(spec->value, size, sizeof size);
	return true;
}

static bool set_value(const struct cli_option *spec, const char *text)
{
	switch (spec->kind) {
	case CLI_FLAG:
		*(bool *)spec->value = true;
		return true;
	case CLI_INT:
	case CLI_REAL:
		return set_number(spec, text);
	case CLI_SIZE:
		return set_size(spec, text);
	case CLI_TEXT:
		if (*text == '\0') {
			fprintf(stderr, "--%s: its %s is empty\n", spec->name, spec->argument);
			return false;
		}
		*(const char **)spec->value = text;
		return true;
	}
	return false;
}

/* "--name", "--name=value" or "-n"; *out_inline is the value after '='. */
static const struct cli_option *find_spec(const struct cli_table *table, const char *word,
					   const char **out_inline)
{
	*out_inline = NULL;
	if (word[1] != '-') {
		for (size_t i = 0; i < table->count; i++)
			if (table->options[i].letter == word[1] && word[2] == '\0')
				return &table->options[i];
		return NULL;
	}
	for (size_t i = 0; i < table->count; i++) {
		const struct cli_option *spec = &table->options[i];
		size_t n = strlen(spec->name);

		if (strncmp(word + 2, spec->name, n) != 0)
			continue;
		if (word[2 + n] == '=')
			*out_inline = word + 2 + n + 1;
		else if (word[2 + n] != '\0')
			continue;
		return spec;
	}
	return NULL;
}

static void refuse_unknown(const struct cli_table *table, const char *word)
{
	const char *bare = word + strspn(word, "-");
	const char *meant;
	struct suggest suggest;

	suggest_start(&suggest, bare);
	for (size_t i = 0; i < table->count; i++)
		suggest_offer(&suggest, table->options[i].name);
	meant = suggest_answer(&suggest);

	if (meant)
		fprintf(stderr, "no option %s: did you mean --%s?\n", word, meant);
	else
		fprintf(stderr, "no option %s\n", word);
}

enum cli_result cli_parse(const struct cli_table *table, int argc, char **argv,
				  int *out_words)
{
	int words = 0;
	bool options_ended = false;

	for (int i = 1; i < argc; i++) {
		const struct cli_option *spec;
		const char *value;

		if (options_ended || argv[i][0] != '-' || argv[i][1] == '\0') {
			argv[++words] = argv[i];
			continue;
		}
		if (strcmp(argv[i], "--") == 0) {
			options_ended = true;
			continue;
		}
		if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
			cli_help(table, stdout);
			return CLI_HELP;
		}
		spec = find_spec(table, argv[i], &value);
		if (!spec) {
			refuse_unknown(table, argv[i]);
			return CLI_WRONG;
		}
		if (spec->kind == CLI_FLAG && value) {
			fprintf(stderr, "--%s takes no value\n", spec->name);
			return CLI_WRONG;
		}
		if (spec->kind != CLI_FLAG && !value) {
			if (i + 1 >= argc) {
				fprintf(stderr, "--%s needs %s\n", spec->name, spec->argument);
				return CLI_WRONG;
			}
			value = argv[++i];
		}
		if (!set_value(spec, value))
			return CLI_WRONG;
	}
	*out_words = words;
	return CLI_RUN;
}

bool cli_same_file(const char *a, const char *b)
{
	struct stat x, y;

	if (!a || !b)
		return false;
	return strcmp(a, b) == 0 || (stat(a, &x) == 0 && stat(b, &y) == 0 && S_ISREG(x.st_mode) &&
				     x.st_dev == y.st_dev && x.st_ino == y.st_ino);
}
