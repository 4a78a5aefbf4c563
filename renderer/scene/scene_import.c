/* From a scene file; apart from import.c so that the importer does not need config/. */
#include "base/result.h"
#include "renderer/scene/environment.h"
#include "renderer/scene/import.h"
#include "renderer/scene/scene_surface.h"

#include <stdlib.h>

int scene_import(const struct scene_file *file, struct scene **out, struct gr_diag *diag)
{
	const struct import_options options = {
		.scale = file->model_scale,
		.emission_scale = file->emission_scale,
		.double_sided = file->double_sided,
	};
	char *path = scene_file_model_path(file);
	int result, environment;

	*out = NULL;
	if (!path)
		return GR_ERR_NOMEM;
	result = import_model(path, &options, out, diag);
	free(path);
	if (result != GR_OK)
		return result;
	result = scene_apply_surfaces(*out, file, diag);
	environment = environment_create(&(*out)->environment, file, diag);
	if (environment < 0)
		result = environment;
	if (result != GR_OK) {
		scene_destroy(out);
		return result;
	}
	scene_note_emission(*out);
	scene_hash(*out);
	return GR_OK;
}
