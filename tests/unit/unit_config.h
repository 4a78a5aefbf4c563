/* What the tests of config/ share: a text with one thing changed, and looking for a message. */
#ifndef GROTTO_TESTS_UNIT_CONFIG_H
#define GROTTO_TESTS_UNIT_CONFIG_H

#include "base/diag.h"
#include "tests/unit/unit.h"

/* base with the first `find` replaced; find "" puts it before everything. Caller frees. */
static inline char *unit_replace(const char *base, const char *find, const char *replace)
{
	const char *at = strstr(base, find);
	char *text = malloc(strlen(base) + strlen(replace) + 1);

	if (!at || !text) {
		fail_msg("\"%s\" is not in the base text", find);
		abort();
	}
	sprintf(text, "%.*s%s%s", (int)(at - base), base, replace, at + strlen(find));
	return text;
}

/* The line on which `part` begins in text. */
static inline int unit_line(const char *text, const char *part)
{
	const char *at = strstr(text, part);
	int line = 1;

	assert_non_null(at);
	for (; text < at; text++)
		line += *text == '\n';
	return line;
}

static inline size_t unit_diag_count(const struct gr_diag *diag, enum gr_severity severity)
{
	size_t count = 0;

	for (size_t i = 0; i < diag->count; i++)
		count += diag->items[i].severity == severity;
	return count;
}

/* Whether a line of that severity begins with `start` and holds `part`. */
static inline int unit_diag_has(const struct gr_diag *diag, enum gr_severity severity,
				const char *start, const char *part)
{
	for (size_t i = 0; i < diag->count; i++)
		if (diag->items[i].severity == severity &&
		    !strncmp(diag->items[i].text, start, strlen(start)) &&
		    strstr(diag->items[i].text, part))
			return 1;
	return 0;
}

static inline void unit_diag_print(const struct gr_diag *diag)
{
	for (size_t i = 0; i < diag->count; i++)
		printf("#   %d %s\n", (int)diag->items[i].severity, diag->items[i].text);
}

/* A file of the source tree: the whole text, caller frees. */
static inline char *unit_source_file(const char *path)
{
	const char *folder = getenv("srcdir");
	char name[1024];
	char *text = calloc(1, 1 << 20);
	FILE *file;

	snprintf(name, sizeof name, "%s/%s", folder ? folder : ".", path);
	file = fopen(name, "r");
	if (!file || !text)
		fail_msg("%s cannot be read", name);
	else
		text[fread(text, 1, (1 << 20) - 1, file)] = '\0';
	if (file)
		fclose(file);
	return text;
}

#endif
