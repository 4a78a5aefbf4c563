#include "config/text_changes.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct text_change *text_changes_add(struct text_changes *c, size_t begin, size_t end)
{
	struct text_change *change = &c->all[c->count++];

	change->begin = begin;
	change->end = end;
	change->text[0] = '\0';
	return change;
}

void text_change_append(struct text_change *change, const char *format, ...)
{
	const size_t len = strlen(change->text);
	va_list args;

	va_start(args, format);
	vsnprintf(change->text + len, sizeof change->text - len, format, args);
	va_end(args);
}

static int compare(const void *a, const void *b)
{
	const struct text_change *x = a, *y = b;

	return (x->begin > y->begin) - (x->begin < y->begin);
}

char *text_changes_apply(struct text_changes *c, const char *text, size_t text_len, size_t *out_len)
{
	size_t size = text_len + 1, at = 0, len = 0;
	char *out;

	qsort(c->all, c->count, sizeof c->all[0], compare);
	for (size_t i = 0; i < c->count; i++)
		size += strlen(c->all[i].text);
	out = malloc(size);
	if (!out)
		return NULL;
	for (size_t i = 0; i < c->count; i++) {
		const struct text_change *change = &c->all[i];

		memcpy(out + len, text + at, change->begin - at);
		len += change->begin - at;
		memcpy(out + len, change->text, strlen(change->text));
		len += strlen(change->text);
		at = change->end;
	}
	memcpy(out + len, text + at, text_len - at);
	len += text_len - at;
	out[len] = '\0';
	*out_len = len;
	return out;
}
