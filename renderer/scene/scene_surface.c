#include "renderer/scene/scene_surface.h"

#include "base/result.h"
#include "config/suggest.h"
#include "renderer/scene/brdf_table.h"
#include "renderer/scene/import.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool given(const float *value)
{
	return !isnan(value[0]);
}

/* "a", "b", "c" and how many more, for the message about a name that is none of them. */
static void list_names(const struct scene *scene, char *text, size_t size)
{
	size_t used = 0;

	text[0] = '\0';
	for (size_t i = 0; i < scene->material_count; i++) {
		int n;

		if (used + 100 > size) {
			snprintf(text + used, size - used, " and %zu more", scene->material_count - i);
			return;
		}
		n = snprintf(text + used, size - used, "%s\"%s\"", i ? ", " : "",
			     scene->materials[i].name);
		used += n > 0 ? (size_t)n : 0;
	}
}

static int unknown(const struct scene *scene, const struct scene_file *file,
		   const struct scene_surface *said, struct gr_diag *diag)
{
	struct suggest suggest;
	const char *near;
	char names[1024];

	suggest_start(&suggest, said->material);
	for (size_t i = 0; i < scene->material_count; i++)
		suggest_offer(&suggest, scene->materials[i].name);
	near = suggest_answer(&suggest);
	list_names(scene, names, sizeof names);
	gr_diag_add(diag, GR_DIAG_ERROR, file->path, said->line, "material",
		    "the model has no material \"%s\"%s%s%s; it has %s", said->material,
		    near ? "; did you mean \"" : "", near ? near : "", near ? "\"?" : "", names);
	return GR_ERR_CONFIG;
}

/* The table of a surface, loaded unless one of those before has the same file. */
static int take_table(struct scene *scene, const struct scene_file *file, size_t index,
		      int tables[SCENE_MAX_MATERIALS], struct gr_diag *diag)
{
	const struct scene_surface *said = &file->surfaces[index];
	char *path;
	int result;

	for (size_t i = 0; i < index; i++) {
		if (tables[i] >= 0 && strcmp(file->surfaces[i].file, said->file) == 0) {
			tables[index] = tables[i];
			return GR_OK;
		}
	}
	path = scene_file_beside(file, said->file);
	if (!path)
		return GR_ERR_NOMEM;
	result = brdf_table_load(&scene->tables[scene->table_count], path, diag);
	free(path);
	if (result == GR_OK)
		tables[index] = (int)scene->table_count++;
	return result;
}

static void set_diffuse(struct scene_material *m, const float *reflectance)
{
	memcpy(m->diffuse, reflectance, sizeof m->diffuse);
	m->diffuse_image = -1;
	m->tinted_specular = false;
}

static void set_specular(struct scene_material *m, const float *reflectance, float shininess)
{
	memcpy(m->specular, reflectance, sizeof m->specular);
	m->shininess = fminf(shininess, IMPORT_MAX_SHININESS);
	m->tinted_specular = false;
}

/* Mirror and conductor: no diffuse light, and for the renderer a highlight as wide as theirs. */
static void set_metal(struct scene_material *m, const struct scene_surface *said)
{
	static const float black[3] = { 0 };

	set_diffuse(m, black);
	if (said->kind == SCENE_SURFACE_MIRROR) {
		m->kind = MATERIAL_MIRROR;
		set_specular(m, said->reflectance, IMPORT_MAX_SHININESS);
		return;
	}
	m->kind = MATERIAL_CONDUCTOR;
	m->alpha = said->roughness * said->roughness;
	set_specular(m, said->reflectance, 2 / (m->alpha * m->alpha) - 2);
}

static void set_kind(struct scene_material *m, const struct scene *scene,
		     const struct scene_surface *said, int table)
{
	static const float black[3] = { 0 };

	switch (said->kind) {
	case SCENE_SURFACE_MIRROR:
	case SCENE_SURFACE_CONDUCTOR: set_metal(m, said); return;
	case SCENE_SURFACE_MEASURED:
		m->kind = MATERIAL_MEASURED;
		m->table = table;
		set_specular(m, black, 0);
		set_diffuse(m, brdf_table_facts(scene->tables[table])->reflectance);
		return;
	case SCENE_SURFACE_DIFFUSE: set_specular(m, black, 0); break;
	case SCENE_SURFACE_PHONG: set_specular(m, said->specular, said->shininess); break;
	case SCENE_SURFACE_AS_MODEL: break;
	}
	if (given(said->reflectance))
		set_diffuse(m, said->reflectance);
}

/* What the file says and what the model says may be more than 1 together. */
static int check_energy(const struct scene_material *m, const struct scene_file *file,
			const struct scene_surface *said, struct gr_diag *diag)
{
	for (int c = 0; c < 3; c++) {
		if (m->diffuse[c] + m->specular[c] <= 1 + 1e-5f)
			continue;
		gr_diag_add(diag, GR_DIAG_ERROR, file->path, said->line, "materials",
			    "\"%s\" reflects %g diffusely and %g in its highlight; at most 1 comes back",
			    m->name, (double)m->diffuse[c], (double)m->specular[c]);
		return GR_ERR_CONFIG;
	}
	return GR_OK;
}

static int apply(struct scene *scene, const struct scene_file *file, size_t index, int table,
		 struct gr_diag *diag)
{
	const struct scene_surface *said = &file->surfaces[index];
	bool found = false;
	int result = GR_OK;

	for (size_t i = 0; i < scene->material_count; i++) {
		struct scene_material *m = &scene->materials[i];

		if (strcmp(m->name, said->material) != 0)
			continue;
		found = true;
		set_kind(m, scene, said, table);
		if (given(said->emission)) {
			memcpy(m->emission, said->emission, sizeof m->emission);
			m->emission_image = -1;
		}
		if (said->sides != SCENE_SIDES_AS_MODEL)
			m->two_sided = said->sides == SCENE_SIDES_TWO;
		if (check_energy(m, file, said, diag) != GR_OK)
			result = GR_ERR_CONFIG;
	}
	return found ? result : unknown(scene, file, said, diag);
}

int scene_apply_surfaces(struct scene *scene, const struct scene_file *file, struct gr_diag *diag)
{
	int tables[SCENE_MAX_MATERIALS];
	int result = GR_OK;

	scene->tables = calloc(file->surface_count + 1, sizeof(struct brdf_table *));
	if (!scene->tables)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < file->surface_count && i < SCENE_MAX_MATERIALS; i++) {
		int one = GR_OK;

		tables[i] = -1;
		if (file->surfaces[i].kind == SCENE_SURFACE_MEASURED)
			one = take_table(scene, file, i, tables, diag);
		if (one == GR_OK)
			one = apply(scene, file, i, tables[i], diag);
		if (one == GR_ERR_NOMEM)
			return one;
		if (one != GR_OK) /* go on, so that all faults are seen */
			result = one;
	}
	return result;
}
