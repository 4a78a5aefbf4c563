/* All that a glTF model names, as one GLB in memory: nothing is left to open or to decode. */
#include "renderer/scene/gltf.h"

#include "base/cursor.h"
#include "base/result.h"
#include "renderer/image/read_file.h"
#include "renderer/scene/import.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

struct pack {
	const struct gltf *g;
	uint8_t *bytes;
	size_t len, size;
};

/* 4-aligned, as accessors want to be. */
static int append(struct pack *p, const uint8_t *bytes, size_t len, size_t *at)
{
	size_t padded;

	*at = p->len;
	if (len == 0)
		return GR_OK;
	if (!bytes)
		return GR_ERR_STATE;
	padded = len > IMPORT_MAX_FILE ? len : (len + 3) / 4 * 4;
	if (padded > IMPORT_MAX_FILE - p->len)
		return gltf_fault(p->g, "buffers", "all buffers together are too large");
	if (!p->bytes || padded > p->size - p->len) {
		size_t size = p->len + padded > 2 * p->size ? p->len + padded : 2 * p->size;
		uint8_t *grown = realloc(p->bytes, size);

		if (!grown)
			return GR_ERR_NOMEM;
		p->bytes = grown;
		p->size = size;
	}
	memcpy(p->bytes + p->len, bytes, len);
	memset(p->bytes + p->len + len, 0, padded - len);
	p->len += padded;
	return GR_OK;
}

/* data:[type];base64,... (RFC 2397); the caller frees. */
static int decode_data(const struct gltf *g, const char *key, const char *uri, uint8_t **out,
		       size_t *out_len)
{
	static const char mark[] = ";base64";
	const char *comma = strchr(uri, ',');
	size_t len;

	if (!comma || (size_t)(comma - uri) < sizeof mark - 1 ||
	    memcmp(comma - (sizeof mark - 1), mark, sizeof mark - 1) != 0)
		return gltf_fault(g, key, "a data: URI must be in base64");
	len = strlen(comma + 1);
	*out = malloc(len / 4 * 3 + 4);
	if (!*out)
		return GR_ERR_NOMEM;
	if (sodium_base642bin(*out, len / 4 * 3 + 4, comma + 1, len, "\r\n", out_len, NULL,
			      sodium_base64_VARIANT_ORIGINAL) == 0 && *out_len > 0)
		return GR_OK;
	free(*out);
	*out = NULL;
	return gltf_fault(g, key, "a data: URI is no proper base64, or empty");
}

static int read_companion(const struct gltf *g, const char *uri, uint8_t **out, size_t *out_len)
{
	char *path = import_beside(g->path, uri);
	int result;

	if (!path)
		return GR_ERR_NOMEM;
	result = read_file(path, IMPORT_MAX_FILE, out, out_len, g->diag, "buffer of a model");
	free(path);
	return result;
}

static int pack_buffer(struct pack *p, struct json_object *buffer, size_t index, size_t *at)
{
	struct json_object *uri = gltf_member(buffer, "uri");
	size_t need = (size_t)gltf_whole(buffer, "byteLength", 0), len = 0;
	const char *name = uri ? json_object_get_string(uri) : NULL;
	uint8_t *bytes = NULL;
	int result = GR_OK;

	if (!name) {
		if (index > 0 || !p->g->binary || need > p->g->binary_len)
			return gltf_fault(p->g, "buffers",
					  "the GLB's binary chunk is shorter than its byteLength");
		return append(p, p->g->binary, need, at);
	}
	if (strncmp(name, "data:", 5) == 0)
		result = decode_data(p->g, "buffers", name, &bytes, &len);
	else
		result = read_companion(p->g, name, &bytes, &len);
	if (result != GR_OK)
		return result;
	if (len < need) {
		gr_diag_add(p->g->diag, GR_DIAG_ERROR, p->g->path, 0, "buffers",
			    "%.64s is cut off: %zu bytes are needed, it has %zu", name, need, len);
		result = GR_ERR_CONFIG;
	} else {
		result = append(p, bytes, need, at);
	}
	free(bytes);
	return result;
}

static int set_whole(struct json_object *object, const char *key, size_t value)
{
	struct json_object *number = json_object_new_int64((int64_t)value);

	return number && json_object_object_add(object, key, number) == 0 ? GR_OK : GR_ERR_NOMEM;
}

static int move_views(const struct gltf *g, const size_t *starts)
{
	size_t views, buffers;
	struct json_object *view_list = gltf_list(g, "bufferViews", &views);
	struct json_object *buffer_list = gltf_list(g, "buffers", &buffers);
	int result = GR_OK;

	for (size_t i = 0; i < views && result == GR_OK; i++) {
		struct json_object *view = json_object_array_get_idx(view_list, i);
		size_t buffer = (size_t)gltf_whole(view, "buffer", 0);
		size_t at = (size_t)gltf_whole(view, "byteOffset", 0);
		size_t len = (size_t)gltf_whole(view, "byteLength", 0);

		if (at + len > (size_t)gltf_whole(json_object_array_get_idx(buffer_list, buffer),
						  "byteLength", 0))
			return gltf_fault(g, "bufferViews", "a view reaches beyond its buffer");
		result = set_whole(view, "byteOffset", at + starts[buffer]);
		if (result == GR_OK)
			result = set_whole(view, "buffer", 0);
	}
	return result;
}

static int add_view(const struct gltf *g, size_t at, size_t len, size_t *index)
{
	struct json_object *view = json_object_new_object();
	struct json_object *views = gltf_list(g, "bufferViews", index);

	if (!views) {
		views = json_object_new_array();
		if (views)
			json_object_object_add(g->root, "bufferViews", views);
	}
	if (!view || !views || json_object_array_add(views, view) != 0) {
		json_object_put(view);
		return GR_ERR_NOMEM;
	}
	if (set_whole(view, "buffer", 0) != GR_OK || set_whole(view, "byteOffset", at) != GR_OK)
		return GR_ERR_NOMEM;
	return set_whole(view, "byteLength", len);
}

/* assimp wants one for what is inside; PNG or JPEG is seen by the bytes. */
static int set_type(struct json_object *image)
{
	struct json_object *type = json_object_new_string("image/png");

	return type && json_object_object_add(image, "mimeType", type) == 0 ? GR_OK : GR_ERR_NOMEM;
}

/* Images of data: URIs become views, as those that are inside already. */
static int pack_image(struct pack *p, struct json_object *image)
{
	struct json_object *uri = gltf_member(image, "uri");
	bool inside = gltf_member(image, "bufferView") != NULL;
	uint8_t *bytes = NULL;
	size_t len = 0, at, view = 0;
	int result;

	json_object_object_del(image, "mimeType");
	if (inside == (uri != NULL))
		return gltf_fault(p->g, "images", "an image must have either a uri or a bufferView");
	if (inside)
		return set_type(image);
	if (strncmp(json_object_get_string(uri), "data:", 5) != 0)
		return GR_OK;
	result = decode_data(p->g, "images", json_object_get_string(uri), &bytes, &len);
	if (result != GR_OK)
		return result;
	result = append(p, bytes, len, &at);
	free(bytes);
	if (result == GR_OK)
		result = add_view(p->g, at, len, &view);
	if (result == GR_OK)
		result = set_whole(image, "bufferView", view);
	json_object_object_del(image, "uri");
	return result == GR_OK ? set_type(image) : result;
}

static int pack_all(struct pack *p)
{
	size_t buffers, images;
	struct json_object *buffer_list = gltf_list(p->g, "buffers", &buffers);
	struct json_object *image_list = gltf_list(p->g, "images", &images);
	size_t *starts = calloc(buffers + 1, sizeof *starts);
	int result = starts ? GR_OK : GR_ERR_NOMEM;

	for (size_t i = 0; i < buffers && result == GR_OK; i++)
		result = pack_buffer(p, json_object_array_get_idx(buffer_list, i), i, &starts[i]);
	if (result == GR_OK)
		result = move_views(p->g, starts);
	for (size_t i = 0; i < images && result == GR_OK; i++)
		result = pack_image(p, json_object_array_get_idx(image_list, i));
	free(starts);
	return result;
}

/* The tree's `buffers` becomes the one that was packed. */
static int one_buffer(const struct pack *p)
{
	struct json_object *list, *buffer;

	json_object_object_del(p->g->root, "buffers");
	if (p->len == 0)
		return GR_OK;
	list = json_object_new_array();
	buffer = json_object_new_object();
	if (!list || !buffer || json_object_array_add(list, buffer) != 0) {
		json_object_put(list);
		json_object_put(buffer);
		return GR_ERR_NOMEM;
	}
	json_object_object_add(p->g->root, "buffers", list);
	return set_whole(buffer, "byteLength", p->len);
}

/* GLB, glTF 2.0 section 4.4. */
static int write_glb(const struct pack *p, uint8_t **out, size_t *out_len)
{
	size_t text_len, padded, len;
	const char *text = json_object_to_json_string_length(
		p->g->root, JSON_C_TO_STRING_PLAIN | JSON_C_TO_STRING_NOSLASHESCAPE, &text_len);
	struct gr_writer w;

	if (!text)
		return GR_ERR_NOMEM;
	padded = (text_len + 3) / 4 * 4;
	len = 20 + padded + (p->len ? 8 + p->len : 0);
	*out = malloc(len);
	if (!*out)
		return GR_ERR_NOMEM;
	w = gr_writer(*out, len);
	gr_write_bytes(&w, "glTF", 4);
	gr_write_u32(&w, 2);
	gr_write_u32(&w, (uint32_t)len);
	gr_write_u32(&w, (uint32_t)padded);
	gr_write_bytes(&w, "JSON", 4);
	gr_write_bytes(&w, text, text_len);
	gr_write_bytes(&w, "   ", padded - text_len);
	if (p->len) {
		gr_write_u32(&w, (uint32_t)p->len);
		gr_write_bytes(&w, "BIN", 4);
		gr_write_bytes(&w, p->bytes, p->len);
	}
	*out_len = len;
	return GR_OK;
}

int gltf_pack(const struct gltf *g, uint8_t **out, size_t *out_len)
{
	struct pack p = { .g = g };
	int result = pack_all(&p);

	if (result == GR_OK)
		result = one_buffer(&p);
	if (result == GR_OK)
		result = write_glb(&p, out, out_len);
	free(p.bytes);
	return result;
}
