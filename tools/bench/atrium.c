#include "tools/bench/atrium.h"

#include "base/result.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265f
#define COLUMNS 6 /* in each of two rows */
#define BAY 3.0f  /* metres from one to the next */
#define SIDE 8.0f /* across */
#define HIGH 4.0f
/* Squares of the finest grid that all parts have together, in squares of its side. */
#define SQUARES 58

enum { STONE, PLASTER, BRICK, MATERIALS };

struct part {
	void (*place)(const struct part *part, float u, float v, float out[3]);
	float at[3], size[3]; /* of the part; what they are is the place function's */
};

static void on_plane(const struct part *p, float u, float v, float out[3])
{
	/* size[0] along x, size[1] along z or, standing, along y; size[2]: the way it stands */
	out[0] = p->at[0] + u * p->size[0];
	out[1] = p->at[1] + (p->size[2] > 0 ? v * p->size[1] : 0);
	out[2] = p->at[2] + (p->size[2] > 0 ? 0 : v * p->size[1]);
}

static void on_end(const struct part *p, float u, float v, float out[3])
{
	out[0] = p->at[0];
	out[1] = p->at[1] + v * p->size[1];
	out[2] = p->at[2] + u * p->size[0];
}

static void on_column(const struct part *p, float u, float v, float out[3])
{
	float phi = -2 * PI * u;
	float radius = p->size[0] * (1 + 0.05f * cosf(12 * phi) + 0.3f * powf(fabsf(2 * v - 1), 12));

	out[0] = p->at[0] + radius * cosf(phi);
	out[1] = p->at[1] + v * p->size[1];
	out[2] = p->at[2] + radius * sinf(phi);
}

static void on_arch(const struct part *p, float u, float v, float out[3])
{
	float along = PI * v, around = 2 * PI * u;
	float ring = p->size[0] + p->size[1] * cosf(around);

	out[0] = p->at[0] - ring * cosf(along);
	out[1] = p->at[1] + ring * sinf(along);
	out[2] = p->at[2] + p->size[1] * sinf(around);
}

static void *must(void *p)
{
	if (!p)
		abort();
	return p;
}

/* nu x nv squares of a part, corners shared; its front is d/du x d/dv. */
static void add(struct scene *s, uint32_t material, const struct part *part, uint32_t nu, uint32_t nv)
{
	size_t first = s->vertex_count;
	struct scene_draw *draw;

	s->vertices = must(realloc(s->vertices,
				   (first + (size_t)(nu + 1) * (nv + 1)) * sizeof *s->vertices));
	s->indices = must(realloc(s->indices,
				  (s->index_count + 6 * (size_t)nu * nv) * sizeof *s->indices));
	s->draws = must(realloc(s->draws, (s->draw_count + 1) * sizeof *s->draws));
	for (uint32_t j = 0; j <= nv; j++)
		for (uint32_t i = 0; i <= nu; i++) {
			struct scene_vertex *v = &s->vertices[s->vertex_count++];
			float a = (float)i / (float)nu, b = (float)j / (float)nv, h = 1e-3f;
			float du[3], dv[3], length = 0;

			part->place(part, a, b, v->position);
			part->place(part, a + h, b, du);
			part->place(part, a, b + h, dv);
			for (int k = 0; k < 3; k++) {
				du[k] -= v->position[k];
				dv[k] -= v->position[k];
			}
			for (int k = 0; k < 3; k++) {
				v->normal[k] = du[(k + 1) % 3] * dv[(k + 2) % 3] -
					       du[(k + 2) % 3] * dv[(k + 1) % 3];
				length += v->normal[k] * v->normal[k];
			}
			for (int k = 0; k < 3; k++)
				v->normal[k] /= sqrtf(length);
			v->uv[0] = a;
			v->uv[1] = b;
		}
	draw = &s->draws[s->draw_count++];
	*draw = (struct scene_draw){ (uint32_t)s->index_count, 6 * nu * nv, material };
	for (uint32_t j = 0; j < nv; j++)
		for (uint32_t i = 0; i < nu; i++) {
			uint32_t a = (uint32_t)first + j * (nu + 1) + i, b = a + nu + 1;
			const uint32_t corners[6] = { a, a + 1, b + 1, a, b + 1, b };

			memcpy(s->indices + s->index_count, corners, sizeof corners);
			s->index_count += 6;
		}
}

static void add_materials(struct scene *s)
{
	static const float colours[MATERIALS][3] = { { 0.6f, 0.57f, 0.5f },
						     { 0.75f, 0.73f, 0.7f },
						     { 0.5f, 0.25f, 0.18f } };

	s->materials = must(calloc(MATERIALS, sizeof *s->materials));
	s->material_count = MATERIALS;
	for (int m = 0; m < MATERIALS; m++) {
		memcpy(s->materials[m].diffuse, colours[m], sizeof colours[m]);
		s->materials[m].diffuse_image = s->materials[m].emission_image = -1;
	}
}

struct scene *atrium_build(size_t triangles)
{
	const float length = BAY * (COLUMNS + 1);
	const struct part floor_ = { on_plane, { 0, 0, SIDE }, { length, -SIDE, 0 } };
	const struct part back = { on_plane, { 0, 0, 0 }, { length, 1.5f * HIGH, 1 } };
	const struct part front = { on_plane, { length, 0, SIDE }, { -length, 1.5f * HIGH, 1 } };
	const struct part left = { on_end, { 0, 0, SIDE }, { -SIDE, 1.5f * HIGH, 0 } };
	const struct part right = { on_end, { length, 0, 0 }, { SIDE, 1.5f * HIGH, 0 } };
	struct scene *s = must(calloc(1, sizeof *s));
	uint32_t n = (uint32_t)fmax(sqrt((double)triangles / (2 * SQUARES)), 4);

	add_materials(s);
	add(s, STONE, &floor_, 4 * n, 4 * n);
	for (int row = 0; row < 2; row++)
		for (int k = 0; k < COLUMNS; k++) {
			float x = BAY * (float)(k + 1), z = SIDE * (0.25f + 0.5f * (float)row);
			const struct part column = { on_column, { x, 0, z }, { 0.25f, HIGH, 0 } };
			const struct part arch = { on_arch, { x + 0.5f * BAY, HIGH, z },
						   { 0.5f * BAY, 0.2f, 0 } };

			add(s, STONE, &column, n, 2 * n);
			if (k + 1 < COLUMNS)
				add(s, STONE, &arch, n, n);
		}
	add(s, PLASTER, &back, 2 * n, n);
	add(s, PLASTER, &front, 2 * n, n);
	add(s, BRICK, &left, 2 * n, n);
	add(s, BRICK, &right, 2 * n, n);
	for (int k = 0; k < 3; k++) {
		s->min[k] = INFINITY;
		s->max[k] = -INFINITY;
		for (size_t i = 0; i < s->vertex_count; i++) {
			s->min[k] = fminf(s->min[k], s->vertices[i].position[k]);
			s->max[k] = fmaxf(s->max[k], s->vertices[i].position[k]);
		}
	}
	return s;
}

/* --- as a file --- */

static void print_materials(FILE *json, const struct scene *s)
{
	fprintf(json, "\"materials\":[");
	for (size_t m = 0; m < s->material_count; m++)
		fprintf(json,
			"%s{\"name\":\"m%zu\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[%g,%g,%g,1],"
			"\"metallicFactor\":0,\"roughnessFactor\":1}}",
			m ? "," : "", m, (double)s->materials[m].diffuse[0],
			(double)s->materials[m].diffuse[1], (double)s->materials[m].diffuse[2]);
	fprintf(json, "],");
}

/* One vertex buffer, one index buffer, a primitive for each draw. */
static void print_json(FILE *json, const struct scene *s)
{
	size_t vertices = s->vertex_count * sizeof *s->vertices, indices = s->index_count * 4;

	fprintf(json, "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
		      "\"nodes\":[{\"mesh\":0}],");
	print_materials(json, s);
	fprintf(json, "\"buffers\":[{\"byteLength\":%zu}],\"bufferViews\":["
		      "{\"buffer\":0,\"byteLength\":%zu,\"byteStride\":%zu},"
		      "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}],"
		      "\"accessors\":["
		      "{\"bufferView\":0,\"componentType\":5126,\"count\":%zu,\"type\":\"VEC3\","
		      "\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]},"
		      "{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5126,\"count\":%zu,\"type\":\"VEC3\"},"
		      "{\"bufferView\":0,\"byteOffset\":24,\"componentType\":5126,\"count\":%zu,\"type\":\"VEC2\"}",
		vertices + indices, vertices, sizeof *s->vertices, vertices, indices,
		s->vertex_count, (double)s->min[0], (double)s->min[1], (double)s->min[2],
		(double)s->max[0], (double)s->max[1], (double)s->max[2], s->vertex_count,
		s->vertex_count);
	for (size_t d = 0; d < s->draw_count; d++)
		fprintf(json, ",{\"bufferView\":1,\"byteOffset\":%zu,\"componentType\":5125,"
			      "\"count\":%u,\"type\":\"SCALAR\"}",
			4 * (size_t)s->draws[d].first_index, s->draws[d].index_count);
	fprintf(json, "],\"meshes\":[{\"primitives\":[");
	for (size_t d = 0; d < s->draw_count; d++)
		fprintf(json, "%s{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2},"
			      "\"indices\":%zu,\"material\":%u}",
			d ? "," : "", 3 + d, s->draws[d].material);
	fprintf(json, "]}]}");
}

int atrium_write(const struct scene *scene, const char *path)
{
	char *text = NULL;
	size_t text_len = 0, binary = scene->vertex_count * sizeof *scene->vertices +
				      scene->index_count * 4;
	FILE *json = must(open_memstream(&text, &text_len)), *file;
	bool ok;

	print_json(json, scene);
	fclose(json);
	size_t padded = (text_len + 3) / 4 * 4;
	const uint32_t head[5] = { 0x46546c67, 2, (uint32_t)(28 + padded + binary), (uint32_t)padded,
				   0x4e4f534a };
	const uint32_t second[2] = { (uint32_t)binary, 0x004e4942 };

	file = fopen(path, "wb");
	ok = file && fwrite(head, sizeof head, 1, file) == 1 &&
	     fwrite(text, 1, text_len, file) == text_len &&
	     fwrite("   ", 1, padded - text_len, file) == padded - text_len &&
	     fwrite(second, sizeof second, 1, file) == 1 &&
	     fwrite(scene->vertices, sizeof *scene->vertices, scene->vertex_count, file) ==
		     scene->vertex_count &&
	     fwrite(scene->indices, 4, scene->index_count, file) == scene->index_count;
	if (file && fclose(file) != 0)
		ok = false;
	free(text);
	return ok ? GR_OK : GR_ERR_IO;
}
