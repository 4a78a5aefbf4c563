/* glTF models from outside: the check of the JSON and the importer behind it. */
#include "renderer/scene/import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const struct import_options options = { .scale = 1.0f, .emission_scale = 1.0f };
	struct gr_diag diag = { 0 };
	struct scene *scene;

	if (import_bytes_here(data, size, "fuzz.glb", &options, &scene, &diag) == 0)
		scene_destroy(&scene);
	gr_diag_finish(&diag);
	return 0;
}
