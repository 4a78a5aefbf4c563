#include "config/setting_place.h"

#include <string.h>

static bool is_one_of(char c, const char *set)
{
	return c != '\0' && strchr(set, c) != NULL;
}

static bool starts(const struct setting_text *t, size_t at, size_t end, const char *with)
{
	const size_t len = strlen(with);

	return end - at >= len && memcmp(t->bytes + at, with, len) == 0;
}

/* Behind a comment that begins at `at`; `at` when none does. */
static size_t skip_comment(const struct setting_text *t, size_t at, size_t end)
{
	if (starts(t, at, end, "/*")) {
		for (at += 2; at < end; at++)
			if (starts(t, at, end, "*/"))
				return at + 2;
		return end;
	}
	if (at < end && (t->bytes[at] == '#' || starts(t, at, end, "//")))
		while (at < end && t->bytes[at] != '\n')
			at++;
	return at;
}

size_t setting_place_skip(const struct setting_text *t, size_t at, size_t end)
{
	for (size_t before = end + 1; before != at;) {
		before = at;
		while (at < end && is_one_of(t->bytes[at], " \t\r\n\f\v"))
			at++;
		at = skip_comment(t, at, end);
	}
	return at;
}

/* Behind the '"' that ends the string which begins at `at`. */
static size_t skip_string(const struct setting_text *t, size_t at, size_t end)
{
	for (at++; at < end && t->bytes[at] != '"'; at++)
		if (t->bytes[at] == '\\' && at + 1 < end)
			at++;
	return at < end ? at + 1 : end;
}

/* Strings beside each other are one. */
static size_t skip_strings(const struct setting_text *t, size_t at, size_t end)
{
	size_t next = at, behind = at;

	while (next < end && t->bytes[next] == '"') {
		behind = skip_string(t, next, end);
		next = setting_place_skip(t, behind, end);
	}
	return behind;
}

/* Behind the bracket that closes the one at `at`. */
static size_t skip_brackets(const struct setting_text *t, size_t at, size_t end)
{
	size_t depth = 0;

	while (at < end) {
		const char c = t->bytes[at];
		const size_t behind = skip_comment(t, at, end);

		if (behind != at) {
			at = behind;
		} else if (c == '"') {
			at = skip_string(t, at, end);
		} else {
			at++;
			if (is_one_of(c, "{[("))
				depth++;
			else if (is_one_of(c, "}])") && --depth == 0)
				return at;
		}
	}
	return end;
}

static size_t skip_value(const struct setting_text *t, size_t at, size_t end)
{
	if (at == end)
		return end;
	if (is_one_of(t->bytes[at], "{[("))
		return skip_brackets(t, at, end);
	if (t->bytes[at] == '"')
		return skip_strings(t, at, end);
	while (at < end && !is_one_of(t->bytes[at], " \t\r\n\f\v;,{}[]()\"#/=:"))
		at++;
	return at;
}

/* The value at `at`, and the mark that ends it. False: there is none. */
static bool place_value(const struct setting_text *t, size_t at, size_t end, const char *marks,
			struct setting_place *out)
{
	size_t mark;

	out->begin = at;
	out->end = out->after = skip_value(t, at, end);
	mark = setting_place_skip(t, out->end, end);
	if (mark < end && is_one_of(t->bytes[mark], marks))
		out->after = mark + 1;
	return out->end > at;
}

/* What is within the brackets, if there are any. */
static void inside(const struct setting_text *t, const struct setting_place *of, size_t *at,
		   size_t *end)
{
	*at = of->begin;
	*end = of->end;
	if (*end - *at >= 2 && is_one_of(t->bytes[*at], "{[(")) {
		++*at;
		--*end;
	}
}

struct setting_place setting_place_root(const struct setting_text *text)
{
	return (struct setting_place){ .begin = 0, .end = text->len, .after = text->len };
}

static size_t skip_name(const struct setting_text *t, size_t at, size_t end)
{
	while (at < end && is_one_of(t->bytes[at], "abcdefghijklmnopqrstuvwxyz"
						   "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_*-"))
		at++;
	return at;
}

bool setting_place_member(const struct setting_text *t, const struct setting_place *group,
			  const char *name, struct setting_place *out)
{
	size_t at, end;

	inside(t, group, &at, &end);
	for (;;) {
		const size_t key = setting_place_skip(t, at, end), behind = skip_name(t, key, end);

		at = setting_place_skip(t, behind, end);
		if (behind == key || at == end || !is_one_of(t->bytes[at], "=:"))
			return false;
		at = setting_place_skip(t, at + 1, end);
		if (!place_value(t, at, end, ";,", out))
			return false;
		out->key = key;
		if (behind - key == strlen(name) && memcmp(t->bytes + key, name, behind - key) == 0)
			return true;
		at = out->after;
	}
}

bool setting_place_element(const struct setting_text *t, const struct setting_place *list,
			   size_t index, struct setting_place *out)
{
	size_t at, end;

	inside(t, list, &at, &end);
	for (size_t i = 0;; i++) {
		at = setting_place_skip(t, at, end);
		if (!place_value(t, at, end, ",", out))
			return false;
		out->key = out->begin;
		if (i == index)
			return true;
		at = out->after;
	}
}
