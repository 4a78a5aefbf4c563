/*
 * Inside of renderer/scene: from a model's bytes to a struct scene. Split into
 * the check of glTF and what it says beside assimp (gltf*.c), materials (import_material.c),
 * textures (texture.c) and geometry (import_geometry.c).
 */
#ifndef GROTTO_RENDERER_SCENE_IMPORT_H
#define GROTTO_RENDERER_SCENE_IMPORT_H

#include "base/diag.h"
#include "renderer/scene/scene.h"

#include <assimp/scene.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What one scene may hold; larger models are refused. */
#define IMPORT_MAX_FILE ((size_t)1 << 30)
#define IMPORT_MAX_VERTICES ((size_t)1 << 25)
#define IMPORT_MAX_INDICES ((size_t)3 << 25)
#define IMPORT_MAX_MATERIALS 4096
#define IMPORT_MAX_IMAGES 1024
#define IMPORT_MAX_IMAGE_SIDE 16384
#define IMPORT_MAX_IMAGE_BYTES ((size_t)1 << 31) /* all images of a scene, decoded */
#define IMPORT_MAX_DEPTH 256                     /* of the node hierarchy */
#define IMPORT_MAX_NODES ((size_t)1 << 20)

/* Blinn-Phong exponents above this would need more than float angles: no true mirrors. */
#define IMPORT_MAX_SHININESS 16384.0f
/* A non-metal at least this rough is pure Lambert. */
#define IMPORT_LAMBERT_ROUGHNESS 0.999f

/* What one import may take; it runs in a child process with these limits. */
#define IMPORT_CPU_S 60
#define IMPORT_WALL_MS 90000 /* below the services' TimeoutStartSec */
#define IMPORT_MEMORY ((size_t)12 << 30)

struct import_options {
	float scale;          /* metres per unit of the model */
	float emission_scale; /* W/(m^2 sr) of emission 1 */
	bool double_sided;
};
/* Diffuse reflectance of a glTF mesh without a material. */
#define IMPORT_DEFAULT_REFLECTANCE 0.5f

/*
 * As scene_import, without a scene file. In a child process (isolate.h): a file
 * that makes assimp crash or run on for ever is refused as any other bad one.
 */
int import_model(const char *path, const struct import_options *options, struct scene **out,
		 struct gr_diag *diag);
/*
 * The same from bytes; `name` gives the format by its ending and the folder of
 * external textures.
 */
int import_bytes(const uint8_t *bytes, size_t len, const char *name,
		 const struct import_options *options, struct scene **out, struct gr_diag *diag);
/* The same without a child, for fuzzing; the scene has no hash. */
int import_bytes_here(const uint8_t *bytes, size_t len, const char *name,
		      const struct import_options *options, struct scene **out,
		      struct gr_diag *diag);

/* The glTF material properties that assimp 5.2 does not hand on. */
struct gltf_material {
	float emissive_strength;  /* KHR_materials_emissive_strength, 1 */
	float specular_factor;    /* KHR_materials_specular, 1 */
	float specular_color[3];  /* the same, 1 1 1 */
	float ior;                /* KHR_materials_ior, 1.5 */
};

struct gltf_extra {
	struct gltf_material *materials; /* in the file's order, which is assimp's */
	size_t material_count;
	size_t triangles; /* that the primitives promise, each mesh once */
	uint8_t *glb;     /* the same model, of nothing but what was checked: for assimp */
	size_t glb_len;
};

/* Whether a name ends in .gltf or .glb. */
bool gltf_is_name(const char *name);
/*
 * Checks what assimp takes on trust (types, lengths, references, cycles,
 * extensions that are required), reads the extra properties and makes a GLB of
 * what is used: one buffer, with companions and data URIs in it. Faults go to
 * diag.
 */
int gltf_read(const uint8_t *bytes, size_t len, const char *path, struct gltf_extra *out,
	      struct gr_diag *diag);
void gltf_finish(struct gltf_extra *extra);

/* One import on its way. */
struct import {
	const char *path;
	const struct import_options *options;
	struct gr_diag *diag;
	const struct aiScene *from;
	const struct gltf_extra *gltf; /* NULL for other formats */
	struct scene *scene;
	size_t image_bytes;
};

/* Drops faces that assimp's own steps must not see: bad indices, NaN corners. */
int import_clean(struct import *import, struct aiScene *from);
int import_materials(struct import *import);
/* Nodes, meshes, bounds; needs the materials. */
int import_geometry(struct import *import);

/*
 * Index of the image that a material names, decoded once however often it is
 * used. GR_ERR_CONFIG with a line in diag when it cannot be had.
 */
int import_image(struct import *import, const char *name, bool srgb, int *out_index);
/* A file that a model names, as it can be opened: %20 and backslashes resolved, beside the
 * model unless absolute. Caller frees; NULL without memory. */
char *import_beside(const char *model, const char *name);
/* PNG or JPEG to RGBA; `what` names it in diag. rgba is the caller's to free. */
int texture_decode(const uint8_t *bytes, size_t len, const char *what, struct scene_image *out,
		   struct gr_diag *diag, const char *path);

#endif
