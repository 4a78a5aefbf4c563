#include "config/options.h"

#include "config/suggest.h"

#include <ctype.h>
#include <math.h>
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

static const char *found_name(const config_setting_t *setting)
{
	switch (setting->type) {
	case CONFIG_TYPE_GROUP:
		return "a group { }";
	case CONFIG_TYPE_INT:
	case CONFIG_TYPE_INT64:
		return "a whole number";
	case CONFIG_TYPE_FLOAT:
		return "a number with a fraction";
	case CONFIG_TYPE_STRING:
		return "a string";
	case CONFIG_TYPE_BOOL:
		return "true or false";
	case CONFIG_TYPE_ARRAY:
		return "an array [ ]";
	case CONFIG_TYPE_LIST:
		return "a list ( )";
	default:
		return "nothing";
	}
}

static void wrong_type(struct options_reader *reader, const config_setting_t *at,
		       const struct option *option, const config_setting_t *found, const char *right)
{
	options_fault(reader, GR_DIAG_ERROR, at, option->key, "expected %s, found %s%s%s%s", right,
		      found_name(found), found->type == CONFIG_TYPE_STRING ? " \"" : "",
		      found->type == CONFIG_TYPE_STRING ? config_setting_get_string(found) : "",
		      found->type == CONFIG_TYPE_STRING ? "\"" : "");
}

static double scale_of(const struct option *option)
{
	return option->scale != 0 ? option->scale : 1;
}

static void store_number(const struct option *option, void *to, unsigned index, double value)
{
	switch (option->type) {
	case OPTION_INT:
		((int *)to)[index] = (int)value;
		break;
	case OPTION_PORT:
		*(uint16_t *)to = (uint16_t)value;
		break;
	case OPTION_U32:
		*(uint32_t *)to = (uint32_t)value;
		break;
	case OPTION_TIME:
		*(int64_t *)to = llround(value * scale_of(option));
		break;
	default:
		((float *)to)[index] = (float)(value * scale_of(option));
		break;
	}
}

static bool whole_number(const struct option *option)
{
	return option->type == OPTION_INT || option->type == OPTION_PORT ||
	       option->type == OPTION_U32;
}

static int choice_index(const struct option *option, const char *word)
{
	for (int i = 0; option->choices[i]; i++)
		if (!strcmp(option->choices[i], word))
			return i;
	return OPTION_ABSENT;
}

static char *copy_string(struct options_reader *reader, const char *text)
{
	char *copy = strdup(text);

	if (!copy)
		reader->nomem = true;
	return copy;
}

static void set_default(struct options_reader *reader, const struct option *option, void *to)
{
	const char *text = option->standard;
	unsigned count = option->count ? option->count : 1;
	char *end;

	switch (option->type) {
	case OPTION_BOOL:
		*(bool *)to = text && !strcmp(text, "true");
		break;
	case OPTION_NAME:
		snprintf(to, OPTION_NAME_SIZE, "%s", text ? text : "");
		break;
	case OPTION_STRING:
		*(char **)to = text ? copy_string(reader, text) : NULL;
		break;
	case OPTION_CHOICE:
		*(int *)to = text ? choice_index(option, text) : OPTION_ABSENT;
		break;
	case OPTION_GROUP:
	case OPTION_LIST:
		break;
	default:
		for (unsigned i = 0; i < count; i++) {
			double value = option->type == OPTION_FLOAT ? NAN : 0;

			if (text) {
				value = strtod(text, &end);
				text = end;
			}
			store_number(option, to, i, value);
		}
		break;
	}
}

static const char *unit_text(const struct option *option, char *buffer, size_t size)
{
	snprintf(buffer, size, "%s%s", option->unit ? " " : "", option->unit ? option->unit : "");
	return buffer;
}

/* One number of an option; false and a fault when it does not fit. */
static bool read_number(struct options_reader *reader, const struct option *option,
			const config_setting_t *at, const config_setting_t *setting, double *out)
{
	char unit[32];
	double value;

	if (setting->type == CONFIG_TYPE_INT)
		value = setting->value.ival;
	else if (setting->type == CONFIG_TYPE_INT64)
		value = (double)setting->value.llval;
	else if (setting->type == CONFIG_TYPE_FLOAT && !whole_number(option))
		value = setting->value.fval;
	else {
		wrong_type(reader, at, option, setting,
			   whole_number(option) ? "a whole number" : "a number");
		return false;
	}
	if (!isfinite(value)) {
		options_fault(reader, GR_DIAG_ERROR, at, option->key, "is not a finite number");
		return false;
	}
	if (value < option->min || value > option->max) {
		options_fault(reader, GR_DIAG_ERROR, at, option->key, "%.10g is outside %.10g to %.10g%s",
			      value, option->min, option->max, unit_text(option, unit, sizeof unit));
		return false;
	}
	*out = value;
	return true;
}

static void read_numbers(struct options_reader *reader, const struct option *option,
			 const config_setting_t *at, const config_setting_t *setting, void *to)
{
	double values[8];

	if (option->count <= 1) {
		if (read_number(reader, option, at, setting, values))
			store_number(option, to, 0, values[0]);
		return;
	}
	if (setting->type != CONFIG_TYPE_ARRAY && setting->type != CONFIG_TYPE_LIST) {
		char right[48];

		snprintf(right, sizeof right, "%u numbers [ ]", option->count);
		wrong_type(reader, at, option, setting, right);
		return;
	}
	if (config_setting_length(setting) != (int)option->count) {
		options_fault(reader, GR_DIAG_ERROR, at, option->key, "expected %u numbers, found %d",
			      option->count, config_setting_length(setting));
		return;
	}
	for (unsigned i = 0; i < option->count; i++)
		if (!read_number(reader, option, at, config_setting_get_elem(setting, i), &values[i]))
			return;
	for (unsigned i = 0; i < option->count; i++)
		store_number(option, to, i, values[i]);
}

static void list_choices(const struct option *option, char *out, size_t size)
{
	size_t len = 0;

	out[0] = '\0';
	for (int i = 0; option->choices[i] && len < size; i++) {
		int n = snprintf(out + len, size - len, "%s\"%s\"", i ? ", " : "", option->choices[i]);
		len += n > 0 ? (size_t)n : 0;
	}
}

static void read_choice(struct options_reader *reader, const struct option *option,
			const config_setting_t *at, const char *word, int *to)
{
	char choices[300];
	struct suggest suggest;
	const char *near;
	int index = choice_index(option, word);

	if (index != OPTION_ABSENT) {
		*to = index;
		return;
	}
	suggest_start(&suggest, word);
	for (int i = 0; option->choices[i]; i++)
		suggest_offer(&suggest, option->choices[i]);
	near = suggest_answer(&suggest);
	list_choices(option, choices, sizeof choices);
	options_fault(reader, GR_DIAG_ERROR, at, option->key, "\"%.64s\" is not known%s%s%s; one of %s",
		      word, near ? ", did you mean \"" : "", near ? near : "", near ? "\"?" : "",
		      choices);
}

static void read_text(struct options_reader *reader, const struct option *option,
		      const config_setting_t *at, const config_setting_t *setting, void *to)
{
	const char *text;

	if (setting->type != CONFIG_TYPE_STRING) {
		wrong_type(reader, at, option, setting, "a string \"...\"");
		return;
	}
	text = config_setting_get_string(setting);
	if (option->type == OPTION_CHOICE) {
		read_choice(reader, option, at, text, to);
		return;
	}
	if (option->type == OPTION_NAME) {
		if (!options_name_fit(text)) {
			options_fault(reader, GR_DIAG_ERROR, at, option->key,
				      "\"%.64s\" cannot be a name: 1 to %d letters, digits, '_', '-' or '.', "
				      "the first a letter or digit",
				      text, OPTION_NAME_SIZE - 1);
			return;
		}
		snprintf(to, OPTION_NAME_SIZE, "%s", text);
		return;
	}
	if (!*text || strlen(text) > OPTION_STRING_MAX) {
		options_fault(reader, GR_DIAG_ERROR, at, option->key,
			      "%s; leave the key out or give 1 to %d bytes",
			      *text ? "too long" : "empty", OPTION_STRING_MAX);
		return;
	}
	for (const char *c = text; *c; c++)
		if ((unsigned char)*c < 0x20 || *c == 0x7f) {
			options_fault(reader, GR_DIAG_ERROR, at, option->key,
				      "holds a control character (byte %d); use printable ones",
				      (unsigned char)*c);
			return;
		}
	free(*(char **)to);
	*(char **)to = copy_string(reader, text);
}

static void read_list(struct options_reader *reader, const struct option *option,
		      const config_setting_t *at, const config_setting_t *setting, char *base)
{
	int length;
	char *elements;

	if (setting->type != CONFIG_TYPE_LIST) {
		wrong_type(reader, at, option, setting, "a list ( { ... }, { ... } )");
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
				      "expected a group { }, found %s", found_name(element));
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

	set_default(reader, option, to);
	if (setting && option->type == OPTION_GROUP && setting->type != CONFIG_TYPE_GROUP) {
		wrong_type(reader, at, option, setting, "a group { }");
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
	switch (option->type) {
	case OPTION_BOOL:
		if (setting->type == CONFIG_TYPE_BOOL)
			*(bool *)to = config_setting_get_bool(setting);
		else
			wrong_type(reader, at, option, setting, "true or false");
		break;
	case OPTION_NAME:
	case OPTION_STRING:
	case OPTION_CHOICE:
		read_text(reader, option, at, setting, to);
		break;
	case OPTION_LIST:
		read_list(reader, option, at, setting, base);
		break;
	default:
		read_numbers(reader, option, at, setting, to);
		break;
	}
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
