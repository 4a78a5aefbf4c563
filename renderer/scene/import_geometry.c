/* Meshes, placed by their nodes, into one vertex and one index array. */
#include "renderer/scene/import.h"

#include "base/result.h"

#include <assimp/cimport.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A triangle whose height is below this part of its longest side has no usable normal in float. */
#define SLIVER 1e-8

/* A mesh at one place of the hierarchy. */
struct instance {
	const struct aiMesh *mesh;
	size_t order; /* in the hierarchy, to keep sorting stable */
	double world[3][4];
	double normal[3][3]; /* cofactors of world: right for any scale */
	bool mirrored;
};

struct gather {
	struct instance *instances;
	size_t count, size;
	size_t vertices, indices; /* upper bounds */
	size_t nodes;
};

static bool finite3(const float v[3])
{
	return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static bool finite_vector(const struct aiVector3D *v)
{
	return isfinite(v->x) && isfinite(v->y) && isfinite(v->z);
}

/* Swaps the face to the end and shortens the list: assimp still frees all of them. */
static void drop_face(struct aiMesh *mesh, unsigned index)
{
	struct aiFace last = mesh->mFaces[mesh->mNumFaces - 1];

	mesh->mFaces[mesh->mNumFaces - 1] = mesh->mFaces[index];
	mesh->mFaces[index] = last;
	mesh->mNumFaces--;
}

static void clean_mesh(struct scene *scene, struct aiMesh *mesh)
{
	for (unsigned f = 0; f < mesh->mNumFaces;) {
		const struct aiFace *face = &mesh->mFaces[f];
		/* A polygon of n corners would have become n - 2 triangles. */
		size_t triangles = face->mNumIndices > 2 ? face->mNumIndices - 2 : 0;
		bool range = true, finite = true;

		for (unsigned i = 0; i < face->mNumIndices && range; i++)
			range = face->mIndices[i] < mesh->mNumVertices;
		for (unsigned i = 0; i < face->mNumIndices && range && finite; i++)
			finite = finite_vector(&mesh->mVertices[face->mIndices[i]]);
		if (range && finite) {
			f++;
			continue;
		}
		*(range ? &scene->dropped_nonfinite : &scene->dropped_index) += triangles;
		drop_face(mesh, f);
	}
	/* Sorting NaN would confuse assimp's search for neighbours. */
	for (unsigned v = 0; v < mesh->mNumVertices; v++) {
		if (!finite_vector(&mesh->mVertices[v]))
			memset(&mesh->mVertices[v], 0, sizeof mesh->mVertices[v]);
		if (mesh->mNormals && !finite_vector(&mesh->mNormals[v]))
			memset(&mesh->mNormals[v], 0, sizeof mesh->mNormals[v]);
	}
}

/* assimp's glTF reader leaves faces with bad indices out by itself, without a count. */
static void count_missing(struct import *import, const struct aiScene *from)
{
	size_t there = 0;

	for (unsigned m = 0; m < from->mNumMeshes; m++) {
		if (from->mMeshes[m]->mPrimitiveTypes & aiPrimitiveType_TRIANGLE)
			there += from->mMeshes[m]->mNumFaces;
	}
	if (there < import->gltf->triangles)
		import->scene->dropped_index += import->gltf->triangles - there;
}

int import_clean(struct import *import, struct aiScene *from)
{
	size_t vertices = 0;

	if (import->gltf)
		count_missing(import, from);

	for (unsigned m = 0; m < from->mNumMeshes; m++) {
		struct aiMesh *mesh = from->mMeshes[m];

		if (!mesh->mVertices)
			mesh->mNumVertices = 0;
		vertices += mesh->mNumVertices;
		clean_mesh(import->scene, mesh);
	}
	if (vertices <= IMPORT_MAX_VERTICES)
		return GR_OK;
	gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, NULL,
		    "%zu vertices; at most %zu are accepted", vertices, IMPORT_MAX_VERTICES);
	return GR_ERR_CONFIG;
}

static void multiply(double a[3][4], const struct aiMatrix4x4 *m, double out[3][4])
{
	const double b[4][4] = {
		{ m->a1, m->a2, m->a3, m->a4 },
		{ m->b1, m->b2, m->b3, m->b4 },
		{ m->c1, m->c2, m->c3, m->c4 },
		{ 0, 0, 0, 1 },
	};

	for (int r = 0; r < 3; r++) {
		for (int c = 0; c < 4; c++) {
			double sum = 0;

			for (int k = 0; k < 4; k++)
				sum += a[r][k] * b[k][c];
			out[r][c] = sum;
		}
	}
}

static void place(struct instance *instance, double world[3][4])
{
	memcpy(instance->world, world, sizeof instance->world);
	for (int r = 0; r < 3; r++) {
		for (int c = 0; c < 3; c++) {
			int r1 = (r + 1) % 3, r2 = (r + 2) % 3;
			int c1 = (c + 1) % 3, c2 = (c + 2) % 3;

			instance->normal[r][c] = world[r1][c1] * world[r2][c2] -
						 world[r1][c2] * world[r2][c1];
		}
	}
	instance->mirrored = world[0][0] * instance->normal[0][0] +
				     world[0][1] * instance->normal[0][1] +
				     world[0][2] * instance->normal[0][2] < 0;
	if (instance->mirrored) { /* cofactors of a mirror point the other way */
		for (int i = 0; i < 9; i++)
			(&instance->normal[0][0])[i] *= -1;
	}
}

static int add_instance(struct import *import, struct gather *g, unsigned mesh, double world[3][4])
{
	const struct aiMesh *from;

	if (mesh >= import->from->mNumMeshes)
		return GR_OK;
	from = import->from->mMeshes[mesh];
	if (!(from->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) || from->mNumFaces == 0)
		return GR_OK; /* points and lines, which were sorted apart */
	if (from->mMaterialIndex >= import->scene->material_count) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, from->mName.data,
			    "the mesh's material does not exist");
		return GR_ERR_CONFIG;
	}
	g->vertices += from->mNumVertices;
	g->indices += (size_t)from->mNumFaces * 3;
	if (g->vertices > IMPORT_MAX_VERTICES || g->indices > IMPORT_MAX_INDICES) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, NULL,
			    "more than %zu vertices or %zu indices once all nodes are placed",
			    IMPORT_MAX_VERTICES, IMPORT_MAX_INDICES);
		return GR_ERR_CONFIG;
	}
	if (g->count == g->size) {
		size_t size = g->size ? g->size * 2 : 64;
		struct instance *grown = realloc(g->instances, size * sizeof *grown);

		if (!grown)
			return GR_ERR_NOMEM;
		g->instances = grown;
		g->size = size;
	}
	g->instances[g->count].mesh = from;
	g->instances[g->count].order = g->count;
	place(&g->instances[g->count++], world);
	return GR_OK;
}

static int walk(struct import *import, struct gather *g, const struct aiNode *node,
		double parent[3][4], int depth)
{
	double world[3][4];
	int result = GR_OK;

	if (depth > IMPORT_MAX_DEPTH || ++g->nodes > IMPORT_MAX_NODES) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, NULL,
			    "nodes are nested more than %d deep, or more than %zu",
			    IMPORT_MAX_DEPTH, IMPORT_MAX_NODES);
		return GR_ERR_CONFIG;
	}
	multiply(parent, &node->mTransformation, world);
	for (unsigned i = 0; i < node->mNumMeshes && result == GR_OK; i++)
		result = add_instance(import, g, node->mMeshes[i], world);
	for (unsigned i = 0; i < node->mNumChildren && result == GR_OK; i++)
		result = walk(import, g, node->mChildren[i], world, depth + 1);
	return result;
}

static bool unit3(double v[3])
{
	double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);

	if (!(length > 0) || !isfinite(length))
		return false;
	for (int i = 0; i < 3; i++)
		v[i] /= length;
	return true;
}

/* Normal left at zero when it cannot be had: the triangle gives its own. */
static void place_vertex(const struct instance *instance, unsigned index,
			 struct scene_vertex *out)
{
	const struct aiMesh *mesh = instance->mesh;
	const struct aiVector3D *p = &mesh->mVertices[index];
	double normal[3] = { 0, 0, 0 };

	memset(out, 0, sizeof *out);
	for (int r = 0; r < 3; r++) {
		const double *row = instance->world[r];

		out->position[r] = (float)(row[0] * (double)p->x + row[1] * (double)p->y +
					   row[2] * (double)p->z + row[3]);
		if (mesh->mNormals) {
			const struct aiVector3D *n = &mesh->mNormals[index];

			row = instance->normal[r];
			normal[r] = row[0] * (double)n->x + row[1] * (double)n->y +
				    row[2] * (double)n->z;
		}
	}
	if (unit3(normal)) {
		for (int i = 0; i < 3; i++)
			out->normal[i] = (float)normal[i];
	}
	if (mesh->mTextureCoords[0]) {
		float u = mesh->mTextureCoords[0][index].x;
		float v = 1.0f - mesh->mTextureCoords[0][index].y; /* assimp counts from below */

		out->uv[0] = isfinite(u) ? u : 0.0f;
		out->uv[1] = isfinite(v) ? v : 0.0f;
	}
}

/* Unit face normal; false for a triangle without area. */
static bool face_normal(const struct scene_vertex *const corners[3], double out[3])
{
	double a[3], b[3], c[3], longest, area;

	for (int i = 0; i < 3; i++) {
		a[i] = (double)corners[1]->position[i] - (double)corners[0]->position[i];
		b[i] = (double)corners[2]->position[i] - (double)corners[0]->position[i];
		c[i] = b[i] - a[i];
	}
	for (int i = 0; i < 3; i++)
		out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
	area = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
	longest = fmax(a[0] * a[0] + a[1] * a[1] + a[2] * a[2],
		       fmax(b[0] * b[0] + b[1] * b[1] + b[2] * b[2],
			    c[0] * c[0] + c[1] * c[1] + c[2] * c[2]));
	return area > SLIVER * longest && unit3(out);
}

static void grow_bounds(struct scene *scene, const float position[3])
{
	for (int i = 0; i < 3; i++) {
		scene->min[i] = fminf(scene->min[i], position[i]);
		scene->max[i] = fmaxf(scene->max[i], position[i]);
	}
}

/* Only vertices that a kept triangle uses are kept; map remembers where they went. */
static uint32_t keep_vertex(struct scene *scene, uint32_t *map, unsigned index,
			    const struct scene_vertex *vertex, const double face[3])
{
	struct scene_vertex *kept;

	if (map[index] != UINT32_MAX)
		return map[index];
	kept = &scene->vertices[scene->vertex_count];
	*kept = *vertex;
	if (kept->normal[0] == 0.0f && kept->normal[1] == 0.0f && kept->normal[2] == 0.0f) {
		for (int i = 0; i < 3; i++)
			kept->normal[i] = (float)face[i];
	}
	grow_bounds(scene, kept->position);
	map[index] = (uint32_t)scene->vertex_count++;
	return map[index];
}

static void place_faces(struct scene *scene, const struct instance *instance, uint32_t *map)
{
	const struct aiMesh *mesh = instance->mesh;

	for (unsigned f = 0; f < mesh->mNumFaces; f++) {
		const unsigned *indices = mesh->mFaces[f].mIndices;
		struct scene_vertex placed[3];
		const struct scene_vertex *corners[3];
		double normal[3];
		bool finite = true;

		if (mesh->mFaces[f].mNumIndices != 3)
			continue;
		for (int i = 0; i < 3; i++) {
			/* A mirror turns the winding round; fronts must stay fronts. */
			place_vertex(instance, indices[i], &placed[i]);
			corners[instance->mirrored ? 2 - i : i] = &placed[i];
			finite = finite && finite3(placed[i].position);
		}
		if (!finite) {
			scene->dropped_nonfinite++;
			continue;
		}
		if (!face_normal(corners, normal)) {
			scene->dropped_degenerate++;
			continue;
		}
		for (int i = 0; i < 3; i++)
			scene->indices[scene->index_count++] =
				keep_vertex(scene, map, indices[corners[i] - placed], corners[i], normal);
	}
}

static int by_material(const void *a, const void *b)
{
	const struct instance *x = a, *y = b;

	if (x->mesh->mMaterialIndex != y->mesh->mMaterialIndex)
		return x->mesh->mMaterialIndex < y->mesh->mMaterialIndex ? -1 : 1;
	return x->order < y->order ? -1 : x->order > y->order;
}

static void close_draw(struct scene *scene, uint32_t material, size_t first)
{
	if (scene->index_count == first)
		return;
	scene->draws[scene->draw_count++] = (struct scene_draw){
		.first_index = (uint32_t)first,
		.index_count = (uint32_t)(scene->index_count - first),
		.material = material,
	};
}

static int place_all(struct scene *scene, struct gather *g)
{
	size_t largest = 1, first = 0;
	uint32_t *map;

	for (size_t i = 0; i < g->count; i++) {
		if (g->instances[i].mesh->mNumVertices > largest)
			largest = g->instances[i].mesh->mNumVertices;
	}
	qsort(g->instances, g->count, sizeof g->instances[0], by_material);
	map = malloc(largest * sizeof *map);
	scene->vertices = calloc(g->vertices, sizeof scene->vertices[0]);
	scene->indices = calloc(g->indices, sizeof scene->indices[0]);
	scene->draws = calloc(scene->material_count, sizeof scene->draws[0]);
	if (!map || !scene->vertices || !scene->indices || !scene->draws) {
		free(map);
		return GR_ERR_NOMEM;
	}
	for (int i = 0; i < 3; i++) {
		scene->min[i] = INFINITY;
		scene->max[i] = -INFINITY;
	}
	for (size_t i = 0; i < g->count; i++) {
		uint32_t material = g->instances[i].mesh->mMaterialIndex;

		memset(map, 0xff, g->instances[i].mesh->mNumVertices * sizeof *map);
		place_faces(scene, &g->instances[i], map);
		if (i + 1 == g->count || g->instances[i + 1].mesh->mMaterialIndex != material) {
			close_draw(scene, material, first);
			first = scene->index_count;
		}
	}
	free(map);
	return GR_OK;
}

int import_geometry(struct import *import)
{
	struct scene *scene = import->scene;
	double scale = (double)import->options->scale;
	double world[3][4] = { { scale, 0, 0, 0 }, { 0, scale, 0, 0 }, { 0, 0, scale, 0 } };
	struct gather g = { 0 };
	int result = GR_OK;

	if (import->from->mRootNode)
		result = walk(import, &g, import->from->mRootNode, world, 0);
	if (result == GR_OK && g.count)
		result = place_all(scene, &g);
	free(g.instances);
	if (result == GR_OK && scene->index_count == 0) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, NULL,
			    "no triangle that can be drawn (%zu dropped)",
			    scene->dropped_nonfinite + scene->dropped_degenerate +
				    scene->dropped_index);
		return GR_ERR_CONFIG;
	}
	scene_note_emission(scene);
	return result;
}
