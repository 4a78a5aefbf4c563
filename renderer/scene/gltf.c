/*
 * The check of a glTF 2.0 file, and what it says beside assimp. assimp 5.2 takes
 * strings, lengths and references on trust and node hierarchies to end, and does
 * not know KHR_materials_emissive_strength and _specular: they are read here.
 */
#include "renderer/scene/gltf.h"
#include "renderer/scene/import.h"

#include "base/cursor.h"
#include "base/result.h"

#include <json-c/json.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define GLB_MAGIC 0x46546c67u
#define GLB_JSON 0x4e4f534au
#define GLB_BIN 0x004e4942u

bool gltf_is_name(const char *name)
{
	const char *dot = strrchr(name, '.');

	return dot && (strcasecmp(dot, ".gltf") == 0 || strcasecmp(dot, ".glb") == 0);
}

int gltf_fault(const struct gltf *g, const char *key, const char *text)
{
	gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, key, "%s", text);
	return GR_ERR_CONFIG;
}

struct json_object *gltf_list(const struct gltf *g, const char *key, size_t *count)
{
	struct json_object *array = NULL;

	*count = 0;
	if (!json_object_object_get_ex(g->root, key, &array) ||
	    !json_object_is_type(array, json_type_array))
		return NULL;
	*count = json_object_array_length(array);
	return array;
}

struct json_object *gltf_member(struct json_object *object, const char *key)
{
	struct json_object *value = NULL;

	if (!json_object_is_type(object, json_type_object))
		return NULL;
	json_object_object_get_ex(object, key, &value);
	return value;
}

int64_t gltf_whole(struct json_object *object, const char *key, int64_t missing)
{
	struct json_object *value = gltf_member(object, key);
	double number;

	if (!value)
		return missing;
	if (!json_object_is_type(value, json_type_int) &&
	    !json_object_is_type(value, json_type_double))
		return -1;
	number = json_object_get_double(value);
	return number >= 0 && number <= 0x1p53 && number == floor(number) ? (int64_t)number : -1;
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
		return gltf_fault(g, NULL, "cut off: a GLB header has 20 bytes");
	if (version != 2)
		return gltf_fault(g, NULL, "GLB of another version; glTF 2.0 is read");
	if (total > len) {
		gr_diag_add(g->diag, GR_DIAG_ERROR, g->path, 0, NULL,
			    "cut off: its header says %u bytes, the file has %zu", total, len);
		return GR_ERR_CONFIG;
	}
	*json = (const char *)gr_read_bytes(&r, chunk_len);
	*json_len = chunk_len;
	if (!*json || chunk != GLB_JSON)
		return gltf_fault(g, NULL, "the GLB's first chunk is not whole JSON");
	if (gr_reader_left(&r) == 0)
		return GR_OK;
	chunk_len = gr_read_u32(&r);
	chunk = gr_read_u32(&r);
	g->binary = gr_read_bytes(&r, chunk_len);
	if (!g->binary)
		return gltf_fault(g, NULL, "cut off: the GLB's second chunk is not whole");
	g->binary_len = chunk == GLB_BIN ? chunk_len : 0;
	return GR_OK;
}

static int parse(struct gltf *g, const char *json, size_t len)
{
	struct json_tokener *tokener = json_tokener_new();

	if (!tokener)
		return GR_ERR_NOMEM;
	json_tokener_set_flags(tokener, JSON_TOKENER_STRICT);
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
		return gltf_fault(g, NULL, "not a glTF file: no JSON object");
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
	struct json_object *required = gltf_list(g, "extensionsRequired", &count);
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
	struct json_object *type = gltf_member(accessor, "type");
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
	struct json_object *accessor_list = gltf_list(g, "accessors", &accessors);
	struct json_object *view_list = gltf_list(g, "bufferViews", &views);

	for (size_t i = 0; i < accessors; i++) {
		struct json_object *accessor = json_object_array_get_idx(accessor_list, i);
		int64_t count = gltf_whole(accessor, "count", -1);
		int64_t at = gltf_whole(accessor, "byteOffset", 0);
		int64_t item = component_size(gltf_whole(accessor, "componentType", -1)) *
			       component_count(accessor);
		int64_t view_index = gltf_whole(accessor, "bufferView", -1);
		struct json_object *view;
		int64_t stride;

		if (count < 1 || (uint64_t)count > IMPORT_MAX_INDICES || at < 0 || item < 1)
			return gltf_fault(g, "accessors", "count, type or byteOffset is wrong or too large");
		if (gltf_member(accessor, "sparse"))
			return gltf_fault(g, "accessors", "sparse accessors are not supported; export without");
		if (view_index < 0 || (size_t)view_index >= views)
			return gltf_fault(g, "accessors", "bufferView is missing or does not exist");
		view = json_object_array_get_idx(view_list, (size_t)view_index);
		stride = gltf_whole(view, "byteStride", item);
		if (stride < item || stride > 252 + item)
			return gltf_fault(g, "bufferViews", "byteStride is smaller than an element, or too large");
		if (at + (count - 1) * stride + item > gltf_whole(view, "byteLength", 0))
			return gltf_fault(g, "accessors", "an accessor reaches beyond its view");
	}
	return GR_OK;
}

/* Floats alone: assimp copies other components as if they were floats. */
static bool attribute_ok(struct json_object *accessors, struct json_object *attributes,
			 const char *name, const char *type, int64_t vertices)
{
	struct json_object *accessor, *given;

	if (!gltf_member(attributes, name))
		return true;
	accessor = json_object_array_get_idx(accessors, (size_t)gltf_whole(attributes, name, 0));
	given = gltf_member(accessor, "type");
	return given && strcmp(json_object_get_string(given), type) == 0 &&
	       gltf_whole(accessor, "componentType", -1) == 5126 &&
	       gltf_whole(accessor, "count", -1) == vertices;
}

/* Of unsigned numbers, one a corner. */
static bool indices_ok(struct json_object *accessor)
{
	int64_t type = gltf_whole(accessor, "componentType", -1);

	return component_count(accessor) == 1 && (type == 5121 || type == 5123 || type == 5125);
}

/* 4 is a list, 5 a strip, 6 a fan of triangles; points and lines have none. */
static size_t triangle_count(int64_t mode, int64_t corners)
{
	if (mode == 4)
		return (size_t)corners / 3;
	return (mode == 5 || mode == 6) && corners > 2 ? (size_t)corners - 2 : 0;
}

static int check_primitive(struct gltf *g, struct json_object *primitive,
			   struct json_object *accessors)
{
	/* points, lines, loop, strip; triangles, strip, fan: assimp counts on one of them */
	static const int64_t least[] = { 1, 2, 2, 2, 3, 3, 3 };
	struct json_object *attributes = gltf_member(primitive, "attributes");
	int64_t mode = gltf_whole(primitive, "mode", 4), corners;
	struct json_object *accessor = json_object_array_get_idx(
		accessors, (size_t)gltf_whole(attributes, "POSITION", 0));
	int64_t vertices = gltf_whole(accessor, "count", 0);

	if (mode < 0 || mode >= (int64_t)(sizeof least / sizeof *least))
		return gltf_fault(g, "meshes", "a primitive's mode must be 0 to 6");
	if (!attribute_ok(accessors, attributes, "POSITION", "VEC3", vertices) ||
	    !attribute_ok(accessors, attributes, "NORMAL", "VEC3", vertices) ||
	    !attribute_ok(accessors, attributes, "TEXCOORD_0", "VEC2", vertices))
		return gltf_fault(g, "meshes", "POSITION, NORMAL and TEXCOORD_0 must be vectors of "
					       "floats, of 3, 3 and 2, as many of each");
	if (gltf_member(primitive, "indices")) {
		accessor = json_object_array_get_idx(accessors,
						     (size_t)gltf_whole(primitive, "indices", 0));
		if (!indices_ok(accessor))
			return gltf_fault(g, "meshes", "indices must be unsigned numbers");
	}
	corners = gltf_whole(accessor, "count", 0);
	if (corners < least[mode])
		return gltf_fault(g, "meshes", "a primitive has too few corners for its mode");
	g->triangles += triangle_count(mode, corners);
	return GR_OK;
}

static int check_meshes(struct gltf *g)
{
	size_t meshes, accessors;
	struct json_object *mesh_list = gltf_list(g, "meshes", &meshes);
	struct json_object *accessor_list = gltf_list(g, "accessors", &accessors);
	int result = GR_OK;

	for (size_t i = 0; i < meshes && result == GR_OK; i++) {
		struct json_object *primitives =
			gltf_member(json_object_array_get_idx(mesh_list, i), "primitives");

		for (size_t k = 0; k < json_object_array_length(primitives) && result == GR_OK; k++)
			result = check_primitive(g, json_object_array_get_idx(primitives, k),
						 accessor_list);
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
				return gltf_fault(g, "nodes", "nodes contain themselves, or are nested too deeply");
		}
	}
	return GR_OK;
}

static int read_parents(const struct gltf *g, int64_t *parents)
{
	size_t nodes;
	struct json_object *node_list = gltf_list(g, "nodes", &nodes);

	for (size_t i = 0; i < nodes; i++) {
		struct json_object *children =
			gltf_member(json_object_array_get_idx(node_list, i), "children");
		size_t count = children ? json_object_array_length(children) : 0;

		for (size_t k = 0; k < count; k++) {
			int64_t child = json_object_get_int64(json_object_array_get_idx(children, k));

			if (parents[child] >= 0 || (size_t)child == i)
				return gltf_fault(g, "nodes", "a node has two parents, or is its own");
			parents[child] = (int64_t)i;
		}
	}
	return GR_OK;
}

/* Scenes begin at roots and name each once: else a short file unfolds into a huge tree. */
static int check_scenes(const struct gltf *g, int64_t *parents)
{
	size_t scenes;
	struct json_object *scene_list = gltf_list(g, "scenes", &scenes);

	for (size_t i = 0; i < scenes; i++) {
		struct json_object *nodes =
			gltf_member(json_object_array_get_idx(scene_list, i), "nodes");

		for (size_t k = 0; k < json_object_array_length(nodes); k++) {
			int64_t node = json_object_get_int64(json_object_array_get_idx(nodes, k));

			if (parents[node] >= 0 || parents[node] == -2 - (int64_t)i)
				return gltf_fault(g, "scenes",
						  "a scene's node is below another, or named twice");
			parents[node] = -2 - (int64_t)i; /* a mark; still no parent */
		}
	}
	return GR_OK;
}

static int check_nodes(const struct gltf *g)
{
	size_t nodes;
	int64_t *parents;
	int result;

	gltf_list(g, "nodes", &nodes);
	parents = malloc((nodes + 1) * sizeof *parents);
	if (!parents)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i <= nodes; i++)
		parents[i] = -1;
	result = read_parents(g, parents);
	if (result == GR_OK)
		result = check_parents(g, parents, nodes);
	if (result == GR_OK)
		result = check_scenes(g, parents);
	free(parents);
	return result;
}

static float number(struct json_object *object, const char *key, float missing)
{
	struct json_object *value = gltf_member(object, key);

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
	struct json_object *extensions = gltf_member(material, "extensions");
	struct json_object *specular = gltf_member(extensions, "KHR_materials_specular");
	struct json_object *color = gltf_member(specular, "specularColorFactor");

	out->emissive_strength = number(gltf_member(extensions, "KHR_materials_emissive_strength"),
					"emissiveStrength", 1.0f);
	out->ior = number(gltf_member(extensions, "KHR_materials_ior"), "ior", 1.5f);
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
	struct json_object *materials = gltf_list(g, "materials", &count);

	if (count > IMPORT_MAX_MATERIALS)
		return gltf_fault(g, "materials", "too many materials");
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
		result = read_materials(&g, out); /* before their extensions are gone */
	if (result == GR_OK)
		result = gltf_schema(&g);
	if (result == GR_OK)
		result = check_accessors(&g);
	if (result == GR_OK)
		result = check_meshes(&g);
	if (result == GR_OK)
		result = check_nodes(&g);
	if (result == GR_OK)
		result = gltf_pack(&g, &out->glb, &out->glb_len);
	out->triangles = g.triangles;
	if (g.root)
		json_object_put(g.root);
	return result;
}

void gltf_finish(struct gltf_extra *extra)
{
	free(extra->materials);
	free(extra->glb);
	memset(extra, 0, sizeof *extra);
}
