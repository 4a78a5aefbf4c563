/* Builds small GLB files in memory for the import tests. */
#ifndef GROTTO_TESTS_GLB_H
#define GROTTO_TESTS_GLB_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static inline void glb_u32(uint8_t *at, uint32_t v)
{
	at[0] = (uint8_t)v;
	at[1] = (uint8_t)(v >> 8);
	at[2] = (uint8_t)(v >> 16);
	at[3] = (uint8_t)(v >> 24);
}

/* Header, JSON chunk padded by blanks, BIN chunk padded by zeroes. Caller frees. */
static inline uint8_t *glb_pack(const char *json, const void *binary, size_t binary_len,
				size_t *out_len)
{
	size_t text = strlen(json), text_padded = (text + 3) / 4 * 4;
	size_t binary_padded = (binary_len + 3) / 4 * 4;
	size_t len = 12 + 8 + text_padded + 8 + binary_padded;
	uint8_t *bytes = calloc(1, len);

	if (!bytes)
		abort();
	memcpy(bytes, "glTF", 4);
	glb_u32(bytes + 4, 2);
	glb_u32(bytes + 8, (uint32_t)len);
	glb_u32(bytes + 12, (uint32_t)text_padded);
	memcpy(bytes + 16, "JSON", 4);
	memset(bytes + 20, ' ', text_padded);
	memcpy(bytes + 20, json, text);
	glb_u32(bytes + 20 + text_padded, (uint32_t)binary_padded);
	memcpy(bytes + 24 + text_padded, "BIN\0", 4);
	memcpy(bytes + 28 + text_padded, binary, binary_len);
	*out_len = len;
	return bytes;
}

/* Four corners and two triangles; the tests spoil some of it. */
struct glb_quad {
	float positions[4][3];
	float uvs[4][2];
	uint16_t indices[6];
	uint16_t padding[2];
};

#define GLB_QUAD                                                                                  \
	{ { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 } },                                 \
	  { { 0, 1 }, { 1, 1 }, { 1, 0 }, { 0, 0 } },                                             \
	  { 0, 1, 2, 0, 2, 3 },                                                                   \
	  { 0 } }

/* `node` and `material` are members of those objects, `more` of the root (", \"x\": ..." or ""). */
static inline uint8_t *glb_of_quad(const struct glb_quad *quad, const char *node,
				   const char *material, const char *more, size_t *out_len)
{
	char json[4096];

	snprintf(json, sizeof json,
		 "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
		 "\"nodes\":[{\"mesh\":0%s}],"
		 "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},"
		 "\"indices\":2,\"material\":0}]}],"
		 "\"materials\":[{\"name\":\"m\"%s}],"
		 "\"accessors\":["
		 "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\","
		 "\"min\":[0,0,0],\"max\":[1,1,0]},"
		 "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
		 "{\"bufferView\":2,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}],"
		 "\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48},"
		 "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":32},"
		 "{\"buffer\":0,\"byteOffset\":80,\"byteLength\":12}],"
		 "\"buffers\":[{\"byteLength\":96}]%s}",
		 node, material, more);
	return glb_pack(json, quad, sizeof *quad, out_len);
}

#endif
