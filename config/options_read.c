#include "config/options_value.h"
#include "config/suggest.h"

#include <stdlib.h>
#include <string.h>

static void read_list(struct options_reader *reader, const struct option *option,
		      const config_setting_t *at, const config_setting_t *setting, char *base)
{
	int length;
	char *elements;

	if (setting->type != CONFIG_TYPE_LIST) {
		option_wrong_type(reader, at, option, setting, "a list ( { ... }, { ... } )");
		return;
	}
	length = config_setting_length(setting);
	if (length > (int)option->count) {
		options_fault(reader, GR_DIAG_ERROR, at, option->key, "%d entries; at most %u", length,
			      option->count);
		return;
	}
	if (length <= 0)
		return;
	elements = calloc((size_t)length, option->size);
	if (!elements) {
		reader->nomem = true;
		return;
	}
	*(char **)(base + option->offset) = elements;
	*(size_t *)(base + option->count_offset) = (size_t)length;
	for (int i = 0; i < length; i++) {
		const config_setting_t *element = config_setting_get_elem(setting, (unsigned)i);

		if (element->type != CONFIG_TYPE_GROUP) {
			options_fault(reader, GR_DIAG_ERROR, element, NULL,
				      "expected a group { }, found %s", option_found(element));
			element = NULL;
		}
		/* A wrong element is read as all defaults, so that its neighbours are still checked. */
		options_read(reader, option->group, element, elements + (size_t)i * option->size);
	}
}

static void read_one(struct options_reader *reader, const struct option *option,
		     const config_setting_t *at, char *base)
{
	const config_setting_t *setting =
		at ? config_setting_get_member(at, option->key) : NULL;
	void *to = base + option->offset;

	option_default(reader, option, to);
	if (setting && option->type == OPTION_GROUP && setting->type != CONFIG_TYPE_GROUP) {
		option_wrong_type(reader, at, option, setting, "a group { }");
		setting = NULL;
	} else if (!setting && at && option->required) {
		options_fault(reader, GR_DIAG_ERROR, at, option->key, "missing; it is %s",
			      option->help);
	}
	if (option->type == OPTION_GROUP) {
		options_read(reader, option->group, setting, to);
		return;
	}
	if (!setting)
		return;
	if (option->type == OPTION_LIST)
		read_list(reader, option, at, setting, base);
	else
		option_value(reader, option, at, setting, to);
}

static void unknown_key(struct options_reader *reader, const struct option *table,
			const config_setting_t *at, const char *key)
{
	struct suggest suggest;
	const char *near;
	char known[600] = "";
	size_t len = 0;

	suggest_start(&suggest, key);
	for (const struct option *o = table; o->key; o++) {
		int n = snprintf(known + len, sizeof known - len, "%s%s", len ? ", " : "", o->key);

		len += n > 0 ? (size_t)n : 0;
		if (len >= sizeof known)
			len = sizeof known - 1;
		suggest_offer(&suggest, o->key);
	}
	near = suggest_answer(&suggest);
	if (near)
		options_fault(reader, GR_DIAG_ERROR, at, key, "unknown key, did you mean \"%s\"?", near);
	else
		options_fault(reader, GR_DIAG_ERROR, at, key, "unknown key; known here: %s", known);
}

void options_read(struct options_reader *reader, const struct option *table,
		  const config_setting_t *at, void *base)
{
	*(const config_setting_t **)base = at;
	for (const struct option *option = table; option->key; option++)
		read_one(reader, option, at, base);
	for (int i = 0; at && i < config_setting_length(at); i++) {
		const config_setting_t *setting = config_setting_get_elem(at, (unsigned)i);
		const struct option *option = table;

		while (option->key && strcmp(option->key, setting->name))
			option++;
		if (!option->key)
			unknown_key(reader, table, at, setting->name);
	}
}
