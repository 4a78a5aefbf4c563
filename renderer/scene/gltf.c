/*
 * What a glTF 2.0 file says beside assimp. assimp 5.2 trusts node hierarchies
 * to end, and does not know KHR_materials_emissive_strength and _specular;
 * both are read here from the file's own JSON.
 */
#include "renderer/scene/import.h"

#include "base/cursor.h"
#include "base/result.h"

#include <errno.h>
#include <json-c/json.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define GLB_MAGIC 0x46546c67u
#define GLB_JSON 0x4e4f534au
#define GLB_BIN 0x004e4942u

struct gltf {
	const char *path;
	struct gr_diag *diag;
	struct json_object *root;
	size_t binary_len; /* of the GLB's BIN chunk, 0 without one */
	size_t triangles;
};

bool gltf_is_name(const char *name)
{
	const char *dot = strrchr(name, '.');

	return dot && (strcasecmp(dot, ".gltf") == 0 || strcasecmp(dot, ".glb") == 0);
}

static int fault(const struct gltf *g, const char *key, const char *text)
{
	gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, key, "%s", text);
	return GR_ERR_CONFIG;
}

/* An array of the root, NULL when absent; *count 0 then. */
static struct json_object *list(const struct gltf *g, const char *key, size_t *count)
{
	struct json_object *array = NULL;

	*count = 0;
	if (!json_object_object_get_ex(g->root, key, &array) ||
	    !json_object_is_type(array, json_type_array))
		return NULL;
	*count = json_object_array_length(array);
	return array;
}

static struct json_object *member(struct json_object *object, const char *key)
{
	struct json_object *value = NULL;

	if (!json_object_is_type(object, json_type_object))
		return NULL;
	json_object_object_get_ex(object, key, &value);
	return value;
}

/* A whole number of at least 0, `missing` when absent, -1 when it is something else. */
static int64_t whole(struct json_object *object, const char *key, int64_t missing)
{
	struct json_object *value = member(object, key);
	double number;

	if (!value)
		return missing;
	if (!json_object_is_type(value, json_type_int) &&
	    !json_object_is_type(value, json_type_double))
		return -1;
	number = json_object_get_double(value);
	return number >= 0 && number <= 0x1p53 && number == floor(number) ? (int64_t)number : -1;
}

static bool is_index(struct json_object *object, const char *key, size_t count)
{
	int64_t value = whole(object, key, 0);

	return value >= 0 && (!member(object, key) || (size_t)value < count);
}

/* Finds the JSON in a GLB; in a .gltf it is the whole file. */
static int find_json(struct gltf *g, const uint8_t *bytes, size_t len, const char **json,
		     size_t *json_len)
{
	struct gr_reader r = gr_reader(bytes, len);
	uint32_t magic = gr_read_u32(&r);
	uint32_t version, total, chunk_len, chunk;

	*json = (const char *)bytes;
	*json_len = len;
	if (!r.ok || magic != GLB_MAGIC)
		return GR_OK;
	version = gr_read_u32(&r);
	total = gr_read_u32(&r);
	chunk_len = gr_read_u32(&r);
	chunk = gr_read_u32(&r);
	if (!r.ok)
		return fault(g, NULL, "cut off: a GLB header has 20 bytes");
	if (version != 2)
		return fault(g, NULL, "GLB of another version; glTF 2.0 is read");
	if (total > len) {
		gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, NULL,
			    "cut off: its header says %u bytes, the file has %zu", total, len);
		return GR_ERR_CONFIG;
	}
	*json = (const char *)gr_read_bytes(&r, chunk_len);
	*json_len = chunk_len;
	if (!*json || chunk != GLB_JSON)
		return fault(g, NULL, "the GLB's first chunk is not whole JSON");
	if (gr_reader_left(&r) == 0)
		return GR_OK;
	chunk_len = gr_read_u32(&r);
	chunk = gr_read_u32(&r);
	if (!gr_read_bytes(&r, chunk_len))
		return fault(g, NULL, "cut off: the GLB's second chunk is not whole");
	g->binary_len = chunk == GLB_BIN ? chunk_len : 0;
	return GR_OK;
}

static int parse(struct gltf *g, const char *json, size_t len)
{
	struct json_tokener *tokener = json_tokener_new();

	if (!tokener)
		return GR_ERR_NOMEM;
	g->root = json_tokener_parse_ex(tokener, json, (int)len);
	if (!g->root) {
		gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, NULL,
			    "not JSON from byte %zu on: %s", json_tokener_get_parse_end(tokener),
			    json_tokener_get_error(tokener) == json_tokener_continue
				    ? "it ends too early"
				    : json_tokener_error_desc(json_tokener_get_error(tokener)));
		json_tokener_free(tokener);
		return GR_ERR_CONFIG;
	}
	json_tokener_free(tokener);
	if (!json_object_is_type(g->root, json_type_object))
		return fault(g, NULL, "not a glTF file: no JSON object");
	return GR_OK;
}

/* Extensions that a file requires and that change its geometry cannot be ignored. */
static int check_extensions(const struct gltf *g)
{
	static const char *const known[] = {
		"KHR_materials_specular", "KHR_materials_ior", "KHR_materials_emissive_strength",
		"KHR_lights_punctual",    "KHR_materials_unlit",
	};
	size_t count;
	struct json_object *required = list(g, "extensionsRequired", &count);
	int result = GR_OK;

	for (size_t i = 0; i < count; i++) {
		const char *name = json_object_get_string(json_object_array_get_idx(required, i));
		bool found = false;

		for (size_t k = 0; k < sizeof known / sizeof known[0] && name; k++)
			found = found || strcmp(name, known[k]) == 0;
		if (!found) {
			gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, "extensionsRequired",
				    "%s is not supported; export without it", name ? name : "null");
			result = GR_ERR_CONFIG;
		}
	}
	return result;
}

/* assimp's own words do not name the file. */
static int check_companion(const struct gltf *g, const char *uri, size_t len)
{
	struct stat status;
	char *path;
	int result = GR_OK;

	if (strncmp(uri, "data:", 5) == 0)
		return GR_OK;
	path = import_beside(g->path, uri);
	if (!path)
		return GR_ERR_NOMEM;
	if (stat(path, &status) != 0) {
		gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, "buffers", "%s: %s", path,
			    strerror(errno));
		result = GR_ERR_CONFIG;
	} else if (!S_ISREG(status.st_mode) || (uint64_t)status.st_size < len) {
		gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, "buffers",
			    "%s is cut off: %zu bytes are needed, it has %lld", path, len,
			    (long long)status.st_size);
		result = GR_ERR_CONFIG;
	}
	free(path);
	return result;
}

static int check_buffers(const struct gltf *g)
{
	size_t buffers, views;
	struct json_object *buffer_list = list(g, "buffers", &buffers);
	struct json_object *view_list = list(g, "bufferViews", &views);

	for (size_t i = 0; i < buffers; i++) {
		struct json_object *buffer = json_object_array_get_idx(buffer_list, i), *uri;
		int64_t len = whole(buffer, "byteLength", -1);
		int result;

		if (len < 0 || (uint64_t)len > IMPORT_MAX_FILE)
			return fault(g, "buffers", "byteLength is missing or out of range");
		uri = member(buffer, "uri");
		if (!uri && (uint64_t)len > g->binary_len)
			return fault(g, "buffers", "the GLB's binary chunk is shorter than its byteLength");
		result = uri ? check_companion(g, json_object_get_string(uri), (size_t)len) : GR_OK;
		if (result != GR_OK)
			return result;
	}
	for (size_t i = 0; i < views; i++) {
		struct json_object *view = json_object_array_get_idx(view_list, i);
		int64_t buffer = whole(view, "buffer", -1);
		int64_t at = whole(view, "byteOffset", 0);
		int64_t len = whole(view, "byteLength", -1);

		if (buffer < 0 || (size_t)buffer >= buffers || at < 0 || len < 1)
			return fault(g, "bufferViews", "buffer, byteOffset or byteLength is wrong");
		if (at + len > whole(json_object_array_get_idx(buffer_list, (size_t)buffer),
				     "byteLength", 0))
			return fault(g, "bufferViews", "a view reaches beyond its buffer");
	}
	return GR_OK;
}

static int64_t component_size(int64_t type)
{
	switch (type) {
	case 5120: /* BYTE, UNSIGNED_BYTE */
	case 5121:
		return 1;
	case 5122: /* SHORT, UNSIGNED_SHORT */
	case 5123:
		return 2;
	case 5125: /* UNSIGNED_INT, FLOAT */
	case 5126:
		return 4;
	default:
		return 0;
	}
}

static int64_t component_count(struct json_object *accessor)
{
	static const struct {
		const char *name;
		int64_t count;
	} types[] = {
		{ "SCALAR", 1 }, { "VEC2", 2 }, { "VEC3", 3 }, { "VEC4", 4 },
		{ "MAT2", 4 },   { "MAT3", 9 }, { "MAT4", 16 },
	};
	struct json_object *type = member(accessor, "type");
	const char *name = type ? json_object_get_string(type) : NULL;

	for (size_t i = 0; i < sizeof types / sizeof types[0] && name; i++) {
		if (strcmp(name, types[i].name) == 0)
			return types[i].count;
	}
	return 0;
}

static int check_accessors(const struct gltf *g)
{
	size_t accessors, views;
	struct json_object *accessor_list = list(g, "accessors", &accessors);
	struct json_object *view_list = list(g, "bufferViews", &views);

	for (size_t i = 0; i < accessors; i++) {
		struct json_object *accessor = json_object_array_get_idx(accessor_list, i);
		int64_t count = whole(accessor, "count", -1);
		int64_t at = whole(accessor, "byteOffset", 0);
		int64_t item = component_size(whole(accessor, "componentType", -1)) *
			       component_count(accessor);
		int64_t view_index = whole(accessor, "bufferView", -1);
		struct json_object *view;
		int64_t stride;

		if (count < 1 || (uint64_t)count > IMPORT_MAX_INDICES || at < 0 || item < 1)
			return fault(g, "accessors", "count, type or byteOffset is wrong or too large");
		if (member(accessor, "sparse"))
			return fault(g, "accessors", "sparse accessors are not supported; export without");
		if (view_index < 0 || (size_t)view_index >= views)
			return fault(g, "accessors", "bufferView is missing or does not exist");
		view = json_object_array_get_idx(view_list, (size_t)view_index);
		stride = whole(view, "byteStride", item);
		if (stride < item || stride > 252 + item)
			return fault(g, "bufferViews", "byteStride is smaller than an element, or too large");
		if (at + (count - 1) * stride + item > whole(view, "byteLength", 0))
			return fault(g, "accessors", "an accessor reaches beyond its view");
	}
	return GR_OK;
}

static bool attribute_ok(struct json_object *accessors, size_t count, struct json_object *attributes,
			 const char *name, const char *type, int64_t vertices)
{
	struct json_object *accessor, *given;

	if (!member(attributes, name))
		return true;
	if (!is_index(attributes, name, count))
		return false;
	accessor = json_object_array_get_idx(accessors, (size_t)whole(attributes, name, 0));
	given = member(accessor, "type");
	return given && strcmp(json_object_get_string(given), type) == 0 &&
	       whole(accessor, "count", -1) == vertices;
}

/* 4 is a list, 5 a strip, 6 a fan of triangles; points and lines have none. */
static size_t triangle_count(int64_t mode, int64_t corners)
{
	if (mode == 4)
		return (size_t)corners / 3;
	return (mode == 5 || mode == 6) && corners > 2 ? (size_t)corners - 2 : 0;
}

static int check_primitive(struct gltf *g, struct json_object *primitive,
			   struct json_object *accessors, size_t count, size_t materials)
{
	struct json_object *attributes = member(primitive, "attributes");
	int64_t position = whole(attributes, "POSITION", -1);
	int64_t vertices;
	struct json_object *accessor;

	if (position < 0 || (size_t)position >= count)
		return fault(g, "meshes", "a primitive has no POSITION");
	accessor = json_object_array_get_idx(accessors, (size_t)position);
	vertices = whole(accessor, "count", -1);
	if (whole(accessor, "componentType", -1) != 5126)
		return fault(g, "meshes", "POSITION must be of floats");
	if (!attribute_ok(accessors, count, attributes, "POSITION", "VEC3", vertices) ||
	    !attribute_ok(accessors, count, attributes, "NORMAL", "VEC3", vertices) ||
	    !attribute_ok(accessors, count, attributes, "TANGENT", "VEC4", vertices) ||
	    !attribute_ok(accessors, count, attributes, "TEXCOORD_0", "VEC2", vertices) ||
	    !attribute_ok(accessors, count, attributes, "TEXCOORD_1", "VEC2", vertices))
		return fault(g, "meshes", "an attribute is of another type or length than POSITION");
	if (!is_index(primitive, "indices", count) || !is_index(primitive, "material", materials))
		return fault(g, "meshes", "indices or material do not exist");
	if (member(primitive, "indices"))
		accessor = json_object_array_get_idx(accessors, (size_t)whole(primitive, "indices", 0));
	g->triangles += triangle_count(whole(primitive, "mode", 4), whole(accessor, "count", 0));
	return GR_OK;
}

static int check_meshes(struct gltf *g)
{
	size_t meshes, accessors, materials;
	struct json_object *mesh_list = list(g, "meshes", &meshes);
	struct json_object *accessor_list = list(g, "accessors", &accessors);
	int result = GR_OK;

	list(g, "materials", &materials);
	for (size_t i = 0; i < meshes && result == GR_OK; i++) {
		struct json_object *primitives =
			member(json_object_array_get_idx(mesh_list, i), "primitives");

		if (!json_object_is_type(primitives, json_type_array))
			return fault(g, "meshes", "a mesh has no primitives");
		for (size_t k = 0; k < json_object_array_length(primitives) && result == GR_OK; k++)
			result = check_primitive(g, json_object_array_get_idx(primitives, k),
						 accessor_list, accessors, materials);
	}
	return result;
}

/*
 * A node has one parent at most and is not below itself: then walking down ends
 * after at most all nodes. Depths are found by going up, without recursion.
 */
static int check_parents(const struct gltf *g, const int64_t *parents, size_t nodes)
{
	for (size_t i = 0; i < nodes; i++) {
		size_t depth = 0;

		for (int64_t at = parents[i]; at >= 0; at = parents[at]) {
			if (++depth > IMPORT_MAX_DEPTH)
				return fault(g, "nodes", "nodes contain themselves, or are nested too deeply");
		}
	}
	return GR_OK;
}

static int check_nodes(const struct gltf *g)
{
	size_t nodes, meshes;
	struct json_object *node_list = list(g, "nodes", &nodes);
	int64_t *parents;
	int result = GR_OK;

	list(g, "meshes", &meshes);
	if (nodes > IMPORT_MAX_NODES)
		return fault(g, "nodes", "too many nodes");
	parents = malloc((nodes ? nodes : 1) * sizeof *parents);
	if (!parents)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < nodes; i++)
		parents[i] = -1;
	for (size_t i = 0; i < nodes && result == GR_OK; i++) {
		struct json_object *node = json_object_array_get_idx(node_list, i);
		struct json_object *children = member(node, "children");
		size_t count = json_object_is_type(children, json_type_array)
				       ? json_object_array_length(children)
				       : 0;

		if (!is_index(node, "mesh", meshes))
			result = fault(g, "nodes", "a node's mesh does not exist");
		for (size_t k = 0; k < count && result == GR_OK; k++) {
			int64_t child = json_object_get_int64(json_object_array_get_idx(children, k));

			if (child < 0 || (size_t)child >= nodes)
				result = fault(g, "nodes", "a node's child does not exist");
			else if (parents[child] >= 0 || (size_t)child == i)
				result = fault(g, "nodes", "a node has two parents, or is its own");
			else
				parents[child] = (int64_t)i;
		}
	}
	if (result == GR_OK)
		result = check_parents(g, parents, nodes);
	free(parents);
	return result;
}

static float number(struct json_object *object, const char *key, float missing)
{
	struct json_object *value = member(object, key);

	if (!value)
		return missing;
	/* Not a number: NaN, which the material's own check names and refuses. */
	if (!json_object_is_type(value, json_type_int) &&
	    !json_object_is_type(value, json_type_double))
		return NAN;
	return (float)json_object_get_double(value);
}

static void read_material(struct json_object *material, struct gltf_material *out)
{
	struct json_object *extensions = member(material, "extensions");
	struct json_object *specular = member(extensions, "KHR_materials_specular");
	struct json_object *color = member(specular, "specularColorFactor");

	out->emissive_strength = number(member(extensions, "KHR_materials_emissive_strength"),
					"emissiveStrength", 1.0f);
	out->ior = number(member(extensions, "KHR_materials_ior"), "ior", 1.5f);
	out->specular_factor = number(specular, "specularFactor", 1.0f);
	for (size_t i = 0; i < 3; i++) {
		out->specular_color[i] = 1.0f;
		if (json_object_is_type(color, json_type_array) &&
		    json_object_array_length(color) == 3)
			out->specular_color[i] = (float)json_object_get_double(
				json_object_array_get_idx(color, i));
	}
}

static int read_materials(const struct gltf *g, struct gltf_extra *out)
{
	size_t count;
	struct json_object *materials = list(g, "materials", &count);

	if (count > IMPORT_MAX_MATERIALS)
		return fault(g, "materials", "too many materials");
	if (count == 0)
		return GR_OK;
	out->materials = calloc(count, sizeof out->materials[0]);
	if (!out->materials)
		return GR_ERR_NOMEM;
	out->material_count = count;
	for (size_t i = 0; i < count; i++)
		read_material(json_object_array_get_idx(materials, i), &out->materials[i]);
	return GR_OK;
}

int gltf_read(const uint8_t *bytes, size_t len, const char *path, struct gltf_extra *out,
	      struct gr_diag *diag)
{
	struct gltf g = { .path = path, .diag = diag };
	const char *json;
	size_t json_len;
	int result;

	memset(out, 0, sizeof *out);
	result = find_json(&g, bytes, len, &json, &json_len);
	if (result == GR_OK)
		result = parse(&g, json, json_len);
	if (result == GR_OK)
		result = check_extensions(&g);
	if (result == GR_OK)
		result = check_buffers(&g);
	if (result == GR_OK)
		result = check_accessors(&g);
	if (result == GR_OK)
		result = check_meshes(&g);
	if (result == GR_OK)
		result = check_nodes(&g);
	if (result == GR_OK)
		result = read_materials(&g, out);
	out->triangles = g.triangles;
	if (g.root)
		json_object_put(g.root);
	return result;
}

void gltf_finish(struct gltf_extra *extra)
{
	free(extra->materials);
	memset(extra, 0, sizeof *extra);
}
