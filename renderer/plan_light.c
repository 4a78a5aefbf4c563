#include "renderer/plan_light.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/calibrate.h"

void light_plan_make(struct light_plan *out, struct target *target, const struct scene *scene,
		     const struct scene_file *file)
{
	out->costs = gi_costs_usual;
	out->costs_from = "no costs needed";
	gi_facts_take(&out->facts, scene, file);
	if (gi_plan_needs_costs(&out->facts)) {
		calibrate_kept(&out->costs, target, &out->costs_from);
		if (gi_facts_count(&out->facts, scene) != GR_OK)
			gr_notice("surfels could not be counted before they are baked: planned by the scene's area alone");
	}
	gi_plan_make(&out->plan, &out->facts, &file->gi, &out->costs);
}

bool light_plan_adopt(struct light_plan *out, const struct light_plan *own,
		      const struct scene_file *file, uint64_t code, const char **out_why)
{
	struct light_plan light = *own;

	if (!gi_plan_adopt(&light.plan, &own->facts, &file->gi, &own->costs, code, out_why))
		return false;
	*out = light;
	return true;
}
