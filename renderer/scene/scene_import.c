/* From a scene file; apart from import.c so that the importer does not need config/. */
#include "renderer/scene/import.h"

#include "base/result.h"

#include <stdlib.h>

int scene_import(const struct scene_file *file, struct scene **out, struct gr_diag *diag)
{
	const struct import_options options = {
		.scale = file->model_scale,
		.emission_scale = file->emission_scale,
		.double_sided = file->double_sided,
	};
	char *path = scene_file_model_path(file);
	int result;

	*out = NULL;
	if (!path)
		return GR_ERR_NOMEM;
	result = import_model(path, &options, out, diag);
	free(path);
	return result;
}
