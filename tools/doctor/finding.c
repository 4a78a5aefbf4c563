#include "tools/doctor/finding.h"

#include "base/result.h"

#include <json-c/json.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char *const level_names[FINDING_LEVELS] = { "OK", "--", "warn", "FAIL" };
static const char *const level_words[FINDING_LEVELS] = { "ok", "unknown", "warn", "fail" };

struct finding finding(enum finding_level level, const char *format, ...)
{
	struct finding one = { .level = level };
	va_list args;

	va_start(args, format);
	vsnprintf(one.text, sizeof one.text, format, args);
	va_end(args);
	return one;
}

struct finding finding_do(struct finding of, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	vsnprintf(of.remedy, sizeof of.remedy, format, args);
	va_end(args);
	return of;
}

/* Facts come from files that others may write: a terminal must not obey them. */
static void make_printable(char *text)
{
	for (; *text; text++)
		if ((unsigned char)*text < ' ' || (unsigned char)*text > '~')
			*text = '?';
}

void findings_add(struct findings *findings, struct finding one)
{
	if (findings->count == findings->room) {
		size_t room = findings->room ? 2 * findings->room : 64;
		struct finding *items = realloc(findings->items, room * sizeof *items);

		if (!items) {
			findings->nomem = true;
			return;
		}
		findings->items = items;
		findings->room = room;
	}
	one.check = findings->check ? findings->check : "";
	make_printable(one.text);
	make_printable(one.remedy);
	findings->items[findings->count++] = one;
	findings->of[one.level]++;
}

void findings_finish(struct findings *findings)
{
	free(findings->items);
	*findings = (struct findings){ 0 };
}

void findings_print(const struct findings *findings, FILE *file)
{
	for (size_t i = 0; i < findings->count; i++) {
		const struct finding *one = &findings->items[i];

		fprintf(file, "%-4s  %-9s  %s\n", level_names[one->level], one->check, one->text);
		if (one->remedy[0])
			fprintf(file, "%18s-> %s\n", "", one->remedy);
	}
	fprintf(file, "%zu found wrong, %zu warnings, %zu right, %zu that cannot be told\n",
		findings->of[FINDING_FAIL], findings->of[FINDING_WARN], findings->of[FINDING_OK],
		findings->of[FINDING_SKIP]);
}

static bool add_string(struct json_object *object, const char *key, const char *value)
{
	struct json_object *text = json_object_new_string(value);

	return text && json_object_object_add(object, key, text) == 0;
}

int findings_print_json(const struct findings *findings, FILE *file)
{
	struct json_object *root = json_object_new_object(), *list = json_object_new_array();
	bool ok = root && list;

	for (size_t i = 0; ok && i < findings->count; i++) {
		const struct finding *one = &findings->items[i];
		struct json_object *object = json_object_new_object();

		ok = object && json_object_array_add(list, object) == 0 &&
		     add_string(object, "check", one->check) &&
		     add_string(object, "level", level_words[one->level]) &&
		     add_string(object, "text", one->text) &&
		     (!one->remedy[0] || add_string(object, "remedy", one->remedy));
	}
	if (ok) {
		json_object_object_add(root, "ok", json_object_new_boolean(!findings->of[FINDING_FAIL]));
		json_object_object_add(root, "findings", list);
		list = NULL;
		fprintf(file, "%s\n", json_object_to_json_string_ext(root, JSON_C_TO_STRING_PLAIN));
	}
	json_object_put(list);
	json_object_put(root);
	return ok ? GR_OK : GR_ERR_NOMEM;
}
