/*
 * Materials to Lambert + normalised Blinn-Phong. docs/models.md gives the
 * mapping in words; the exponent is m = 2/alpha^2 - 2 with alpha = roughness^2,
 * which gives both lobes the same width (Karis, "Specular BRDF Reference", 2013).
 */
#include "renderer/scene/import.h"

#include "base/result.h"

#include <assimp/GltfMaterial.h>
#include <assimp/cimport.h>
#include <assimp/material.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void get_color(const struct aiMaterial *m, const char *key, unsigned type, unsigned index,
		      float out[3])
{
	struct aiColor4D color;

	if (aiGetMaterialColor(m, key, type, index, &color) != aiReturn_SUCCESS)
		return;
	out[0] = color.r;
	out[1] = color.g;
	out[2] = color.b;
}

static bool get_float(const struct aiMaterial *m, const char *key, unsigned type, unsigned index,
		      float *out)
{
	unsigned count = 1;

	return aiGetMaterialFloatArray(m, key, type, index, out, &count) == aiReturn_SUCCESS &&
	       count == 1;
}

static bool get_int(const struct aiMaterial *m, const char *key, unsigned type, unsigned index,
		    int *out)
{
	unsigned count = 1;

	return aiGetMaterialIntegerArray(m, key, type, index, out, &count) == aiReturn_SUCCESS &&
	       count == 1;
}

/* The first of the texture kinds that the material has; *out_index -1 when none. */
static int get_texture(struct import *import, const struct aiMaterial *m,
		       const enum aiTextureType *kinds, size_t count, bool srgb, int *out_index)
{
	*out_index = -1;
	for (size_t i = 0; i < count; i++) {
		struct aiString name;

		if (aiGetMaterialTexture(m, kinds[i], 0, &name, NULL, NULL, NULL, NULL, NULL,
					 NULL) == aiReturn_SUCCESS && name.length)
			return import_image(import, name.data, srgb, out_index);
	}
	return GR_OK;
}

/* Outside 0..1 is named and brought inside; NaN and Inf are refused later. */
static void limit(struct import *import, const struct scene_material *material, const char *what,
		  float *value)
{
	if (!isfinite(*value) || (*value >= 0.0f && *value <= 1.0f))
		return;
	gr_diag_add(import->diag, GR_DIAG_WARNING, import->path, 0, material->name,
		    "%s is %g, taken as %d; 0 to 1 is meant", what, (double)*value, *value > 0.0f);
	*value = *value > 0.0f ? 1.0f : 0.0f;
}

static float shininess_of(float roughness)
{
	float alpha = roughness * roughness;
	float m = 2.0f / (alpha * alpha) - 2.0f; /* Inf at 0, 0 at 1 */

	return m > IMPORT_MAX_SHININESS ? IMPORT_MAX_SHININESS : m;
}

/* Means over the texture of roughness (green) and metallic (blue): one value a material. */
static int apply_metallic_roughness_map(struct import *import, const struct aiMaterial *from,
					float *metallic, float *roughness)
{
	static const enum aiTextureType kinds[] = { aiTextureType_METALNESS, aiTextureType_UNKNOWN };
	const struct scene_image *image;
	double green = 0, blue = 0;
	size_t pixels;
	int index;
	int result = get_texture(import, from, kinds, 2, false, &index);

	if (result != GR_OK || index < 0)
		return result;
	image = &import->scene->images[index];
	pixels = (size_t)image->width * (size_t)image->height;
	for (size_t i = 0; i < pixels; i++) {
		green += image->rgba[4 * i + 1];
		blue += image->rgba[4 * i + 2];
	}
	*roughness *= (float)(green / (255.0 * (double)pixels));
	*metallic *= (float)(blue / (255.0 * (double)pixels));
	return GR_OK;
}

static int map_metallic_roughness(struct import *import, const struct aiMaterial *from,
				  const struct gltf_material *gltf, struct scene_material *out)
{
	float base[3] = { 1, 1, 1 };
	float metallic = 1.0f, roughness = 1.0f, f0;
	int result;

	if (!gltf) { /* a mesh without material: not glTF's white metal, which has no diffuse light */
		out->diffuse[0] = out->diffuse[1] = out->diffuse[2] = IMPORT_DEFAULT_REFLECTANCE;
		return GR_OK;
	}
	get_color(from, AI_MATKEY_BASE_COLOR, base);
	get_float(from, AI_MATKEY_METALLIC_FACTOR, &metallic);
	get_float(from, AI_MATKEY_ROUGHNESS_FACTOR, &roughness);
	limit(import, out, "metallicFactor", &metallic);
	limit(import, out, "roughnessFactor", &roughness);
	result = apply_metallic_roughness_map(import, from, &metallic, &roughness);
	f0 = (gltf->ior - 1.0f) / (gltf->ior + 1.0f);
	f0 *= f0;
	for (int i = 0; i < 3; i++) {
		float dielectric = f0 * gltf->specular_color[i] * gltf->specular_factor;

		limit(import, out, "baseColorFactor", &base[i]);
		limit(import, out, "specular", &dielectric);
		if (metallic == 0.0f && roughness >= IMPORT_LAMBERT_ROUGHNESS)
			dielectric = 0.0f;
		out->specular[i] = dielectric * (1.0f - metallic) + base[i] * metallic;
		out->diffuse[i] = base[i] * (1.0f - metallic) * (1.0f - dielectric);
	}
	out->shininess = shininess_of(roughness);
	out->tinted_specular = metallic >= 0.5f;
	return result;
}

/* Phong materials of OBJ, FBX and Collada. Their sum may exceed 1: then both shrink alike. */
static void map_phong(struct import *import, const struct aiMaterial *from,
		      struct scene_material *out)
{
	float strength = 1.0f, most = 0.0f;
	int model = aiShadingMode_Phong;

	get_color(from, AI_MATKEY_COLOR_DIFFUSE, out->diffuse);
	get_int(from, AI_MATKEY_SHADING_MODEL, &model);
	if (model != aiShadingMode_Flat && model != aiShadingMode_Gouraud) {
		get_color(from, AI_MATKEY_COLOR_SPECULAR, out->specular);
		get_float(from, AI_MATKEY_SHININESS, &out->shininess);
		get_float(from, AI_MATKEY_SHININESS_STRENGTH, &strength);
	}
	for (int i = 0; i < 3; i++) {
		out->specular[i] *= strength;
		limit(import, out, "diffuse", &out->diffuse[i]);
		limit(import, out, "specular", &out->specular[i]);
		if (out->diffuse[i] + out->specular[i] > most)
			most = out->diffuse[i] + out->specular[i];
	}
	for (int i = 0; i < 3 && most > 1.0f; i++) {
		out->diffuse[i] /= most;
		out->specular[i] /= most;
	}
	if (out->shininess < 0.0f)
		out->shininess = 0.0f;
	if (out->shininess > IMPORT_MAX_SHININESS)
		out->shininess = IMPORT_MAX_SHININESS;
}

static int check_material(struct import *import, const struct scene_material *m)
{
	bool good = isfinite(m->shininess);

	for (int i = 0; i < 3; i++)
		good = good && isfinite(m->diffuse[i]) && isfinite(m->specular[i]) &&
		       isfinite(m->emission[i]) && m->emission[i] >= 0.0f;
	if (good)
		return GR_OK;
	gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, m->name,
		    "a value of the material is no finite number, or its emission is negative");
	return GR_ERR_CONFIG;
}

static void note_transparency(struct import *import, const struct aiMaterial *from,
			      const struct scene_material *m)
{
	float opacity = 1.0f;
	struct aiString mode;

	get_float(from, AI_MATKEY_OPACITY, &opacity);
	if (aiGetMaterialString(from, AI_MATKEY_GLTF_ALPHAMODE, &mode) != aiReturn_SUCCESS)
		strcpy(mode.data, "OPAQUE");
	if (opacity < 1.0f || strcmp(mode.data, "OPAQUE") != 0)
		gr_diag_add(import->diag, GR_DIAG_NOTE, import->path, 0, m->name,
			    "transparent material is drawn opaque");
}

static int map_material(struct import *import, const struct aiMaterial *from,
			const struct gltf_material *gltf, struct scene_material *out)
{
	static const enum aiTextureType diffuse[] = { aiTextureType_BASE_COLOR,
						      aiTextureType_DIFFUSE };
	static const enum aiTextureType emission[] = { aiTextureType_EMISSIVE,
						       aiTextureType_EMISSION_COLOR };
	struct aiString name;
	int two_sided = 0, result;
	float ignored;

	if (aiGetMaterialString(from, AI_MATKEY_NAME, &name) == aiReturn_SUCCESS && name.length)
		snprintf(out->name, sizeof out->name, "%.63s", name.data);
	else
		snprintf(out->name, sizeof out->name, "material %td", out - import->scene->materials);
	out->diffuse_image = out->emission_image = -1;
	get_color(from, AI_MATKEY_COLOR_EMISSIVE, out->emission);
	for (int i = 0; i < 3; i++)
		out->emission[i] *= import->options->emission_scale *
				    (gltf ? gltf->emissive_strength : 1.0f);
	get_int(from, AI_MATKEY_TWOSIDED, &two_sided);
	out->two_sided = two_sided || import->options->double_sided;
	result = get_texture(import, from, diffuse, 2, true, &out->diffuse_image);
	if (result == GR_OK)
		result = get_texture(import, from, emission, 2, true, &out->emission_image);
	if (result != GR_OK)
		return result;
	if (import->gltf || (get_float(from, AI_MATKEY_METALLIC_FACTOR, &ignored) &&
			     get_float(from, AI_MATKEY_ROUGHNESS_FACTOR, &ignored)))
		result = map_metallic_roughness(import, from, gltf, out);
	else
		map_phong(import, from, out);
	note_transparency(import, from, out);
	return result == GR_OK ? check_material(import, out) : result;
}

int import_materials(struct import *import)
{
	const struct gltf_material plain = { 1.0f, 1.0f, { 1.0f, 1.0f, 1.0f }, 1.5f };
	const struct aiScene *from = import->from;
	struct scene *scene = import->scene;
	int result = GR_OK;

	if (from->mNumMaterials < 1 && from->mNumMeshes < 1) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, NULL,
			    "there is no model in it: neither a mesh nor a material");
		return GR_ERR_CONFIG;
	}
	if (from->mNumMaterials < 1 || from->mNumMaterials > IMPORT_MAX_MATERIALS) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, NULL,
			    "%u materials; 1 to %d are accepted", from->mNumMaterials,
			    IMPORT_MAX_MATERIALS);
		return GR_ERR_CONFIG;
	}
	scene->materials = calloc(from->mNumMaterials, sizeof scene->materials[0]);
	if (!scene->materials)
		return GR_ERR_NOMEM;
	scene->material_count = from->mNumMaterials;
	for (unsigned i = 0; i < from->mNumMaterials && result == GR_OK; i++) {
		const struct gltf_material *gltf = &plain;

		/* assimp adds one behind the file's for meshes that have none. */
		if (import->gltf)
			gltf = i < import->gltf->material_count ? &import->gltf->materials[i] : NULL;
		result = map_material(import, from->mMaterials[i], gltf, &scene->materials[i]);
	}
	return result;
}
