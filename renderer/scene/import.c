/*
 * A model through assimp, in a process of its own. The order matters for models that lie: glTF's JSON is
 * checked first and handed on without what is not needed; then assimp only reads; faces with bad indices or NaN corners
 * go; only then assimp's own steps (triangulation, normals) see the meshes.
 */
#include "config.h" /* strsignal */

#include "renderer/scene/import.h"

#include "base/result.h"
#include "renderer/image/read_file.h"
#include "renderer/scene/isolate.h"
#include "renderer/scene/scene_block.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Where normals are made up, edges sharper than this stay edges. */
#define SMOOTH_DEGREES 60.0f

/* assimp knows many more forms, and guesses at unknown endings: fewer ways in. */
static int check_name(const char *path, struct gr_diag *diag)
{
	static const char *const endings[] = { ".gltf", ".glb", ".obj", ".fbx", ".dae" };
	const char *dot = strrchr(path, '.');

	for (size_t i = 0; i < sizeof endings / sizeof endings[0] && dot; i++) {
		if (strcasecmp(dot, endings[i]) == 0)
			return GR_OK;
	}
	gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
		    "of no known form; models are read from .gltf, .glb, .obj, .fbx and .dae");
	return GR_ERR_CONFIG;
}

static void report_dropped(const struct import *import)
{
	const struct scene *s = import->scene;

	if (s->dropped_nonfinite + s->dropped_degenerate + s->dropped_index)
		gr_diag_add(import->diag, GR_DIAG_WARNING, import->path, 0, NULL,
			    "triangles dropped: %zu with NaN or infinite corners, %zu without area, "
			    "%zu with an index out of range",
			    s->dropped_nonfinite, s->dropped_degenerate, s->dropped_index);
}

static int convert(struct import *import, struct aiScene *from)
{
	/* glTF asks for flat normals where it gives none; the others mean smooth ones. */
	unsigned steps = aiProcess_Triangulate | aiProcess_SortByPType;
	int result;

	steps |= import->gltf ? aiProcess_GenNormals
			      : aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices;
	if ((from->mFlags & AI_SCENE_FLAGS_INCOMPLETE) || !from->mRootNode) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, NULL,
			    "the model is not complete");
		return GR_ERR_CONFIG;
	}
	result = import_clean(import, from);
	if (result != GR_OK)
		return result;
	import->from = aiApplyPostProcessing(from, steps);
	if (!import->from) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, NULL,
			    "triangles cannot be made of it: %s", aiGetErrorString());
		return GR_ERR_CONFIG;
	}
	result = import_materials(import);
	if (result == GR_OK)
		result = import_geometry(import);
	return result;
}

/* assimp reads from the file, since formats name their own companions, or from bytes. */
static const struct aiScene *read_with_assimp(const char *path, const uint8_t *bytes, size_t len,
					      bool from_file)
{
	struct aiPropertyStore *properties = aiCreatePropertyStore();
	const char *ending = gltf_is_name(path) ? ".glb" : strrchr(path, '.');
	const struct aiScene *from;

	if (!properties)
		return NULL;
	aiSetImportPropertyFloat(properties, AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, SMOOTH_DEGREES);
	aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, 0);
	if (from_file)
		from = aiImportFileExWithProperties(path, 0, NULL, properties);
	else
		from = aiImportFileFromMemoryWithProperties((const char *)bytes, (unsigned)len, 0,
							    ending ? ending + 1 : "", properties);
	aiReleasePropertyStore(properties);
	return from;
}

static int import_parts(struct import *import, const uint8_t *bytes, size_t len, bool from_file)
{
	const struct aiScene *from = read_with_assimp(import->path, bytes, len, from_file);
	int result;

	if (!from) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, NULL, "cannot be imported: %s",
			    aiGetErrorString());
		return GR_ERR_CONFIG;
	}
	import->from = from;
	/* aiApplyPostProcessing works in place, so the scene is not const in truth. */
	result = convert(import, (struct aiScene *)from);
	if (import->from) /* else a step failed, and assimp has freed it itself */
		aiReleaseImport(import->from);
	return result;
}

/* Reading, checking and converting; here, in this process. */
static int import_any(const uint8_t *bytes, size_t len, const char *path, bool from_file,
		      const struct import_options *options, struct scene **out,
		      struct gr_diag *diag)
{
	struct gltf_extra extra = { 0 };
	struct import import = { .path = path, .options = options, .diag = diag };
	int result = check_name(path, diag);

	if (result == GR_OK && gltf_is_name(path)) {
		result = gltf_read(bytes, len, path, &extra, diag);
		import.gltf = &extra;
		/* What was checked is what assimp gets, and nothing beside it. */
		bytes = extra.glb;
		len = extra.glb_len;
		from_file = false;
	}
	if (result == GR_OK) {
		import.scene = calloc(1, sizeof *import.scene);
		result = import.scene ? import_parts(&import, bytes, len, from_file) : GR_ERR_NOMEM;
	}
	gltf_finish(&extra);
	if (result != GR_OK) {
		scene_destroy(&import.scene);
		return result;
	}
	report_dropped(&import);
	*out = import.scene;
	return GR_OK;
}

struct guarded {
	const uint8_t *bytes; /* NULL: from the file of that name */
	size_t len;
	const char *path;
	const struct import_options *options;
};

static int import_any_here(const struct guarded *g, struct scene **out, struct gr_diag *diag)
{
	uint8_t *bytes;
	size_t len;
	int result;

	if (g->bytes)
		return import_any(g->bytes, g->len, g->path, false, g->options, out, diag);
	result = read_file(g->path, IMPORT_MAX_FILE, &bytes, &len, diag, "model");
	if (result != GR_OK)
		return result;
	result = import_any(bytes, len, g->path, true, g->options, out, diag);
	free(bytes);
	return result;
}

/* In the child. Nothing is freed: the process ends. */
static int work(void *context, int fd)
{
	struct gr_diag diag = { 0 };
	struct scene *scene = NULL;
	int result = import_any_here(context, &scene, &diag);

	return scene_block_write(fd, result, scene, &diag) == GR_OK ? 0 : 1;
}

static int tell_end(const struct isolate_end *end, const char *path, struct gr_diag *diag)
{
	switch (end->how) {
	case ISOLATE_LATE:
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
			    "importing the model takes longer than %d s: damaged, hostile or too large",
			    IMPORT_WALL_MS / 1000);
		break;
	case ISOLATE_STATUS:
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
			    "the importer gave up (status %d): damaged, hostile or too large",
			    end->number);
		break;
	default:
		if (end->number == SIGXCPU)
			gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
				    "importing the model takes more than %d s of processor time: "
				    "damaged, hostile or too large", IMPORT_CPU_S);
		else
			gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
				    "the model makes the importer crash (signal %d, %s): damaged or "
				    "hostile; export it again, best as glTF", end->number,
				    strsignal(end->number));
	}
	return GR_ERR_CONFIG;
}

static int import_guarded(struct guarded *g, struct scene **out, struct gr_diag *diag)
{
	static const struct isolate_limits limits = {
		.memory = IMPORT_MEMORY,
		.block = SCENE_BLOCK_MAX,
		.cpu_s = IMPORT_CPU_S,
		.wall_ms = IMPORT_WALL_MS,
	};
	struct isolate_end end;
	int result = isolate_run(&limits, work, g, &end);

	if (result != GR_OK) {
		gr_diag_add(diag, GR_DIAG_ERROR, g->path, 0, NULL,
			    "no process to import the model in: %s", strerror(errno));
		return result;
	}
	if (end.how == ISOLATE_DONE) {
		result = scene_block_read(end.block, end.len, out, diag);
		if (result == GR_ERR_FORMAT) {
			gr_diag_add(diag, GR_DIAG_ERROR, g->path, 0, NULL,
				    "the importer hands back no whole scene: damaged or hostile");
			result = GR_ERR_CONFIG;
		}
	} else {
		result = tell_end(&end, g->path, diag);
	}
	isolate_finish(&end);
	if (result == GR_OK)
		scene_hash(*out);
	return result;
}

int import_bytes(const uint8_t *bytes, size_t len, const char *name,
		 const struct import_options *options, struct scene **out, struct gr_diag *diag)
{
	struct guarded g = { bytes, len, name, options };

	*out = NULL;
	if (len < 1 || len > IMPORT_MAX_FILE)
		return GR_ERR_RANGE;
	return import_guarded(&g, out, diag);
}

int import_bytes_here(const uint8_t *bytes, size_t len, const char *name,
		      const struct import_options *options, struct scene **out,
		      struct gr_diag *diag)
{
	*out = NULL;
	if (len < 1 || len > IMPORT_MAX_FILE)
		return GR_ERR_RANGE;
	return import_any(bytes, len, name, false, options, out, diag);
}

int import_model(const char *path, const struct import_options *options, struct scene **out,
		 struct gr_diag *diag)
{
	struct guarded g = { .path = path, .options = options };

	*out = NULL;
	return import_guarded(&g, out, diag);
}
