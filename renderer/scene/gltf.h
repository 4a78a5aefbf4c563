/*
 * Inside of the glTF check: the file on its way through parsing (gltf.c), types
 * and references (gltf_schema.c), lengths and meshes (gltf.c) and packing
 * (gltf_pack.c).
 */
#ifndef GROTTO_RENDERER_SCENE_GLTF_H
#define GROTTO_RENDERER_SCENE_GLTF_H

#include "base/diag.h"

#include <json-c/json.h>
#include <stddef.h>
#include <stdint.h>

struct gltf {
	const char *path;
	struct gr_diag *diag;
	struct json_object *root;
	const uint8_t *binary; /* the GLB's BIN chunk, NULL without one */
	size_t binary_len;
	size_t triangles;
};

/* A line in diag; GR_ERR_CONFIG. */
int gltf_fault(const struct gltf *g, const char *key, const char *text);
/* An array of the root, NULL when absent; *count 0 then. */
struct json_object *gltf_list(const struct gltf *g, const char *key, size_t *count);
struct json_object *gltf_member(struct json_object *object, const char *key);
/* A whole number of at least 0, `missing` when absent, -1 when it is something else. */
int64_t gltf_whole(struct json_object *object, const char *key, int64_t missing);

/*
 * Every value has its type and range, every reference points at something, and
 * what is not used (animations, skins, cameras, extensions, extras) is gone from
 * the tree. Two readers of JSON differ on doubled keys and 1.0 as an index: the
 * tree has neither.
 */
int gltf_schema(const struct gltf *g);
/*
 * The tree and all bytes that it names as one GLB with one buffer. Checks the
 * buffers, their companions, and the views; changes the tree.
 */
int gltf_pack(const struct gltf *g, uint8_t **out, size_t *out_len);

#endif
