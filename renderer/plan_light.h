/*
 * gi.method = "auto" as every process of a machine settles it, nodes and
 * `grotto bake` alike: what the scene holds, what this GPU costs
 * (calibrate.h), and what follows (gi/plan.h).
 *
 * GL thread only; a target must be current.
 */
#ifndef GROTTO_RENDERER_PLAN_LIGHT_H
#define GROTTO_RENDERER_PLAN_LIGHT_H

#include "renderer/gi/plan.h"
#include "renderer/gl/target.h"

struct light_plan {
	struct gi_facts facts;
	struct gi_costs costs;
	struct gi_plan plan;
	const char *costs_from; /* for people: where the costs are from; a constant */
};
/*
 * Never fails: what cannot be measured or counted is replaced by what is usual,
 * and the log says so. Some tenths of a second, seconds where costs are measured.
 */
void light_plan_make(struct light_plan *out, struct target *target, const struct scene *scene,
		     const struct scene_file *file);
/*
 * The room's plan, by its code, for what `own` knows of scene and GPU. Pure. False,
 * *out unchanged and *out_why a constant where it is refused, as gi_plan_adopt.
 */
bool light_plan_adopt(struct light_plan *out, const struct light_plan *own,
		      const struct scene_file *file, uint64_t code, const char **out_why);

#endif
