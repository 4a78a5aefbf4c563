#include "tests/accuracy/folder/model.h"

#include "base/result.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Blender's own when a scene does not say. */
#define SEGMENTS 128
#define RINGS 64
#define MOST_SEGMENTS 1024
#define MOST_MATERIALS 256

struct vertex {
	float position[3], normal[3];
};

/* Triangles of one material, one after the other. */
struct part {
	const char *material; /* the JSON's */
	struct vertex *vertices;
	size_t count, room;
};

struct parts {
	struct part *parts;
	size_t count;
	bool nomem;
};

void write_floats(FILE *out, const char *key, const double *values, int count)
{
	fprintf(out, "%s = %s", key, count > 1 ? "[" : "");
	for (int i = 0; i < count; i++) {
		char text[40];

		snprintf(text, sizeof text, "%.9g", values[i]);
		fprintf(out, "%s%s%s", i ? ", " : "", text, strpbrk(text, ".e") ? "" : ".0");
	}
	fprintf(out, "%s; ", count > 1 ? "]" : "");
}

void write_text(FILE *out, const char *key, const char *text)
{
	fprintf(out, "%s = \"", key);
	for (; *text; text++) {
		if (*text == '"' || *text == '\\')
			fputc('\\', out);
		fputc(*text, out);
	}
	fputs("\"; ", out);
}

static struct part *part_of(struct parts *all, const char *material)
{
	struct part *more;

	for (size_t i = 0; i < all->count; i++)
		if (strcmp(all->parts[i].material, material) == 0)
			return &all->parts[i];
	more = realloc(all->parts, (all->count + 1) * sizeof *more);
	if (!more) {
		all->nomem = true;
		return NULL;
	}
	all->parts = more;
	more[all->count] = (struct part){ .material = material };
	return &more[all->count++];
}

static void add_triangle(struct parts *all, struct part *part, const struct vertex *a,
			 const struct vertex *b, const struct vertex *c)
{
	if (part->count + 3 > part->room) {
		size_t room = part->room ? 2 * part->room : 96;
		struct vertex *more = realloc(part->vertices, room * sizeof *more);

		if (!more) {
			all->nomem = true;
			return;
		}
		part->vertices = more;
		part->room = room;
	}
	part->vertices[part->count++] = *a;
	part->vertices[part->count++] = *b;
	part->vertices[part->count++] = *c;
}

static void face_normal(struct vertex *const corners[3])
{
	float a[3], b[3], n[3], length;

	for (int i = 0; i < 3; i++) {
		a[i] = corners[1]->position[i] - corners[0]->position[i];
		b[i] = corners[2]->position[i] - corners[0]->position[i];
	}
	for (int i = 0; i < 3; i++)
		n[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
	length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			corners[k]->normal[i] = length > 0 ? n[i] / length : i == 1;
}

static void add_quads(struct json_walk *walk, const char *where, json_object *quads,
		      struct parts *all, struct part *part)
{
	for (size_t q = 0; q < json_object_array_length(quads) && !walk->failed; q++) {
		json_object *quad = json_object_array_get_idx(quads, q);
		struct vertex v[4];

		if (!json_object_is_type(quad, json_type_array) ||
		    json_object_array_length(quad) != 4) {
			json_fault(walk, where, "quad %zu has no four corners", q);
			return;
		}
		for (size_t k = 0; k < 4; k++) {
			double at[3] = { 0 };

			json_array_numbers(walk, where, json_object_array_get_idx(quad, k), 3, at);
			for (int i = 0; i < 3; i++)
				v[k].position[i] = (float)at[i];
		}
		face_normal((struct vertex *const[]){ &v[0], &v[1], &v[2] });
		memcpy(v[3].normal, v[0].normal, sizeof v[3].normal);
		add_triangle(all, part, &v[0], &v[1], &v[2]);
		add_triangle(all, part, &v[0], &v[2], &v[3]);
	}
}

struct sphere {
	double center[3], radius;
	int segments, rings;
	bool flat;
};

static struct vertex sphere_vertex(const struct sphere *s, int ring, int segment)
{
	double theta = M_PI * ring / s->rings, phi = 2 * M_PI * segment / s->segments;
	const double n[3] = { sin(theta) * cos(phi), cos(theta), -sin(theta) * sin(phi) };
	struct vertex v;

	for (int i = 0; i < 3; i++) {
		v.normal[i] = (float)n[i];
		v.position[i] = (float)(s->center[i] + s->radius * n[i]);
	}
	return v;
}

static void add_face(struct parts *all, struct part *part, const struct sphere *s, struct vertex a,
		     struct vertex b, struct vertex c)
{
	if (s->flat)
		face_normal((struct vertex *const[]){ &a, &b, &c });
	add_triangle(all, part, &a, &b, &c);
}

static void add_sphere(struct json_walk *walk, const char *where, json_object *said,
		       struct parts *all, struct part *part)
{
	static const char *const known[] = { "center", "radius", "segments", "rings", "flat", NULL };
	double segments = SEGMENTS, rings = RINGS;
	struct sphere s;

	json_only(walk, where, said, known);
	json_numbers(walk, where, said, "center", true, 3, s.center);
	json_number(walk, where, said, "radius", true, &s.radius);
	json_number(walk, where, said, "segments", false, &segments);
	json_number(walk, where, said, "rings", false, &rings);
	s.flat = json_flag(walk, where, said, "flat");
	if (segments < 3 || segments > MOST_SEGMENTS || rings < 3 || rings > MOST_SEGMENTS)
		json_fault(walk, where, "segments and rings are 3 to %d", MOST_SEGMENTS);
	if (walk->failed)
		return;
	s.segments = (int)segments;
	s.rings = (int)rings;
	for (int ring = 0; ring < s.rings; ring++) {
		for (int k = 0; k < s.segments; k++) {
			struct vertex a = sphere_vertex(&s, ring, k);
			struct vertex b = sphere_vertex(&s, ring + 1, k);
			struct vertex c = sphere_vertex(&s, ring + 1, k + 1);
			struct vertex d = sphere_vertex(&s, ring, k + 1);

			if (ring < s.rings - 1)
				add_face(all, part, &s, a, b, c);
			if (ring > 0)
				add_face(all, part, &s, a, c, d);
		}
	}
}

static void add_object(struct json_walk *walk, json_object *object, size_t index,
		       struct parts *all)
{
	json_object *quads, *sphere;
	const char *material;
	struct part *part;
	char where[64];

	snprintf(where, sizeof where, "objects[%zu]", index);
	quads = json_member(walk, where, object, "quads", json_type_array, false);
	sphere = json_member(walk, where, object, "sphere", json_type_object, false);
	material = json_text(walk, where, object, "material");
	if (walk->failed)
		return;
	if (!quads == !sphere) {
		json_fault(walk, where, "has neither quads nor a sphere, or both; and there is no scene.glb");
		return;
	}
	part = part_of(all, material);
	if (part && quads)
		add_quads(walk, where, quads, all, part);
	else if (part)
		add_sphere(walk, where, sphere, all, part);
}

/* The JSON of the GLB; each part has its vertices in a view of its own. */
static json_object *describe(const struct parts *all, size_t bytes)
{
	json_object *root = json_object_new_object(), *asset = json_object_new_object();
	json_object *scene = json_object_new_object(), *node = json_object_new_object();
	json_object *mesh = json_object_new_object(), *primitives = json_object_new_array();
	json_object *materials = json_object_new_array(), *accessors = json_object_new_array();
	json_object *views = json_object_new_array(), *buffer = json_object_new_object();
	json_object *list;
	size_t offset = 0;

	for (size_t i = 0; i < all->count; i++) {
		const struct part *p = &all->parts[i];
		json_object *primitive = json_object_new_object(), *of = json_object_new_object();
		json_object *material = json_object_new_object(), *view = json_object_new_object();

		json_object_object_add(material, "name", json_object_new_string(p->material));
		json_object_object_add(material, "doubleSided", json_object_new_boolean(true));
		json_object_array_add(materials, material);
		json_object_object_add(view, "buffer", json_object_new_int(0));
		json_object_object_add(view, "byteOffset", json_object_new_int64((int64_t)offset));
		json_object_object_add(view, "byteStride", json_object_new_int(sizeof(struct vertex)));
		json_object_object_add(view, "byteLength",
				       json_object_new_int64((int64_t)(p->count * sizeof(struct vertex))));
		json_object_array_add(views, view);
		for (int k = 0; k < 2; k++) {
			json_object *accessor = json_object_new_object();

			json_object_object_add(accessor, "bufferView", json_object_new_int((int)i));
			json_object_object_add(accessor, "byteOffset", json_object_new_int(12 * k));
			json_object_object_add(accessor, "componentType", json_object_new_int(5126));
			json_object_object_add(accessor, "count", json_object_new_int64((int64_t)p->count));
			json_object_object_add(accessor, "type", json_object_new_string("VEC3"));
			json_object_array_add(accessors, accessor);
			json_object_object_add(of, k ? "NORMAL" : "POSITION",
					       json_object_new_int(2 * (int)i + k));
		}
		json_object_object_add(primitive, "attributes", of);
		json_object_object_add(primitive, "material", json_object_new_int((int)i));
		json_object_array_add(primitives, primitive);
		offset += p->count * sizeof(struct vertex);
	}
	json_object_object_add(asset, "version", json_object_new_string("2.0"));
	json_object_object_add(root, "asset", asset);
	json_object_object_add(root, "scene", json_object_new_int(0));
	json_object_array_add(list = json_object_new_array(), json_object_new_int(0));
	json_object_object_add(scene, "nodes", list);
	json_object_array_add(list = json_object_new_array(), scene);
	json_object_object_add(root, "scenes", list);
	json_object_object_add(node, "mesh", json_object_new_int(0));
	json_object_array_add(list = json_object_new_array(), node);
	json_object_object_add(root, "nodes", list);
	json_object_object_add(mesh, "primitives", primitives);
	json_object_array_add(list = json_object_new_array(), mesh);
	json_object_object_add(root, "meshes", list);
	json_object_object_add(root, "materials", materials);
	json_object_object_add(root, "accessors", accessors);
	json_object_object_add(root, "bufferViews", views);
	json_object_object_add(buffer, "byteLength", json_object_new_int64((int64_t)bytes));
	json_object_array_add(list = json_object_new_array(), buffer);
	json_object_object_add(root, "buffers", list);
	return root;
}

static void put_u32(FILE *out, size_t value)
{
	for (int i = 0; i < 4; i++)
		fputc((int)(value >> (8 * i) & 255), out);
}

static int write_glb(const struct parts *all, const char *path)
{
	FILE *out = fopen(path, "wb");
	json_object *root;
	size_t bytes = 0, len, padded;
	const char *text;
	bool failed;

	if (!out)
		return GR_ERR_IO;
	for (size_t i = 0; i < all->count; i++)
		bytes += all->parts[i].count * sizeof(struct vertex);
	root = describe(all, bytes);
	text = json_object_to_json_string_length(root, JSON_C_TO_STRING_PLAIN, &len);
	padded = (len + 3) / 4 * 4;
	fputs("glTF", out);
	put_u32(out, 2);
	put_u32(out, 12 + 8 + padded + 8 + bytes);
	put_u32(out, padded);
	fputs("JSON", out);
	fwrite(text, 1, len, out);
	for (size_t i = len; i < padded; i++)
		fputc(' ', out);
	put_u32(out, bytes);
	fwrite("BIN", 1, 4, out);
	for (size_t i = 0; i < all->count; i++)
		fwrite(all->parts[i].vertices, sizeof(struct vertex), all->parts[i].count, out);
	json_object_put(root);
	failed = ferror(out) != 0;
	return fclose(out) != 0 || failed ? GR_ERR_IO : GR_OK;
}

int model_write(struct json_walk *walk, json_object *objects, const char *path)
{
	struct parts all = { 0 };
	int result = GR_OK;

	for (size_t i = 0; i < json_object_array_length(objects) && !walk->failed && !all.nomem; i++)
		add_object(walk, json_object_array_get_idx(objects, i), i, &all);
	if (all.nomem)
		result = GR_ERR_NOMEM;
	else if (walk->failed)
		result = GR_ERR_CONFIG;
	else
		result = write_glb(&all, path);
	for (size_t i = 0; i < all.count; i++)
		free(all.parts[i].vertices);
	free(all.parts);
	return result;
}

static void lambert_entry(struct json_walk *walk, json_object *material, size_t index, FILE *out)
{
	double color[4] = { 1, 1, 1, 1 };
	json_object *name, *pbr, *unused;
	char unnamed[64], where[64];

	snprintf(where, sizeof where, "materials[%zu]", index);
	/* as renderer/scene/import_material.c names it */
	snprintf(unnamed, sizeof unnamed, "material %zu", index);
	name = json_member(walk, where, material, "name", json_type_string, false);
	pbr = json_member(walk, where, material, "pbrMetallicRoughness", json_type_object, false);
	if (pbr)
		json_numbers(walk, where, pbr, "baseColorFactor", false, 4, color);
	if (pbr && json_object_object_get_ex(pbr, "baseColorTexture", &unused))
		json_fault(walk, where, "baseColorTexture: a Lambert surface of one colour is meant");
	fputs("\t{ ", out);
	write_text(out, "material", name ? json_object_get_string(name) : unnamed);
	fputs("kind = \"diffuse\"; sides = \"two\"; ", out);
	write_floats(out, "reflectance", color, 3);
	fputs("}", out);
}

bool model_lambert(const char *path, struct gr_diag *diag, FILE *out)
{
	struct json_walk walk = { .path = path, .diag = diag };
	json_object *root = json_load(&walk), *materials = NULL;
	size_t count = 0;

	if (root)
		materials = json_member(&walk, NULL, root, "materials", json_type_array, false);
	if (materials)
		count = json_object_array_length(materials);
	if (count > MOST_MATERIALS)
		json_fault(&walk, "materials", "%zu; at most %d are taken", count, MOST_MATERIALS);
	for (size_t i = 0; i < count && !walk.failed; i++) {
		fputs(i ? ",\n" : "\n", out);
		lambert_entry(&walk, json_object_array_get_idx(materials, i), i, out);
	}
	json_object_put(root);
	return !walk.failed;
}
