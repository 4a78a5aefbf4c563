/*
 * A model in memory, as imported: one vertex and one index array, draws that
 * share a material, decoded images. Static; scene frame, metres.
 *
 * What could not be used was dropped and counted: triangles with a NaN or
 * infinite corner, of zero area, or with an index out of range.
 */
#ifndef GROTTO_RENDERER_SCENE_SCENE_H
#define GROTTO_RENDERER_SCENE_SCENE_H

#include "base/diag.h"
#include "config/scene_file.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct scene_vertex {
	float position[3];
	float normal[3]; /* unit */
	float uv[2];
};

/*
 * Lambert plus half-vector normalised Blinn-Phong (seed 004, eq. 3.2):
 *   f = diffuse/pi + (shininess + 8)/(8 pi) specular cos^shininess(theta_h)
 * mapped from glTF metallic/roughness as docs/models.md says.
 */
enum scene_material_kind {
	MATERIAL_PHONG,     /* the above */
	MATERIAL_MIRROR,    /* perfect: radiance times specular, no Fresnel */
	MATERIAL_CONDUCTOR, /* GGX of alpha, separable Smith, times specular, no Fresnel */
	MATERIAL_MEASURED,  /* a table; diffuse is its reflectance as a Lambert one, for what knows no tables */
};

/*
 * Of the last three kinds the renderer's own shading has no more than what
 * diffuse, specular and shininess say: a highlight of the same width.
 */
struct scene_material {
	char name[64];
	enum scene_material_kind kind;
	float alpha;       /* conductor: 1e-4..1 */
	int table;         /* measured: index into tables */
	float diffuse[3];  /* reflectance 0..1 */
	float specular[3]; /* reflectance 0..1; diffuse + specular <= 1 */
	float shininess;   /* exponent m >= 0 */
	float emission[3]; /* radiance, W/(m^2 sr); the unlit side of a one-sided surface emits none */
	int diffuse_image; /* index into images, -1 for none; multiplies diffuse */
	bool tinted_specular; /* a metal: diffuse_image multiplies specular, too */
	int emission_image;
	bool two_sided;
};

/* Decoded to 8 bit RGBA; row 0 is the top (uv v = 0, as in glTF). */
struct brdf_table;
struct environment;

struct scene_image {
	char *name;
	int width, height;
	bool srgb;
	uint8_t *rgba;
};

struct scene_draw {
	uint32_t first_index, index_count; /* multiples of 3 */
	uint32_t material;
};

struct scene {
	struct scene_vertex *vertices;
	size_t vertex_count;
	uint32_t *indices; /* triangles, counter-clockwise seen from the front */
	size_t index_count;
	struct scene_draw *draws; /* sorted by material */
	size_t draw_count;
	struct scene_material *materials;
	size_t material_count;
	struct scene_image *images;
	size_t image_count;
	struct brdf_table **tables; /* renderer/scene/brdf_table.h */
	size_t table_count;
	struct environment *environment; /* renderer/scene/environment.h; NULL: dark */
	float min[3], max[3]; /* bounds of what is left */
	size_t dropped_nonfinite, dropped_degenerate, dropped_index;
	bool emissive;     /* some triangle emits */
	uint8_t hash[32];  /* BLAKE2b of all of the above: content, not paths */
};

/*
 * Imports the model that the scene file names (glTF, OBJ, FBX, Collada through
 * assimp), gives its materials what the file says of them instead, and loads the
 * environment. What is missing, truncated or unsupported is named in diag:
 * GR_ERR_CONFIG, *out NULL.
 */
int scene_import(const struct scene_file *file, struct scene **out, struct gr_diag *diag);
void scene_destroy(struct scene **scene);
/* Fills `emissive` and `hash` from the rest, after a change to materials. */
void scene_note_emission(struct scene *scene);
void scene_hash(struct scene *scene);
/* The hash that nodes compare at join: scene file and model content together. */
void scene_content_hash(const struct scene_file *file, const struct scene *scene,
			uint8_t out[32]);
/*
 * The parts of it by name: those of the scene file, then the files that it names.
 * At most SCENE_ITEMS_MAX, as layout_items. Reads tables and environment whole.
 */
#define SCENE_ITEMS_MAX (SCENE_FILE_ITEMS_MAX + 3)
size_t scene_content_items(const struct scene_file *file, const struct scene *scene,
			   struct gr_item items[SCENE_ITEMS_MAX]);

#endif
