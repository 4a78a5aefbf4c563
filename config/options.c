#include "config/options.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* "walls[1].nodes[0]" for a setting; "" for the root. */
static void setting_path(const config_setting_t *setting, char *out, size_t size)
{
	const config_setting_t *chain[32];
	size_t depth = 0, len = 0;

	out[0] = '\0';
	for (; setting && setting->parent && depth < 32; setting = setting->parent)
		chain[depth++] = setting;
	while (depth-- && len < size) {
		const config_setting_t *s = chain[depth];
		int n;

		if (s->name)
			n = snprintf(out + len, size - len, "%s%s", len ? "." : "", s->name);
		else
			n = snprintf(out + len, size - len, "[%d]", config_setting_index(s));
		len += n > 0 ? (size_t)n : 0;
	}
}

/* The setting that a dotted path leads to, or the last one on the way that the file has. */
static const config_setting_t *nearest(const config_setting_t *at, const char *path)
{
	char part[OPTION_NAME_SIZE];

	while (at && *path) {
		size_t len = strcspn(path, ".");
		const config_setting_t *next;

		if (at->type != CONFIG_TYPE_GROUP || len >= sizeof part)
			break;
		memcpy(part, path, len);
		part[len] = '\0';
		next = config_setting_get_member(at, part);
		if (!next)
			break;
		at = next;
		path += len + (path[len] == '.');
	}
	return at;
}

void options_fault(struct options_reader *reader, enum gr_severity severity,
		   const config_setting_t *at, const char *key, const char *format, ...)
{
	char path[512], text[900];
	const config_setting_t *where;
	va_list args;
	size_t len;

	if (severity == GR_DIAG_ERROR && ++reader->faults > OPTIONS_FAULTS_SHOWN) {
		if (reader->faults == OPTIONS_FAULTS_SHOWN + 1)
			gr_diag_add(reader->diag, GR_DIAG_ERROR, reader->file, 0, NULL,
				    "more faults are not shown; mend these first");
		return;
	}
	if (!at)
		at = reader->root;
	setting_path(at, path, sizeof path);
	len = strlen(path);
	if (key && *key)
		snprintf(path + len, sizeof path - len, "%s%s", len ? "." : "", key);
	where = nearest(at, key ? key : "");
	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	gr_diag_add(reader->diag, severity, reader->file,
		    where ? (int)config_setting_source_line(where) : 0, path[0] ? path : NULL, "%s",
		    text);
}

bool options_given(const config_setting_t *at, const char *key)
{
	return at && at->type == CONFIG_TYPE_GROUP && config_setting_get_member(at, key);
}

bool options_name_fit(const char *name)
{
	if (!isalnum((unsigned char)name[0]))
		return false;
	for (const char *c = name; *c; c++)
		if (!isalnum((unsigned char)*c) && !strchr("_-.", *c))
			return false;
	return strlen(name) < OPTION_NAME_SIZE;
}

void options_free(const struct option *table, void *base)
{
	for (const struct option *option = table; option->key; option++) {
		char *to = (char *)base + option->offset;

		if (option->type == OPTION_STRING) {
			free(*(char **)to);
			*(char **)to = NULL;
		} else if (option->type == OPTION_GROUP) {
			options_free(option->group, to);
		} else if (option->type == OPTION_LIST) {
			size_t *count = (size_t *)((char *)base + option->count_offset);
			char *elements = *(char **)to;

			for (size_t i = 0; i < *count; i++)
				options_free(option->group, elements + i * option->size);
			free(elements);
			*(char **)to = NULL;
			*count = 0;
		}
	}
}
