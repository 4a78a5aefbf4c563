#include "tests/accuracy/folder/json_walk.h"

#include "base/result.h"
#include "renderer/image/read_file.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_FILE ((size_t)1 << 30)
#define MAX_DEPTH 32
#define GLB_HEAD 20 /* magic, version, length; the first chunk's length and kind */

void json_fault(struct json_walk *walk, const char *where, const char *format, ...)
{
	char text[512];
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	gr_diag_add(walk->diag, GR_DIAG_ERROR, walk->path, 0, where, "%s", text);
	walk->failed = true;
}

void json_only(struct json_walk *walk, const char *where, json_object *object,
	       const char *const *known)
{
	json_object_object_foreach(object, key, value)
	{
		bool found = false;

		(void)value;
		for (int i = 0; known[i]; i++)
			found = found || strcmp(known[i], key) == 0;
		if (!found)
			json_fault(walk, where, "\"%.64s\" is not known here", key);
	}
}

json_object *json_member(struct json_walk *walk, const char *where, json_object *object,
			 const char *key, json_type type, bool needed)
{
	json_object *member;

	if (!json_object_object_get_ex(object, key, &member)) {
		if (needed)
			json_fault(walk, where, "\"%s\" is missing", key);
		return NULL;
	}
	if (json_object_get_type(member) != type) {
		json_fault(walk, where, "\"%s\" is %s; %s is meant", key,
			   json_type_to_name(json_object_get_type(member)), json_type_to_name(type));
		return NULL;
	}
	return member;
}

static bool is_number(json_object *value)
{
	return json_object_is_type(value, json_type_int) || json_object_is_type(value, json_type_double);
}

bool json_number(struct json_walk *walk, const char *where, json_object *object, const char *key,
		 bool needed, double *out)
{
	json_object *member;

	if (!json_object_object_get_ex(object, key, &member)) {
		if (needed)
			json_fault(walk, where, "\"%s\" is missing", key);
		return false;
	}
	if (!is_number(member) || !isfinite(json_object_get_double(member))) {
		json_fault(walk, where, "\"%s\" is no finite number", key);
		return false;
	}
	*out = json_object_get_double(member);
	return true;
}

bool json_array_numbers(struct json_walk *walk, const char *where, json_object *array, int count,
			double *out)
{
	bool good = json_object_is_type(array, json_type_array) &&
		    json_object_array_length(array) == (size_t)count;

	for (int i = 0; i < count && good; i++) {
		json_object *value = json_object_array_get_idx(array, (size_t)i);

		good = is_number(value) && isfinite(json_object_get_double(value));
		if (good)
			out[i] = json_object_get_double(value);
	}
	if (!good)
		json_fault(walk, where, "%d finite numbers are meant", count);
	return good;
}

bool json_numbers(struct json_walk *walk, const char *where, json_object *object, const char *key,
		  bool needed, int count, double *out)
{
	json_object *member = json_member(walk, where, object, key, json_type_array, needed);
	char place[256];

	snprintf(place, sizeof place, "%.180s.%.64s", where, key);
	return member && json_array_numbers(walk, place, member, count, out);
}

const char *json_text(struct json_walk *walk, const char *where, json_object *object,
		      const char *key)
{
	json_object *member = json_member(walk, where, object, key, json_type_string, true);

	return member ? json_object_get_string(member) : NULL;
}

bool json_flag(struct json_walk *walk, const char *where, json_object *object, const char *key)
{
	json_object *member = json_member(walk, where, object, key, json_type_boolean, false);

	return member && json_object_get_boolean(member);
}

static size_t little(const uint8_t *p)
{
	return (size_t)p[0] | (size_t)p[1] << 8 | (size_t)p[2] << 16 | (size_t)p[3] << 24;
}

/* Within a GLB the first chunk is the JSON. */
static bool find_text(struct json_walk *walk, const uint8_t *bytes, size_t len, const char **text,
		      size_t *text_len)
{
	*text = (const char *)bytes;
	*text_len = len;
	if (len < 4 || memcmp(bytes, "glTF", 4) != 0)
		return true;
	if (len < GLB_HEAD || memcmp(bytes + 16, "JSON", 4) != 0 ||
	    little(bytes + 12) > len - GLB_HEAD) {
		json_fault(walk, NULL, "a GLB without its JSON");
		return false;
	}
	*text = (const char *)bytes + GLB_HEAD;
	*text_len = little(bytes + 12);
	return true;
}

json_object *json_load(struct json_walk *walk)
{
	json_tokener *tokener = json_tokener_new_ex(MAX_DEPTH);
	json_object *root = NULL;
	const char *text;
	uint8_t *bytes = NULL;
	size_t len;

	if (!tokener || read_file(walk->path, MAX_FILE, &bytes, &len, walk->diag, "scene") != GR_OK) {
		walk->failed = true;
	} else if (find_text(walk, bytes, len, &text, &len)) {
		json_tokener_set_flags(tokener, JSON_TOKENER_VALIDATE_UTF8);
		root = len < INT32_MAX ? json_tokener_parse_ex(tokener, text, (int)len) : NULL;
		if (!json_object_is_type(root, json_type_object)) {
			json_fault(walk, NULL, "no JSON object: %s",
				   json_tokener_error_desc(json_tokener_get_error(tokener)));
			json_object_put(root);
			root = NULL;
		}
	}
	free(bytes);
	if (tokener)
		json_tokener_free(tokener);
	return root;
}
