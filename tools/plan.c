#include "tools/plan.h"

#include "base/plain.h"
#include "base/result.h"
#include "renderer/plan_light.h"

#include <stdio.h>

int plan_as_node(struct scene_gi *out, const struct scene_file *file, const struct scene *scene, int gpu)
{
	const struct target_params params = { .kind = TARGET_HEADLESS, .title = "grotto",
					      .width = 16, .height = 16, .gpu = gpu };
	struct target *target;
	struct light_plan light;
	int result = target_create(&target, &params);

	*out = file->gi;
	if (result != GR_OK && gpu >= 0)
		return result;
	if (result != GR_OK) {
		fprintf(stderr,
			"warning: %s: gi.method is \"auto\", and without OpenGL no costs are known: surfels are "
			"as the file says; a node that chooses otherwise bakes its own\n",
			file->path);
		return GR_NOTHING;
	}
	light_plan_make(&light, target, scene, file);
	printf("as a node on %s chooses for %s ms, by %s: %s\n", target_renderer_name(target),
	       gr_plain((double)file->gi.budget_ms, 3).text, light.costs_from, light.plan.why);
	target_destroy(&target);
	*out = light.plan.gi;
	return GR_OK;
}
