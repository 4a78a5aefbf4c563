/* The part of the glTF 2.0 schema that grotto draws, as tables (glTF 2.0, section 5). */
#include "renderer/scene/gltf.h"

#include "base/result.h"
#include "renderer/scene/import.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define NAME_MAX_BYTES 255 /* longer names are cut */
#define URI_SHOWN 4096     /* an URI other than data: may be this long */
#define LIST_MAX IMPORT_MAX_NODES

enum kind {
	NAME,    /* text for people */
	WORD,    /* one of `words` */
	URI,     /* without NUL */
	NUMBER,  /* fits float */
	NUMBERS, /* `most` of them */
	WHOLE,   /* least to most */
	INDEX,   /* of an object in the root's array `of` */
	INDICES, /* a list of them */
	BOOLEAN,
	OBJECT,  /* with `fields` */
	OBJECTS, /* a list of them */
};

struct field {
	const char *key;
	enum kind kind;
	bool required;
	int64_t least, most;
	const char *of;
	const char *const *words;
	const struct field *fields;
};

/* Where in the file, for messages: materials[3].emissiveTexture.index */
struct place {
	char text[192];
};

static const char *const alpha_modes[] = { "OPAQUE", "MASK", "BLEND", NULL };
static const char *const image_types[] = { "image/png", "image/jpeg", NULL };
static const char *const accessor_types[] = { "SCALAR", "VEC2", "VEC3", "VEC4",
					      "MAT2",   "MAT3", "MAT4", NULL };

static const struct field asset[] = { { .key = "version", .kind = NAME, .required = true }, { 0 } };
static const struct field scene[] = {
	{ .key = "nodes", .kind = INDICES, .required = true, .of = "nodes" },
	{ 0 },
};
static const struct field node[] = {
	{ .key = "children", .kind = INDICES, .of = "nodes" },
	{ .key = "matrix", .kind = NUMBERS, .most = 16 },
	{ .key = "mesh", .kind = INDEX, .of = "meshes" },
	{ .key = "rotation", .kind = NUMBERS, .most = 4 },
	{ .key = "scale", .kind = NUMBERS, .most = 3 },
	{ .key = "translation", .kind = NUMBERS, .most = 3 },
	{ 0 },
};
static const struct field attributes[] = {
	{ .key = "POSITION", .kind = INDEX, .required = true, .of = "accessors" },
	{ .key = "NORMAL", .kind = INDEX, .of = "accessors" },
	{ .key = "TEXCOORD_0", .kind = INDEX, .of = "accessors" },
	{ 0 },
};
static const struct field primitive[] = {
	{ .key = "attributes", .kind = OBJECT, .required = true, .fields = attributes },
	{ .key = "indices", .kind = INDEX, .of = "accessors" },
	{ .key = "material", .kind = INDEX, .of = "materials" },
	{ .key = "mode", .kind = WHOLE, .most = 6 },
	{ 0 },
};
static const struct field mesh[] = {
	{ .key = "primitives", .kind = OBJECTS, .required = true, .fields = primitive },
	{ 0 },
};
static const struct field texture_use[] = {
	{ .key = "index", .kind = INDEX, .required = true, .of = "textures" },
	{ 0 },
};
static const struct field metallic_roughness[] = {
	{ .key = "baseColorFactor", .kind = NUMBERS, .most = 4 },
	{ .key = "baseColorTexture", .kind = OBJECT, .fields = texture_use },
	{ .key = "metallicFactor", .kind = NUMBER },
	{ .key = "metallicRoughnessTexture", .kind = OBJECT, .fields = texture_use },
	{ .key = "roughnessFactor", .kind = NUMBER },
	{ 0 },
};
static const struct field material[] = {
	{ .key = "alphaMode", .kind = WORD, .words = alpha_modes },
	{ .key = "doubleSided", .kind = BOOLEAN },
	{ .key = "emissiveFactor", .kind = NUMBERS, .most = 3 },
	{ .key = "emissiveTexture", .kind = OBJECT, .fields = texture_use },
	{ .key = "name", .kind = NAME },
	{ .key = "pbrMetallicRoughness", .kind = OBJECT, .fields = metallic_roughness },
	{ 0 },
};
static const struct field texture[] = {
	{ .key = "source", .kind = INDEX, .required = true, .of = "images" },
	{ 0 },
};
static const struct field image[] = {
	{ .key = "bufferView", .kind = INDEX, .of = "bufferViews" },
	{ .key = "mimeType", .kind = WORD, .words = image_types },
	{ .key = "uri", .kind = URI },
	{ 0 },
};
static const struct field accessor[] = {
	{ .key = "bufferView", .kind = INDEX, .of = "bufferViews" },
	{ .key = "byteOffset", .kind = WHOLE, .most = IMPORT_MAX_FILE },
	{ .key = "componentType", .kind = WHOLE, .required = true, .least = 5120, .most = 5126 },
	{ .key = "count", .kind = WHOLE, .required = true, .least = 1, .most = IMPORT_MAX_INDICES },
	{ .key = "sparse", .kind = OBJECT }, /* kept for the message that refuses it */
	{ .key = "type", .kind = WORD, .required = true, .words = accessor_types },
	{ 0 },
};
static const struct field view[] = {
	{ .key = "buffer", .kind = INDEX, .required = true, .of = "buffers" },
	{ .key = "byteLength", .kind = WHOLE, .required = true, .least = 1, .most = IMPORT_MAX_FILE },
	{ .key = "byteOffset", .kind = WHOLE, .most = IMPORT_MAX_FILE },
	{ .key = "byteStride", .kind = WHOLE, .least = 1, .most = 252 },
	{ 0 },
};
static const struct field buffer[] = {
	{ .key = "byteLength", .kind = WHOLE, .required = true, .least = 1, .most = IMPORT_MAX_FILE },
	{ .key = "uri", .kind = URI },
	{ 0 },
};
static const struct field root[] = {
	{ .key = "accessors", .kind = OBJECTS, .fields = accessor },
	{ .key = "asset", .kind = OBJECT, .required = true, .fields = asset },
	{ .key = "bufferViews", .kind = OBJECTS, .fields = view },
	{ .key = "buffers", .kind = OBJECTS, .fields = buffer },
	{ .key = "images", .kind = OBJECTS, .fields = image },
	{ .key = "materials", .kind = OBJECTS, .fields = material },
	{ .key = "meshes", .kind = OBJECTS, .required = true, .fields = mesh },
	{ .key = "nodes", .kind = OBJECTS, .required = true, .fields = node },
	{ .key = "scene", .kind = INDEX, .of = "scenes" },
	{ .key = "scenes", .kind = OBJECTS, .required = true, .fields = scene },
	{ .key = "textures", .kind = OBJECTS, .fields = texture },
	{ 0 },
};

static int check_object(const struct gltf *g, struct json_object *object,
			const struct field *fields, const struct place *where);

static int wrong(const struct gltf *g, const struct place *where, const char *must)
{
	gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, where->text, "%s", must);
	return GR_ERR_CONFIG;
}

static struct place inside_key(const struct place *where, const char *key)
{
	struct place place;

	if (snprintf(place.text, sizeof place.text, "%s%s%s", where->text,
		     where->text[0] ? "." : "", key) >= (int)sizeof place.text)
		place = *where;
	return place;
}

static struct place inside_list(const struct place *where, size_t index)
{
	struct place place;

	if (snprintf(place.text, sizeof place.text, "%s[%zu]", where->text, index) >=
	    (int)sizeof place.text)
		place = *where;
	return place;
}

static bool is_number(struct json_object *value, double *out)
{
	if (!json_object_is_type(value, json_type_int) &&
	    !json_object_is_type(value, json_type_double))
		return false;
	*out = json_object_get_double(value);
	return isfinite(*out) && fabs(*out) <= (double)FLT_MAX;
}

static bool is_text(struct json_object *value)
{
	return json_object_is_type(value, json_type_string) &&
	       strlen(json_object_get_string(value)) == (size_t)json_object_get_string_len(value);
}

static int check_text(const struct gltf *g, struct json_object *value, const struct field *field,
		      const struct place *where)
{
	const char *text;

	if (!is_text(value))
		return wrong(g, where, "must be a string, without NUL");
	text = json_object_get_string(value);
	if (field->kind == NAME && strlen(text) > NAME_MAX_BYTES)
		json_object_set_string_len(value, text, NAME_MAX_BYTES);
	if (field->kind == URI && strncmp(text, "data:", 5) != 0 &&
	    (text[0] == '\0' || strlen(text) > URI_SHOWN))
		return wrong(g, where, "must be the name of a file, or a data: URI");
	for (size_t i = 0; field->kind == WORD; i++) {
		if (!field->words[i])
			return wrong(g, where, "is none of the words that glTF 2.0 knows here");
		if (strcmp(field->words[i], text) == 0)
			break;
	}
	return GR_OK;
}

static int check_whole(const struct gltf *g, struct json_object *value, int64_t least,
		       int64_t most, const struct place *where, struct json_object **plain)
{
	double number;

	if (!is_number(value, &number) || number != floor(number) || number < (double)least ||
	    number > (double)most) {
		gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, where->text,
			    "must be a whole number from %lld to %lld", (long long)least,
			    (long long)most);
		return GR_ERR_CONFIG;
	}
	*plain = json_object_new_int64((int64_t)number); /* not 1.0 */
	return *plain ? GR_OK : GR_ERR_NOMEM;
}

static int check_index(const struct gltf *g, struct json_object *value, const char *of,
		       const struct place *where, struct json_object **plain)
{
	size_t count;

	gltf_list(g, of, &count);
	if (count == 0) {
		gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, where->text,
			    "does not exist: the file has no %s", of);
		return GR_ERR_CONFIG;
	}
	return check_whole(g, value, 0, (int64_t)count - 1, where, plain);
}

static int check_list(const struct gltf *g, struct json_object *list, const struct field *field,
		      const struct place *where)
{
	size_t count;
	int result = GR_OK;

	if (!json_object_is_type(list, json_type_array))
		return wrong(g, where, "must be a list");
	count = json_object_array_length(list);
	if (count > LIST_MAX)
		return wrong(g, where, "has too many items");
	if (field->kind == NUMBERS && count != (size_t)field->most)
		return wrong(g, where, "has another number of items than glTF 2.0 wants");
	for (size_t i = 0; i < count && result == GR_OK; i++) {
		struct json_object *item = json_object_array_get_idx(list, i), *plain = NULL;
		struct place at = inside_list(where, i);
		double number;

		if (field->kind == OBJECTS)
			result = check_object(g, item, field->fields, &at);
		else if (field->kind == INDICES)
			result = check_index(g, item, field->of, &at, &plain);
		else if (!is_number(item, &number))
			result = wrong(g, &at, "must be a number");
		if (plain)
			json_object_array_put_idx(list, i, plain);
	}
	return result;
}

static int check_value(const struct gltf *g, struct json_object *parent,
		       struct json_object *value, const struct field *field,
		       const struct place *where)
{
	struct json_object *plain = NULL;
	double number;
	int result = GR_OK;

	switch (field->kind) {
	case NAME:
	case WORD:
	case URI:
		return check_text(g, value, field, where);
	case NUMBER:
		return is_number(value, &number) ? GR_OK : wrong(g, where, "must be a number");
	case BOOLEAN:
		return json_object_is_type(value, json_type_boolean)
			       ? GR_OK
			       : wrong(g, where, "must be true or false");
	case WHOLE:
		result = check_whole(g, value, field->least, field->most, where, &plain);
		break;
	case INDEX:
		result = check_index(g, value, field->of, where, &plain);
		break;
	case OBJECT:
		return check_object(g, value, field->fields, where);
	case OBJECTS:
	case INDICES:
	case NUMBERS:
		return check_list(g, value, field, where);
	}
	if (plain)
		json_object_object_add(parent, field->key, plain);
	return result;
}

static bool has_field(const struct field *fields, const char *key)
{
	for (; fields && fields->key; fields++) {
		if (strcmp(fields->key, key) == 0)
			return true;
	}
	return false;
}

static int check_object(const struct gltf *g, struct json_object *object,
			const struct field *fields, const struct place *where)
{
	int result = GR_OK;

	if (!json_object_is_type(object, json_type_object))
		return wrong(g, where, "must be an object");
	json_object_object_foreach(object, key, value)
	{
		(void)value;
		if (!has_field(fields, key))
			json_object_object_del(object, key);
	}
	for (; fields && fields->key && result == GR_OK; fields++) {
		struct place at = inside_key(where, fields->key);
		struct json_object *member;

		/* A null is there, and is none of the types. */
		if (json_object_object_get_ex(object, fields->key, &member))
			result = check_value(g, object, member, fields, &at);
		else if (fields->required)
			result = wrong(g, &at, "is missing");
	}
	return result;
}

/* assimp's choice of the scene is its own where the file gives none. */
static int choose_scene(const struct gltf *g)
{
	size_t count;

	gltf_list(g, "scenes", &count);
	if (count == 0)
		return gltf_fault(g, "scenes", "the file has no scene to draw");
	if (gltf_member(g->root, "scene"))
		return GR_OK;
	return json_object_object_add(g->root, "scene", json_object_new_int64(0)) == 0
		       ? GR_OK
		       : GR_ERR_NOMEM;
}

int gltf_schema(const struct gltf *g)
{
	static const struct place top;
	struct json_object *version = gltf_member(gltf_member(g->root, "asset"), "version");
	int result;

	if (!version || !is_text(version) ||
	    strncmp(json_object_get_string(version), "2.", 2) != 0)
		return gltf_fault(g, "asset", "version must be 2.0: glTF 2.0 is read");
	result = check_object(g, g->root, root, &top);
	return result == GR_OK ? choose_scene(g) : result;
}
