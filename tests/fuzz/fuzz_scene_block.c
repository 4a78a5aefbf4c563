/* What the process that imports a model hands back: it may have been taken over by the model. */
#include "renderer/scene/scene_block.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gr_diag diag = { 0 };
	struct scene *scene;

	if (scene_block_read(data, size, &scene, &diag) == 0)
		scene_destroy(&scene);
	gr_diag_finish(&diag);
	return 0;
}
