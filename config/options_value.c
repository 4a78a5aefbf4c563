#include "config/options_value.h"

#include "config/suggest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *option_found(const config_setting_t *setting)
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

void option_wrong_type(struct options_reader *reader, const config_setting_t *at,
		       const struct option *option, const config_setting_t *found, const char *right)
{
	options_fault(reader, GR_DIAG_ERROR, at, option->key, "expected %s, found %s%s%s%s", right,
		      option_found(found), found->type == CONFIG_TYPE_STRING ? " \"" : "",
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

void option_default(struct options_reader *reader, const struct option *option, void *to)
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
		option_wrong_type(reader, at, option, setting,
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
		option_wrong_type(reader, at, option, setting, right);
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
		option_wrong_type(reader, at, option, setting, "a string \"...\"");
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

void option_value(struct options_reader *reader, const struct option *option,
		  const config_setting_t *at, const config_setting_t *setting, void *to)
{
	switch (option->type) {
	case OPTION_BOOL:
		if (setting->type == CONFIG_TYPE_BOOL)
			*(bool *)to = config_setting_get_bool(setting);
		else
			option_wrong_type(reader, at, option, setting, "true or false");
		break;
	case OPTION_NAME:
	case OPTION_STRING:
	case OPTION_CHOICE:
		read_text(reader, option, at, setting, to);
		break;
	default:
		read_numbers(reader, option, at, setting, to);
		break;
	}
}
