#include "tools/load.h"

#include "base/result.h"
#include "tools/say.h"

int load_scene(const char *path, struct scene_file **out_file, struct scene **out_scene)
{
	struct gr_diag diag = { 0 };
	int result;

	*out_scene = NULL;
	result = scene_file_load(path, out_file, &diag);
	if (result == GR_OK)
		result = scene_import(*out_file, out_scene, &diag);
	say_diag(&diag);
	gr_diag_finish(&diag);
	return result == GR_OK || result == GR_ERR_NOMEM ? result : GR_ERR_CONFIG;
}
